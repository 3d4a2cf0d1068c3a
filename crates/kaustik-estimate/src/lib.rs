//! From the visits of Markov chains to splats on a film.
//!
//! A chain knows values and densities; a film knows splats. Between them stands what a visit
//! is worth: [`PathTarget`] evaluates paths, [`ScalarContribution`] reads the chain's density
//! off them ([`MappedContribution`]: times a [`RasterMap`]), [`KelemenDeposit`] weighs and
//! splats every visit. [`ReplicaFamily`] and [`ReplicaDeposit`] do the same for replica
//! exchange.
//!
//! For photons, [`PhotonMap`] says what a light path brings to which measurement points,
//! [`PhotonTarget`] gives the densities of all levels, [`PhotonDeposit`] weighs the visits.
//! The spatial target learns by [`RegionSums`] (what has touched a region) and [`Regions`]
//! (the tree, and the density of photons in each of its leaves).

mod density_target;
mod deposit;
mod first_meetings;
mod photon_deposit;
mod photon_map;
mod photon_target;
mod photon_target_kind;
mod raster_map;
mod region_sums;
mod regions;
mod replica_set;
mod replicas;
mod scalar;
mod shares;
mod specular_split;
mod target;

pub use density_target::DensityTarget;
pub use deposit::{KelemenDeposit, Mis, Scale};
pub use first_meetings::FirstMeetings;
pub use kaustik_path::ScalarTarget;
pub use photon_deposit::{Combine, PhotonDeposit, Sharing, TOUCH};
pub use photon_map::PhotonMap;
pub use photon_target::{Meeting, PhotonLevels, PhotonTarget, PhotonValue};
pub use photon_target_kind::PhotonTargetKind;
pub use raster_map::RasterMap;
pub use region_sums::{RegionSums, Witnesses};
pub use regions::{LeafTally, Learnt, Place, Refinement, Regions, inverse};
pub use replica_set::{ClassWeights, ReplicaSet, ReplicaSetError};
pub use replicas::{ReplicaDeposit, ReplicaFamily, ReplicaWeights, SpecificFamily};
pub use scalar::{Contribution, MappedContribution, ScalarContribution};
pub use shares::Shares;
pub use specular_split::SpecularSplit;
pub use target::{CountedTarget, PathTarget};
