use std::collections::HashMap;
use std::sync::Arc;

use kaustik_geometry::Mesh;

use super::accessor::Accessor;
use super::budget::VISIT;
use super::json::Cursor;
use super::reader::Reader;
use super::shape::Shape;
use super::triangles::Topology;
use super::variant::Variants;
use super::{ErrorKind, LoadError, vertices};

type Result<T> = std::result::Result<T, LoadError>;

/// The accessors of a primitive's vertices.
type Attributes = [Option<usize>; vertices::NAMES.len()];

/// What makes two primitives the same geometry, whatever their materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Key {
    attributes: Attributes,
    indices: Option<usize>,
    topology: Topology,
}

/// A primitive: a mesh of the description and a material.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub(super) mesh: usize,
    pub(super) material: Option<usize>,
}

/// All geometry of the file. Primitives over the same accessors are one mesh.
#[derive(Debug, Default)]
pub(super) struct Meshes {
    pub(super) list: Vec<Arc<Mesh>>,
    /// The primitives of each mesh of the file.
    pub(super) parts: Vec<Vec<Part>>,
}

impl Meshes {
    pub(super) fn load(reader: &mut Reader<'_>, variants: &Variants) -> Result<Self> {
        let mut plan = Plan::default();
        let mut parts = Vec::new();
        for place in reader.root.list("meshes")? {
            let mut own = Vec::new();
            for primitive in place.need("primitives")?.items()? {
                own.extend(plan.part(reader, variants, primitive)?);
            }
            parts.push(own);
        }
        let list = plan.read(reader)?;
        Ok(Self { list, parts })
    }
}

/// The geometries of a mesh in another shape, in the order of [`Meshes::parts`].
pub(super) fn shaped<'a>(
    reader: &mut Reader<'a>,
    place: &Cursor<'a>,
    shape: &Shape,
) -> Result<Vec<Arc<Mesh>>> {
    let mut list = Vec::new();
    // Exporters put the vertices of thousands of primitives into one buffer.
    let mut last: Option<(Cursor<'a>, Mesh)> = None;
    for primitive in place.need("primitives")?.items()? {
        let Some(key) = key(&primitive)? else {
            continue;
        };
        let vertices = match last.take() {
            Some((before, vertices)) if are_alike(&before, &primitive)? => vertices,
            before => {
                if let Some((_, idle)) = before {
                    reader.budget.give(idle.memory() as u64);
                }
                let mut vertices = vertices::read(reader, &primitive.need("attributes")?)?;
                reader.budget.work(&primitive, vertices.memory())?;
                shape.apply(reader, &primitive, &mut vertices)?;
                vertices
            }
        };
        let own = own_vertices(reader, &primitive, &key, &vertices)?;
        let around = size_of::<Mesh>() + 2 * size_of::<Arc<Mesh>>();
        reader.budget.take(&primitive.pointer(), around as u64)?;
        reader.budget.work(&primitive, own.memory() + VISIT)?;
        list.push(checked(own, &primitive)?);
        last = Some((primitive, vertices));
    }
    if let Some((_, idle)) = last {
        reader.budget.give(idle.memory() as u64);
    }
    Ok(list)
}

/// Do two primitives have the same vertices and morph targets?
fn are_alike<'a>(one: &Cursor<'a>, other: &Cursor<'a>) -> Result<bool> {
    let attributes = one.need("attributes")?.says_as(&other.need("attributes")?);
    let targets = match (one.get("targets")?, other.get("targets")?) {
        (Some(one), Some(other)) => one.says_as(&other),
        (None, None) => true,
        _ => false,
    };
    Ok(attributes && targets)
}

/// The different geometries of a file, in the order in which they are first used.
#[derive(Debug, Default)]
struct Plan<'a> {
    wanted: Vec<(Key, Cursor<'a>)>,
    known: HashMap<Key, usize>,
}

impl<'a> Plan<'a> {
    fn part(
        &mut self,
        reader: &mut Reader<'a>,
        variants: &Variants,
        primitive: Cursor<'a>,
    ) -> Result<Option<Part>> {
        let Some(key) = key(&primitive)? else {
            let topology = Topology::read(&primitive)?;
            let what = if topology.is_none() {
                "points or lines"
            } else {
                "no POSITION"
            };
            reader.warn(&primitive, format!("{what}; the primitive is left out"));
            return Ok(None);
        };
        let material = variants.material(&reader.root, &primitive)?;
        let mesh = *self.known.entry(key).or_insert(self.wanted.len());
        if mesh == self.wanted.len() {
            self.wanted.push((key, primitive));
        }
        Ok(Some(Part { mesh, material }))
    }

    /// Reads all geometries, those over the same vertices one after another: each set of vertices is read
    /// once, whatever the order of the primitives.
    fn read(self, reader: &mut Reader<'a>) -> Result<Vec<Arc<Mesh>>> {
        let mut first = HashMap::new();
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for (index, (key, _)) in self.wanted.iter().enumerate() {
            let group = *first.entry(key.attributes).or_insert(groups.len());
            match groups.get_mut(group) {
                Some(group) => group.push(index),
                None => groups.push(vec![index]),
            }
        }
        let mut list = vec![None; self.wanted.len()];
        for group in groups {
            let (_, primitive) = &self.wanted[group[0]];
            let mut vertices = vertices::read(reader, &primitive.need("attributes")?)?;
            reader.budget.work(primitive, vertices.memory())?;
            if let [index] = group[..] {
                let (key, primitive) = &self.wanted[index];
                vertices.indices =
                    triangles(reader, primitive, key.topology, vertices.positions.len())?;
                list[index] = Some(checked(vertices, primitive)?);
                continue;
            }
            for index in group {
                let (key, primitive) = &self.wanted[index];
                let own = own_vertices(reader, primitive, key, &vertices)?;
                list[index] = Some(checked(own, primitive)?);
            }
            reader.budget.give(vertices.memory() as u64);
        }
        Ok(list.into_iter().flatten().collect())
    }
}

fn checked(mesh: Mesh, primitive: &Cursor<'_>) -> Result<Arc<Mesh>> {
    let checked = mesh.checked();
    checked
        .map(Arc::new)
        .map_err(|e| primitive.error(ErrorKind::Value, e.to_string(), "a well-formed mesh"))
}

/// A primitive that uses only some of the vertices it names gets a copy of those alone: exporters put the vertices of
/// thousands of primitives into one buffer.
fn own_vertices<'a>(
    reader: &mut Reader<'a>,
    primitive: &Cursor<'a>,
    key: &Key,
    all: &Mesh,
) -> Result<Mesh> {
    let triangles = triangles(reader, primitive, key.topology, all.positions.len())?;
    let each = all.memory() / all.positions.len().max(1);
    let most = all.positions.len().min(3 * triangles.len());
    reader.budget.take_many(&primitive.pointer(), most, each)?;
    let scratch = size_of_val(&triangles[..]) as u64;
    reader.budget.take(&primitive.pointer(), scratch)?;
    let mesh = compact(all, triangles);
    reader.budget.give(scratch);
    Ok(mesh)
}

/// `None` for what has no triangles.
fn key(primitive: &Cursor<'_>) -> Result<Option<Key>> {
    let Some(topology) = Topology::read(primitive)? else {
        return Ok(None);
    };
    let place = primitive.need("attributes")?;
    let mut attributes = [None; vertices::NAMES.len()];
    for (attribute, name) in attributes.iter_mut().zip(vertices::NAMES) {
        *attribute = place.get(name)?.map(|a| a.usize()).transpose()?;
    }
    if attributes[0].is_none() {
        return Ok(None);
    }
    Ok(Some(Key {
        attributes,
        indices: primitive.get("indices")?.map(|i| i.usize()).transpose()?,
        topology,
    }))
}

/// The triangles of a primitive over `vertices` vertices.
fn triangles<'a>(
    reader: &mut Reader<'a>,
    primitive: &Cursor<'a>,
    topology: Topology,
    vertices: usize,
) -> Result<Vec<[u32; 3]>> {
    let pointer = primitive.pointer();
    let indices = match primitive.get("indices")? {
        Some(place) => Some(indices(reader, &place, vertices)?),
        None => None,
    };
    let corners = indices.as_ref().map_or(vertices, Vec::len);
    if topology == Topology::List && corners % 3 != 0 {
        reader.warn(
            primitive,
            "its vertices do not make whole triangles; the rest is left out",
        );
    }
    reader
        .budget
        .take_many(&pointer, topology.count(corners), size_of::<[u32; 3]>())?;
    Ok(match indices {
        Some(indices) => {
            let triangles = topology.triangles(corners, |i| indices[i]);
            reader.budget.give(size_of_val(&indices[..]) as u64);
            triangles
        }
        None => topology.triangles(corners, |i| i as u32),
    })
}

fn indices<'a>(reader: &mut Reader<'a>, place: &Cursor<'a>, vertices: usize) -> Result<Vec<u32>> {
    let accessor = Accessor::find(&reader.root, place)?;
    let indices = accessor.indices(&reader.buffers, &mut reader.budget)?;
    if let Some(at) = indices.iter().position(|&i| i as usize >= vertices) {
        let found = format!("index {} at position {at}", indices[at]);
        let expected = format!("indices below {vertices}, the number of vertices");
        return Err(place.error(ErrorKind::Reference, found, expected));
    }
    Ok(indices)
}

/// The vertices that the triangles use, in their old order, and the triangles over them.
fn compact(all: &Mesh, mut triangles: Vec<[u32; 3]>) -> Mesh {
    let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    for index in triangles.iter_mut().flatten() {
        // found, as it was put there
        *index = used.binary_search(index).unwrap_or_default() as u32;
    }
    fn pick<T: Copy>(used: &[u32], values: &[T]) -> Vec<T> {
        let value = |&i: &u32| values.get(i as usize).copied();
        used.iter().filter_map(value).collect()
    }
    Mesh {
        positions: pick(&used, &all.positions),
        indices: triangles,
        normals: pick(&used, &all.normals),
        tangents: pick(&used, &all.tangents),
        uv: [pick(&used, &all.uv[0]), pick(&used, &all.uv[1])],
        colors: pick(&used, &all.colors),
    }
}
