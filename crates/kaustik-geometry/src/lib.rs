//! Triangle meshes, instances and a wide, watertight ray traversal.
//!
//! A [`World`] is built once from shared [`Mesh`]es and [`Instance`]s and then answers rays: the closest hit, whether
//! anything is hit, and either of them with a filter for alpha tests. A [`Hit`] is small and plain; [`World::surface`]
//! turns it into a [`Surface`] with normals, texture coordinates and a bound on the rounding error of its position,
//! from which [`Ray::spawn`] and [`Ray::between`] make rays that neither meet the surface they leave nor pass through
//! it, at any scale.
//!
//! Instances may move ([`Motion`]): [`World::at`] is the same world at an instant, which rays see as it stands then.
//!
//! This crate knows triangles and rays. It knows no material, no light and no camera.
//!
//! ```
//! use std::sync::Arc;
//! use glam::{Affine3A, Vec3};
//! use kaustik_geometry::{Instance, Mesh, Ray, World};
//!
//! let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]])?;
//! let instance = Instance { mesh: 0, transform: Affine3A::from_translation(Vec3::Z) };
//! let world = World::build(vec![Arc::new(mesh)], vec![instance])?;
//!
//! let ray = Ray::new(Vec3::new(0.25, 0.25, 3.0), -Vec3::Z);
//! let hit = world.intersect(&ray).ok_or("the ray points at the triangle")?;
//! let surface = world.surface(&ray, &hit);
//! assert_eq!(surface.position, Vec3::new(0.25, 0.25, 1.0));
//! assert!(surface.front);
//! assert!(!world.occluded(&Ray::spawn(&surface, Vec3::Z)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod aabb;
mod assembly;
mod bvh;
mod instance;
mod mesh;
mod motion;
mod ray;
mod standing;
mod surface;
mod unwrapping;
mod world;

pub use aabb::Aabb;
pub use instance::{Instance, WorldError};
pub use mesh::{Mesh, MeshError};
pub use motion::Motion;
pub use ray::{Hit, Ray};
pub use surface::{Surface, offset_origin};
pub use unwrapping::Unwrapping;
pub use world::World;
