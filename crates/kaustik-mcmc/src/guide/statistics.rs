//! For readers from statistics: what is the same, and what is not.
//!
//! The decision is Metropolis and Hastings', a [`Ladder`](crate::Ladder) is parallel tempering,
//! a [`Population`](crate::Population) a sequential Monte Carlo sampler. Unlike usual:
//!
//! * **The state is a point of a cube whose dimension is not known**, since the evaluation
//!   decides how many numbers it reads. Coordinates exist when they have been read. One that an
//!   evaluation does not read is uniform and independent of the others under the target, and
//!   owes the moves of the accepted steps that it slept through. They are made when it is next
//!   read: [`Point`](crate::Point). The law is that of a chain which moves all coordinates at
//!   every step.
//! * **The cube is a torus and the prior uniform.** Random walks wrap round. A model with
//!   another prior maps each coordinate through the prior's quantile function.
//! * **Densities are linear, not logarithms**, because zero is an ordinary density: the
//!   integrand vanishes on large parts of the cube. If you have logarithms, subtract a constant first.
//! * **An evaluation yields a value**, of which densities are cheap functions: all levels of a
//!   ladder, all weights of an annealing, and whatever is estimated are read off the one value.
//! * **What is estimated is an integral, not a posterior mean**: the normalising constant is
//!   wanted as much as the shape. See "Estimating" on the [crate page](crate#estimating).
//! * **Rejected proposals are not lost.** A step counts the proposal with its acceptance
//!   probability a and the current state with 1 - a, whatever is decided (Rao-Blackwell, in
//!   this form also "waste recycling"): [`Visit::weight`](crate::Visit::weight). A trace of
//!   the states themselves is read off [`Metropolis::value`](crate::Metropolis::value) after each
//!   step.
//! * **Chains from exact starts need no burn-in.** A start drawn from N independent samples by
//!   importance, together with the mean of their weights, makes every later sum unbiased
//!   ([`Pool`](crate::Pool)): the one-particle form of what particle MCMC does.
//!
//! | usual word | here |
//! |---|---|
//! | log density, model | [`Target`](crate::Target) and [`Family`](crate::Family) |
//! | transition kernel without its decision | [`Kernel`](crate::Kernel) |
//! | Hastings ratio q(y, x) / q(x, y) | [`Move::ratio`](crate::Move) |
//! | random walk, independence sampler | [`Step::Small`](crate::Step::Small), [`Step::Large`](crate::Step::Large) |
//! | deterministic even-odd exchange | [`Schedule::Alternating`](crate::Schedule::Alternating) |
//! | evidence, marginal likelihood | a normaliser: [`SteppingStone`](crate::SteppingStone), [`Stage::normaliser`](crate::Stage::normaliser) |
//! | local and global barrier, round trips, restarts | [`LadderStatistics`](crate::LadderStatistics) |
//! | integrated autocorrelation time, effective sample size, split R-hat | [`Autocorrelation`](crate::Autocorrelation), [`split_r_hat`](crate::split_r_hat) |
//! | detailed balance, stationarity, simulation-based checks | [`testing`](crate::testing): exact, by enumeration |
