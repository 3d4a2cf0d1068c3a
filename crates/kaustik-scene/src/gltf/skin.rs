//! Where meshes with a skin stand.

use std::collections::HashMap;

use glam::{DAffine3, DMat4};

use super::LoadError;
use super::accessor::{Accessor, Allowed};
use super::json::Cursor;
use super::node::Placed;
use super::reader::Reader;

type Result<T> = std::result::Result<T, LoadError>;

/// How the first joint of a skin holds the mesh.
///
/// Skins are not bent here. Where all joints rest as they were bound, each vertex goes where the first joint
/// takes it; by glTF's rules the transform of the mesh's own node is ignored.
#[derive(Clone, Copy, Debug)]
pub(super) struct Skin {
    /// Position of the joint in the list of placed nodes.
    pub(super) joint: usize,
    /// From the mesh to the joint.
    pub(super) inverse_bind: DAffine3,
}

/// All skins of the file; `None` for one whose first joint is not in the scene.
pub(super) fn load(reader: &mut Reader<'_>, nodes: &[Placed<'_>]) -> Result<Vec<Option<Skin>>> {
    let skins = reader.root.list("skins")?;
    if skins.is_empty() {
        return Ok(Vec::new());
    }
    let all = reader.root.count("nodes")?;
    let positions = nodes.iter().enumerate();
    let positions: HashMap<usize, usize> = positions.map(|(at, node)| (node.index, at)).collect();
    let mut found = Vec::new();
    for place in skins {
        let joints = place.need("joints")?;
        let Some(first) = joints.items()?.next() else {
            return Err(joints.mismatch("at least one joint"));
        };
        let joint = positions.get(&first.index("/nodes", all)?).copied();
        let inverse_bind = inverse_bind(reader, &place)?;
        found.push(joint.map(|joint| Skin {
            joint,
            inverse_bind,
        }));
    }
    Ok(found)
}

const MATRICES: Allowed = Allowed {
    components: &[],
    plain_integers: false,
    words: "MAT4 of FLOAT",
};

/// That of the first joint. What is read for it stays in the budget: many skins may name one long list.
fn inverse_bind<'a>(reader: &mut Reader<'a>, skin: &Cursor<'a>) -> Result<DAffine3> {
    let Some(place) = skin.get("inverseBindMatrices")? else {
        return Ok(DAffine3::IDENTITY);
    };
    let accessor = Accessor::find(&reader.root, &place)?;
    let matrices: Vec<[f32; 16]> =
        accessor.floats(&MATRICES, &reader.buffers, &mut reader.budget)?;
    let Some(first) = matrices.first() else {
        return Err(place.mismatch("a matrix for each joint"));
    };
    Ok(DAffine3::from_mat4(DMat4::from_cols_array(
        &first.map(f64::from),
    )))
}
