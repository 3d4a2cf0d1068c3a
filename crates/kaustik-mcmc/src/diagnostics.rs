//! What a chain's course says about its estimates. All in fixed memory, all mergeable:
//! merge chains in the order of their indices, for the same bits.

mod autocorrelation;
mod halves;
mod jumps;
mod r_hat;

pub use autocorrelation::Autocorrelation;
pub use halves::Halves;
pub use jumps::Jumps;
pub use r_hat::{r_hat, rank_split_r_hat, split_r_hat};
