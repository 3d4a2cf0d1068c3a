//! Tails of the two laws that statistics are compared with, and a test that is hardly ever
//! wrong.

/// The chance of a chi-square statistic of so many degrees of freedom to be `x` or more.
///
/// `degrees` is positive; to about 1e-12 (incomplete gamma function, by its series or its
/// continued fraction).
pub fn chi_square_tail(x: f64, degrees: f64) -> f64 {
    let (a, x) = (degrees / 2.0, x / 2.0);
    if x.is_nan() || a.is_nan() || a <= 0.0 {
        return f64::NAN;
    }
    if x <= 0.0 {
        return 1.0;
    }
    if x.is_infinite() {
        return 0.0;
    }
    let front = libm::exp(a * libm::log(x) - x - libm::lgamma(a));
    let tail = if x < a + 1.0 {
        1.0 - front * lower_series(a, x)
    } else {
        front * upper_fraction(a, x)
    };
    tail.clamp(0.0, 1.0)
}

/// gamma(a, x) / (x^a e^-x), by its series: for x < a + 1.
fn lower_series(a: f64, x: f64) -> f64 {
    let (mut term, mut sum) = (1.0 / a, 1.0 / a);
    for n in 1..10_000 {
        term *= x / (a + f64::from(n));
        sum += term;
        if term < sum * 1e-16 {
            break;
        }
    }
    sum
}

/// Gamma(a, x) / (x^a e^-x), by Legendre's continued fraction, evaluated forwards (Lentz).
fn upper_fraction(a: f64, x: f64) -> f64 {
    const TINY: f64 = 1e-300;
    let mut b = x + 1.0 - a;
    let mut c = 1.0 / TINY;
    let mut d = 1.0 / b;
    let mut fraction = d;
    for n in 1..10_000 {
        let n = f64::from(n);
        let numerator = -n * (n - a);
        b += 2.0;
        d = 1.0 / nonzero(numerator * d + b, TINY);
        c = nonzero(b + numerator / c, TINY);
        fraction *= c * d;
        if (c * d - 1.0).abs() < 1e-16 {
            break;
        }
    }
    fraction
}

fn nonzero(x: f64, tiny: f64) -> f64 {
    if x.abs() < tiny { tiny } else { x }
}

/// The chance of a standard normal number to be `z` or more away from zero, either way.
pub fn normal_tails(z: f64) -> f64 {
    libm::erfc(z.abs() * std::f64::consts::FRAC_1_SQRT_2)
}

/// A test that may be repeated on more samples until it is sure: cheap if all is well,
/// strong if not (Gandy and Scott 2020, section 3).
///
/// One fixed p-value is either too lax or fails on a correct program now and then. Here a
/// stage that is clearly fine ends the test, one that is clearly not fails it, and what
/// lies between is tried again on new and more samples. All stages together fail a correct
/// program with a probability of at most [`false_alarm`](Self::false_alarm).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sequential {
    /// Chance to fail although nothing is wrong, in (0, 1).
    pub false_alarm: f64,
    /// How often to try at most, at least 1.
    pub stages: u32,
    /// By what factor the second and later tries are larger, at least 1.
    pub growth: u64,
}

impl Default for Sequential {
    /// One false alarm in 100,000; seven tries, from the second on four times as large.
    fn default() -> Self {
        Self {
            false_alarm: 1e-5,
            stages: 7,
            growth: 4,
        }
    }
}

impl Sequential {
    /// Runs `p_value(stage, factor)`: the p-value of new samples, independent of those of
    /// other stages, `factor` times as many as in the first. An error is the stage that
    /// failed, counted from 0, and its p-value.
    ///
    /// # Errors
    ///
    /// If the hypothesis is refuted. A p-value that is NaN refutes.
    pub fn run(&self, mut p_value: impl FnMut(u32, u64) -> f64) -> Result<(), (u32, f64)> {
        let stages = self.stages.max(1);
        let mut reject = self.false_alarm / f64::from(stages);
        let undecided = libm::pow(reject, 1.0 / f64::from(stages));
        for stage in 0..stages {
            let p = p_value(stage, if stage == 0 { 1 } else { self.growth.max(1) });
            if p.is_nan() || p <= reject {
                return Err((stage, p));
            }
            if p > undecided + reject {
                return Ok(());
            }
            reject /= undecided;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Draws, generator};

    /// With 2 degrees the tail is exp(-x/2); with 1, that of a squared normal number; and
    /// two more degrees add (x/2)^(d/2) e^(-x/2) / Gamma(d/2 + 1).
    #[test]
    fn tails_agree_with_closed_forms() {
        for x in [1e-6, 0.3, 1.0, 3.0, 7.0, 30.0, 200.0f64] {
            let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * a.max(1e-3);
            assert!(near(chi_square_tail(x, 2.0), (-x / 2.0).exp()), "{x}");
            assert!(near(chi_square_tail(x, 1.0), normal_tails(x.sqrt())), "{x}");
            for d in [1.0, 4.0, 9.0, 60.0] {
                let more = (d / 2.0 * (x / 2.0).ln() - x / 2.0 - libm::lgamma(d / 2.0 + 1.0)).exp();
                let (less, all) = (chi_square_tail(x, d), chi_square_tail(x, d + 2.0));
                assert!(near(all, less + more), "{x} {d}: {all} {less} {more}");
            }
        }
        assert!((normal_tails(1.959_963_984_540_054) - 0.05).abs() < 1e-12);
        assert!(chi_square_tail(f64::NAN, 1.0).is_nan() && chi_square_tail(1.0, 0.0).is_nan());
        let ends = [
            chi_square_tail(-1.0, 3.0),
            chi_square_tail(f64::INFINITY, 3.0),
        ];
        assert_eq!(ends.map(|p| p as u8), [1, 0]);
    }

    #[test]
    fn a_sequence_fails_as_rarely_as_it_says() {
        let lax = Sequential {
            false_alarm: 0.1,
            ..Sequential::default()
        };
        let mut rng = generator(1, 0);
        let (mut failures, mut tries) = (0, 0);
        for _ in 0..20_000 {
            let run = lax.run(|_, _| {
                tries += 1;
                rng.uniform()
            });
            failures += i32::from(run.is_err());
        }
        assert!((1200..2100).contains(&failures), "{failures} of 20,000");
        assert!(tries > 25_000, "some are tried again");
        assert_eq!(lax.run(|_, _| 1e-9), Err((0, 1e-9)));
        assert!(lax.run(|_, _| f64::NAN).is_err());
        assert!(
            Sequential::default()
                .run(|stage, _| [0.1, 0.9][stage as usize])
                .is_ok()
        );
    }
}
