//! Laws and check values of the crate's public interface.

#![expect(clippy::float_cmp, reason = "exact where equality is the law")]

mod colour;
mod materials;
mod sampler;
mod uplift;
