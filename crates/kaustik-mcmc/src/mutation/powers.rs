//! Powers of numbers below one, to a few parts in 10^9: the law of a step needs no more, and its symmetry none at all,
//! while the library's functions took most of a coordinate's time.

use std::f64::consts::{LN_2, LOG2_E, SQRT_2};

/// 2^y for -1000 < y <= 0, to 5e-9.
#[inline]
pub(super) fn exp2_below_zero(y: f64) -> f64 {
    /// Added to a small number it leaves the nearest whole number in the last bits: no conversion that
    /// would have to look for numbers out of range.
    const ROUND: f64 = 1.5 * (1u64 << 52) as f64;
    let rounded = y + ROUND;
    let whole = rounded - ROUND;
    let power = f64::from_bits((rounded.to_bits() << 52).wrapping_add(1.0_f64.to_bits()));
    // exp(z) with |z| <= ln(2)/2 by its series, in pairs that need not wait for each other.
    let z = (y - whole) * LN_2;
    let (z2, low, middle) = (z * z, 1.0 + z, 1.0 / 2.0 + z * (1.0 / 6.0));
    let high = (1.0 / 24.0 + z * (1.0 / 120.0)) + z2 * (1.0 / 720.0 + z * (1.0 / 5040.0));
    power * ((low + z2 * middle) + z2 * z2 * high)
}

/// log2 x for a normal 0 < x <= 1, to 1e-9.
#[inline]
fn log2_below_one(x: f64) -> f64 {
    // x = 2^whole m with sqrt(1/2) <= m < sqrt(2): the mantissa's upper half goes with the next power.
    let bits = x.to_bits();
    let mantissa = f64::from_bits((bits & ((1 << 52) - 1)) | 1.0_f64.to_bits());
    let upper = mantissa >= SQRT_2;
    let m = if upper { 0.5 * mantissa } else { mantissa };
    let whole = (bits >> 52) as i32 - 1023 + i32::from(upper);
    // ln m = 2 artanh((m - 1) / (m + 1)), by its series.
    let s = (m - 1.0) / (m + 1.0);
    let (s2, s4) = (s * s, s * s * s * s);
    let series = (1.0 + s2 * (1.0 / 3.0)) + s4 * ((0.2 + s2 * (1.0 / 7.0)) + s4 * (1.0 / 9.0));
    f64::from(whole) + 2.0 * LOG2_E * s * series
}

/// x^exponent for 0 <= x <= 1 and an exponent of at least 1, with a relative error of 5e-9 times the exponent;
/// next to nothing where it would be below 2^-1000.
#[inline]
pub(super) fn power_below_one(x: f64, exponent: f64) -> f64 {
    let x = x.max(f64::MIN_POSITIVE);
    exp2_below_zero((exponent * log2_below_one(x)).max(-999.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_those_of_the_library() {
        for n in 1..=100_000 {
            let x = f64::from(n) / 100_000.0;
            for exponent in [1.0, 1.01, 2.0, 7.5, 50.0] {
                let (found, expected) = (power_below_one(x, exponent), libm::pow(x, exponent));
                let error = (found / expected - 1.0).abs();
                assert!(error < 1e-8 * exponent, "{x}^{exponent}: {error:e}");
            }
        }
    }

    #[test]
    fn powers_of_zero_and_one_are_right() {
        for exponent in [1.0, 3.0, 10_001.0] {
            assert!((power_below_one(1.0, exponent) - 1.0).abs() < 1e-9);
            let least = power_below_one(0.0, exponent);
            assert!((0.0..1e-290).contains(&least), "{least:e}");
            let small = power_below_one(1.0 / (1u64 << 53) as f64, exponent);
            assert!((0.0..2e-16).contains(&small), "{small:e}");
        }
    }
}
