//! Where meshes with a skin stand, and how they are bent.

use std::collections::HashMap;
use std::rc::Rc;

use glam::{DAffine3, DMat4};

use super::accessor::{Accessor, Allowed};
use super::json::Cursor;
use super::node::Placed;
use super::reader::Reader;
use super::{ErrorKind, LoadError};

type Result<T> = std::result::Result<T, LoadError>;

/// What a skin does to a mesh while all joints rest.
///
/// The first joint holds the mesh, and moves it if it moves; by glTF's rules the transform of the mesh's
/// own node is ignored. What the others do beyond that bends it.
#[derive(Clone, Debug)]
pub(super) struct Skin {
    /// Position of the first joint in the list of placed nodes.
    pub(super) first: usize,
    /// From the mesh to the first joint.
    pub(super) inverse_bind: DAffine3,
    /// What each joint does to the mesh as the first joint holds it; `None` where all rest as they were bound.
    pub(super) bends: Option<Rc<[DAffine3]>>,
    /// Positions of the joints that are in the scene.
    pub(super) joints: Rc<[usize]>,
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
        let list = place.need("joints")?;
        let each = size_of::<Option<usize>>() + size_of::<usize>() + 2 * size_of::<DAffine3>();
        let count = place.count("joints")?;
        (reader.budget).take_many(&list.pointer(), count, each)?;
        let mut joints = Vec::with_capacity(count);
        for joint in list.items()? {
            joints.push(positions.get(&joint.index("/nodes", all)?).copied());
        }
        if joints.is_empty() {
            return Err(list.mismatch("at least one joint"));
        }
        let binds = inverse_binds(reader, &place, joints.len())?;
        found.push(skin(nodes, &joints, &binds));
    }
    Ok(found)
}

fn skin(nodes: &[Placed<'_>], joints: &[Option<usize>], binds: &[DAffine3]) -> Option<Skin> {
    let first = (*joints.first()?)?;
    let bind = |joint: usize| binds.get(joint).copied().unwrap_or(DAffine3::IDENTITY);
    Some(Skin {
        first,
        inverse_bind: bind(0),
        bends: bends(nodes, joints, bind, nodes[first].world * bind(0)),
        joints: joints.iter().flatten().copied().collect(),
    })
}

/// What the joints do beyond `held`, which is what the first one does. One that is not in the scene does what that does.
fn bends(
    nodes: &[Placed<'_>],
    joints: &[Option<usize>],
    bind: impl Fn(usize) -> DAffine3,
    held: DAffine3,
) -> Option<Rc<[DAffine3]>> {
    // Exporters round matrices and positions to single precision.
    const ROUNDING: f64 = 1e-6;
    let back = held.inverse();
    if !back.is_finite() {
        return None; // flat, or nothing of it is seen
    }
    let bend = |(index, joint): (usize, &Option<usize>)| match joint {
        Some(joint) => back * nodes[*joint].world * bind(index),
        None => DAffine3::IDENTITY,
    };
    let bends: Rc<[DAffine3]> = joints.iter().enumerate().map(bend).collect();
    let rests = |bend: &DAffine3| bend.abs_diff_eq(DAffine3::IDENTITY, ROUNDING);
    (!bends.iter().all(rests)).then_some(bends)
}

const MATRICES: Allowed = Allowed {
    components: &[],
    plain_integers: false,
    words: "MAT4 of FLOAT",
};

/// One for each of so many joints, or none at all. What is read for them stays in the budget: many skins may name one
/// long list.
fn inverse_binds<'a>(
    reader: &mut Reader<'a>,
    skin: &Cursor<'a>,
    joints: usize,
) -> Result<Vec<DAffine3>> {
    let Some(place) = skin.get("inverseBindMatrices")? else {
        return Ok(Vec::new());
    };
    let accessor = Accessor::find(&reader.root, &place)?;
    if accessor.count() < joints {
        let found = format!("{} matrices", accessor.count());
        let expected = format!("one for each of the {joints} joints");
        return Err(place.error(ErrorKind::Value, found, expected));
    }
    let matrices: Vec<[f32; 16]> =
        accessor.floats(&MATRICES, &reader.buffers, &mut reader.budget)?;
    let affine =
        |matrix: &[f32; 16]| DAffine3::from_mat4(DMat4::from_cols_array(&matrix.map(f64::from)));
    Ok(matrices.iter().take(joints).map(affine).collect())
}
