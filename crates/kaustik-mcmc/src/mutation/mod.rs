//! How one coordinate takes a small step.

mod exponential;
mod per_coordinate;
mod power;
mod powers;
#[cfg(feature = "serde")]
mod serial;
mod uniform;
mod wrapped_cauchy;
mod wrapped_normal;

use kaustik_pss::Stream;

pub use exponential::Exponential;
pub use per_coordinate::PerCoordinate;
pub use power::Power;
pub use uniform::Uniform;
pub use wrapped_cauchy::WrappedCauchy;
pub use wrapped_normal::WrappedNormal;

use crate::Draws;

/// A random perturbation of one coordinate, symmetric on the circle [0, 1).
///
/// Contract: the chance to go from `x` to `y` equals that to go from `y` to `x`. Then the
/// mutation cancels in every acceptance probability, and the uniform law is invariant,
/// which is what allows coordinates to be created lazily (Kelemen et al. 2002, section 4).
///
/// # Which one
///
/// | mutation | steps | when |
/// |---|---|---|
/// | [`Exponential`] | between two sizes, uniform logarithm | the default: no single scale to tune |
/// | [`Uniform`] | up to a size, flat | one scale is known; the cheapest |
/// | [`WrappedNormal`] | around one size | smooth targets of known width; where a Gaussian random walk is wanted |
/// | [`WrappedCauchy`] | around one size, with leaps | narrow modes that are also far apart |
/// | [`Power`] | from almost nothing to everything | with [`DiminishingAdaptation`](crate::DiminishingAdaptation), whose size it has |
/// | [`PerCoordinate`] | each coordinate its own | coordinates of different meaning |
pub trait Mutation {
    /// A neighbour of `x`, both in [0, 1).
    fn mutate<D: Draws + ?Sized>(&self, x: f64, draws: &mut D) -> f64;

    /// A neighbour of `x`, which is the coordinate `index` of `stream`.
    ///
    /// A [`Point`](crate::Point) calls this, also when it replays what a coordinate slept
    /// through. The default forgets the address.
    #[inline(always)] // or objects (`dyn Draws`) pay a second call a coordinate: a third of its time
    fn mutate_at<D: Draws + ?Sized>(
        &self,
        stream: Stream,
        index: u32,
        x: f64,
        draws: &mut D,
    ) -> f64 {
        let _ = (stream, index);
        self.mutate(x, draws)
    }

    /// After how many repetitions a coordinate is uniform whatever it was: no wave round
    /// the circle is left with more than one part in 2^53 of its amplitude.
    ///
    /// A coordinate that slept through so many accepted steps is drawn anew instead of
    /// being replayed. The default, never, is always right.
    fn mixed_after(&self) -> u64 {
        u64::MAX
    }

    /// As [`mixed_after`](Self::mixed_after), for one coordinate.
    #[inline]
    fn mixed_after_at(&self, stream: Stream, index: u32) -> u64 {
        let _ = (stream, index);
        self.mixed_after()
    }
}

/// A mutation that can be made bolder or more timid as a whole: what adaptation needs.
pub trait Scalable: Mutation + Sized {
    /// The same kind of step, `factor` times as large (finite, positive), as far as the
    /// circle allows.
    #[must_use]
    fn scaled(&self, factor: f64) -> Self;
}

/// Below this a step would be lost in rounding.
const SMALLEST: f64 = 1.0 / (1u64 << 40) as f64;

/// ln(2^53).
const LN_2_POW_53: f64 = 53.0 * std::f64::consts::LN_2;

/// Splits a uniform number into a fair sign, by its first bit, and a uniform number.
///
/// A select, not a jump: no processor can guess a fair coin.
#[inline]
fn sign_and_rest(uniform: f64) -> (f64, f64) {
    let xi = 2.0 * uniform;
    if xi < 1.0 {
        (1.0, xi)
    } else {
        (-1.0, xi - 1.0)
    }
}

/// A size of steps, brought to the nearest between [`SMALLEST`] and `most`; what is no number is the smallest.
fn size_within(size: f64, most: f64) -> f64 {
    if size.is_nan() {
        SMALLEST
    } else {
        size.clamp(SMALLEST, most)
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
pub(crate) const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;
