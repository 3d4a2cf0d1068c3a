//! What stands in the world's own tree, and what gets a tree of its own.
//!
//! A mesh that is placed once is flattened: its triangles are transformed and stand in the world's tree, so that
//! neither a single mesh nor a scene of many different ones pays for a second level. A mesh that is placed more often
//! has one tree, shared by its instances, unless it is so small that copies cost less than the second level.

use std::sync::Arc;

use glam::{Affine3A, Vec3};

use crate::bvh::{Bvh, Kind, LIMIT, Leaf, Place, build};
use crate::{Aabb, Instance, Mesh, WorldError};

/// A mesh of which all copies together have no more triangles is copied.
const COPIED: usize = 1 << 14;

pub(crate) struct Assembly {
    /// Of the world's tree.
    pub(crate) leaves: Vec<Leaf>,
    /// For each instance, whether its triangles are among the leaves.
    pub(crate) flattened: Vec<bool>,
    pub(crate) places: Vec<Place>,
    pub(crate) trees: Vec<Bvh>,
    pub(crate) bounds: Aabb,
}

impl Assembly {
    pub(crate) fn new(
        meshes: &[Arc<Mesh>],
        instances: &[Instance],
    ) -> Result<Assembly, WorldError> {
        for (mesh, checked) in meshes.iter().enumerate() {
            checked
                .check()
                .map_err(|source| WorldError::Mesh { mesh, source })?;
        }
        let uses = uses(meshes, instances)?;
        let mut assembly = Assembly {
            leaves: Vec::new(),
            flattened: Vec::with_capacity(instances.len()),
            places: Vec::new(),
            trees: Vec::new(),
            bounds: Aabb::EMPTY,
        };
        let mut tree_of = vec![None; meshes.len()];
        for (index, instance) in instances.iter().enumerate() {
            let mesh = &meshes[instance.mesh as usize];
            let uses = uses[instance.mesh as usize];
            check_transform(index, instance, mesh)?;
            let flat = uses == 1 || uses.saturating_mul(mesh.triangle_count()) <= COPIED;
            assembly.flattened.push(flat);
            if flat {
                assembly.flatten(index as u32, &instance.transform, mesh)?;
            } else {
                let tree = *tree_of[instance.mesh as usize].get_or_insert_with(|| {
                    assembly.trees.push(own_tree(mesh));
                    assembly.trees.len() - 1
                });
                assembly.place(index as u32, &instance.transform, mesh, tree);
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

    fn place(&mut self, instance: u32, transform: &Affine3A, mesh: &Mesh, tree: usize) {
        let bounds = placed_bounds(&self.trees[tree], mesh, transform);
        self.bounds = self.bounds.union(&bounds);
        self.leaves.push(Leaf::Instance {
            place: self.places.len() as u32,
            bounds,
        });
        self.places.push(Place {
            instance,
            tree: tree as u32,
            to_object: transform.inverse(),
            to_world: *transform,
        });
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

/// Around the transformed boxes of the root's children: tighter than around that of the whole.
fn placed_bounds(tree: &Bvh, mesh: &Mesh, transform: &Affine3A) -> Aabb {
    let boxes = match tree.root.map(|root| root.kind()) {
        Some(Kind::Node { index }) => tree.nodes[index].boxes().collect(),
        _ => vec![mesh.bounds()],
    };
    let corner = |b: &Aabb, k: usize| std::array::from_fn(|a| [b.min, b.max][k >> a & 1][a]);
    let corners = boxes
        .iter()
        .flat_map(|b| (0..8).map(move |k| Vec3::from_array(corner(b, k))));
    Aabb::from_points(corners.map(|p| transform.transform_point3(p)))
}

fn check_transform(index: usize, instance: &Instance, mesh: &Mesh) -> Result<(), WorldError> {
    let transform = &instance.transform;
    if transform.matrix3.as_dmat3().determinant() == 0.0 {
        return Err(WorldError::Singular { instance: index });
    }
    let b = mesh.bounds();
    let far = b.min.abs().max(b.max.abs());
    let m = &transform.matrix3;
    let reach = m.x_axis.abs() * far.x
        + m.y_axis.abs() * far.y
        + m.z_axis.abs() * far.z
        + transform.translation.abs();
    let kept = transform.is_finite() && (mesh.indices.is_empty() || reach.is_finite());
    if !(kept && transform.inverse().is_finite()) {
        return Err(WorldError::NonFinite { instance: index });
    }
    Ok(())
}
