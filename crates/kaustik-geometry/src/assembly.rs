//! What stands in the world's own tree, and what gets a tree of its own.
//!
//! A mesh that is placed once is flattened: its triangles are transformed and stand in the world's tree, so that
//! neither a single mesh nor a scene of many different ones pays for a second level. A mesh that is placed more often
//! has one tree, shared by its instances, unless it is so small that copies cost less than the second level. What
//! moves always has one: the world's tree holds the box around all of its way.

use std::sync::Arc;

use glam::{Affine3A, Vec3};

use crate::bvh::{Bvh, Kind, LIMIT, Leaf, PlacedTree, PlacedTrees, STILL, build};
use crate::{Aabb, Instance, Mesh, Motion, WorldError};

/// A mesh of which all copies together have no more triangles is copied.
const COPIED: usize = 1 << 14;

pub(crate) struct Assembly {
    /// Of the world's tree.
    pub(crate) leaves: Vec<Leaf>,
    /// For each instance, whether its triangles are among the leaves.
    pub(crate) flattened: Vec<bool>,
    pub(crate) places: PlacedTrees,
    /// For each instance the index of its motion, or [`STILL`].
    pub(crate) motion_of: Vec<u32>,
    pub(crate) bounds: Aabb,
}

impl Assembly {
    pub(crate) fn new(
        meshes: &[Arc<Mesh>],
        instances: &[Instance],
        motions: Vec<(u32, Motion)>,
    ) -> Result<Assembly, WorldError> {
        for (mesh, checked) in meshes.iter().enumerate() {
            checked
                .check()
                .map_err(|source| WorldError::Mesh { mesh, source })?;
        }
        let uses = uses(meshes, instances)?;
        let motion_of = motion_of(instances.len(), &motions)?;
        let mut assembly = Assembly {
            leaves: Vec::new(),
            flattened: Vec::with_capacity(instances.len()),
            places: PlacedTrees {
                motions: motions.into_iter().map(|(_, motion)| motion).collect(),
                ..PlacedTrees::default()
            },
            motion_of,
            bounds: Aabb::EMPTY,
        };
        // once a mesh and not once an instance: each looks at every triangle
        let boxes: Vec<Aabb> = meshes.iter().map(|mesh| mesh.bounds()).collect();
        let mut tree_of = vec![None; meshes.len()];
        for (index, instance) in instances.iter().enumerate() {
            let mesh = &meshes[instance.mesh as usize];
            let bounds = &boxes[instance.mesh as usize];
            let uses = uses[instance.mesh as usize];
            let motion = assembly.motion_of[index];
            let moves = motion != STILL;
            if moves {
                assembly.check_motion(index, bounds)?;
            } else {
                check_transform(index, instance, bounds)?;
            }
            let flat =
                !moves && (uses == 1 || uses.saturating_mul(mesh.triangle_count()) <= COPIED);
            assembly.flattened.push(flat);
            if flat {
                assembly.flatten(index as u32, &instance.transform, mesh)?;
            } else {
                let tree = *tree_of[instance.mesh as usize].get_or_insert_with(|| {
                    assembly.places.trees.push(own_tree(mesh));
                    assembly.places.trees.len() - 1
                });
                assembly.place(index as u32, &instance.transform, bounds, tree);
            }
        }
        Ok(assembly)
    }

    fn flatten(
        &mut self,
        instance: u32,
        transform: &Affine3A,
        mesh: &Mesh,
    ) -> Result<(), WorldError> {
        let count = self.leaves.len() + mesh.triangle_count();
        if count >= LIMIT {
            return Err(WorldError::TooLarge {
                what: "triangles",
                count,
            });
        }
        self.leaves.reserve(mesh.triangle_count());
        for primitive in 0..mesh.triangle_count() as u32 {
            let corners = mesh
                .corners(primitive)
                .map(|p| transform.transform_point3(p));
            self.bounds = self.bounds.union(&Aabb::from_points(corners));
            let leaf = Leaf::Triangle {
                corners,
                instance,
                primitive,
            };
            if !leaf.is_degenerate() {
                self.leaves.push(leaf);
            }
        }
        Ok(())
    }

    fn place(&mut self, instance: u32, transform: &Affine3A, whole: &Aabb, tree: usize) {
        let motion = self.motion_of[instance as usize];
        let tree_of = &self.places.trees[tree];
        let bounds = match self.places.motions.get(motion as usize) {
            Some(motion) => swept_bounds(tree_of, whole, motion),
            None => placed_bounds(tree_of, whole, transform),
        };
        self.bounds = self.bounds.union(&bounds);
        self.leaves.push(Leaf::Instance {
            place: self.places.list.len() as u32,
            bounds,
        });
        self.places.list.push(PlacedTree {
            instance,
            tree: tree as u32,
            to_object: transform.inverse(),
            to_world: *transform,
            motion,
        });
    }

    /// Every key must be one that an instance could have, but for having an inverse: what is flat at an instant is not
    /// met then.
    fn check_motion(&self, index: usize, bounds: &Aabb) -> Result<(), WorldError> {
        let motion = &self.places.motions[self.motion_of[index] as usize];
        let kept = |(_, key): &(f32, Affine3A)| stays_finite(key, bounds);
        if motion.keys().iter().all(kept) {
            return Ok(());
        }
        Err(WorldError::NonFinite { instance: index })
    }
}

/// For each instance the index of its motion.
fn motion_of(instances: usize, motions: &[(u32, Motion)]) -> Result<Vec<u32>, WorldError> {
    let mut of = vec![STILL; instances];
    for (index, &(instance, _)) in motions.iter().enumerate() {
        let instance = instance as usize;
        match of.get_mut(instance) {
            Some(motion) if *motion == STILL => *motion = index as u32,
            _ => {
                return Err(WorldError::Motion {
                    instance,
                    instances,
                });
            }
        }
    }
    Ok(of)
}

/// Around all of the way: each point goes straight from key to key, and so stays within the boxes of the keys. With
/// room for the rounding of what is between them.
fn swept_bounds(tree: &Bvh, whole: &Aabb, motion: &Motion) -> Aabb {
    let boxes = motion.keys().iter();
    let boxes = boxes.map(|(_, key)| placed_bounds(tree, whole, key));
    let tight = boxes.fold(Aabb::EMPTY, |all, one| all.union(&one));
    let reach = tight.min.abs().max(tight.max.abs()).max_element();
    let room = Vec3::splat(reach * (8.0 * f32::EPSILON));
    Aabb {
        min: tight.min - room,
        max: tight.max + room,
    }
}

/// How often each mesh is placed.
fn uses(meshes: &[Arc<Mesh>], instances: &[Instance]) -> Result<Vec<usize>, WorldError> {
    if instances.len() >= LIMIT {
        return Err(WorldError::TooLarge {
            what: "instances",
            count: instances.len(),
        });
    }
    let mut uses = vec![0; meshes.len()];
    for (index, instance) in instances.iter().enumerate() {
        *uses
            .get_mut(instance.mesh as usize)
            .ok_or(WorldError::NoSuchMesh {
                instance: index,
                mesh: instance.mesh,
                meshes: meshes.len(),
            })? += 1;
    }
    Ok(uses)
}

fn own_tree(mesh: &Mesh) -> Bvh {
    let leaf = |primitive| Leaf::Triangle {
        corners: mesh.corners(primitive),
        instance: 0,
        primitive,
    };
    let leaves: Vec<Leaf> = (0..mesh.triangle_count() as u32)
        .map(leaf)
        .filter(|leaf| !leaf.is_degenerate())
        .collect();
    build(&leaves)
}

/// Around the transformed boxes of the root's children: tighter than around that of the whole mesh.
fn placed_bounds(tree: &Bvh, whole: &Aabb, transform: &Affine3A) -> Aabb {
    let boxes = match tree.root.map(|root| root.kind()) {
        Some(Kind::Node { index }) => tree.nodes[index].boxes().collect(),
        _ => vec![*whole],
    };
    let corner = |b: &Aabb, k: usize| std::array::from_fn(|a| [b.min, b.max][k >> a & 1][a]);
    let corners = boxes
        .iter()
        .flat_map(|b| (0..8).map(move |k| Vec3::from_array(corner(b, k))));
    Aabb::from_points(corners.map(|p| transform.transform_point3(p)))
}

fn check_transform(index: usize, instance: &Instance, bounds: &Aabb) -> Result<(), WorldError> {
    let transform = &instance.transform;
    if transform.matrix3.as_dmat3().determinant() == 0.0 {
        return Err(WorldError::Singular { instance: index });
    }
    if !(stays_finite(transform, bounds) && transform.inverse().is_finite()) {
        return Err(WorldError::NonFinite { instance: index });
    }
    Ok(())
}

/// Do all points of a mesh stay so? Its box is inside out if it has no triangles.
fn stays_finite(transform: &Affine3A, b: &Aabb) -> bool {
    let far = b.min.abs().max(b.max.abs());
    let m = &transform.matrix3;
    let reach = m.x_axis.abs() * far.x
        + m.y_axis.abs() * far.y
        + m.z_axis.abs() * far.z
        + transform.translation.abs();
    let is_empty = b.min.x > b.max.x;
    transform.is_finite() && (is_empty || reach.is_finite())
}
