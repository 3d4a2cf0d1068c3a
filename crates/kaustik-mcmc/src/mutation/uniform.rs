use super::{LN_2_POW_53, size_within, wrap};
use crate::{Draws, Mutation, Scalable};

/// A step uniform over a given fraction of the domain, centred on where it was.
///
/// Fraction 1 is an independent uniform number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uniform {
    fraction: f64,
}

impl Uniform {
    /// Steps uniform over `fraction` of the domain: at most half of it either way.
    /// Fractions outside (0, 1] are moved to the nearest that makes sense.
    pub fn new(fraction: f64) -> Self {
        Self {
            fraction: size_within(fraction, 1.0),
        }
    }

    /// The fraction of the domain that a step can reach, in (0, 1].
    pub fn fraction(&self) -> f64 {
        self.fraction
    }

    /// The density of a step to circular distance `distance`, per unit of the circle.
    pub fn density(&self, distance: f64) -> f64 {
        if distance <= 0.5 * self.fraction {
            1.0 / self.fraction
        } else {
            0.0
        }
    }
}

impl Scalable for Uniform {
    fn scaled(&self, factor: f64) -> Self {
        Self::new(self.fraction * factor)
    }
}

impl Mutation for Uniform {
    #[inline]
    fn mutate<D: Draws + ?Sized>(&self, x: f64, draws: &mut D) -> f64 {
        wrap(x + self.fraction * (draws.uniform() - 0.5))
    }

    /// The wave of frequency k is dampened by sin(pi k f) / (pi k f); the slowest, k = 1,
    /// by at most 1 - f^2 for f <= 1; higher ones at least as fast as k = 1 does.
    fn mixed_after(&self) -> u64 {
        (LN_2_POW_53 / (self.fraction * self.fraction)).ceil() as u64
    }
}
