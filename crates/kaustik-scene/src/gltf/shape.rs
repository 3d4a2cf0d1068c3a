//! The shape of a mesh at rest: morph targets by their weights, then bent by a skin.

use std::rc::Rc;

use glam::{DAffine3, DMat3, DVec3, Vec3};
use kaustik_geometry::Mesh;

use super::accessor::{Allowed, Component};
use super::budget::VISIT;
use super::json::Cursor;
use super::reader::Reader;
use super::{ErrorKind, LoadError, vertices};

type Result<T> = std::result::Result<T, LoadError>;

/// What shapes the mesh of a node.
#[derive(Clone, Debug, Default)]
pub(super) struct Shape {
    /// Weight of each morph target; none beyond are taken.
    pub(super) weights: Vec<f32>,
    /// What each joint of the node's skin does to the mesh, if it is bent at all.
    pub(super) bends: Option<Rc<[DAffine3]>>,
}

/// Attributes of the joints that pull at a vertex and their weights, four in each pair.
const PULLS: [[&str; 2]; 4] = [
    ["JOINTS_0", "WEIGHTS_0"],
    ["JOINTS_1", "WEIGHTS_1"],
    ["JOINTS_2", "WEIGHTS_2"],
    ["JOINTS_3", "WEIGHTS_3"],
];

const WEIGHTS: Allowed = vertices::allowed(
    &[Component::U8, Component::U16],
    false,
    "VEC4 of FLOAT, or normalized UNSIGNED_BYTE or _SHORT",
);

/// One of the joints that pull at a vertex.
#[derive(Clone, Copy, Debug)]
struct Pull {
    joint: usize,
    weight: f64,
}

impl Shape {
    /// Does it leave meshes as they are?
    pub(super) fn is_plain(&self) -> bool {
        self.bends.is_none() && self.weights.iter().all(|&weight| weight == 0.0)
    }

    /// Shapes the vertices of a primitive.
    pub(super) fn apply<'a>(
        &self,
        reader: &mut Reader<'a>,
        primitive: &Cursor<'a>,
        mesh: &mut Mesh,
    ) -> Result<()> {
        self.morph(reader, primitive, mesh)?;
        match &self.bends {
            Some(bends) => bend(reader, primitive, bends, mesh),
            None => Ok(()),
        }
    }

    fn morph<'a>(
        &self,
        reader: &mut Reader<'a>,
        primitive: &Cursor<'a>,
        mesh: &mut Mesh,
    ) -> Result<()> {
        let count = mesh.positions.len();
        for (target, &weight) in primitive.list("targets")?.iter().zip(&self.weights) {
            reader.budget.work(target, VISIT)?;
            if weight == 0.0 {
                continue;
            }
            let mut moves = |name| vertices::displacements(reader, target, name, count);
            let [positions, normals, tangents] =
                [moves("POSITION")?, moves("NORMAL")?, moves("TANGENT")?];
            let by = |moves: &[f32; 3]| weight * Vec3::from(*moves);
            for (value, moves) in mesh.positions.iter_mut().zip(&positions) {
                *value += by(moves);
            }
            for (value, moves) in mesh.normals.iter_mut().zip(&normals) {
                *value += by(moves);
            }
            // The sign in w is no direction.
            for (value, moves) in mesh.tangents.iter_mut().zip(&tangents) {
                *value += by(moves).extend(0.0);
            }
            let read = [positions, normals, tangents];
            let bytes: usize = read.iter().map(|moves| size_of_val(&moves[..])).sum();
            reader.budget.give(bytes as u64);
            reader.budget.work(target, bytes)?;
        }
        // For one that is nothing, geometry takes the face's.
        for normal in &mut mesh.normals {
            *normal = normal.try_normalize().unwrap_or(Vec3::ZERO);
        }
        if mesh.tangents.iter().any(|tangent| !tangent.is_finite()) {
            reader.warn(
                primitive,
                "morphed tangents are not finite; they are left out",
            );
            reader.budget.give(size_of_val(&mesh.tangents[..]) as u64);
            mesh.tangents = Vec::new();
        }
        Ok(())
    }
}

/// Each vertex goes where the joints that pull at it take it, in the mean by their weights. One at which nothing pulls is held by the
/// first joint alone.
fn bend<'a>(
    reader: &mut Reader<'a>,
    primitive: &Cursor<'a>,
    bends: &[DAffine3],
    mesh: &mut Mesh,
) -> Result<()> {
    let pulls = pulls(reader, primitive, bends.len(), mesh.positions.len())?;
    let each = pulls.len() / mesh.positions.len().max(1);
    reader.budget.work(primitive, size_of_val(&pulls[..]))?;
    for vertex in 0..mesh.positions.len() {
        let own = &pulls[vertex * each..][..each];
        let by = mean(own, bends).or(bends.first().copied());
        let by = by.unwrap_or(DAffine3::IDENTITY);
        let position = &mut mesh.positions[vertex];
        *position = by.transform_point3(position.as_dvec3()).as_vec3();
        if let Some(normal) = mesh.normals.get_mut(vertex) {
            *normal = turned(cofactors(&by.matrix3), *normal);
        }
        if let Some(tangent) = mesh.tangents.get_mut(vertex) {
            *tangent = turned(by.matrix3, tangent.truncate()).extend(tangent.w);
        }
    }
    reader.budget.give(size_of_val(&pulls[..]) as u64);
    Ok(())
}

/// The pulls at all vertices, as many at each.
fn pulls<'a>(
    reader: &mut Reader<'a>,
    primitive: &Cursor<'a>,
    joints: usize,
    count: usize,
) -> Result<Vec<Pull>> {
    let attributes = primitive.need("attributes")?;
    let mut sets = Vec::new();
    for [joint, weight] in PULLS {
        let (Some(place), Some(_)) = (attributes.get(joint)?, attributes.get(weight)?) else {
            break;
        };
        let by = vertices::accessor(reader, &place, Some(count))?;
        let by = by.quads(&reader.buffers, &mut reader.budget)?;
        let much = vertices::attribute::<4>(reader, &attributes, weight, Some(count), &WEIGHTS)?;
        // Without a pull, what stands for the joint means nothing.
        let pulled = by.as_flattened().iter().zip(much.as_flattened());
        let stray =
            { pulled }.find(|&(&joint, &weight)| weight > 0.0 && usize::from(joint) >= joints);
        if let Some((joint, _)) = stray {
            let expected = format!("joints below {joints}, the number of the skin");
            return Err(place.error(ErrorKind::Reference, format!("joint {joint}"), expected));
        }
        sets.push((by, much));
    }
    let each = 4 * sets.len();
    (reader.budget).take_many(&attributes.pointer(), count, each * size_of::<Pull>())?;
    let mut pulls = Vec::with_capacity(count * each);
    for vertex in 0..count {
        for (by, much) in &sets {
            let four = by[vertex].iter().zip(&much[vertex]);
            pulls.extend(four.map(|(&joint, &weight)| Pull {
                joint: usize::from(joint),
                weight: if weight > 0.0 && weight.is_finite() {
                    f64::from(weight)
                } else {
                    0.0
                },
            }));
        }
    }
    let read: usize = sets
        .iter()
        .map(|(by, much)| size_of_val(&by[..]) + size_of_val(&much[..]))
        .sum();
    reader.budget.give(read as u64);
    Ok(pulls)
}

/// What the joints do together; `None` where none pulls.
fn mean(pulls: &[Pull], bends: &[DAffine3]) -> Option<DAffine3> {
    let whole: f64 = pulls.iter().map(|pull| pull.weight).sum();
    if whole <= 0.0 {
        return None;
    }
    let mut matrix = DMat3::ZERO;
    let mut translation = DVec3::ZERO;
    for pull in pulls.iter().filter(|pull| pull.weight > 0.0) {
        let bend = bends.get(pull.joint)?;
        let share = pull.weight / whole;
        matrix += bend.matrix3 * share;
        translation += bend.translation * share;
    }
    Some(DAffine3 {
        matrix3: matrix,
        translation,
    })
}

/// How normals turn: the inverse transpose but for its length, which a flat transform has too.
fn cofactors(m: &DMat3) -> DMat3 {
    DMat3::from_cols(
        m.y_axis.cross(m.z_axis),
        m.z_axis.cross(m.x_axis),
        m.x_axis.cross(m.y_axis),
    )
}

/// A direction after a transform; as it was where that leaves nothing of it.
fn turned(by: DMat3, direction: Vec3) -> Vec3 {
    let turned = (by * direction.as_dvec3()).try_normalize();
    turned.map_or(direction, |turned| turned.as_vec3())
}
