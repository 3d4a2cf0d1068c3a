//! Step sizes that learn, between rounds.
//!
//! A chain whose step size depends on its own past is no Markov chain, and its stationary
//! law need not be the target. So sizes are frozen within a round: an adaptation is a value
//! beside the chain. At the end of a round it takes what the round has measured and
//! gives a *new mutation*, and [`Metropolis::set_mutation`](crate::Metropolis::set_mutation)
//! pays what sleeping coordinates owe to the old one and installs it. Nothing here can
//! change a mutation in place.
//!
//! # What bias is left
//!
//! Between rounds the size still depends on where the chain has just been. Adaptation from
//! a chain's own acceptance in rounds of 16 steps with a large gain was measured to bias a
//! toy by 20 %, whether settled or not; rounds of 1,000 with a gain of 2 / round, by nothing
//! that could be seen (within 1.3 standard errors). All
//! adaptations here *diminish*, which with a bounded set of sizes makes the chain converge
//! to its target (Roberts and Rosenthal 2007): estimates are consistent, not unbiased. To be
//! unbiased, adapt in a burn-in, throw that away, and start anew with the size frozen; or
//! let each chain use the sizes that *other* chains have learnt.
//!
//! # Which one
//!
//! | adaptation | drives | when |
//! |---|---|---|
//! | [`AcceptanceAdaptation`] | acceptance to a target | the default: acceptance is free and little noisy |
//! | [`JumpAdaptation`] | the largest mean squared jump | no right acceptance is known: dark regions, plateaus, heavy tails |
//! | [`DiminishingAdaptation`] | as Hachisuka and Jensen do | to reproduce them |

mod acceptance;
mod diminishing;
mod jump;

pub use acceptance::AcceptanceAdaptation;
pub use diminishing::DiminishingAdaptation;
pub use jump::JumpAdaptation;

#[cfg(test)]
mod tests;
