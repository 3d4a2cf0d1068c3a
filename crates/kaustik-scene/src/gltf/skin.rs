//! Where meshes with a skin stand, and how they are bent.

use std::collections::HashMap;
use std::rc::Rc;

use glam::{DAffine3, DMat3, DMat4, DVec3};

use super::accessor::{Accessor, Allowed};
use super::animation::{Carrier, Rig};
use super::json::Cursor;
use super::node::Placed;
use super::reader::Reader;
use super::{ErrorKind, LoadError};

type Result<T> = std::result::Result<T, LoadError>;

/// What a skin does to a mesh while all joints rest. By glTF's rules the transform of the mesh's own node is ignored.
#[derive(Clone, Debug)]
pub(super) struct Skin {
    /// Where the mesh stands.
    pub(super) world: DAffine3,
    /// What moves it.
    pub(super) carrier: Carrier,
    /// From the mesh to the node that is carried.
    pub(super) local: DAffine3,
    /// What each joint does to the mesh before that stands there; `None` where it is not bent.
    pub(super) bends: Option<Rc<[DAffine3]>>,
    /// Do joints move otherwise than the mesh?
    pub(super) moves: bool,
}

/// All skins of the file; `None` for one whose first joint is not in the scene.
pub(super) fn load(
    reader: &mut Reader<'_>,
    nodes: &[Placed<'_>],
    rig: &Rig,
) -> Result<Vec<Option<Skin>>> {
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
        let count = place.count("joints")?;
        let each = size_of::<Option<usize>>() + 3 * size_of::<DAffine3>();
        (reader.budget).take_many(&list.pointer(), count, each)?;
        let mut joints = Vec::with_capacity(count);
        for joint in list.items()? {
            joints.push(positions.get(&joint.index("/nodes", all)?).copied());
        }
        let Some(&first) = joints.first() else {
            return Err(list.mismatch("at least one joint"));
        };
        if first.is_none() {
            let message = "its first joint is not in the scene: meshes stand as their nodes do";
            reader.warn(&place, message);
        } else if joints.contains(&None) {
            let message = "joints that are not in the scene do as the first one does";
            reader.warn(&place, message);
        }
        let binds = inverse_binds(reader, &place, count)?;
        found.push(first.map(|first| Pose { nodes, rig, first }.skin(&joints, &binds)));
    }
    Ok(found)
}

/// How the nodes stand, and which is a skin's first joint.
struct Pose<'p> {
    nodes: &'p [Placed<'p>],
    rig: &'p Rig,
    first: usize,
}

impl Pose<'_> {
    /// If all joints do the same, or the first one moves while a shutter is open, the mesh stands as the first one holds it. Else it
    /// stands without turns and scales, so that a joint which flattens or mirrors what it holds does so to nothing else.
    fn skin(&self, joints: &[Option<usize>], binds: &[DAffine3]) -> Skin {
        let bind = |joint: usize| binds.get(joint).copied().unwrap_or(DAffine3::IDENTITY);
        let held = self.nodes[self.first].world * bind(0);
        let takes = |(index, joint): (usize, &Option<usize>)| match joint {
            Some(joint) => self.nodes[*joint].world * bind(index),
            None => held,
        };
        let takes: Vec<DAffine3> = joints.iter().enumerate().map(takes).collect();
        let carrier = self.rig.carrier(self.first);
        let driver = |carrier: Carrier| carrier.map(|(joint, _)| joint);
        let follows = |joint: usize| driver(self.rig.carrier(joint)) == driver(carrier);
        let moves = !joints.iter().flatten().all(|&joint| follows(joint));
        let reach = (0..joints.len()).map(|joint| bind(joint).inverse().translation.length());
        let reach = reach.filter(|reach| reach.is_finite());
        let unbent = are_one(&takes, reach.fold(0.0, f64::max));
        if unbent || carrier.is_some() {
            return Skin {
                world: held,
                carrier,
                local: bind(0),
                bends: bends(&takes, held).filter(|_| !unbent),
                moves,
            };
        }
        let mirrored = takes.iter().filter(|take| take.matrix3.determinant() < 0.0);
        let side = if 2 * mirrored.count() > takes.len() {
            -1.0
        } else {
            1.0
        };
        let world = DAffine3 {
            matrix3: DMat3::from_diagonal(DVec3::new(side, 1.0, 1.0)),
            translation: held.translation,
        };
        Skin {
            world,
            carrier: None,
            local: DAffine3::IDENTITY,
            bends: bends(&takes, world),
            moves,
        }
    }
}

/// Do all joints do the same, up to rounding, to what lies within `reach` of the origin? Exporters round to single precision.
fn are_one(takes: &[DAffine3], reach: f64) -> bool {
    const ROUNDING: f64 = 1e-6;
    let Some(first) = takes.first() else {
        return true;
    };
    let size = |m: &DMat3| {
        m.x_axis
            .length()
            .max(m.y_axis.length())
            .max(m.z_axis.length())
    };
    let (scale, far) = (size(&first.matrix3), first.translation.length());
    takes.iter().all(|take| {
        let turned = size(&(take.matrix3 - first.matrix3));
        let moved = (take.translation - first.translation).length();
        turned <= ROUNDING * scale && moved <= ROUNDING * (far + scale * reach)
    })
}

/// What joints do before the mesh stands where it does; `None` if that cannot be told.
fn bends(takes: &[DAffine3], world: DAffine3) -> Option<Rc<[DAffine3]>> {
    let back = world.inverse();
    back.is_finite()
        .then(|| takes.iter().map(|take| back * *take).collect())
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
