//! Estimators: from the visits of Markov chains to splats on a film.
//!
//! A chain works with values and densities, a film with splats. This crate lies between them and decides what a visit
//! contributes: [`PathTarget`] evaluates paths, [`ScalarContribution`] computes the chain's density
//! from the result ([`MappedContribution`]: times a [`RasterMap`]), [`KelemenDeposit`] weights and
//! splats every visit. [`ReplicaFamily`] and [`ReplicaDeposit`] do the same for replica
//! exchange.
//!
//! For photons, [`PhotonMap`] gives the contribution of a light path to each measurement point,
//! [`PhotonTarget`] gives the densities of all levels, [`PhotonDeposit`] weights the visits.
//! The spatial target is learnt through [`RegionSums`] (statistics of what has touched a region) and [`Regions`]
//! (the tree, and the density of photons in each of its leaves).
//!
//! ```
//! use std::sync::atomic::AtomicU64;
//!
//! use kaustik_estimate::{KelemenDeposit, Mis, PathTarget, Scale, ScalarContribution};
//! use kaustik_film::{Film, Filter, Layout, Quantum, develop};
//! use kaustik_mcmc::{Exponential, Metropolis, PointKernel, generator};
//! use kaustik_path::{BuilderSettings, Unidirectional};
//! use kaustik_scene::{Scene, SceneOptions, builtin};
//!
//! let description = builtin::load("cornell")?;
//! let scene = Scene::new(&description, &SceneOptions { width: 8, height: 8, ..Default::default() })?;
//! let builder = Unidirectional {
//!     settings: BuilderSettings::default(),
//!     next_event: true,
//! };
//! let nonfinite = AtomicU64::new(0);
//! let target = PathTarget { scene: &scene, builder: &builder, nonfinite: &nonfinite };
//! let family = ScalarContribution::default();
//! // The film counts in quanta of a small part of a pixel's rough mean.
//! let film = Film::with_layout(&Layout::new(8, 8).with_filter(Filter::BOX), Quantum::from_mean(1.0))?;
//!
//! let (p_large, mut draws) = (0.3, generator(7, 0));
//! let small = Exponential::new(1.0 / 1024.0, 1.0 / 64.0);
//! // Wherever it comes first: a renderer draws a chain's first state from a `Pool`, and is unbiased from then on.
//! let mut chain = Metropolis::start(&target, &family, 0, small, &mut draws);
//! let kernel = PointKernel::new(target, p_large);
//! let mut deposit = KelemenDeposit {
//!     chain: &film,
//!     large: None,
//!     scale: Scale { width: 8.0, height: 8.0 },
//!     b0: 1.0, // a constant in the weights, which falls out
//!     p_large,
//!     mis: Mis::Off, // expected values alone
//! };
//! for _ in 0..2000 {
//!     chain.step(&kernel, &family, &mut draws, &mut deposit);
//! }
//! chain.flush(&mut deposit);
//! // Large steps are independent samples: their mean is b, which scales the film of 64 pixels and 2000 mutations.
//! let b = chain.statistics().independent[0].mean();
//! let image = develop(&[(&film, b * 64.0 / 2000.0)])?;
//! assert!(b > 0.0 && image.width() == 8);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod density_target;
mod deposit;
mod first_meetings;
mod photon_deposit;
mod photon_map;
mod photon_target;
mod photon_target_kind;
mod raster_map;
mod region_sums;
mod region_witnesses;
mod regions;
mod replica_set;
mod replicas;
mod scalar;
mod shares;
mod specular_split;
mod target;

pub use density_target::DensityTarget;
pub use deposit::{KelemenDeposit, Mis, Scale};
pub use kaustik_path::ScalarTarget;
pub use photon_deposit::{Combine, PhotonDeposit, Sharing, TOUCH};
pub use photon_map::PhotonMap;
pub use photon_target::{Meeting, PhotonLevels, PhotonTarget, PhotonValue};
pub use photon_target_kind::PhotonTargetKind;
pub use raster_map::RasterMap;
pub use region_sums::{RegionSums, Witnesses};
pub use region_witnesses::RegionWitnesses;
pub use regions::{LeafTally, Learnt, Refinement, RegionPoint, Regions, inverse};
pub use replica_set::{ClassWeights, ReplicaSet, ReplicaSetError};
pub use replicas::{ReplicaDeposit, ReplicaFamily, ReplicaWeights, SpecificFamily};
pub use scalar::{Contribution, MappedContribution, ScalarContribution};
pub use shares::ReplicaShares;
pub use specular_split::SpecularSplit;
pub use target::{CountedTarget, PathTarget};
