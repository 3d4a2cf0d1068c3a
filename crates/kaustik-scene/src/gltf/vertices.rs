//! The vertex attributes of a primitive.

use glam::{Vec2, Vec3, Vec4};
use kaustik_geometry::Mesh;

use super::accessor::{Accessor, Allowed, Component};
use super::json::Cursor;
use super::reader::Reader;
use super::{ErrorKind, LoadError};

use Component::{I8, I16, U8, U16};

type Result<T> = std::result::Result<T, LoadError>;

/// What is read of a primitive's attributes.
pub(super) const NAMES: [&str; 6] = [
    "POSITION",
    "NORMAL",
    "TANGENT",
    "TEXCOORD_0",
    "TEXCOORD_1",
    "COLOR_0",
];

pub(super) const fn allowed(
    components: &'static [Component],
    plain_integers: bool,
    words: &'static str,
) -> Allowed {
    Allowed {
        components,
        plain_integers,
        words,
    }
}

const POSITION: Allowed = allowed(
    &[],
    false,
    "VEC3 of FLOAT (integers need KHR_mesh_quantization)",
);
const POSITION_QUANTIZED: Allowed =
    allowed(&[I8, U8, I16, U16], true, "VEC3 of FLOAT, BYTE or SHORT");
pub(super) const VECTOR: Allowed = allowed(&[], false, "VEC3 of FLOAT");
const DIRECTION_QUANTIZED: Allowed =
    allowed(&[I8, I16], false, "FLOAT, or normalized BYTE or SHORT");
const TANGENT: Allowed = allowed(&[], false, "VEC4 of FLOAT");
pub(super) const ROTATION: Allowed = allowed(
    &[I8, I16],
    false,
    "VEC4 of FLOAT, or normalized BYTE or SHORT",
);
/// Of an animation, which may say it without signs as well.
pub(super) const ANIMATED_ROTATION: Allowed = allowed(
    &[I8, U8, I16, U16],
    false,
    "VEC4 of FLOAT, or normalized BYTE, SHORT, UNSIGNED_BYTE or _SHORT",
);
const UV: Allowed = allowed(
    &[U8, U16],
    false,
    "VEC2 of FLOAT, or normalized UNSIGNED_BYTE or _SHORT",
);
const UV_QUANTIZED: Allowed = allowed(&[I8, U8, I16, U16], true, "VEC2 of FLOAT, BYTE or SHORT");
const COLOR: Allowed = allowed(
    &[U8, U16],
    false,
    "VEC3 or VEC4 of FLOAT, or normalized UNSIGNED_BYTE or _SHORT",
);

/// All vertices of a primitive: a mesh without triangles.
pub(super) fn read<'a>(reader: &mut Reader<'a>, attributes: &Cursor<'a>) -> Result<Mesh> {
    let positions = positions(reader, attributes)?;
    let count = positions.len();
    let mesh = Mesh {
        normals: normals(reader, attributes, count)?,
        tangents: tangents(reader, attributes, count)?,
        uv: [
            uv(reader, attributes, "TEXCOORD_0", count)?,
            uv(reader, attributes, "TEXCOORD_1", count)?,
        ],
        colors: colors(reader, attributes, count)?,
        positions,
        indices: Vec::new(),
    };
    Ok(mesh)
}

/// By how much a morph target moves an attribute at each vertex; empty if it leaves that alone. What is not finite moves
/// nothing.
pub(super) fn displacements<'a>(
    reader: &mut Reader<'a>,
    target: &Cursor<'a>,
    name: &'static str,
    count: usize,
) -> Result<Vec<[f32; 3]>> {
    let allowed = match (reader.quantized, name) {
        (false, _) => VECTOR,
        (true, "POSITION") => POSITION_QUANTIZED,
        (true, _) => DIRECTION_QUANTIZED,
    };
    let mut values = attribute(reader, target, name, Some(count), &allowed)?;
    replace(reader, target, name, &mut values, finite, [0.0; 3])?;
    Ok(values)
}

/// The values of an attribute, one a vertex; empty if there is no such attribute.
pub(super) fn attribute<'a, const N: usize>(
    reader: &mut Reader<'a>,
    attributes: &Cursor<'a>,
    name: &'static str,
    count: Option<usize>,
    allowed: &Allowed,
) -> Result<Vec<[f32; N]>> {
    let Some(place) = attributes.get(name)? else {
        return Ok(Vec::new());
    };
    accessor(reader, &place, count)?.floats(allowed, &reader.buffers, &mut reader.budget)
}

/// The accessor of an attribute at a place, which has a value for each of so many vertices.
pub(super) fn accessor<'a>(
    reader: &Reader<'a>,
    place: &Cursor<'a>,
    count: Option<usize>,
) -> Result<Accessor<'a>> {
    let accessor = Accessor::find(&reader.root, place)?;
    if let Some(count) = count.filter(|&count| count != accessor.count()) {
        let found = format!("{} values", accessor.count());
        let expected = format!("one for each of the {count} positions");
        return Err(place.error(ErrorKind::Value, found, expected));
    }
    Ok(accessor)
}

fn positions<'a>(reader: &mut Reader<'a>, attributes: &Cursor<'a>) -> Result<Vec<Vec3>> {
    let allowed = if reader.quantized {
        POSITION_QUANTIZED
    } else {
        POSITION
    };
    let values = attribute(reader, attributes, "POSITION", None, &allowed)?;
    if let Some(vertex) = values.iter().position(|v| !finite(v)) {
        let place = attributes.need("POSITION")?;
        let found = format!("vertex {vertex} at {:?}", values[vertex]);
        return Err(place.error(ErrorKind::NotFinite, found, "finite positions"));
    }
    Ok(values.into_iter().map(Vec3::from).collect())
}

/// A normal that is not finite becomes zero, for which geometry takes the face's.
fn normals<'a>(
    reader: &mut Reader<'a>,
    attributes: &Cursor<'a>,
    count: usize,
) -> Result<Vec<Vec3>> {
    let allowed = if reader.quantized {
        DIRECTION_QUANTIZED
    } else {
        VECTOR
    };
    let mut values = attribute(reader, attributes, "NORMAL", Some(count), &allowed)?;
    replace(reader, attributes, "NORMAL", &mut values, finite, [0.0; 3])?;
    Ok(values.into_iter().map(Vec3::from).collect())
}

/// The sign in w is made +-1. Where a tangent is not finite, all are left out.
fn tangents<'a>(
    reader: &mut Reader<'a>,
    attributes: &Cursor<'a>,
    count: usize,
) -> Result<Vec<Vec4>> {
    let allowed = if reader.quantized {
        DIRECTION_QUANTIZED
    } else {
        TANGENT
    };
    let values: Vec<[f32; 4]> = attribute(reader, attributes, "TANGENT", Some(count), &allowed)?;
    if let Some(vertex) = values.iter().position(|v| !finite(v)) {
        let message = format!("vertex {vertex} is not finite; the tangents are left out");
        reader.warn(&attributes.need("TANGENT")?, message);
        return Ok(Vec::new());
    }
    // aligned differently, the values are copied
    let bytes = size_of_val(&values[..]) as u64;
    reader.budget.take(&attributes.pointer(), bytes)?;
    reader.budget.give(bytes);
    let signed = |[x, y, z, w]: [f32; 4]| Vec4::new(x, y, z, if w < 0.0 { -1.0 } else { 1.0 });
    Ok(values.into_iter().map(signed).collect())
}

fn uv<'a>(
    reader: &mut Reader<'a>,
    attributes: &Cursor<'a>,
    name: &'static str,
    count: usize,
) -> Result<Vec<Vec2>> {
    let allowed = if reader.quantized { UV_QUANTIZED } else { UV };
    let mut values = attribute(reader, attributes, name, Some(count), &allowed)?;
    replace(reader, attributes, name, &mut values, finite, [0.0; 2])?;
    Ok(values.into_iter().map(Vec2::from).collect())
}

fn colors<'a>(
    reader: &mut Reader<'a>,
    attributes: &Cursor<'a>,
    count: usize,
) -> Result<Vec<[f32; 4]>> {
    let Some(place) = attributes.get("COLOR_0")? else {
        return Ok(Vec::new());
    };
    let mut values = if Accessor::find(&reader.root, &place)?.width() == 3 {
        let values = attribute(reader, attributes, "COLOR_0", Some(count), &COLOR)?;
        reader
            .budget
            .take_many(&place.pointer(), count, size_of::<[f32; 4]>())?;
        reader.budget.give(size_of_val(&values[..]) as u64);
        values.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect()
    } else {
        attribute(reader, attributes, "COLOR_0", Some(count), &COLOR)?
    };
    replace(reader, attributes, "COLOR_0", &mut values, finite, [1.0; 4])?;
    // As glTF has it (3.7.2.1).
    for value in values.as_flattened_mut() {
        *value = value.clamp(0.0, 1.0);
    }
    Ok(values)
}

/// Puts `substitute` where a value is not sound, with a warning.
fn replace<'a, const N: usize>(
    reader: &mut Reader<'a>,
    attributes: &Cursor<'a>,
    name: &'static str,
    values: &mut [[f32; N]],
    sound: impl Fn(&[f32; N]) -> bool,
    substitute: [f32; N],
) -> Result<()> {
    let Some(first) = values.iter().position(|v| !sound(v)) else {
        return Ok(());
    };
    let found = values[first];
    for value in values.iter_mut().filter(|v| !sound(v)) {
        *value = substitute;
    }
    let message = format!("vertex {first} is {found:?}; {substitute:?} is used for such");
    reader.warn(&attributes.need(name)?, message);
    Ok(())
}

fn finite<const N: usize>(value: &[f32; N]) -> bool {
    value.iter().all(|x| x.is_finite())
}
