//! Bits, threads, stopping and going on.
//!
//! # The same bits
//!
//! Nothing here reads a clock or a generator that is not given. A chain, a ladder or a
//! population with the generator of its own index ([`generator`](crate::generator)) has the
//! same bits whichever thread moves it, and whatever others do in between. Sums of floating
//! point depend on their order: merge statistics in the order of indices, not of arrival.
//! Exponentials and logarithms come from `libm`, so that machines agree; values of generators,
//! mutations and sequences are pinned by tests.
//!
//! ```
//! # use kaustik_mcmc::{Exponential, Ignore, Metropolis, PointKernel, Statistics, generator, target};
//! # use kaustik_pss::{Coordinates, Stream};
//! # let square = target(|u: &mut dyn Coordinates| u.get(Stream::Camera, 0));
//! # let family = |x: &f64| [x * x];
//! let run = |ladder: u64| {
//!     let mut rng = generator(1, ladder); // all that it does follows from its index
//!     let mut chain = Metropolis::start(&square, &family, 0, Exponential::default(), &mut rng);
//!     let kernel = PointKernel::new(&square, 0.3);
//!     for _ in 0..1000 {
//!         chain.step(&kernel, &family, &mut rng, &mut Ignore);
//!     }
//!     chain.statistics().clone()
//! };
//! let parts: Vec<_> = std::thread::scope(|scope| {
//!     let run = &run;
//!     let threads: Vec<_> = (0..8).map(|ladder| scope.spawn(move || run(ladder))).collect();
//!     threads.into_iter().map(|thread| thread.join().expect("no panic")).collect()
//! });
//! let mut all = Statistics::new();
//! for part in &parts {
//!     all.merge(part); // by index, not by arrival
//! }
//! assert_eq!(all.steps, 8000);
//! ```
//!
//! # A state is a value
//!
//! With the feature `serde`, all that a run consists of can be written between any two steps
//! and read again, and goes on with the same bits: [`Metropolis`](crate::Metropolis) (what is
//! pending and its statistics included), [`Point`](crate::Point), [`Ladder`](crate::Ladder),
//! [`Population`](crate::Population), [`Redistributor`](crate::Redistributor), adaptations,
//! diagnostics, normalisers, [`Pool`](crate::Pool), [`Stratification`](crate::Stratification)
//! and the generator [`Pcg64Dxsm`](crate::Pcg64Dxsm). Kernels, targets and families are functions
//! and not written; step sizes are, with the points that own them. A state or a value of
//! one's own must be `Serialize` and `Deserialize`, and the value `Default` as always.
//!
#![cfg_attr(feature = "serde", doc = "```")]
#![cfg_attr(not(feature = "serde"), doc = "```ignore")]
//! # use kaustik_mcmc::{Exponential, Ignore, Metropolis, Pcg64Dxsm, Point, PointKernel, generator, target};
//! # use kaustik_pss::{Coordinates, Stream};
//! let square = target(|u: &mut dyn Coordinates| u.get(Stream::Camera, 0));
//! let family = |x: &f64| [x * x];
//! let kernel = PointKernel::new(&square, 0.3);
//! let mut rng = generator(1, 0);
//! let mut chain = Metropolis::start(&square, &family, 0, Exponential::default(), &mut rng);
//! chain.step(&kernel, &family, &mut rng, &mut Ignore);
//!
//! let file = serde_json::to_string(&(&chain, &rng))?;
//! let (mut again, mut same): (Metropolis<Point<Exponential>, f64, 1>, Pcg64Dxsm) =
//!     serde_json::from_str(&file)?;
//! for _ in 0..100 {
//!     chain.step(&kernel, &family, &mut rng, &mut Ignore);
//!     again.step(&kernel, &family, &mut same, &mut Ignore);
//! }
//! assert_eq!(chain.value().to_bits(), again.value().to_bits());
//! # Ok::<(), serde_json::Error>(())
//! ```
//!
//! What is left out: the buffer of the next proposal, which each step writes anew, the memory
//! of resampling, and a proposal that is open, which a state never has (one that was forgotten
//! by `mem::forget` is rolled back in what is written).
//!
//! *Formats* must keep the bits of an `f64`. Binary ones do; `serde_json` does with its feature
//! `float_roundtrip`. Formats that are text are put to the test: four numbers stand beside each chain, and a reader that changes
//! them is refused. Errors that are not known are written as absent, so that JSON can hold them;
//! sums that have overflowed to infinity it cannot.
//!
//! *Files from strangers* give a value or an error. What later steps rely on is checked when
//! it is read: levels, lengths, pairs, times, positions in lists, counters, densities. A file can
//! still be wrong: that a value belongs to its coordinates is not known before it is
//! [evaluated again](crate::Metropolis::evaluate_again).
