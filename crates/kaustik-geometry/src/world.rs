//! Meshes and instances, and the rays that ask for them.

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3, Vec4};

use crate::assembly::Assembly;
use crate::bvh::{Any, Bvh, Closest, Goal, InstructionSet, Level, Near, PlacedTrees, STILL, build};
use crate::standing::{Pose, Standing};
use crate::{Aabb, Hit, Instance, Mesh, Motion, Ray, Surface, Unwrapping, WorldError};

/// The pose of an instance now, by reference: its own if it stands still, else one that is worked out into
/// the slot. Not a function, so that nothing is copied where nothing moves.
macro_rules! pose {
    ($world:expr, $standing:expr, $slot:ident) => {
        if $standing.motion == STILL {
            &$standing.pose
        } else {
            $slot = $world.moved($standing);
            &$slot
        }
    };
}

/// Meshes, instances and the structure that finds them, at an instant. Immutable; share it by reference between
/// threads. [`World::at`] is the same world at another instant, and as cheap as a pointer.
pub struct World {
    stock: Arc<Stock>,
    /// In [0, 1]: where what moves stands.
    time: f32,
}

/// All that there is, whatever the time.
struct Stock {
    meshes: Vec<Arc<Mesh>>,
    instances: Vec<Instance>,
    /// The instances as hits ask for them.
    standing: Vec<Standing>,
    tree: Bvh,
    places: PlacedTrees,
    instruction_set: InstructionSet,
    bounds: Aabb,
}

impl std::fmt::Debug for World {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("World")
            .field("meshes", &self.stock.meshes.len())
            .field("instances", &self.stock.instances.len())
            .field("bounds", &self.stock.bounds)
            .field("time", &self.time)
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
        World::moving(meshes, instances, Vec::new())
    }

    /// As [`World::build`], where some instances (by index) move. Their own transform counts for nothing then; it may
    /// be singular at some times of the motion, when no ray meets them. The world stands at time 0.
    ///
    /// # Errors
    /// As [`World::build`]; a motion of an instance that does not exist, or a second one of the same.
    pub fn moving(
        meshes: Vec<Arc<Mesh>>,
        mut instances: Vec<Instance>,
        motions: Vec<(u32, Motion)>,
    ) -> Result<World, WorldError> {
        for (instance, motion) in &motions {
            if let Some(instance) = instances.get_mut(*instance as usize) {
                instance.transform = motion.at(0.0);
            }
        }
        let assembly = Assembly::new(&meshes, &instances, motions)?;
        let sizes: Vec<f32> = meshes.iter().map(|mesh| largest(&mesh.bounds())).collect();
        let kinds = assembly.flattened.iter().zip(&assembly.motion_of);
        let standing = instances
            .iter()
            .zip(kinds)
            .map(|(instance, (&flat, &motion))| {
                let mesh = instance.mesh as usize;
                Standing::new(instance.transform, &meshes[mesh], flat, sizes[mesh], motion)
            });
        let stock = Stock {
            standing: standing.collect(),
            tree: build(&assembly.leaves),
            bounds: assembly.bounds,
            places: assembly.places,
            instruction_set: InstructionSet::detect(),
            meshes,
            instances,
        };
        Ok(World {
            stock: Arc::new(stock),
            time: 0.0,
        })
    }

    /// The same world at a time from 0 to 1: where its [`Motion`]s are then. Every question about it is answered for
    /// that instant, but for [`World::bounds`].
    #[must_use]
    pub fn at(&self, time: f32) -> World {
        World {
            stock: Arc::clone(&self.stock),
            time,
        }
    }

    /// The instant that it stands at, from 0 to 1.
    pub fn time(&self) -> f32 {
        self.time
    }

    /// Does anything move?
    pub fn moves(&self) -> bool {
        !self.stock.places.motions.is_empty()
    }

    /// Does this instance move?
    ///
    /// # Panics
    /// Where there is no such instance.
    pub fn is_moving(&self, instance: u32) -> bool {
        self.stock.standing[instance as usize].motion != STILL
    }

    /// Is this instance flat as it stands now, because its motion has no inverse? No ray meets it then.
    ///
    /// # Panics
    /// Where there is no such instance.
    pub fn is_flat(&self, instance: u32) -> bool {
        let motion = self.stock.standing[instance as usize].motion;
        let at = |motion: &Motion| motion.at(self.time).inverse().is_finite();
        motion != STILL && !at(&self.stock.places.motions[motion as usize])
    }

    /// The same world, walked without vector instructions: same answers to the last bit, slower. For tests.
    ///
    /// # Panics
    /// If another handle shares the world, such as one of [`at`](Self::at).
    #[must_use]
    pub fn portable(self) -> World {
        let time = self.time;
        // Nobody else holds a world that was just built.
        let stock = Arc::into_inner(self.stock).map(|stock| Stock {
            instruction_set: InstructionSet::Portable,
            ..stock
        });
        World {
            stock: Arc::new(stock.expect("the only handle")),
            time,
        }
    }

    /// The closest hit.
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.intersect_filtered(ray, |_| true)
    }

    /// The closest hit that `filter` counts (returns true for). The filter may be asked about hits that turn out not to
    /// be the closest, in no particular order, but never twice about one triangle.
    #[inline]
    pub fn intersect_filtered(&self, ray: &Ray, filter: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        let (low, high) = (ray.t_min.next_up(), ray.t_max);
        let mut goal = Closest {
            filter,
            after: None,
            low,
            high,
            best: None,
        };
        self.walk(ray, &mut goal);
        goal.best
    }

    /// The closest counted hit that comes strictly after `after` in the order of [`Hit::precedes`]. Asked again with
    /// each answer it meets every triangle on the ray exactly once, also where several lie at the same `t`.
    pub fn intersect_after(
        &self,
        ray: &Ray,
        after: &Hit,
        filter: impl FnMut(&Hit) -> bool,
    ) -> Option<Hit> {
        let (low, high) = (ray.t_min.next_up().max(after.t), ray.t_max);
        let mut goal = Closest {
            filter,
            after: Some(after),
            low,
            high,
            best: None,
        };
        self.walk(ray, &mut goal);
        goal.best
    }

    /// Whether anything lies on the ray.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.occluded_filtered(ray, |_| true)
    }

    /// Whether anything that `filter` counts lies on the ray. Each triangle on it is offered at most once, in no
    /// particular order, until one counts.
    #[inline]
    pub fn occluded_filtered(&self, ray: &Ray, filter: impl FnMut(&Hit) -> bool) -> bool {
        let mut goal = Any {
            filter,
            low: ray.t_min.next_up(),
            high: ray.t_max,
        };
        self.walk(ray, &mut goal)
    }

    /// Whether `counts` is true of a triangle near a ball. All that reach into the ball are offered (up to rounding), and
    /// some that only pass by; each at most once, in no particular order, until one counts: its corners in world space,
    /// counter-clockwise seen from the front. Near a place or within a radius that is no number, nothing is.
    pub fn any_near(
        &self,
        center: Vec3,
        radius: f32,
        mut counts: impl FnMut([Vec3; 3]) -> bool,
    ) -> bool {
        let stock = &*self.stock;
        let bounds = Aabb {
            min: center - Vec3::splat(radius),
            max: center + Vec3::splat(radius),
        };
        if bounds.min.is_nan() || bounds.max.is_nan() {
            return false;
        }
        let near = Near {
            places: &stock.places,
            time: self.time,
        };
        near.any(&stock.tree, &bounds, &mut |instance, [a, b, c]| {
            let moved;
            let standing = &stock.standing[instance as usize];
            let pose = pose!(self, standing, moved);
            counts(if pose.handedness < 0.0 {
                [a, c, b]
            } else {
                [a, b, c]
            })
        })
    }

    /// The surface that `ray` met at `hit`.
    #[inline(always)]
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        let mut surface = Surface::bare(Vec3::ZERO, Vec3::Z);
        self.write_surface(ray, hit, &mut surface);
        surface
    }

    /// [`World::surface`] into the caller's slot, for innermost loops. Returns its position, geometric and shading
    /// normal, as it is slow to read at once what was just written.
    #[inline(always)]
    pub fn write_surface(&self, ray: &Ray, hit: &Hit, surface: &mut Surface) -> [Vec3; 3] {
        let moved;
        let standing = &self.stock.standing[hit.instance as usize];
        let pose = pose!(self, standing, moved);
        let corners = standing.corners(pose, hit.primitive);
        corners.write_surface(hit.u, hit.v, ray.direction, surface)
    }

    /// The surface at barycentric weights `u`, `v` of a triangle, seen from its front.
    ///
    /// # Panics
    /// Where there is no such instance or triangle.
    #[inline]
    pub fn surface_at(&self, instance: u32, primitive: u32, u: f32, v: f32) -> Surface {
        let mut surface = Surface::bare(Vec3::ZERO, Vec3::Z);
        let moved;
        let standing = &self.stock.standing[instance as usize];
        let pose = pose!(self, standing, moved);
        standing
            .corners(pose, primitive)
            .write_surface(u, v, Vec3::ZERO, &mut surface);
        surface
    }

    /// Unit tangent at a hit, orthogonal to a shading normal, and the sign of the bitangent (`cross(normal,
    /// tangent) * w`): from the mesh's tangents (if it has normals too), or else from the derivatives of
    /// these texture coordinates (then with glTF's convention that the bitangent points against `v`), or else
    /// none.
    ///
    /// Apart from [`World::surface`] because only normal maps and anisotropy ask.
    ///
    /// # Panics
    /// Where there is no such instance or triangle.
    pub fn tangent(&self, hit: &Hit, normal: Vec3, along: &Unwrapping) -> Option<Vec4> {
        let moved;
        let standing = &self.stock.standing[hit.instance as usize];
        let pose = pose!(self, standing, moved);
        standing
            .corners(pose, hit.primitive)
            .tangent(hit.u, hit.v, normal, along)
    }

    /// The texture coordinates (set 0 or 1) at a hit, for alpha tests; zero where the mesh has none.
    ///
    /// # Panics
    /// Where `set` is neither 0 nor 1.
    pub fn uv(&self, hit: &Hit, set: usize) -> Vec2 {
        let standing = &self.stock.standing[hit.instance as usize];
        standing
            .corners(&standing.pose, hit.primitive)
            .uv(set, weights(hit))
    }

    /// The vertex colour at a hit, for alpha tests; ones where the mesh has none.
    pub fn color(&self, hit: &Hit) -> [f32; 4] {
        let standing = &self.stock.standing[hit.instance as usize];
        standing
            .corners(&standing.pose, hit.primitive)
            .color(weights(hit))
    }

    /// The corners of a triangle in world space.
    ///
    /// # Panics
    /// Where there is no such instance or triangle.
    pub fn triangle(&self, instance: u32, primitive: u32) -> [Vec3; 3] {
        self.positions(instance, primitive).map(|p| p.as_vec3())
    }

    /// The area of a triangle in world space.
    ///
    /// # Panics
    /// Where there is no such instance or triangle.
    pub fn triangle_area(&self, instance: u32, primitive: u32) -> f64 {
        let [a, b, c] = self.positions(instance, primitive);
        (b - a).cross(c - a).length() * 0.5
    }

    /// The box around all instances, and around all of the way of those that move; [`Aabb::EMPTY`] of an empty world.
    pub fn bounds(&self) -> Aabb {
        self.stock.bounds
    }

    /// The instances, in the order in which they were given; those that move with their transform at time 0.
    pub fn instances(&self) -> &[Instance] {
        &self.stock.instances
    }

    /// The meshes, in the order in which they were given.
    pub fn meshes(&self) -> &[Arc<Mesh>] {
        &self.stock.meshes
    }

    /// The mesh with this index.
    ///
    /// # Panics
    /// Where there is no such mesh.
    pub fn mesh(&self, mesh: u32) -> &Mesh {
        &self.stock.meshes[mesh as usize]
    }

    /// The mesh that an instance places.
    ///
    /// # Panics
    /// Where there is no such instance.
    pub fn mesh_of(&self, instance: u32) -> &Mesh {
        self.mesh(self.stock.instances[instance as usize].mesh)
    }

    /// Triangles of all instances together: what a ray may meet.
    pub fn triangle_count(&self) -> u64 {
        self.stock
            .instances
            .iter()
            .map(|i| self.mesh(i.mesh).triangle_count() as u64)
            .sum()
    }

    /// Bytes that the acceleration structure takes, without the meshes.
    pub fn memory(&self) -> usize {
        let Stock { tree, places, .. } = &*self.stock;
        let trees: usize = places.trees.iter().map(Bvh::memory).sum();
        let keys = |motion: &Motion| size_of_val(motion.keys());
        let keys: usize = places.motions.iter().map(keys).sum();
        tree.memory() + trees + size_of_val(&places.list[..]) + keys
    }

    #[inline]
    fn walk<G: Goal>(&self, ray: &Ray, goal: &mut G) -> bool {
        let stock = &*self.stock;
        let level = Level {
            bvh: &stock.tree,
            ray,
            place: None,
            places: &stock.places,
            time: self.time,
        };
        stock.instruction_set.walk(&level, goal)
    }

    /// A triangle's corners exactly as the walk sees them.
    fn positions(&self, instance: u32, primitive: u32) -> [DVec3; 3] {
        let moved;
        let standing = &self.stock.standing[instance as usize];
        let pose = pose!(self, standing, moved);
        standing.corners(pose, primitive).positions
    }

    /// Where something that moves stands now.
    #[inline(never)]
    fn moved(&self, standing: &Standing) -> Pose {
        let motion = &self.stock.places.motions[standing.motion as usize];
        standing.moved(motion.at(self.time))
    }
}

/// The largest coordinate, absolute.
fn largest(bounds: &Aabb) -> f32 {
    bounds.min.abs().max(bounds.max.abs()).max_element()
}

fn weights(hit: &Hit) -> [f64; 3] {
    let (u, v) = (f64::from(hit.u), f64::from(hit.v));
    [1.0 - u - v, u, v]
}
