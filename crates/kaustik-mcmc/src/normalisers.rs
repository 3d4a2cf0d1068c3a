//! Normalising constants, by what may be done with them.
//!
//! Weights of combined estimators hold constants b^_k; films are scaled by b_k / b^_k (RELT
//! eqs. 22 and 23). The first must be *fixed* before the run, any positive numbers will
//! do; the second may be refined while it runs. A running estimate inside a weight biases the
//! picture, so the two are different types.

use std::array::from_fn;
use std::fmt;

use crate::Mean;

/// A number with its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Estimate {
    /// The estimate.
    pub value: f64,
    /// Its standard error: infinite where it is not known.
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::known"))]
    pub standard_error: f64,
}

impl Estimate {
    /// A number known exactly.
    pub const fn exact(value: f64) -> Self {
        Self {
            value,
            standard_error: 0.0,
        }
    }

    /// The standard error over the value; infinite for a value of zero.
    pub fn relative_error(&self) -> f64 {
        if self.value > 0.0 {
            self.standard_error / self.value
        } else {
            f64::INFINITY
        }
    }
}

impl From<Mean> for Estimate {
    fn from(mean: Mean) -> Self {
        Self::from(&mean)
    }
}

impl From<&Mean> for Estimate {
    fn from(mean: &Mean) -> Self {
        Self {
            value: mean.mean(),
            standard_error: mean.standard_error(),
        }
    }
}

/// Value and standard error, both with as many decimals as asked for: `{:.3}` gives `0.463 +- 0.001`. An error that is not
/// known is infinite.
impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.value, f)?;
        f.write_str(" +- ")?;
        fmt::Display::fmt(&self.standard_error, f)
    }
}

/// Rough normalising constants of K densities, from an initial phase: fixed for the whole
/// run, and the only ones that may stand inside weights.
///
/// The type is the rule:
///
/// ```compile_fail
/// # use kaustik_mcmc::{RoughNormalisers, SteppingStone};
/// fn weights(fixed: &RoughNormalisers<2>) {}
/// let running = SteppingStone::<2>::line().normalisers(1.0);
/// weights(&running); // no: these change during the run
/// ```
///
/// The same with what is fixed:
///
/// ```
/// # use kaustik_mcmc::RoughNormalisers;
/// fn weights(fixed: &RoughNormalisers<2>) {}
/// weights(&RoughNormalisers::guess([1.0, 0.5]));
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RoughNormalisers<const K: usize> {
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::array"))]
    estimates: [Estimate; K],
    /// How much went into them, for merging.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::sound"))]
    particles: f64,
}

impl<const K: usize> RoughNormalisers<K> {
    /// Of a population annealing with so many particles.
    pub(crate) fn annealed(estimates: [Estimate; K], particles: usize) -> Self {
        Self {
            estimates,
            particles: particles as f64,
        }
    }

    /// From elsewhere: any positive numbers keep an estimator unbiased, good ones make it
    /// efficient. Zero is a level that is not used. Their errors are not known.
    ///
    /// # Panics
    ///
    /// If a number is negative, infinite or NaN.
    pub fn guess(values: [f64; K]) -> Self {
        assert!(
            values.iter().all(|b| b.is_finite() && *b >= 0.0),
            "no normalisers: {values:?}"
        );
        let standard_error = f64::INFINITY;
        Self {
            estimates: values.map(|value| Estimate {
                value,
                standard_error,
            }),
            particles: 1.0,
        }
    }

    /// The constants with their errors, by level.
    pub fn estimates(&self) -> &[Estimate; K] {
        &self.estimates
    }

    /// The constants, by level.
    pub fn values(&self) -> [f64; K] {
        self.estimates.map(|e| e.value)
    }

    /// Averages with those of another, independent annealing of the same family, by numbers
    /// of particles. The average is unbiased if extinct ones take part with their zeros;
    /// leaving these out made it 26 % too large at one extinction in five (measured).
    pub fn merge(&mut self, other: &Self) {
        let total = self.particles + other.particles;
        if total <= 0.0 {
            return; // neither tells anything
        }
        let (p, q) = (self.particles / total, other.particles / total);
        for (mine, theirs) in self.estimates.iter_mut().zip(&other.estimates) {
            mine.value = p * mine.value + q * theirs.value;
            mine.standard_error = libm::hypot(p * mine.standard_error, q * theirs.standard_error);
        }
        self.particles = total;
    }
}

/// Normalising constants as a run knows them so far: consistent, not unbiased, better with
/// every sweep. For scaling what has been gathered, never for weights.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RunningNormalisers<const K: usize> {
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::array"))]
    pub(crate) estimates: [Estimate; K],
}

impl<const K: usize> RunningNormalisers<K> {
    /// The constants with their errors, by level.
    pub fn estimates(&self) -> &[Estimate; K] {
        &self.estimates
    }

    /// The constants, by level.
    pub fn values(&self) -> [f64; K] {
        self.estimates.map(|e| e.value)
    }

    /// The scales b_k / b^_k of RELT eq. 23; 0 for a level whose rough constant is 0,
    /// which is not used.
    pub fn over(&self, rough: &RoughNormalisers<K>) -> [f64; K] {
        let (running, rough) = (self.values(), rough.values());
        from_fn(|k| {
            if rough[k] > 0.0 {
                running[k] / rough[k]
            } else {
                0.0
            }
        })
    }

    /// How many standard errors these lie above the unbiased estimates from independent
    /// proposals ([`Statistics::independent`](crate::Statistics::independent), of a chain
    /// with large steps); NaN where one of them does not know its error.
    ///
    /// Both come from one run and are correlated, so this is a warning light (beyond
    /// 5, say), not a test.
    pub fn discrepancies(&self, independent: &[Mean; K]) -> [f64; K] {
        from_fn(|k| {
            let (running, mean) = (&self.estimates[k], &independent[k]);
            let error = libm::hypot(running.standard_error, mean.standard_error());
            let difference = running.value - mean.mean();
            if difference.abs() <= 1e-12 * running.value {
                0.0 // a constant known exactly has no error to compare with
            } else if error.is_finite() {
                difference / error
            } else {
                f64::NAN
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-14
    }

    #[test]
    fn rough_ones_average_by_particles_zeros_included() {
        let stage = |value, standard_error| Estimate {
            value,
            standard_error,
        };
        let mut rough = RoughNormalisers::annealed([Estimate::exact(1.0), stage(0.4, 0.03)], 100);
        rough.merge(&RoughNormalisers::annealed(
            [Estimate::exact(1.0), stage(0.0, 0.0)],
            300,
        ));
        let [a, b] = rough.estimates();
        assert!(close(a.value, 1.0) && close(a.standard_error, 0.0));
        assert!(close(b.value, 0.1) && close(b.standard_error, 0.0075));
        rough.merge(&RoughNormalisers::annealed([Estimate::exact(1.0); 2], 400));
        assert!(close(rough.values()[1], 0.55));
    }

    /// Of no particles at all there is no mean, and nothing that is not a number.
    #[test]
    fn nothing_adds_nothing() {
        let nothing = || RoughNormalisers::annealed([Estimate::exact(0.0); 2], 0);
        let mut rough = nothing();
        rough.merge(&nothing());
        assert_eq!(rough, nothing());
        let some = RoughNormalisers::annealed([Estimate::exact(1.0), Estimate::exact(0.3)], 10);
        rough.merge(&some);
        assert_eq!(rough, some);
        rough.merge(&nothing());
        assert_eq!(rough, some);
    }

    #[test]
    fn running_ones_scale_and_compare() {
        let running = RunningNormalisers {
            estimates: [
                Estimate::exact(1.0),
                Estimate {
                    value: 0.5,
                    standard_error: 0.03,
                },
                Estimate::default(),
            ],
        };
        let scales = running.over(&RoughNormalisers::guess([1.0, 0.25, 0.0]));
        assert!(close(scales[1], 2.0) && close(scales[2], 0.0));
        // a mean of 0.3 +- 0.04
        let spread = 0.04 * f64::sqrt(1.0);
        let mean: Mean = [0.3 - spread, 0.3 + spread].into_iter().collect();
        let ones: Mean = [1.0, 1.0].into_iter().collect();
        let z = running.discrepancies(&[ones, mean, Mean::new()]);
        assert!(close(z[0], 0.0) && close(z[1], 0.2 / 0.05), "{z:?}");
        assert!(running.estimates()[2].relative_error().is_infinite());
    }
}
