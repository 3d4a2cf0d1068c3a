//! Node transforms, in double precision until they are placed.

use glam::{Affine3A, DAffine3, DMat3, DQuat, DVec3};

use super::json::Cursor;
use super::reader::Reader;
use super::{ErrorKind, LoadError};
use crate::description::Rest;

/// The transform of a node to its parent: a matrix, or translation, rotation and scale.
pub(super) fn local(reader: &mut Reader<'_>, node: &Cursor<'_>) -> Result<DAffine3, LoadError> {
    if let Some(place) = node.get("matrix")? {
        return matrix(reader, &place);
    }
    let vector = |key, default| {
        let [x, y, z] = node.floats_or(key, default)?;
        Ok(DVec3::new(x.into(), y.into(), z.into()))
    };
    let rotation = match node.get("rotation")? {
        Some(place) => rotation(place.floats()?).unwrap_or_else(|| {
            reader.warn(&place, "a rotation of length 0 is ignored");
            DQuat::IDENTITY
        }),
        None => DQuat::IDENTITY,
    };
    Ok(DAffine3::from_scale_rotation_translation(
        vector("scale", [1.0; 3])?,
        rotation,
        vector("translation", [0.0; 3])?,
    ))
}

/// Translation, rotation and scale of a node without a matrix.
pub(super) fn rest(node: &Cursor<'_>) -> Result<Rest, LoadError> {
    Ok(Rest {
        translation: node.floats_or("translation", [0.0; 3])?,
        rotation: node.floats_or("rotation", [0.0, 0.0, 0.0, 1.0])?,
        scale: node.floats_or("scale", [1.0; 3])?,
    })
}

/// The unit quaternion along `[x, y, z, w]`; `None` if that has no length.
pub(super) fn rotation(xyzw: [f32; 4]) -> Option<DQuat> {
    let quaternion = DQuat::from_array(xyzw.map(f64::from));
    let length = quaternion.length_squared().sqrt();
    (length > 0.0).then(|| DQuat::from_array(quaternion.to_array().map(|q| q / length)))
}

/// Sixteen numbers, column by column; the last row is that of an affine map.
fn matrix(reader: &mut Reader<'_>, place: &Cursor<'_>) -> Result<DAffine3, LoadError> {
    let m = place.floats::<16>()?;
    let last = [m[3], m[7], m[11], m[15]];
    let affine = [0.0, 0.0, 0.0, 1.0_f32];
    if last.iter().zip(affine).any(|(&a, b)| (a - b).abs() > 1e-6) {
        reader.warn(place, "its last row is not (0, 0, 0, 1) and is ignored");
    }
    let column = |i: usize| DVec3::new(m[4 * i].into(), m[4 * i + 1].into(), m[4 * i + 2].into());
    Ok(DAffine3 {
        matrix3: DMat3::from_cols(column(0), column(1), column(2)),
        translation: column(3),
    })
}

/// Thickness of what is flattened along one axis, in units of its size along the others.
const THIN: f64 = 1e-4;

/// A transform that flattens along one axis (glTF allows such scales), with a little left along that axis, so
/// that there is a way back for rays: what was flat already does not change. `None` where only a line or a
/// point is left.
pub(super) fn flattened(transform: &Affine3A) -> Option<Affine3A> {
    let m = transform.matrix3.as_dmat3();
    // Of rank 2: the normal of the plane that is left, times the axis that is lost, times the area that the
    // others span.
    let cofactors = DMat3::from_cols(
        m.y_axis.cross(m.z_axis),
        m.z_axis.cross(m.x_axis),
        m.x_axis.cross(m.y_axis),
    );
    let norm = |m: DMat3| m.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt();
    let area = norm(cofactors);
    if area <= 1e-6 * norm(m).powi(2) {
        return None;
    }
    let thick = m + cofactors * (THIN * area.sqrt() / area);
    let thick = thick.as_mat3();
    (thick.as_dmat3().determinant() != 0.0).then(|| Affine3A {
        matrix3: thick.into(),
        translation: transform.translation,
    })
}

/// In single precision, if it stays finite there.
pub(super) fn narrow(world: &DAffine3, node: &Cursor<'_>) -> Result<Affine3A, LoadError> {
    let narrow = Affine3A::from_cols_array(&world.to_cols_array().map(|x| x as f32));
    if narrow.is_finite() {
        return Ok(narrow);
    }
    let found = "a transform to the world with infinite entries";
    Err(node.error(ErrorKind::NotFinite, found, "entries below 3.4e38"))
}
