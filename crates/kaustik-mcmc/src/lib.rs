//! Markov chains for expensive, vector-valued targets on the unit cube and on any state.
//!
//! Some integrals are expensive: each evaluation takes microseconds or more, yields not a single number
//! but a bundle of contributions (which pixels, which colours), and reads as many random
//! numbers as it happens to need. Where such an integrand is concentrated in small regions,
//! independent samples waste nearly all evaluations. A Metropolis chain walks on the
//! *random numbers themselves*, the primary samples (Kelemen, Szirmay-Kalos, Antal and
//! Csonka, "A simple and robust mutation strategy for the Metropolis light transport
//! algorithm", 2002), and stays where the integrand is large. This crate implements that method.
//! It was made for rendering but contains nothing about light: no vector, no image and no thread.
//!
//! ```
//! use kaustik_mcmc::{
//!     Coordinates, Exponential, Metropolis, PointKernel, Pool, Stream, Visit, generator, sample,
//!     sample_generator, target,
//! };
//!
//! // Where does a particle end that decays with chance 2% at each of its random steps?
//! // We want the far tail: how much of (end - 3)^+ is there? Evaluation is the dear part,
//! // its dimension is random.
//! let walk = target(|u: &mut dyn Coordinates| -> f64 {
//!     let (mut end, mut i) = (0.0, 0);
//!     while i < 200 && u.get(Stream::Camera, 2 * i) > 0.02 {
//!         end += 0.5 * (u.get(Stream::Camera, 2 * i + 1) - 0.5);
//!         i += 1;
//!     }
//!     end
//! });
//! // The density that guides the chain: positive wherever the integrand is.
//! let tail = |end: &f64| [(end - 3.0f64).max(0.0)];
//!
//! // A pool of independent samples gives the normaliser and the start of the chain.
//! // (A ladder is one chain, or several that exchange, with a generator of its own.)
//! let (seed, ladder) = (7, 0);
//! let mut end = 0.0;
//! let pool = Pool::new((0..50_000).map(|step| {
//!     let densities = sample(&walk, &tail, sample_generator(seed, ladder, step), &mut end);
//!     densities.map_or(f64::NAN, |d| d[0]) // NaN: a defect, which the pool counts
//! }));
//! let mut rng = generator(seed, ladder);
//! let start = pool.choose(&mut rng).expect("some walk gets beyond 3");
//! let mut again = sample_generator(seed, ladder, start.index);
//! let level = 0; // which of the family's densities it follows: here there is one
//! let mut chain =
//!     Metropolis::rebuild(&walk, &tail, level, Exponential::default(), &start, &mut again)?;
//!
//! // The chain: large steps with probability 0.3. Every visit comes with its weight.
//! let kernel = PointKernel::new(&walk, 0.3);
//! let (steps, mut beyond_four) = (20_000, 0.0);
//! let mut record = |visit: Visit<'_, f64, 1>| {
//!     if *visit.value > 4.0 {
//!         beyond_four += visit.weight; // the share of the tail that lies beyond 4
//!     }
//! };
//! for _ in 0..steps {
//!     chain.step(&kernel, &tail, &mut rng, &mut record);
//! }
//! chain.flush(&mut record);
//!
//! let b = pool.normaliser(); // the integral of the tail, with its standard error
//! println!("{:.5} +- {:.5}, {:.3} of it beyond 4", b.mean(), b.standard_error(),
//!     beyond_four / steps as f64);
//! let statistics = chain.statistics(); // small steps are accepted far more often
//! assert!(statistics.small().rate() > 20.0 * statistics.large().rate());
//! # assert!(b.mean() > 5.0 * b.standard_error());
//! # Ok::<(), kaustik_mcmc::StartError>(())
//! ```
//!
//! # The nouns
//!
//! | noun | is |
//! |---|---|
//! | [`Target`] | the expensive part: evaluates a point into a value |
//! | [`Family`] | the cheap part: K unnormalised target densities, one per level, computed from a value |
//! | [`Point`] | coordinates that are created when first read, with time stamps (Kelemen sec. 4 and 6) |
//! | [`Mutation`] | how one coordinate takes a small step: [`Exponential`], [`Uniform`], [`WrappedNormal`], [`WrappedCauchy`], [`Power`]; [`PerCoordinate`] |
//! | [`Proposal`] | a guard that holds the proposed point until it is decided on; dropped undecided, it leaves no trace |
//! | [`Kernel`] | how a chain proposes, for any state: [`PointKernel`] for points, [`LevelKernel`] and [`SizedKernel`] with step sizes of their own |
//! | [`Mixture`] | several kernels in one, by fixed chances or by [`Suitability`] |
//! | [`Scouting`] | independence proposals that a cheap test screens before they are evaluated: [`Metropolis::scout`] |
//! | [`Touring`] | surrogate transitions (Liu 2001): many steps under a cheap target, offered as one: [`Metropolis::step_by_tour`] |
//! | [`SecondStage`] | a second try after a rejected large step: [`Metropolis::step_delayed`] |
//! | [`Metropolis`] | a chain: its current value, the accept/reject decision, visits not yet reported |
//! | [`Ladder`] | chains at all levels that exchange states: by a [`Schedule`], on a [`SwapGraph`] |
//! | [`Population`], [`anneal`](fn@anneal) | particles that climb the levels: starts and rough normalisers |
//! | [`RoughNormalisers`], [`SteppingStone`] | integrals of the densities: fixed ones for weights, running ones for scales |
//! | [`Visit`], [`Recorder`] | what a chain reports at each step, and what receives it |
//! | [`Pool`], [`Start`] | independent samples, and the one a chain begins at |
//! | [`Stratification`] | a pool of samples that are stratified over the cube |
//! | [`Redistribution`], [`Redistributor`], [`Deposit`] | many short chains from Monte Carlo samples |
//! | [`AcceptanceAdaptation`], [`JumpAdaptation`], [`DiminishingAdaptation`] | step sizes that learn, between rounds |
//! | [`Mean`], [`Estimate`] | a running mean with its standard error; a number with its own |
//! | [`IndexProcess`] | which replica was where: lineages, round trips |
//! | [`Autocorrelation`], [`Halves`], [`split_r_hat`], [`Jumps`] | how far a chain's estimates can be trusted |
//! | [`Draws`] | the source of every random decision: a generator, or the [enumerator](testing::Enumerator) |
//! | [`testing`] | with the feature `testing`: how to prove a kernel of your own correct |
//!
//! The expensive and the cheap part are kept apart so that a value, once computed, can be used under any
//! number of densities: exchange between replicas, multiple importance sampling and
//! annealing need no further evaluation.
//!
//! # Two ways in
//!
//! *The chain pulls*: implement [`Target`] (or use [`target`]) and call
//! [`Metropolis::step`]. This is the way above.
//!
//! *You ask and tell*: keep your own loop, take a [`Proposal`] from a [`Point`], read
//! coordinates from it, evaluate, decide. There is no trait to implement; [`Proposal`] has a complete example.
//!
//! Either way, a renderer that asks a sampler for the *next* number wraps the coordinates in a
//! [`Cursor`].
//!
//! Path mutations and other states that are no points implement [`Kernel`] and use the
//! same chain. There is one accept/reject decision, [`decide`](fn@decide), with one acceptance
//! probability, [`acceptance`], in all of this.
//!
//! # Estimating
//!
//! Let b be the integral of the density I at the chain's level, M the number of steps and F the quantity to be integrated:
//!
//! | estimator | each visit adds | scale |
//! |---|---|---|
//! | expected values (Kelemen sec. 1.2) | weight * F / I | b / M |
//! | Kelemen's combination (eqs. 1 and 2), split: of all visits | weight * F / (I/b0 + p) | (b / b0) / M |
//! | the same: of independent proposals | independent * F / (I/b0 + p) | 1 / M |
//!
//! where p is the probability of large steps and b0 any positive constant, such as a guess of b. Kelemen's
//! combination is the sum of the two lower rows. Both estimators are unbiased after any number of steps, if b is the
//! [normaliser](Pool::normaliser) of the same pool that the chain's start was chosen from.
//! (A pool whose samples all have density 0 has b = 0, which is right for the sum over all visits: a chain from any
//! start still contributes its independent proposals.)
//! Kelemen's printed form, which has an estimate of b inside the weights, is biased.
//!
//! # To read on
//!
//! * [`guide::algorithms`]: each algorithm with its source, what it assumes, what is unbiased and
//!   what only consistent, and when to use which.
//! * [`guide::graphics`]: the words and equation numbers of Kelemen, Kitaoka, Cline and Batty.
//! * [`guide::statistics`]: what is unlike other libraries of Markov chains.
//! * [`guide::keeping`]: determinism, threads, states written and read again (feature `serde`).
//! * [`testing`]: proving a kernel of one's own (feature `testing`).
//!
//! # Features
//!
//! None by default: the dependencies are then `kaustik-pss`, `rand`'s traits, one generator and `libm`.
//! `testing` adds the kit with proptest's strategies, `serde` the states as files. (JSON keeps the bits of numbers only with
//! `serde_json`'s feature `float_roundtrip`; without it, chains are refused when they are read.)
//!
//! # Determinism and replay
//!
//! Nothing here reads a clock or a global generator. [`generator`] belongs to a stream of random numbers: that of one
//! chain, or of a [`Ladder`] of chains that exchange; its second argument counts them. [`sample_generator`] makes the numbers of a single sample, which
//! is made again from (seed, ladder, step) alone.
//!
//! # Errors
//!
//! A step cannot fail. A density that is NaN, infinite or negative is counted
//! ([`Statistics::defects`]), treated as zero, and neither enters a state nor reaches a
//! recorder. What can: a start ([`StartError`]), a population that dies out ([`Extinct`]), parameters out of
//! range ([`RedistributionError`], [`SwapGraphError`]). An index that does not exist, such as a level of K
//! or more, and a constant that no program should have, such as a target acceptance of 2, panic: "Panics" says so at each.

/// The program of the README runs.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod adapt;
mod anneal;
mod decide;
mod delayed_rejection;
mod diagnostics;
mod draws;
mod family;
mod generator;
pub mod guide;
mod independent;
mod index_process;
mod kernel;
mod ladder;
mod ladder_statistics;
mod level_kernel;
mod mean;
mod metropolis;
mod mixture;
mod mutation;
mod normal;
mod normalisers;
mod permutation;
mod point;
mod pool;
mod population;
mod proposal;
mod redistribute;
mod resample;
mod schedule;
mod scout;
#[cfg(feature = "serde")]
mod serial;
mod sized_kernel;
mod sobol;
mod statistics;
mod stepping_stone;
mod stratified;
mod swap_graph;
mod target;
// `doc`: so that the documentation has it, and links to it, without features
#[cfg(any(test, doc, feature = "testing"))]
pub mod testing;
mod tour;
#[cfg(test)]
mod toys;
mod visit;

pub use adapt::{AcceptanceAdaptation, DiminishingAdaptation, JumpAdaptation};
pub use anneal::{Annealed, anneal};
pub use decide::{acceptance, decide, exchange_acceptance};
pub use delayed_rejection::{SecondStage, second_acceptance};
pub use diagnostics::{Autocorrelation, Halves, Jumps, r_hat, rank_split_r_hat, split_r_hat};
pub use draws::{ByRef, Draws, Uniforms};
pub use family::{Family, checked_densities};
pub use generator::{SampleGenerators, generator, sample_generator};
pub use independent::Independent;
pub use index_process::IndexProcess;
pub use kernel::{Kernel, Move, PointKernel};
pub use ladder::Ladder;
pub use ladder_statistics::LadderStatistics;
pub use level_kernel::LevelKernel;
pub use mean::Mean;
pub use metropolis::Metropolis;
pub use mixture::{Components, Mixture, Suitability};
pub use mutation::{
    Exponential, Mutation, PerCoordinate, Power, Scalable, Uniform, WrappedCauchy, WrappedNormal,
};
pub use normalisers::{Estimate, RoughNormalisers, RunningNormalisers};
pub use point::{Current, Point, Seeding, Step};
pub use pool::{Pool, Start, StartError, sample};
pub use population::{Extinct, Population, Stage};
pub use proposal::Proposal;
pub use redistribute::{
    Deposit, Depositor, Redistribution, RedistributionError, RedistributionStatistics,
    Redistributor,
};
pub use resample::Resampling;
pub use schedule::Schedule;
pub use scout::{Region, Scouted, Scouting};
pub use sized_kernel::SizedKernel;
pub use statistics::{Acceptance, Statistics};
pub use stepping_stone::SteppingStone;
pub use stratified::{Stratification, Stratified};
pub use swap_graph::{SwapGraph, SwapGraphError};
pub use target::{FnTarget, Target, target};
pub use tour::{TourRecorder, Touring};
pub use visit::{Both, Ignore, Recorder, Visit};

/// What targets are given: coordinates of a point of the unit cube, by stream.
pub use kaustik_pss::{Coordinates, Cursor, Recorded, Recording, Stream};
/// The generator that [`generator`] and [`sample_generator`] make.
pub use rand_pcg::Pcg64Dxsm;
