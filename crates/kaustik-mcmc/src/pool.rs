//! Where chains start: a pool of independent samples (Kelemen section 1.2).
//!
//! A chain that starts at an arbitrary point is biased until it has forgotten it. The cure
//! is exact: draw N independent samples, start at one of them chosen with probability
//! proportional to its density, and scale what the chain estimates by the pool's own mean
//! density b. For every N, and after any number of steps, b times the chain's estimate is
//! unbiased. Only densities are kept; the chosen sample is made again from its generator.
//!
//! You evaluate the samples yourself, because this crate starts no threads: each is
//! [`sample`] on the generator of its index, and a [`Pool`] takes the densities in the
//! order of their indices.

use std::fmt;

use crate::family::checked_densities;
use crate::{Draws, Family, Independent, Mean, Target};

/// Evaluates one independent sample into `value` and reads its densities; `None` if they
/// are defective.
pub fn sample<T, F, D, const K: usize>(
    target: &T,
    family: &F,
    draws: D,
    value: &mut T::Value,
) -> Option<[f64; K]>
where
    T: Target + ?Sized,
    F: Family<T::Value, K> + ?Sized,
    D: Draws,
{
    target.evaluate(&mut Independent::new(draws), value);
    checked_densities(family, value)
}

/// The densities, at one level, of independent samples.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "Written"))]
pub struct Pool {
    densities: Vec<f64>,
    #[cfg_attr(feature = "serde", serde(skip_serializing))]
    normaliser: Mean,
    defects: u64,
}

impl Pool {
    /// Takes the densities in the order of their indices. NaN, infinite and negative ones
    /// are counted as defects and kept as zero, so that an index stays an index.
    pub fn new(densities: impl IntoIterator<Item = f64>) -> Self {
        let mut pool = Self::default();
        pool.extend(densities);
        pool
    }

    /// Chooses a sample with probability proportional to its density, independently of
    /// other choices. `None` if the pool has seen nothing: no sample, or all of density
    /// zero.
    ///
    /// Such a pool estimates b as zero, so what a chain's visits stand for is zero as well. But
    /// independent proposals of a chain are samples of their own: a program that uses them (film
    /// L of the [estimators](crate#estimating)) is to run its chain all the same, from any state, with b = 0 for
    /// what scales with b; ending here would bias it.
    pub fn choose<D: Draws + ?Sized>(&self, draws: &mut D) -> Option<Start> {
        if !self.densities.iter().any(|&density| density > 0.0) {
            return None;
        }
        let index = draws.index(&self.densities);
        Some(Start {
            index: index as u64,
            density: self.densities[index],
        })
    }

    /// The mean density: an unbiased estimate of the normalising constant b, with its
    /// standard error. Chains whose starts were chosen here are unbiased with exactly this.
    pub fn normaliser(&self) -> &Mean {
        &self.normaliser
    }

    /// The densities in the order of their indices.
    pub fn densities(&self) -> &[f64] {
        &self.densities
    }

    /// How many samples had no valid density.
    pub fn defects(&self) -> u64 {
        self.defects
    }
}

/// Takes further samples, whose indices go on from the last: a pool that is made part by part is the one that is
/// made at once.
impl Extend<f64> for Pool {
    fn extend<I: IntoIterator<Item = f64>>(&mut self, densities: I) {
        for density in densities {
            let sound = density.is_finite() && density >= 0.0;
            let density = if sound { density } else { 0.0 };
            self.defects += u64::from(!sound);
            self.normaliser.push(density);
            self.densities.push(density);
        }
    }
}

/// The normaliser follows from the densities, to the bit.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct Written {
    densities: Vec<f64>,
    #[serde(deserialize_with = "crate::serial::count")]
    defects: u64,
}

#[cfg(feature = "serde")]
impl From<Written> for Pool {
    fn from(written: Written) -> Self {
        let mut pool = Self::new(written.densities);
        pool.defects += written.defects;
        pool
    }
}

/// A chosen sample.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Start {
    /// Its index in the pool, from which its generator is made.
    pub index: u64,
    /// Its density.
    pub density: f64,
}

impl Start {
    pub(crate) fn check(&self, found: f64) -> Result<(), StartError> {
        if found.to_bits() != self.density.to_bits() {
            return Err(StartError::Differs {
                index: self.index,
                expected: self.density,
                found,
            });
        }
        if found > 0.0 {
            Ok(())
        } else {
            Err(StartError::Zero { index: self.index })
        }
    }
}

/// Why a chain cannot start at a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum StartError {
    /// Making the sample again gave another density: the target is not a function of its
    /// coordinates, or asks twice for one, or the generator is not that of the sample.
    Differs {
        /// The sample's index in the pool.
        index: u64,
        /// The density that the pool holds.
        expected: f64,
        /// The density that the rebuilt sample has.
        found: f64,
    },
    /// The sample has density zero.
    Zero {
        /// The sample's index in the pool.
        index: u64,
    },
}

impl fmt::Display for StartError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Differs {
                index,
                expected,
                found,
            } => write!(
                f,
                "sample {index} of the pool had density {expected:e} but has {found:e} when rebuilt"
            ),
            Self::Zero { index } => write!(f, "sample {index} of the pool has density zero"),
        }
    }
}

impl std::error::Error for StartError {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generator;

    #[test]
    fn a_dark_pool_is_no_panic() {
        let mut rng = generator(1, 0);
        for pool in [
            Pool::new([]),
            Pool::new([0.0, 0.0]),
            Pool::new([f64::NAN, -1.0]),
        ] {
            assert_eq!(pool.choose(&mut rng), None);
            assert!(pool.normaliser().mean().abs() < 1e-300);
        }
    }

    #[test]
    fn parts_make_the_pool_that_is_made_at_once() {
        let densities = [0.3, f64::NAN, 2.0, 0.0, 7.5, -1.0];
        let mut parts = Pool::new(densities[..2].iter().copied());
        parts.extend(densities[2..].iter().copied());
        assert_eq!(parts, Pool::new(densities));
        assert_eq!(parts.defects(), 2);
    }

    #[test]
    fn defects_are_counted_and_never_chosen() {
        let mut rng = generator(1, 0);
        let pool = Pool::new([f64::NAN, 2.0, f64::INFINITY, 0.0, 6.0]);
        assert_eq!(pool.defects(), 2);
        assert!((pool.normaliser().mean() - 1.6).abs() < 1e-15);
        let mut fours = 0;
        for _ in 0..4000 {
            let start = pool.choose(&mut rng).unwrap();
            assert!(start.index == 1 || start.index == 4);
            fours += i32::from(start.index == 4);
        }
        assert!((fours - 3000).abs() < 130, "{fours}");
    }
}
