//! Exact tests of kernels on small discrete targets.
//!
//! A kernel that is wrong by half a percent passes any histogram that a test has time to
//! fill. But every decision here is a call of [`Draws`](crate::Draws), so a program that
//! makes finitely many of them can be run along *all* its branches, and its law is then
//! known to rounding error: [`enumerate`]. From laws follow the
//! [`TransitionMatrix`] of a kernel on a small state space, with its defects of
//! stationarity and of detailed balance, and the law of a whole chain after several steps
//! ([`Law`]), which sees what a matrix cannot: coordinates that sleep.

mod enumerator;
mod grid;
mod law;
mod matrix;

pub use enumerator::{Enumerator, enumerate};
pub use grid::GridStep;
pub use law::{Law, PointKey, point_key};
pub use matrix::TransitionMatrix;
