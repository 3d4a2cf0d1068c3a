//! Scattering at surfaces in the local frame, spectral, in both transport modes.
//!
//! A [`Bsdf`] is a closed, `Copy` enum of scattering functions; each variant is a file of its own
//! and implements [`Lobe`], and so do all through the enum. They take numbers and never a
//! sampler, so each can be tested, replayed and mutated by itself. Directions and densities are
//! `f64`, values are [`Spectrum`](kaustik_spectrum::Spectrum) at the path's four wavelengths.
//!
//! ```
//! use kaustik_bsdf::{Bsdf, Lobe, Mode};
//! use kaustik_spectrum::Spectrum;
//! use glam::DVec3;
//!
//! let clay = Bsdf::lambertian(Spectrum::splat(0.5));
//! let wo = DVec3::new(0.6, 0.0, 0.8);
//! let sample = clay.sample(wo, 0.3, [0.2, 0.7], Mode::Radiance).unwrap();
//! assert!((sample.pdf - clay.pdf(wo, sample.wi, Mode::Radiance)).abs() < 1e-12);
//! ```
//!
//! # Conventions
//! * z is the shading normal; `wo` points to where the walk came from, `wi` to where it goes on;
//!   both are unit and point away from the surface.
//! * [`Mode::Radiance`] walks from the eye, [`Mode::Importance`] from a light. Each is the other's
//!   adjoint: `eval(wo, wi, Importance) == eval(wi, wo, Radiance)`.
//! * Opaque surfaces reflect on both sides; a dielectric's outside is z > 0.
//! * Lobes are chosen by their means over the lanes (the path's four wavelengths), so a pdf is one number for all wavelengths.
//! * **Hero alone**: refraction where the index differs between lanes sends all of them in the direction of the
//!   hero wavelength, which is right for the hero only. `Sample::dispersive` and
//!   [`Lobe::dispersive_between`] report this; such a path counts for its hero only.

mod albedo;
mod bsdf;
mod bsdf_list;
mod coat;
mod coated;
mod conductor;
mod delta;
mod dielectric;
mod facets;
mod finish;
mod frame;
pub mod fresnel;
mod ggx;
mod interface;
mod lambertian;
mod layered;
mod lobe;
mod local;
mod mirror;
mod mode;
mod oren_nayar;
mod parts;
mod passing;
mod phong;
mod principled;
mod rebound;
mod reflectance;
mod rough_conductor;
mod rough_dielectric;
mod rough_thin_dielectric;
mod sample;
pub mod shading;
mod shared;
mod sheen;
mod thin_dielectric;
mod thin_film;
pub mod warp;

pub use bsdf::{Bsdf, SMOOTH_ALPHA};
pub use bsdf_list::BsdfList;
pub use coated::Coated;
pub use conductor::Conductor;
pub use delta::Delta;
pub use dielectric::Dielectric;
pub use finish::Finish;
pub use frame::Frame;
pub use interface::Interface;
pub use lambertian::Lambertian;
pub use layered::{LayerParameters, Layered};
pub use lobe::Lobe;
pub use mirror::Mirror;
pub use mode::Mode;
pub use oren_nayar::OrenNayar;
pub use parts::Parts;
pub use passing::Passing;
pub use phong::Phong;
pub use principled::{FilmParameters, Principled, PrincipledParameters, Wall};
pub use reflectance::Reflectance;
pub use rough_conductor::RoughConductor;
pub use rough_dielectric::RoughDielectric;
pub use rough_thin_dielectric::RoughThinDielectric;
pub use sample::Sample;
pub use thin_dielectric::ThinDielectric;
pub use thin_film::ThinFilm;
