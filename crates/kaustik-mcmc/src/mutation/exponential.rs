use super::powers::exp2_below_zero;
use super::{LN_2_POW_53, sign_and_rest, size_within, wrap};
use crate::{Draws, Mutation, Scalable};

/// Kelemen's mutation (section 6): a step of size between `s1` and `s2`, either way,
/// with uniform logarithm.
///
/// Sizes are fractions of the domain. Small steps are as likely as large ones in every
/// octave, so that no scale has to be tuned; steps below `s1` would move nothing visible.
/// With circular distance d, the density of the step is 1 / (2 d ln(s2/s1)) on (s1, s2].
/// One uniform number decides the sign (its first bit) and the size (the rest).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exponential {
    s1: f64,
    s2: f64,
    /// ln(s1 / s2), at most 0.
    log_ratio: f64,
    /// log2(s1 / s2), at most 0.
    octaves: f64,
}

impl Exponential {
    /// Steps between `s1` and `s2`.
    ///
    /// Sizes make sense for 0 < s1 <= s2 <= 1/2; others are moved to the nearest that do (NaN to the smallest),
    /// so that a size that is being adapted cannot leave the circle. If `s2` is the smaller one they change places.
    ///
    /// With equal sizes a coordinate walks on a lattice, and never forgets on which.
    pub fn new(s1: f64, s2: f64) -> Self {
        let (s1, s2) = if s1 > s2 { (s2, s1) } else { (s1, s2) };
        let s2 = size_within(s2, 0.5);
        let s1 = size_within(s1, s2);
        Self {
            s1,
            s2,
            log_ratio: libm::log(s1 / s2),
            octaves: libm::log2(s1 / s2),
        }
    }

    /// The smallest and the largest step, as fractions of the domain.
    pub fn sizes(&self) -> (f64, f64) {
        (self.s1, self.s2)
    }

    /// The mean step, (s2 - s1) / ln(s2/s1).
    pub fn mean_size(&self) -> f64 {
        if self.log_ratio < 0.0 {
            (self.s1 - self.s2) / self.log_ratio
        } else {
            self.s2
        }
    }

    /// The density of a step to circular distance `distance`, per unit of the circle: both
    /// ways together, twice this. Not defined for equal sizes.
    pub fn density(&self, distance: f64) -> f64 {
        if self.s1 < distance && distance <= self.s2 {
            -0.5 / (distance * self.log_ratio) // 1 / (2 d ln(s2 / s1))
        } else {
            0.0
        }
    }
}

impl Scalable for Exponential {
    /// Both sizes, in their proportion.
    fn scaled(&self, factor: f64) -> Self {
        let s2 = size_within(self.s2 * factor, 0.5);
        Self::new(self.s1 * (s2 / self.s2), s2)
    }
}

impl Default for Exponential {
    /// Kelemen's sizes, 1/1024 to 1/64.
    fn default() -> Self {
        Self::new(1.0 / 1024.0, 1.0 / 64.0)
    }
}

impl Mutation for Exponential {
    #[inline(always)] // a call for each coordinate is felt
    fn mutate<D: Draws + ?Sized>(&self, x: f64, draws: &mut D) -> f64 {
        let (sign, xi) = sign_and_rest(draws.uniform());
        let step = self.s2 * exp2_below_zero(self.octaves * xi);
        wrap(x + sign * step.clamp(self.s1, self.s2))
    }

    /// A repeated step dampens the wave of frequency k round the circle by
    /// E cos(2 pi k d). With s2/s1 >= 2 the slowest is k = 1 with
    /// 1 - E cos(2 pi d) >= 8 E d^2 for d <= 1/2, unless steps are so large that a
    /// negative factor rules: none is beyond exp(-0.196), so that the 184 steps of 0.2 leave 2^-52 of it. (For nearly equal sizes a high
    /// frequency may beat with the step; these are always replayed.)
    fn mixed_after(&self) -> u64 {
        if self.s1 * 2.0 > self.s2 {
            return u64::MAX;
        }
        let mean_square = (self.s1 * self.s1 - self.s2 * self.s2) / (2.0 * self.log_ratio);
        (LN_2_POW_53 / (8.0 * mean_square).min(0.2)).ceil() as u64
    }
}
