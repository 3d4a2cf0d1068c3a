//! Markov-chain Monte Carlo light transport.
//!
//! This crate wires the others: a [`Scene`](scene::Scene) and [`RenderSettings`] go in, an
//! image and [`RenderStatistics`] come out of [`render`]. Rendering's threads are started here
//! and nowhere below (where scenes are loaded and trees are built, the feature `parallel` uses some); the same settings give the same bits for any number of them.
//!
//! ```
//! use kaustik::{Budget, Control, Method, RenderSettings, render};
//! use kaustik::scene::{Scene, SceneOptions, builtin};
//!
//! let description = builtin::load("furnace")?;
//! let scene = Scene::new(&description, &SceneOptions { width: 8, height: 8, ..Default::default() })?;
//! let settings = RenderSettings {
//!     method: Method::Path,
//!     width: 8,
//!     height: 8,
//!     budget: Budget::PerPixel(4),
//!     ..RenderSettings::default()
//! };
//! let done = render(&scene, &settings, &mut Control::default())?;
//! assert_eq!(done.image.width(), 8);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod annealing;
mod beside;
mod builders;
mod carried;
mod cells;
mod chains;
mod check;
mod choices;
mod control;
mod direct;
mod energy_statistics;
mod engine;
mod erpt;
mod erpt_pss;
mod error;
#[cfg(test)]
mod faults;
mod features;
mod independent;
mod key;
mod lamps;
mod lost;
mod mark;
mod merge;
mod merge_statistics;
mod meter;
mod method;
mod mlt;
mod mmlt;
mod mutation_kind;
mod mutations;
mod options;
mod path_space;
mod photon;
mod photon_options;
mod pssmlt;
mod relt;
mod render;
mod replay;
mod replica_statistics;
#[cfg(test)]
mod retold;
mod settings;
mod shuffle;
#[cfg(test)]
mod small;
mod sobol;
mod stages;
mod state;
mod statistics;
#[cfg(test)]
mod stops;
mod stratified;
mod streams;
mod threads;

pub use choices::{
    Builder, Caustics, Colours, Direct, Energy, EvenSamples, Jitter, Normaliser, SmallStep, Starts,
    Steps, Strategies,
};
pub use control::{Control, Progress};
pub use energy_statistics::EnergyStatistics;
pub use error::RenderError;
pub use key::{KEYS, Key};
pub use merge::{merge, whole};
pub use merge_statistics::{MergeStatistics, MergedPart, Parts};
pub use method::{Method, UnknownMethod};
pub use mutation_kind::MutationKind;
pub use mutations::Mutations;
pub use options::{OptionError, Options};
pub use photon_options::{LadderSize, Normalisation, Pace, PhotonOptions, TargetFunction};
pub use render::{Outcome, Rendered, Watch, render, render_watched, resume};
pub use replay::{replay, replay_from};
pub use replica_statistics::{ReplicaLevel, ReplicaStatistics};
pub use settings::{Budget, RenderSettings};
pub use stages::{StageLadder, StageOptions};
pub use state::{Snapshot, Source, State, StateError};
pub use statistics::{
    ChainStatistics, DirectStatistics, MutationStatistics, PhotonLevel, PhotonStatistics, Place,
    RayStatistics, RenderStatistics, StageStatistics,
};
pub use threads::on_threads;

pub use kaustik_estimate::Mis;

pub use kaustik_bsdf as bsdf;
pub use kaustik_estimate as estimate;
pub use kaustik_film as film;
pub use kaustik_geometry as geometry;
pub use kaustik_mcmc as mcmc;
pub use kaustik_mutate as mutate;
pub use kaustik_path as path;
pub use kaustik_pss as pss;
pub use kaustik_scene as scene;
pub use kaustik_spectrum as spectrum;
