//! How to prove a kernel right.
mod asserts;
mod chance;
mod enumerator;
mod grid;
mod law;
mod matrix;
mod paired;
mod rank;
mod script;
#[cfg(any(test, feature = "testing"))]
pub mod strategies;

pub use asserts::{
    assert_deposits, assert_detailed_balance, assert_detailed_balance_within, assert_stationary,
    assert_stationary_within, expected_deposits,
};
pub use chance::{Sequential, chi_square_tail, normal_tails};
pub use enumerator::{Enumerator, enumerate, expectation};
pub use grid::{Grid, GridStep, OnGrid};
pub use law::{Law, PointKey, point_key};
pub use matrix::{Drift, Imbalance, TransitionMatrix};
pub use paired::{Changes, PairedTest, assert_invariant};
pub use rank::{RankTest, Ranks, assert_reversible};
pub use script::Script;
