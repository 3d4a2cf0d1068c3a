//! Pages to read.
//!
//! The [crate page](crate) has the running example and the nouns. From here:
//!
//! 1. [`algorithms`]: which one, where it comes from, what it assumes, and what is unbiased
//!    and what only consistent.
//! 2. [`graphics`]: for those who know the papers of light transport; their words and the
//!    numbers of their equations.
//! 3. [`statistics`]: for those who know Markov chains and no graphics.
//! 4. [`keeping`]: bits, threads, stopping and going on.
//!
//! How a kernel of one's own is proved right is the page of [`testing`](crate::testing).

pub mod algorithms;
pub mod graphics;
pub mod keeping;
pub mod statistics;
