use std::fmt;

use crate::Estimate;

/// The mean of a stream of numbers and its standard error, by Welford's recurrence.
///
/// Two means merge into that of both streams. Merging is not associative to the last bit:
/// merge in a fixed order where bits matter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Mean {
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::count"))]
    count: u64,
    mean: f64,
    /// Sum of squared deviations from the mean.
    squares: f64,
}

impl Mean {
    /// Of nothing.
    pub fn new() -> Self {
        Self::default()
    }

    /// The mean of `count` >= 2 hypothetical independent numbers that have this value and standard error,
    /// so that an estimate made in another way can be merged with others.
    ///
    /// # Panics
    /// If they are fewer than two.
    pub fn of(count: u64, estimate: Estimate) -> Self {
        assert!(count > 1, "{count} numbers have no standard error");
        let n = count as f64;
        Self {
            count,
            mean: estimate.value,
            squares: estimate.standard_error.powi(2) * n * (n - 1.0),
        }
    }

    /// Takes one number.
    #[inline]
    pub fn push(&mut self, x: f64) {
        self.count += 1;
        let delta = x - self.mean;
        self.mean += delta / self.count as f64;
        self.squares += delta * (x - self.mean);
    }

    /// Takes so many zeros.
    pub fn push_zeros(&mut self, count: u64) {
        self.merge(&Self {
            count,
            mean: 0.0,
            squares: 0.0,
        });
    }

    /// Takes all numbers of another mean (Chan et al. 1979).
    pub fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        let (n, m) = (self.count as f64, other.count as f64);
        let delta = other.mean - self.mean;
        self.count += other.count;
        self.mean += delta * (m / (n + m));
        self.squares += other.squares + delta * delta * (n * m / (n + m));
    }

    /// How many numbers were taken.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Their mean; 0 if there are none.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Their sample variance; infinite for fewer than two.
    pub fn variance(&self) -> f64 {
        match self.count {
            0 | 1 => f64::INFINITY,
            n => self.squares / (n - 1) as f64,
        }
    }

    /// The standard error of the mean of independent numbers; infinite for fewer than two.
    pub fn standard_error(&self) -> f64 {
        (self.variance() / self.count.max(1) as f64).sqrt()
    }
}

impl FromIterator<f64> for Mean {
    fn from_iter<I: IntoIterator<Item = f64>>(numbers: I) -> Self {
        let mut mean = Self::new();
        mean.extend(numbers);
        mean
    }
}

impl Extend<f64> for Mean {
    fn extend<I: IntoIterator<Item = f64>>(&mut self, numbers: I) {
        numbers.into_iter().for_each(|x| self.push(x));
    }
}

/// As an [`Estimate`].
impl fmt::Display for Mean {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Estimate::from(self).fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{Estimate, Mean};

    #[test]
    fn mean_variance_and_standard_error_of_three_numbers() {
        let mean: Mean = [1.0, 2.0, 3.0].into_iter().collect();
        assert!((mean.mean() - 2.0).abs() < 1e-15 && (mean.variance() - 1.0).abs() < 1e-15);
        assert!((mean.standard_error() - f64::sqrt(1.0 / 3.0)).abs() < 1e-15);
        assert!(Mean::new().standard_error().is_infinite());
    }

    #[test]
    fn an_estimate_counts_for_numbers() {
        let numbers: Mean = (0..40).map(|i| f64::from(i * i)).collect();
        let estimate = Estimate {
            value: numbers.mean(),
            standard_error: numbers.standard_error(),
        };
        let of = Mean::of(40, estimate);
        assert_eq!(
            (of.count(), of.mean().to_bits()),
            (40, numbers.mean().to_bits())
        );
        assert!((of.variance() / numbers.variance() - 1.0).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn merging_is_taking_both(a in prop::collection::vec(-5.0..5.0f64, 0..20),
                                  b in prop::collection::vec(-5.0..5.0f64, 0..20)) {
            let mut merged: Mean = a.iter().copied().collect();
            merged.merge(&b.iter().copied().collect());
            let both: Mean = a.into_iter().chain(b).collect();
            prop_assert_eq!(merged.count(), both.count());
            prop_assert!((merged.mean() - both.mean()).abs() < 1e-12);
            if both.count() > 1 {
                prop_assert!((merged.variance() - both.variance()).abs() < 1e-10);
            }
        }
    }
}
