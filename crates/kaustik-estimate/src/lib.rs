//! From the visits of Markov chains to splats on a film.
//!
//! A chain knows values and densities; a film knows splats. Between them stands what a visit
//! is worth: [`PathTarget`] evaluates paths, [`ScalarContribution`] reads the chain's density
//! off them, [`KelemenDeposit`] weighs and splats every visit.

mod deposit;
mod scalar;
mod target;

pub use deposit::{KelemenDeposit, Mis, Scale};
pub use kaustik_path::ScalarTarget;
pub use scalar::{Contribution, ScalarContribution};
pub use target::PathTarget;
