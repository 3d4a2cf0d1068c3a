//! Markov-chain kernels on light paths (Veach and Guibas 1997; Cline et al. 2005).
//!
//! The state of a chain is a [`Path`]: its vertices with all that evaluating it again takes. A
//! kernel ([`kaustik_mcmc::Kernel`]) writes a changed path over an older one, traces only what
//! changed, and returns T(y -> x) / T(x -> y); whether it is accepted is the chain's matter.
//!
//! # Measure
//! `f` and all densities are per area of the vertices (per solid angle where an emitter lies
//! infinitely far away, per area of the lens), spec: bdpt-and-mis.md 1. Between two vertices that
//! do not scatter into Dirac directions stands `G`. A run of Dirac scatterings between `b`
//! (nearer the eye) and `a` (nearer the light) stands instead with the Jacobian
//! `cos_b d(omega_b)/dA_a`, which is a factor of `f` and of the density of every way to make the
//! run; it cancels wherever paths are compared, because runs are kept or made as a whole, and is set to 1. So
//! in this crate
//!
//! | step | density |
//! |---|---|
//! | to `a` from `b`, against the light | `p_w(b) P.. / cos_b` |
//! | to `b` from `a`, with the light | `p_w(a) P.. / cos_a` times `s / S` of each vertex passed |
//!
//! where `P` are the probabilities of the lobes, `s` is the squared ratio of the indices that radiance
//! is multiplied by (8.1) and `S` the factor of shading normals for particles (8.2).

mod bidirectional;
mod caustic;
mod density;
mod evaluate;
mod every;
mod factor;
mod jitter;
mod join;
mod lens;
mod lens_subpath;
mod path;
mod seed;
mod space;
mod vertex;
mod walk;
mod wavelength;

pub use bidirectional::BidirectionalMutation;
pub use caustic::CausticPerturbation;
pub use every::EveryPerturbation;
pub use jitter::Radii;
pub use lens::{LensPerturbation, Run};
pub use lens_subpath::LensMutation;
pub use path::Path;
pub use seed::Seeds;
pub use space::PathSpace;
pub use wavelength::WavelengthMutation;

#[cfg(test)]
mod tests;
