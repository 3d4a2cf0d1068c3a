//! Which algorithm, and what it promises.
//!
//! Two words have their strict sense here. *Unbiased*: the expectation after any finite
//! number of steps is the integral. *Consistent*: the estimate converges to it as the run goes
//! on. What is unbiased may be averaged over many short runs; what is consistent may not.
//!
//! | you have | take |
//! |---|---|
//! | an integrand that independent samples find easily | no chain: [`Stratification`](crate::Stratification) and [`sample`](crate::sample) |
//! | one that is found, and has a few heavy samples | [`Redistributor`](crate::Redistributor) |
//! | one that is concentrated, in one region or several near ones | [`Metropolis`](crate::Metropolis) with large steps |
//! | large steps that are nearly always rejected | [`step_delayed`](crate::Metropolis::step_delayed) |
//! | regions apart, with easier densities in between | [`Ladder`](crate::Ladder) |
//! | a rare event, or no idea of where to start a ladder | [`anneal`](fn@crate::anneal) |
//! | several ways to propose, each good somewhere | [`Mixture`](crate::Mixture) |
//!
//! # A chain on the cube
//!
//! [`Metropolis`](crate::Metropolis), [`Point`](crate::Point),
//! [`PointKernel`](crate::PointKernel). Kelemen, Szirmay-Kalos, Antal and Csonka 2002; the
//! decision is that of Metropolis et al. 1953 and Hastings 1970.
//!
//! *Assumes* that the value is a function of the coordinates, that the density is positive
//! wherever what is wanted is not zero, and that some large steps are made (or another level
//! makes them): else the chain may not move everywhere.
//!
//! *Unbiased*: sums over visits scaled by the normaliser of the very
//! [`Pool`](crate::Pool) that the start was chosen from; means over the independent proposals
//! ([`Statistics::independent`](crate::Statistics::independent)).
//! *Consistent*: sums scaled by any better estimate of the normaliser; everything from a start
//! that was not chosen from a pool.
//!
//! # A second try
//!
//! [`Metropolis::step_delayed`](crate::Metropolis::step_delayed). Tierney and Mira 1999;
//! Green and Mira 2001; for light Rioux-Lavoie et al. 2020. *Assumes* that the first
//! proposal is independent and uniform. The step is reversible, its weights are unbiased and
//! sum to the number of steps in the mean alone. Up to two evaluations a step.
//!
//! # Replica exchange
//!
//! [`Ladder`](crate::Ladder), [`Schedule`](crate::Schedule),
//! [`SwapGraph`](crate::SwapGraph). Swendsen and Wang 1986; Geyer 1991; for light Kitaoka,
//! Kitamura and Kishino 2009 (RELT); schedules after Okabe et al. 2001 and Syed et al. 2021.
//!
//! *Assumes* levels that overlap, the easiest of which moves everywhere.
//! *Unbiased*: nothing by itself but visits from starts with the exact joint law; what is left
//! of the start-up vanishes with the length of the run. *Consistent*: the mean of each
//! level, the running normalisers ([`SteppingStone`](crate::SteppingStone), RELT eq. 10).
//! [`LadderStatistics`](crate::LadderStatistics) says whether levels are too far apart (a large
//! [barrier](crate::LadderStatistics::barrier)) or steps too timid (few
//! [round trips](crate::LadderStatistics::round_trip_rate) for the barrier).
//!
//! # Population annealing
//!
//! [`Population`](crate::Population), [`anneal`](fn@crate::anneal). Hukushima and Iba 2003; Del
//! Moral, Doucet and Jasra 2006; RELT sec. 4.3 and Algorithm 2. *Assumes* nested supports:
//! a density is zero wherever one before it is. *Unbiased*: each normaliser Z, and Z times
//! the mean over the particles, for every number of particles and of moves, if extinct runs
//! take part with Z = 0. *Consistent*: ratios of Z, means over particles alone.
//!
//! # Redistribution
//!
//! [`Redistribution`](crate::Redistribution), [`Redistributor`](crate::Redistributor). Cline,
//! Talbot and Egbert 2005; Batty's Algorithm 2. *Assumes* unbiased weights of the starts and a
//! kernel that keeps the density; it need not move everywhere. *Unbiased*: the sum of all
//! deposits, in every channel. The [filter](crate::Redistribution::patience) is *biased*, and off.
//!
//! # Mixtures
//!
//! [`Mixture`](crate::Mixture). Tierney 1994. Exact: each component keeps the target, chances
//! that depend on the state are part of the acceptance.
//!
//! # Step sizes
//!
//! [`AcceptanceAdaptation`](crate::AcceptanceAdaptation) (Robbins and Monro 1951; Roberts,
//! Gelman and Gilks 1997), [`JumpAdaptation`](crate::JumpAdaptation) (Pasarica and Gelman 2010),
//! [`DiminishingAdaptation`](crate::DiminishingAdaptation) (Hachisuka and Jensen 2011). A
//! chain that adapts is *consistent* (Roberts and Rosenthal 2007), never unbiased: freeze the
//! size after a burn-in if that matters. Rounds short beside the chain's memory bias visibly
//! (20 % on a toy in rounds of 16 steps).
//!
//! # How far to trust a run
//!
//! [`Autocorrelation`](crate::Autocorrelation) (blocking: Flyvbjerg and Petersen 1989) gives the
//! standard error of a mean with the chain's memory in it;
//! [`split_r_hat`](crate::split_r_hat) and [`rank_split_r_hat`](crate::rank_split_r_hat)
//! (Gelman and Rubin 1992; Vehtari et al. 2021) tell whether chains disagree. None of them sees
//! a mode that no chain has met.
