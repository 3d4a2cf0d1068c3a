//! Meshes and instances, and the rays that ask for them.

use std::sync::Arc;
use std::time::Duration;

use glam::{Affine3A, DMat3, DVec3, Vec2, Vec3};
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::{BvhBuildParams, triangle::Triangle};

use crate::surface::Corners;
use crate::{Aabb, Hit, Mesh, MeshError, Ray, Surface};

/// A mesh placed in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// Index into the world's meshes.
    pub mesh: u32,
    /// Object to world. Finite and invertible; it may mirror, which leaves the front side where glTF puts it.
    pub transform: Affine3A,
}

/// Why a world cannot be built.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WorldError {
    /// A mesh breaks its own rules.
    #[error("mesh {mesh}: {source}")]
    Mesh {
        /// Which mesh.
        mesh: usize,
        /// What is wrong with it.
        source: MeshError,
    },
    /// An instance names a mesh that does not exist.
    #[error("instance {instance} names mesh {mesh}, but there are only {meshes}")]
    NoSuchMesh {
        /// Which instance.
        instance: usize,
        /// The mesh that it names.
        mesh: u32,
        /// How many meshes there are.
        meshes: usize,
    },
    /// A transform has a component that is not finite, or moves its mesh beyond what `f32` holds.
    #[error("the transform of instance {instance} leaves the finite numbers")]
    NonFinite {
        /// Which instance.
        instance: usize,
    },
    /// A transform flattens its mesh.
    #[error("the transform of instance {instance} has no inverse")]
    Singular {
        /// Which instance.
        instance: usize,
    },
    /// More instances or triangles than 31 bits count.
    #[error("{count} {what}: more than 2^31")]
    TooLarge {
        /// "instances" or "triangles".
        what: &'static str,
        /// How many.
        count: usize,
    },
}

/// Meshes, instances and the structure that finds them. Immutable; share it by reference between threads.
pub struct World {
    meshes: Vec<Arc<Mesh>>,
    instances: Vec<Instance>,
    triangles: Vec<[Vec3; 3]>,
    ids: Vec<(u32, u32)>,
    bvh: Bvh2,
    bounds: Aabb,
}

impl std::fmt::Debug for World {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("World")
            .field("meshes", &self.meshes.len())
            .field("instances", &self.instances.len())
            .field("bounds", &self.bounds)
            .finish_non_exhaustive()
    }
}

impl World {
    /// Builds the acceleration structure. Neither meshes nor instances need to exist; meshes without an instance are
    /// kept but never met.
    ///
    /// # Errors
    /// A mesh that [`Mesh::check`] refuses, an instance of a mesh that does not exist, a transform that is not finite
    /// or not invertible.
    pub fn build(meshes: Vec<Arc<Mesh>>, instances: Vec<Instance>) -> Result<World, WorldError> {
        for (mesh, checked) in meshes.iter().enumerate() {
            checked
                .check()
                .map_err(|source| WorldError::Mesh { mesh, source })?;
        }
        let (mut triangles, mut ids) = (Vec::new(), Vec::new());
        for (index, instance) in instances.iter().enumerate() {
            let mesh = meshes
                .get(instance.mesh as usize)
                .ok_or(WorldError::NoSuchMesh {
                    instance: index,
                    mesh: instance.mesh,
                    meshes: meshes.len(),
                })?;
            check_transform(index, instance, mesh)?;
            for primitive in 0..mesh.triangle_count() as u32 {
                triangles.push(
                    mesh.corners(primitive)
                        .map(|p| instance.transform.transform_point3(p)),
                );
                ids.push((index as u32, primitive));
            }
        }
        let boxes: Vec<Triangle> = triangles
            .iter()
            .map(|t| Triangle {
                v0: t[0].into(),
                v1: t[1].into(),
                v2: t[2].into(),
            })
            .collect();
        let bvh = build_bvh2(
            &boxes,
            BvhBuildParams::medium_build(),
            &mut Duration::default(),
        );
        let bounds = Aabb::from_points(triangles.iter().flatten().copied());
        Ok(World {
            meshes,
            instances,
            triangles,
            ids,
            bvh,
            bounds,
        })
    }

    /// The closest hit.
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.intersect_filtered(ray, |_| true)
    }

    /// The closest hit that `filter` counts (returns true for). The filter may be asked about hits that turn out not to
    /// be the closest, in no particular order, but never twice about one triangle.
    pub fn intersect_filtered(&self, ray: &Ray, filter: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        self.closest(ray, None, filter)
    }

    /// The closest counted hit that comes strictly after `after` in the order of [`Hit::precedes`]. Asked again with
    /// each answer it meets every triangle on the ray exactly once, also where several lie at the same `t`.
    pub fn intersect_after(
        &self,
        ray: &Ray,
        after: &Hit,
        filter: impl FnMut(&Hit) -> bool,
    ) -> Option<Hit> {
        self.closest(ray, Some(after), filter)
    }

    /// Whether anything lies on the ray.
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.occluded_filtered(ray, |_| true)
    }

    /// Whether anything that `filter` counts lies on the ray. Each triangle on it is offered at most once, in no
    /// particular order, until one counts.
    pub fn occluded_filtered(&self, ray: &Ray, mut filter: impl FnMut(&Hit) -> bool) -> bool {
        let mut found = false;
        self.visit(ray, |hit, t_max| {
            found = filter(&hit);
            if found { f32::NEG_INFINITY } else { t_max }
        });
        found
    }

    /// The surface that `ray` met at `hit`.
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        self.corners(hit.instance, hit.primitive)
            .surface(hit.u, hit.v, ray.direction)
    }

    /// The surface at barycentric weights `u`, `v` of a triangle, seen from its front.
    ///
    /// # Panics
    /// Where there is no such instance or triangle.
    pub fn surface_at(&self, instance: u32, primitive: u32, u: f32, v: f32) -> Surface {
        self.corners(instance, primitive).surface(u, v, Vec3::ZERO)
    }

    /// The texture coordinates (set 0 or 1) at a hit, for alpha tests; zero where the mesh has none.
    ///
    /// # Panics
    /// Where `set` is neither 0 nor 1.
    pub fn uv(&self, hit: &Hit, set: usize) -> Vec2 {
        self.corners(hit.instance, hit.primitive)
            .uv(set, weights(hit))
    }

    /// The vertex colour at a hit, for alpha tests; ones where the mesh has none.
    pub fn color(&self, hit: &Hit) -> [f32; 4] {
        self.corners(hit.instance, hit.primitive)
            .color(weights(hit))
    }

    /// The corners of a triangle in world space.
    ///
    /// # Panics
    /// Where there is no such instance or triangle.
    pub fn triangle(&self, instance: u32, primitive: u32) -> [Vec3; 3] {
        self.corners(instance, primitive)
            .positions
            .map(|p| p.as_vec3())
    }

    /// The area of a triangle in world space.
    ///
    /// # Panics
    /// Where there is no such instance or triangle.
    pub fn triangle_area(&self, instance: u32, primitive: u32) -> f64 {
        let [a, b, c] = self.corners(instance, primitive).positions;
        (b - a).cross(c - a).length() * 0.5
    }

    /// The box around all instances; [`Aabb::EMPTY`] of an empty world.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The instances, in the order in which they were given.
    pub fn instances(&self) -> &[Instance] {
        &self.instances
    }

    /// The meshes, in the order in which they were given.
    pub fn meshes(&self) -> &[Arc<Mesh>] {
        &self.meshes
    }

    /// The mesh with this index.
    ///
    /// # Panics
    /// Where there is no such mesh.
    pub fn mesh(&self, mesh: u32) -> &Mesh {
        &self.meshes[mesh as usize]
    }

    /// The mesh that an instance places.
    ///
    /// # Panics
    /// Where there is no such instance.
    pub fn mesh_of(&self, instance: u32) -> &Mesh {
        self.mesh(self.instances[instance as usize].mesh)
    }

    /// Triangles of all instances together: what a ray may meet.
    pub fn triangle_count(&self) -> u64 {
        self.instances
            .iter()
            .map(|i| self.mesh(i.mesh).triangle_count() as u64)
            .sum()
    }

    /// Bytes that the acceleration structure takes, without the meshes.
    pub fn memory(&self) -> usize {
        size_of_val(&self.triangles[..]) + size_of_val(&self.bvh.nodes[..])
    }

    fn corners(&self, instance: u32, primitive: u32) -> Corners<'_> {
        let placed = &self.instances[instance as usize];
        let mesh = self.mesh(placed.mesh);
        let transform = placed.transform;
        Corners {
            mesh,
            primitive,
            positions: mesh
                .corners(primitive)
                .map(|p| transform.transform_point3(p).as_dvec3()),
            linear: DMat3::from_cols_array(&transform.matrix3.to_cols_array().map(f64::from)),
        }
    }

    fn closest(
        &self,
        ray: &Ray,
        after: Option<&Hit>,
        mut filter: impl FnMut(&Hit) -> bool,
    ) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        self.visit(ray, |hit, t_max| {
            let later = after.is_none_or(|a| a.precedes(&hit));
            if later && best.is_none_or(|b| hit.precedes(&b)) && filter(&hit) {
                best = Some(hit);
                return hit.t;
            }
            t_max
        });
        best
    }

    /// Calls `meet` with every hit up to the `t_max` that it last returned.
    fn visit(&self, ray: &Ray, mut meet: impl FnMut(Hit, f32) -> f32) {
        let mut t_max = ray.t_max;
        let mut stack = vec![0];
        while let Some(index) = stack.pop() {
            let Some(node) = self.bvh.nodes.get(index) else {
                return;
            };
            if !crosses(ray, t_max, node.aabb().min.into(), node.aabb().max.into()) {
                continue;
            }
            if !node.is_leaf() {
                stack.extend([node.first_index as usize, node.first_index as usize + 1]);
                continue;
            }
            for slot in node.first_index..node.first_index + node.prim_count {
                let triangle = self.bvh.primitive_indices[slot as usize] as usize;
                let Some((t, u, v)) = meets(ray, self.triangles[triangle]) else {
                    continue;
                };
                if t > ray.t_min && t <= t_max {
                    let (instance, primitive) = self.ids[triangle];
                    t_max = meet(
                        Hit {
                            t,
                            u,
                            v,
                            instance,
                            primitive,
                        },
                        t_max,
                    );
                }
            }
        }
    }
}

fn weights(hit: &Hit) -> [f64; 3] {
    let (u, v) = (f64::from(hit.u), f64::from(hit.v));
    [1.0 - u - v, u, v]
}

fn check_transform(index: usize, instance: &Instance, mesh: &Mesh) -> Result<(), WorldError> {
    let bounds = mesh.bounds();
    let reach = [bounds.min, bounds.max].map(|p| instance.transform.transform_point3(p));
    if !instance.transform.is_finite()
        || !(mesh.indices.is_empty() || reach.iter().all(|p| p.is_finite()))
    {
        return Err(WorldError::NonFinite { instance: index });
    }
    let linear = DMat3::from_cols_array(&instance.transform.matrix3.to_cols_array().map(f64::from));
    if linear.determinant() == 0.0 {
        return Err(WorldError::Singular { instance: index });
    }
    Ok(())
}

fn crosses(ray: &Ray, t_max: f32, min: Vec3, max: Vec3) -> bool {
    let (mut near, mut far) = (0.0f64, f64::from(t_max));
    for axis in 0..3 {
        let (o, d) = (f64::from(ray.origin[axis]), f64::from(ray.direction[axis]));
        let (a, b) = (f64::from(min[axis]) - o, f64::from(max[axis]) - o);
        if d == 0.0 {
            if a > 0.0 || b < 0.0 {
                return false;
            }
            continue;
        }
        let (a, b) = (a / d, b / d);
        near = near.max(a.min(b));
        far = far.min(a.max(b));
    }
    near <= far * (1.0 + 1e-6)
}

fn meets(ray: &Ray, corners: [Vec3; 3]) -> Option<(f32, f32, f32)> {
    let o = ray.origin.as_dvec3();
    let d = ray.direction.as_dvec3();
    let [a, b, c] = corners.map(|p| p.as_dvec3() - o);
    let edge = |p: DVec3, q: DVec3| d.dot(q.cross(p));
    let (wa, wb, wc) = (edge(c, b), edge(a, c), edge(b, a));
    let det = wa + wb + wc;
    let inside = (wa >= 0.0 && wb >= 0.0 && wc >= 0.0) || (wa <= 0.0 && wb <= 0.0 && wc <= 0.0);
    if det == 0.0 || !inside {
        return None;
    }
    let normal = (b - a).cross(c - a);
    let t = a.dot(normal) / d.dot(normal);
    t.is_finite()
        .then_some((t as f32, (wb / det) as f32, (wc / det) as f32))
}
