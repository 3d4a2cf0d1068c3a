//! The unit of a film's fixed-point sums.
//!
//! A power of two, so that scaling by it is exact and a state file can keep one small integer. It is
//! chosen from the mean of a pilot run: 2^-32 of the mean leaves 29 bits above it for a single splat and
//! 30 for a sum (a pixel may receive 2^30 splats of the mean), and rounds a splat as small as a
//! thousandth of the mean with a relative error below 2^-22, which averages out over many splats.

use serde::{Deserialize, Serialize};

/// The value of one step of a film's integer sums: 2^exponent, in the units of what is splatted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(from = "i32", into = "i32")]
pub struct Quantum {
    exponent: i32,
}

impl Quantum {
    /// What stands in when a pilot saw nothing: 2^-32, the quantum of a mean of one.
    pub const FALLBACK: Quantum = Quantum { exponent: -32 };

    /// Exponents outside of this range are clamped, so that the quantum, its inverse and 2^62 quanta are
    /// all normal `f64` values.
    const RANGE: (i32, i32) = (-1000, 900);

    /// As [`from_mean`](Self::from_mean), for pixels whose X + Y + Z is `sum` in the mean.
    #[must_use]
    pub fn from_sum_of_xyz(sum: f64) -> Self {
        Self::from_mean(sum / 3.0)
    }

    /// The power of two nearest (in ratio) to `mean` x 2^-32. [`Quantum::FALLBACK`] if the mean is zero,
    /// negative or not finite, because then the pilot has nothing to say.
    #[must_use]
    pub fn from_mean(mean: f64) -> Self {
        if !mean.is_finite() || mean <= 0.0 {
            return Self::FALLBACK;
        }
        let (mantissa, exponent) = libm::frexp(mean); // mean = mantissa * 2^exponent, mantissa in [0.5, 1)
        let nearest = if mantissa >= std::f64::consts::FRAC_1_SQRT_2 {
            exponent
        } else {
            exponent - 1
        };
        Self::from_exponent(nearest - 32)
    }

    /// The unit for contributions `factor` times as large, which is positive: by the power of two nearest to it.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        let exponent = Self::from_mean(factor).exponent() - Self::from_mean(1.0).exponent();
        Self::from_exponent(self.exponent + exponent)
    }

    /// 2^exponent; the exponent is clamped to -1000..=900.
    #[must_use]
    pub fn from_exponent(exponent: i32) -> Self {
        Self {
            exponent: exponent.clamp(Self::RANGE.0, Self::RANGE.1),
        }
    }

    /// The exponent of two.
    #[must_use]
    pub fn exponent(self) -> i32 {
        self.exponent
    }

    /// The quantum itself, > 0.
    #[must_use]
    pub fn value(self) -> f64 {
        libm::ldexp(1.0, self.exponent)
    }

    /// 1 / [`Quantum::value`], exactly.
    #[must_use]
    pub fn inverse(self) -> f64 {
        libm::ldexp(1.0, -self.exponent)
    }
}

impl From<i32> for Quantum {
    fn from(exponent: i32) -> Self {
        Self::from_exponent(exponent)
    }
}

impl From<Quantum> for i32 {
    fn from(quantum: Quantum) -> Self {
        quantum.exponent
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_power_of_two() {
        assert_eq!(Quantum::from_mean(1.0).exponent(), -32);
        assert_eq!(Quantum::from_mean(1.41).exponent(), -32);
        assert_eq!(Quantum::from_mean(1.42).exponent(), -31);
        assert_eq!(Quantum::from_mean(0.72).exponent(), -32);
        assert_eq!(Quantum::from_mean(0.70).exponent(), -33);
        assert_eq!(Quantum::from_mean(1024.0).exponent(), -22);
    }

    #[test]
    fn what_is_a_thousandth_has_a_unit_of_a_thousandth() {
        let unit = Quantum::from_mean(3.0);
        assert_eq!(unit.scaled(1.0), unit);
        assert_eq!(unit.scaled(1e-3).exponent(), unit.exponent() - 10);
        assert!(unit.scaled(1e-300).exponent() < -900);
    }

    #[test]
    fn a_pilot_that_saw_nothing_falls_back() {
        for mean in [0.0, -0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(Quantum::from_mean(mean), Quantum::FALLBACK);
        }
    }

    #[test]
    fn extremes_stay_normal() {
        for mean in [f64::MIN_POSITIVE, 5e-324, 1e-300, 1e300, f64::MAX] {
            let quantum = Quantum::from_mean(mean);
            assert!(quantum.value().is_normal() && quantum.inverse().is_normal());
            assert!((quantum.value() * 2f64.powi(62)).is_normal());
            assert_eq!(
                (quantum.value() * quantum.inverse()).to_bits(),
                1f64.to_bits()
            );
        }
    }
}
