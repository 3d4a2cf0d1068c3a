//! Small scenes by code, for tests: a [`Stage`] to put things on, materials and meshes to put there.
//!
//! Enable it where you test, with `kaustik-scene = { version = "0.1", features = ["testing"] }` among
//! the dev-dependencies.
//!
//! ```
//! use glam::Vec3;
//! use kaustik_scene::testing::{Stage, ceiling, cuboid, dielectric, diffuse, floor, lamp};
//!
//! // A slab of green glass between a grey floor and a lamp.
//! let scene = Stage::new()
//!     .look_at(Vec3::new(0.3, 3.0, 2.0), Vec3::ZERO, 0.8)
//!     .add(diffuse([0.5; 3]), floor(0.0, 6.0))
//!     .add(
//!         dielectric(1.5, 0.0, [0.5, 0.8, 0.6]),
//!         cuboid(Vec3::new(-1.0, 0.4, -1.0), Vec3::new(1.0, 0.7, 1.0)),
//!     )
//!     .add(lamp(4.0), ceiling(Vec3::Y * 2.5, 0.7))
//!     .build();
//! assert!(scene.has_extended_lights() && !scene.has_punctual_lights());
//! ```
//!
//! Materials are plain [`MaterialDescription`](crate::description::MaterialDescription)s: what else one of them
//! shall be is said with `..`, as in `MaterialDescription { priority: 1, ..dielectric(1.3, 0.0, [1.0; 3]) }`.

mod materials;
mod meshes;
#[cfg(test)]
mod motion;
mod stage;
#[cfg(test)]
mod statistics;

pub use materials::{blended, dielectric, diffuse, double_sided, grey, lamp, metal};
pub use meshes::{ceiling, cuboid, floor, rectangle, rectangle_with_uv, sphere};
#[cfg(test)]
pub(crate) use motion::{channel, joint};
pub use stage::{Stage, compile, image, punctual};
#[cfg(test)]
pub(crate) use statistics::{Rng, chi_square, level, mean, wavelengths};
