//! How much of the picture's light each replica's film stands for.

use std::array::from_fn;

use kaustik_mcmc::{Estimate, Mean};

/// What the films of K replicas hold, and what they should hold.
///
/// The weights of the replicas share the light of every path. The part of replica k is an integral over the
/// unit cube, `W_k = integral of w_k l`, with `l` the scalar (X + Y + Z) of the light and `w_k` the weight of
/// that replica, and every independent sample gives an unbiased estimate of all of them. A film
/// that a chain has filled is right up to a factor; scaling it to its `W_k` gives that factor
/// without the chain's own normaliser (RELT eq. 10), which a chain that has not yet found all light
/// gets wrong, and does not know.
///
/// The light of all films together is then the mean of `l` over independent samples: unbiased, with the
/// standard error of a mean of independent numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shares<const K: usize> {
    /// `w_k l` of independent samples.
    parts: [Mean; K],
    /// Their sum, `l`.
    whole: Mean,
    /// What the films were given: sums of weight times light.
    held: [f64; K],
}

impl<const K: usize> Default for Shares<K> {
    fn default() -> Self {
        Self {
            parts: [Mean::new(); K],
            whole: Mean::new(),
            held: [0.0; K],
        }
    }
}

impl<const K: usize> Shares<K> {
    /// Takes an independent sample: the light that falls to each replica, dark samples included.
    #[inline]
    pub fn sample(&mut self, parts: [f64; K]) {
        for (mean, part) in self.parts.iter_mut().zip(parts) {
            mean.push(part);
        }
        self.whole.push(parts.iter().sum());
    }

    /// The film of a replica was given so much light.
    #[inline]
    pub fn hold(&mut self, level: usize, light: f64) {
        self.held[level] += light;
    }

    /// Adds those of another ladder.
    pub fn merge(&mut self, other: &Self) {
        for k in 0..K {
            self.parts[k].merge(&other.parts[k]);
            self.held[k] += other.held[k];
        }
        self.whole.merge(&other.whole);
    }

    /// The light of all replicas: the picture's mean X + Y + Z times its area.
    pub fn whole(&self) -> Estimate {
        estimate(&self.whole)
    }

    /// The light of a replica.
    ///
    /// # Panics
    /// If `level` is K or more.
    pub fn part(&self, level: usize) -> Estimate {
        estimate(&self.parts[level])
    }

    /// What the films were given: sums of weight times light.
    pub fn held(&self) -> [f64; K] {
        self.held
    }

    /// What each film, after so many sweeps, is to be multiplied by on top of 1 over the sweeps; 0 where
    /// it is empty.
    pub fn scales(&self, sweeps: u64) -> [f64; K] {
        from_fn(|k| {
            if self.held[k] > 0.0 {
                self.parts[k].mean() * sweeps as f64 / self.held[k]
            } else {
                0.0
            }
        })
    }
}

fn estimate(mean: &Mean) -> Estimate {
    Estimate {
        value: mean.mean(),
        standard_error: mean.standard_error(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn films_are_scaled_to_what_independent_samples_say() {
        let mut one = Shares::<2>::default();
        one.sample([1.0, 3.0]);
        one.sample([0.0, 0.0]);
        one.hold(0, 0.25);
        let mut other = Shares::default();
        other.sample([2.0, 0.0]);
        other.hold(0, 0.75);
        one.merge(&other);
        // shares of 1 and 1; the first film holds 1 after 4 sweeps, the second nothing
        let [first, second] = one.scales(4);
        assert!((first - 4.0).abs() < 1e-15 && second.abs() < 1e-300);
        let whole = one.whole();
        assert!((whole.value - 2.0).abs() < 1e-15);
        // 4, 0, 2: variance 4, error of the mean of three
        assert!((whole.standard_error - (4.0_f64 / 3.0).sqrt()).abs() < 1e-15);
        assert!((one.part(0).value - 1.0).abs() < 1e-15);
    }
}
