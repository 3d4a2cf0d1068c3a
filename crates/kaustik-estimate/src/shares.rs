//! How much of the picture's light each replica's film stands for.

use std::array::from_fn;

use kaustik_mcmc::{Estimate, Mean};

/// So many effective samples are few.
const FEW: f64 = 8.0;

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

    /// How far independent samples alone are to be trusted with a replica's light, in [0, 1]: n / (n + 8)
    /// for n effective samples, `(sum of light)^2 / sum of squares`.
    ///
    /// Light that one sample in 100,000 meets is nothing to the first 50,000, and far too much once the first has
    /// met it, while chains may have come to it by small steps. Until a few dozen have met
    /// it the exchange's word counts as well.
    fn trust(&self, level: usize) -> f64 {
        let mean = &self.parts[level];
        let square = mean.mean() * mean.mean();
        if square <= 0.0 || mean.count() < 2 {
            return 0.0;
        }
        let n = mean.count() as f64;
        let effective = n * square / (square + mean.variance() * (n - 1.0) / n);
        effective / (effective + FEW)
    }

    /// What each film is to be multiplied by, on top of 1 over the number of sweeps that filled it; `exchange`
    /// is what the replicas tell about each other, `b_k / b_hat_k` (spec relt.md (7)).
    pub fn scales(&self, sweeps: u64, exchange: &[f64; K]) -> [f64; K] {
        from_fn(|k| {
            let trust = self.trust(k);
            if self.held[k] > 0.0 {
                let own = self.parts[k].mean() * sweeps as f64 / self.held[k];
                trust * own + (1.0 - trust) * exchange[k]
            } else {
                0.0
            }
        })
    }

    /// The light of the films so scaled. Its error is that of the independent samples, and where these are
    /// not trusted alone what the two ways differ by.
    pub fn brightness(&self, sweeps: u64, exchange: &[f64; K]) -> Estimate {
        let scales = self.scales(sweeps, exchange);
        let mut value = 0.0;
        let mut square = self.whole().standard_error * self.whole().standard_error;
        for (k, scale) in scales.iter().enumerate() {
            let light = scale * self.held[k] / sweeps.max(1) as f64;
            value += light;
            let apart = light - self.parts[k].mean();
            square += apart * apart;
        }
        Estimate {
            value,
            standard_error: square.sqrt(),
        }
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

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12 * a.abs().max(1.0)
    }

    #[test]
    fn films_are_scaled_to_what_independent_samples_say() {
        let (mut one, mut other) = (Shares::<3>::default(), Shares::default());
        for i in 0..4_000 {
            let half = if i % 2 == 0 { &mut one } else { &mut other };
            half.sample([1.0, if i < 1_000 { 3.0 } else { 0.0 }, 0.0]);
        }
        one.hold(0, 0.25);
        other.hold(0, 0.75);
        other.hold(1, 1.0);
        one.merge(&other);
        let [first, second, third] = one.scales(4, &[9.0, 2.0, 5.0]);
        // 4,000 and 1,000 effective samples; the third film is empty
        assert!(close(first, (4_000.0 * 4.0 + 8.0 * 9.0) / 4_008.0));
        assert!(close(second, (1_000.0 * 3.0 + 8.0 * 2.0) / 1_008.0));
        assert!(close(third, 0.0));
        let whole = one.whole();
        assert!(close(whole.value, 1.75) && close(one.part(1).value, 0.75));
        assert!((whole.standard_error / (1.6875_f64 / 4_000.0).sqrt() - 1.0).abs() < 1e-3);
        let light = one.brightness(4, &[4.0, 3.0, 1.0]);
        assert!(close(light.value, whole.value) && close(light.standard_error, whole.standard_error));
    }

    #[test]
    fn what_samples_have_hardly_met_is_left_to_the_exchange() {
        let mut shares = Shares::<1>::default();
        shares.sample([0.0]);
        shares.hold(0, 3.0);
        assert!(close(shares.scales(6, &[0.5])[0], 0.5));
        shares.sample([8.0]); // one effective sample, a mean of 4
        let [scale] = shares.scales(6, &[0.5]);
        assert!(close(scale, (8.0 + 8.0 * 0.5) / 9.0), "{scale}");
        let light = shares.brightness(6, &[0.5]);
        assert!(close(light.value, scale / 2.0));
        // an error of sqrt(32 / 2), and what lies between the two
        let apart = 4.0 - light.value;
        assert!(close(light.standard_error, (16.0 + apart * apart).sqrt()));
    }
}
