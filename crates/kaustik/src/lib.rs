//! Markov-chain Monte Carlo light transport.
//!
//! This crate wires the others: a [`Scene`](scene::Scene) and [`RenderSettings`] go in, an
//! image and [`RenderStatistics`] come out of [`render()`]. Rendering's threads are started here
//! and nowhere below (where scenes are loaded and trees are built, the feature `parallel` uses some); the same settings give the same bits for any number of them.
//!
//! ```
//! use kaustik::{Budget, Control, Method, RenderSettings, render};
//! use kaustik::scene::{Scene, builtin};
//!
//! let settings = RenderSettings {
//!     method: Method::Path,
//!     width: 8,
//!     height: 8,
//!     budget: Budget::PerPixel(4),
//!     ..RenderSettings::default()
//! };
//! let scene = Scene::new(&builtin::load("furnace")?, &settings.scene_options())?;
//! let done = render(&scene, &settings, &mut Control::default())?;
//! assert_eq!(done.image.width(), 8);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A file in place of a built-in scene, and the picture in a file:
//!
//! ```no_run
//! use std::path::Path;
//! use kaustik::film::{Tone, png};
//! use kaustik::scene::{Scene, gltf};
//! use kaustik::{Control, RenderSettings, render};
//!
//! let settings = RenderSettings::default();
//! let loaded = gltf::load(Path::new("scene.glb"), &gltf::LoadOptions::default())?;
//! for warning in &loaded.warnings {
//!     eprintln!("{warning}");
//! }
//! let scene = Scene::new(&loaded.description, &settings.scene_options())?;
//! let done = render(&scene, &settings, &mut Control::default())?;
//! png::write(Path::new("scene.png"), &done.image, &Tone::default())?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod beside;
mod carried;
mod chains;
mod check;
mod control;
mod engine;
mod error;
#[cfg(test)]
mod faults;
mod features;
mod mark;
mod merge;
mod methods;
mod render;
mod replay;
#[cfg(test)]
mod retold;
mod sampling;
mod settings;
#[cfg(test)]
mod small;
mod state;
mod statistics;
#[cfg(test)]
mod stops;
mod threads;
mod work;

pub use control::{Control, Progress};
pub use error::RenderError;
pub use merge::{merge, merged_settings};
pub use methods::{StageLadder, StageOptions};
pub use render::{Outcome, Rendered, Watch, render, render_watched, resume};
pub use replay::{replay, replay_from};
pub use settings::{
    Budget, Builder, Caustics, Colours, Direct, Energy, EvenSamples, Jitter, KEYS, Key, LadderSize,
    Method, MutationKind, Mutations, Normalisation, Normaliser, OptionError, Options, Pace,
    PhotonOptions, RenderSettings, SmallStep, StartShare, Starts, Steps, Strategies,
    TargetFunction, UnknownMethod,
};
pub use state::{Snapshot, Source, State, StateError};
pub use statistics::{
    ChainStatistics, DirectStatistics, EnergyStatistics, MergeStatistics, MergedPart,
    MutationStatistics, Parts, PhotonLevel, PhotonStatistics, RenderStatistics, ReplicaLevel,
    ReplicaStatistics, StageStatistics, StepId,
};
pub use threads::on_threads;

pub use kaustik_estimate::Mis;
pub use kaustik_path::RayCounts;

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
