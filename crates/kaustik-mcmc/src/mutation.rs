//! How one coordinate takes a small step.

use crate::Draws;

/// A random perturbation of one coordinate, symmetric on the circle [0, 1).
///
/// Contract: the chance to go from `x` to `y` equals that to go from `y` to `x`. Then the
/// mutation cancels in every acceptance probability, and the uniform law is invariant,
/// which is what allows coordinates to be created lazily (Kelemen et al. 2002, section 4).
pub trait Mutation {
    /// A neighbour of `x`, both in [0, 1).
    fn mutate<D: Draws + ?Sized>(&self, x: f64, draws: &mut D) -> f64;

    /// After how many repetitions a coordinate is uniform whatever it was, to within one
    /// part in 2^53.
    ///
    /// A coordinate that slept through so many accepted steps is drawn anew instead of
    /// being replayed. The default, never, is always right.
    fn mixed_after(&self) -> u64 {
        u64::MAX
    }
}

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
    /// Sizes make sense for 0 < s1 <= s2 <= 1/2; others are moved to the nearest that do,
    /// so that a size that is being adapted cannot leave the circle.
    pub fn new(s1: f64, s2: f64) -> Self {
        let s2 = s2.clamp(SMALLEST, 0.5);
        let s1 = s1.clamp(SMALLEST, s2);
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
}

/// Below this a step would be lost in rounding.
const SMALLEST: f64 = 1.0 / (1u64 << 40) as f64;

impl Default for Exponential {
    /// Kelemen's sizes, 1/1024 to 1/64.
    fn default() -> Self {
        Self::new(1.0 / 1024.0, 1.0 / 64.0)
    }
}

impl Mutation for Exponential {
    #[inline]
    fn mutate<D: Draws + ?Sized>(&self, x: f64, draws: &mut D) -> f64 {
        let xi = 2.0 * draws.uniform();
        // A select, not a jump: no processor can guess a fair coin.
        let (sign, xi) = if xi < 1.0 {
            (1.0, xi)
        } else {
            (-1.0, xi - 1.0)
        };
        let step = self.s2 * exp2_below_zero(self.octaves * xi);
        wrap(x + sign * step.clamp(self.s1, self.s2))
    }

    /// A repeated step dampens the wave of frequency k round the circle by
    /// E cos(2 pi k d). With s2/s1 >= 2 the slowest is k = 1 with
    /// 1 - E cos(2 pi d) >= 8 E d^2 for d <= 1/2, unless steps are so large that a
    /// negative factor rules: none is beyond exp(-0.2). (For nearly equal sizes a high
    /// frequency may beat with the step; these are always replayed.)
    fn mixed_after(&self) -> u64 {
        if self.s1 * 2.0 > self.s2 {
            return u64::MAX;
        }
        let mean_square = (self.s1 * self.s1 - self.s2 * self.s2) / (2.0 * self.log_ratio);
        (LN_2_POW_53 / (8.0 * mean_square).min(0.2)).ceil() as u64
    }
}

/// 2^y for -1000 < y <= 0, to 5e-9: the law of a step needs no more, and its symmetry none at
/// all, while the library's function took most of a coordinate's time.
#[inline]
fn exp2_below_zero(y: f64) -> f64 {
    let cut = y as i64; // toward zero, that is up
    let whole = (cut - i64::from(cut as f64 > y)) as f64;
    // exp(z) with |z| <= ln(2)/2 by its series, about the middle of the octave.
    let z = (y - whole - 0.5) * std::f64::consts::LN_2;
    let series = 1.0
        + z * (1.0
            + z * (1.0 / 2.0
                + z * (1.0 / 6.0
                    + z * (1.0 / 24.0
                        + z * (1.0 / 120.0 + z * (1.0 / 720.0 + z * (1.0 / 5040.0)))))));
    let power = f64::from_bits(((1023 + whole as i64) as u64) << 52);
    power * (series * std::f64::consts::SQRT_2)
}

/// ln(2^53).
const LN_2_POW_53: f64 = 53.0 * std::f64::consts::LN_2;

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
            fraction: fraction.clamp(SMALLEST, 1.0),
        }
    }

    /// The fraction of the domain that a step can reach, in (0, 1].
    pub fn fraction(&self) -> f64 {
        self.fraction
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

/// Brings a number of (-1, 2) back to the circle [0, 1).
#[inline]
pub(crate) fn wrap(x: f64) -> f64 {
    // K sec. 6 tests `> 1`, which would let 1 itself through
    let x = if x >= 1.0 {
        x - 1.0
    } else if x < 0.0 {
        x + 1.0
    } else {
        x
    };
    x.min(BELOW_ONE) // a tiny negative number plus 1 rounds to 1
}

/// The largest double below 1.
const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;
