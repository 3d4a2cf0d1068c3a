//! Markov chains for expensive, vector-valued targets on the unit cube and on any state.

mod decide;
mod draws;
mod family;
mod generator;
mod independent;
mod kernel;
mod mean;
mod metropolis;
mod mutation;
mod point;
mod pool;
mod proposal;
mod statistics;
mod target;
pub mod testing;
mod visit;

pub use decide::{acceptance, decide};
pub use draws::Draws;
pub use family::{Family, checked_densities};
pub use generator::{generator, sample_generator};
pub use independent::Independent;
pub use kernel::{Kernel, Move, PointKernel};
pub use mean::Mean;
pub use metropolis::Metropolis;
pub use mutation::{Exponential, Mutation, Uniform};
pub use point::{Current, Point, Step};
pub use pool::{Pool, Start, StartError, sample};
pub use proposal::Proposal;
pub use statistics::{Acceptance, Statistics};
pub use target::{FnTarget, Target, target};
pub use visit::{Ignore, Recorder, Visit};

/// The generator that [`generator`] and [`sample_generator`] make.
pub use rand_pcg::Pcg64Dxsm;
