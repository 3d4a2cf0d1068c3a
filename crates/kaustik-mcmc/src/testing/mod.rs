//! How to prove a kernel right.
//!
//! A kernel that is wrong by half a percent passes any histogram that a test has time to
//! fill. But every decision here is a call of [`Draws`](crate::Draws), so a program that
//! makes finitely many of them can be run along *all* its branches, and its law is then
//! known to rounding error. Where there is a grid, proofs are exact; where there is none,
//! they are statistical, and say how often they cry wolf.
//!
//! Enable it where you test, with `kaustik-mcmc = { version = "0.1", features = ["testing"] }` among
//! the dev-dependencies, and `proptest = "1.12"` if you use its `strategies`. The example `new_kernel` is this page as a program.
//!
//! # 1. Write decisions as draws
//!
//! Whatever has a known probability is [`bernoulli`](crate::Draws::bernoulli) or
//! [`index`](crate::Draws::index), never a comparison with a uniform number: a coin in
//! disguise cannot be enumerated. [`uniform`](crate::Draws::uniform) is for coordinates, and
//! is replaced by the middles of the cells of a grid. A kernel does not decide about its own
//! proposal: it returns the ratio, and the chain decides.
//!
//! # 2. An elementary kernel: detailed balance
//!
//! Number the states of a small case, enumerate one step from each, and compare the flow
//! between each two: [`TransitionMatrix::of`], [`assert_detailed_balance`], to 1e-14.
//! Balance is more than stationarity, and its message names the pair of states that is off.
//!
//! ```
//! use kaustik_mcmc::testing::{TransitionMatrix, assert_detailed_balance};
//! use kaustik_mcmc::{Draws, Ignore, Kernel, Metropolis, Move};
//!
//! /// Doubles or halves, but doubles twice as often.
//! struct Scale;
//!
//! impl Kernel<()> for Scale {
//!     type Value = u32; // the exponent
//!     fn propose<D: Draws + ?Sized>(
//!         &self, (): &mut (), &x: &u32, y: &mut u32, draws: &mut D,
//!     ) -> Move {
//!         let doubles = draws.bernoulli(2.0 / 3.0);
//!         if !doubles && x == 0 {
//!             return Move::impossible(Move::OWN);
//!         }
//!         *y = if doubles { x + 1 } else { x - 1 };
//!         Move::new(Move::OWN, if doubles { 0.5 } else { 2.0 }) // T(y -> x) / T(x -> y)
//!     }
//! }
//!
//! let pi = [0.1, 0.0, 3.0, 1.0, 0.5];
//! let family = |x: &u32| [pi.get(*x as usize).copied().unwrap_or(0.0)];
//! let matrix = TransitionMatrix::of(pi.len(), 1, |from, draws| {
//!     let mut chain = Metropolis::at((), from as u32, &family, 0);
//!     chain.step(&Scale, &family, draws, &mut Ignore);
//!     *chain.value() as usize
//! });
//! assert_detailed_balance(&matrix, &pi);
//! ```
//!
//! If the kernel has a state beside the value, return a number that is made of it, and assert that value and
//! state agree: the value alone is right after one step even where a rejected state is not taken back. Two
//! steps, enumerated together, must be the matrix [squared](TransitionMatrix::power).
//!
//! For chains on [`Point`](crate::Point)s, [`Grid`] numbers the states and
//! [`Grid::matrix`] does the rest; [`GridStep`] is a mutation on the grid, [`OnGrid`] brings
//! any other there.
//!
//! # 3. On targets that hurt
//!
//! One pleasant target proves little. `strategies` has proptest strategies for targets with
//! zeros, spikes, plateaus and many modes, for densities on the unit square, and for
//! symmetric mutations. A thousand small targets are enumerated in about a second.
//!
//! ```
//! use kaustik_mcmc::testing::{TransitionMatrix, assert_detailed_balance, strategies};
//! use kaustik_mcmc::{Draws, acceptance, decide};
//! use proptest::prelude::*;
//!
//! proptest!(|(pi in strategies::targets(2..7))| {
//!     let n = pi.len();
//!     let matrix = TransitionMatrix::of(n, 1, |from, draws| {
//!         let to = draws.index(&vec![1.0; n]);
//!         if decide(acceptance(pi[from], pi[to], 1.0), draws) { to } else { from }
//!     });
//!     assert_detailed_balance(&matrix, &pi);
//! });
//! ```
//!
//! # 4. A composite: stationarity
//!
//! Kernels one after the other keep what each of them keeps, but are not reversible:
//! [`assert_stationary`], to 1e-12, and see there for a measured example. Enumerate the
//! composite as a whole; if that is too much, its parts, and put the matrices together
//! ([`then`](TransitionMatrix::then), [`mixture`](TransitionMatrix::mixture)). The second way
//! is blind to what parts hand to each other beside the state.
//!
//! # 5. What a matrix cannot see
//!
//! Some programs remember more than their state: lazy points have coordinates that sleep and
//! owe steps. A [`Law`] carries all that a program remembers through several steps. Two
//! programs have one law if the joint laws of what they show agree; and a chain started from
//! its target, exactly, must still have it after each step. [`point_key`] tells points apart
//! by their future.
//!
//! # 6. Estimators: deposits
//!
//! Weighted visits, and chains that deposit energy, are right if what they add up is right
//! in the mean, in every place and channel, over all starts: [`assert_deposits`].
//!
//! # 7. Continuous states
//!
//! A path has no grid. Two tests remain, deterministic from a seed, that never fail a correct
//! kernel but once in 100,000 seeds ([`Sequential`]):
//!
//! | if you can | then |
//! |---|---|
//! | draw from the target exactly, and the kernel is reversible | [`assert_reversible`]: exact at any length of chain (Gandy and Scott 2020) |
//! | draw states of any known density | [`assert_invariant`]: weigh, step, compare in pairs; finds a missing factor of a ratio |
//!
//! And whatever the state: for an accepted x -> y, the ratio there times the ratio back is 1. (That finds a
//! factor turned upside down, and not one left out both ways.)
//!
//! # 8. Test the test
//!
//! Break the kernel where it is most likely to be wrong (the ratio upside down, a selection
//! probability left out, a rejected state not taken back, an exponent that is off), see the
//! test fail, and keep that as a test. Enumeration finds any fault that is larger than
//! rounding. A test by samples needs them in proportion to the inverse square of the fault: where
//! 20,000 starts find 10 % in an exponent, 2 % take some 400,000 (set [`PairedTest::starts`],
//! [`RankTest::chains`]). Mind that a kernel which never moves is in perfect balance (`assert_ne!` the matrix and
//! [`TransitionMatrix::identity`]), and one that never joins two states too: see that the matrix connects them.
//!
//! Two promises that none of these tests see: that a [move](crate::Move) which says it is
//! [independent](crate::Move::independent) is a sample of the uniform law (check the mean of
//! [`Statistics::independent`](crate::Statistics::independent) against a known integral), and
//! balance between states that are both a millionth of the whole and less likely: defects are relative to
//! all mass, so give small targets (`strategies` draws some) their own test.

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
