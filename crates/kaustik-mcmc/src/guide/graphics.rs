//! For readers from graphics: the papers' words and the numbers of their equations.
//!
//! This crate knows no light. A *value* is what one path contributes (pixels and colours), a
//! *density* its luminance or what else guides the chain, a *recorder* a film.
//!
//! # Kelemen et al. 2002: primary sample space
//!
//! | there | here |
//! |---|---|
//! | primary sample, `PrimarySample(i)` (sec. 6) | a coordinate: `get` of [`Coordinates`](kaustik_pss::Coordinates) on a [`Proposal`](crate::Proposal) |
//! | camera and light numbers apart (sec. 2, end) | [`Stream`](kaustik_pss::Stream) |
//! | the point u, its time stamps (sec. 4, 6) | [`Point`](crate::Point) |
//! | `Mutate`, s1 and s2 (sec. 6) | [`Exponential`](crate::Exponential) |
//! | large step, `largestepprob` (sec. 3) | [`Step::Large`](crate::Step::Large), [`PointKernel::p_large`](crate::PointKernel::p_large) |
//! | `Accept`, `Reject`, the stack | [`Proposal::decide`](crate::Proposal::decide); dropped is rejected |
//! | I*, scalar contribution | a [`Family`](crate::Family) of one level |
//! | a(u, v) | [`acceptance`](crate::acceptance) |
//! | both states weighted, 1 - a and a (sec. 1.2) | [`Visit::weight`](crate::Visit::weight) |
//! | weights of eqs. (1) and (2), `Next` | the split form under "Estimating" on the [crate page](crate#estimating) |
//! | b and the seeds (sec. 1.2) | [`Pool`](crate::Pool) |
//!
//! # Kitaoka, Kitamura and Kishino 2009: replica exchange light transport
//!
//! | there | here |
//! |---|---|
//! | replica k, its target q_k | level k of a [`Ladder`](crate::Ladder); `densities[k]` |
//! | exchange, r of eqs. (8) and (9) | [`exchange_acceptance`](crate::exchange_acceptance) (a minimum; the text of sec. 4.1 prints a maximum) |
//! | `RecodeSample`, Algorithm 1 | [`Recorder`](crate::Recorder); [`Ladder::sweep`](crate::Ladder::sweep) |
//! | one random pair a sweep (Algorithm 1) | [`Schedule::RandomPair`](crate::Schedule::RandomPair); the default tries all |
//! | partially ordered sets (sec. 6) | [`SwapGraph`](crate::SwapGraph), [`SteppingStone::on`](crate::SteppingStone::on) |
//! | b_k by eq. (10) | [`SteppingStone`](crate::SteppingStone), [`RunningNormalisers`](crate::RunningNormalisers) |
//! | annealing, Algorithm 2, c_i of eq. (20) | [`Population`](crate::Population), [`anneal`](fn@crate::anneal), [`Stage::ratio`](crate::Stage::ratio) |
//! | the rough b inside the power heuristic | [`RoughNormalisers`](crate::RoughNormalisers) |
//! | a step size for each replica, eq. (24) | a [`Mutation`](crate::Mutation) for each level; [`LevelKernel`](crate::LevelKernel) in annealing |
//! | not in the paper: a sleeping coordinate owes steps to its level | [`Point::settle`](crate::Point::settle), [`Kernel::exchange`](crate::Kernel::exchange) |
//!
//! # Cline, Talbot and Egbert 2005; Batty: energy redistribution
//!
//! | there | here |
//! |---|---|
//! | Monte Carlo sample of energy e | a start of weight e: [`Redistributor::run`](crate::Redistributor::run) |
//! | deposition energy e_d, Batty's Algorithm 1 | [`Redistribution::unit`](crate::Redistribution::unit), [`pilot`](crate::Redistribution::pilot) |
//! | `numChains`, Batty's Algorithm 2 | the number that `run` returns |
//! | EqualDepositionFlow, Batty's Algorithm 2 | [`Redistribution`](crate::Redistribution) of so many steps; `plain` as printed, expected values by default |
//! | `depVal`, in the colour of the first path | [`Deposit`](crate::Deposit), in the colour of the path that it falls on |
//! | consecutive sample filtering (Batty sec. 4.2) | [`Redistribution::patience`](crate::Redistribution::patience) |
//! | proposed mutations filter (Batty sec. 6) | [`Deposit::is_proposal`](crate::Deposit::is_proposal), counted by the listener |
//!
//! # Others
//!
//! | there | here |
//! |---|---|
//! | Veach and Guibas 1997: mutation of paths, T(x to y) | a [`Kernel`](crate::Kernel) on any state, [`Move::ratio`](crate::Move) |
//! | Hachisuka and Jensen 2011: adaptive mutation size | [`Power`](crate::Power), [`DiminishingAdaptation`](crate::DiminishingAdaptation) |
//! | Rioux-Lavoie et al. 2020: delayed rejection | [`Metropolis::step_delayed`](crate::Metropolis::step_delayed) |
