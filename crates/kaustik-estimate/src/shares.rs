//! How much of the picture's light each replica's film stands for.

use std::array::from_fn;

use kaustik_mcmc::{Estimate, Mean};

/// With so many effective samples, samples and bridges are trusted alike.
const FEW: f64 = 2.0;

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
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "serial::Written", into = "serial::Written")
)]
pub struct ReplicaShares<const K: usize> {
    /// `w_k l` of independent samples.
    parts: [Mean; K],
    /// Their sum, `l`.
    whole: Mean,
    /// What the films were given: sums of weight times light.
    held: [f64; K],
    /// The same times all light of the visit.
    squares: [f64; K],
    /// Over the visits of the replica below: the sum of this replica's part of the bridge density.
    up: [f64; K],
    /// Over the visits of this replica: the sum of the lower one's part of the bridge density.
    down: [f64; K],
    /// The replica that each stands on.
    below: [usize; K],
}

/// Of replicas in a line.
impl<const K: usize> Default for ReplicaShares<K> {
    fn default() -> Self {
        Self::on(from_fn(|k| k.saturating_sub(1)))
    }
}

impl<const K: usize> ReplicaShares<K> {
    /// For replicas in a tree: `below[k] < k` is the parent of replica k; `below[0]` is ignored.
    ///
    /// # Panics
    /// If one stands on a replica that is not before it.
    pub fn on(below: [usize; K]) -> Self {
        let before = |(k, &below): (usize, &usize)| k == 0 || below < k;
        assert!(below.iter().enumerate().all(before), "{below:?}");
        Self {
            below,
            parts: [Mean::new(); K],
            whole: Mean::new(),
            held: [0.0; K],
            squares: [0.0; K],
            up: [0.0; K],
            down: [0.0; K],
        }
    }

    /// Takes an independent sample: the light that falls to each replica, dark samples included.
    #[inline]
    pub fn sample(&mut self, parts: [f64; K]) {
        for (mean, part) in self.parts.iter_mut().zip(parts) {
            mean.push(part);
        }
        self.whole.push(parts.iter().sum());
    }

    /// The film of a replica was given so much light by a visit whose whole light is this.
    #[inline]
    pub fn hold(&mut self, level: usize, light: f64, whole: f64) {
        self.held[level] += light;
        self.squares[level] += light * whole;
    }

    /// Records a visit of a replica with its weight. `roughly` holds the densities at the visited state,
    /// each divided by its rough normaliser.
    #[inline]
    pub fn visit(&mut self, level: usize, weight: f64, roughly: &[f64; K]) {
        let share = |of: usize, other: usize| {
            let both = roughly[of] + roughly[other];
            if both > 0.0 {
                weight * roughly[of] / both
            } else {
                0.0
            }
        };
        for upper in 1..K {
            let lower = self.below[upper];
            if upper == level {
                self.down[upper] += share(lower, upper);
            } else if lower == level {
                self.up[upper] += share(upper, lower);
            }
        }
    }

    /// An independent sample of the light of one replica alone, dark or not.
    #[inline]
    pub fn scout(&mut self, level: usize, light: f64) {
        self.parts[level].push(light);
    }

    /// Records `sent` such samples, of which these were not dark.
    ///
    /// # Panics
    /// If more were found than were sent.
    pub fn scouts(&mut self, level: usize, found: &[f64], sent: u64) {
        assert!(
            found.len() as u64 <= sent,
            "more samples with light than samples"
        );
        for &light in found {
            self.parts[level].push(light);
        }
        self.parts[level].push_zeros(sent - found.len() as u64);
    }

    /// What counts for independent samples of the light of one replica alone: how many, and what they would say.
    pub fn sampled(&mut self, level: usize, light: &Mean) {
        self.parts[level].merge(light);
    }

    /// What the replicas tell about each other: `b_k / b_hat_k` (RELT eq. 10) by Bennett's acceptance ratio
    /// (J. Comput. Phys. 22, 1976) from each to those that stand on it. Visits count by at most their weight:
    /// RELT eq. 10 lets what the uniform replica met by chance count by its density, which may be ten
    /// thousand times the mean. And supports need not be nested. 1 where two replicas have nothing in common
    /// yet.
    pub fn bridged(&self) -> [f64; K] {
        let mut constants = [1.0; K];
        for k in 1..K {
            let known = self.up[k] > 0.0 && self.down[k] > 0.0;
            let ratio = if known {
                self.up[k] / self.down[k]
            } else {
                1.0
            };
            constants[k] = constants[self.below[k]] * ratio;
        }
        constants
    }

    /// Adds those of another ladder.
    pub fn merge(&mut self, other: &Self) {
        for k in 0..K {
            self.parts[k].merge(&other.parts[k]);
            self.held[k] += other.held[k];
            self.squares[k] += other.squares[k];
            self.up[k] += other.up[k];
            self.down[k] += other.down[k];
        }
        self.whole.merge(&other.whole);
    }

    /// The light of all replicas: the picture's mean X + Y + Z times its area.
    pub fn whole(&self) -> Estimate {
        estimate(&self.whole)
    }

    /// Standard error that these samples contribute to the mean of `all`, of which they are a
    /// part. Errors of the first `shared` replicas are taken to be fully correlated, those of the
    /// others to be independent. The variance is that of `all`: these alone may have met none of
    /// what is rare and bright.
    fn error_within(&self, all: &Self, shared: usize) -> f64 {
        let error = |k: usize| {
            let share = self.parts[k].count() as f64 / all.parts[k].count().max(1) as f64;
            share.sqrt() * all.parts[k].standard_error()
        };
        let alike: f64 = (0..shared.min(K)).map(error).sum();
        (shared..K).map(error).fold(alike, f64::hypot)
    }

    /// The light of a replica.
    ///
    /// # Panics
    /// If `level` is K or more.
    pub fn part(&self, level: usize) -> Estimate {
        estimate(&self.parts[level])
    }

    /// How many samples know the light of a replica, and what [counts](Self::sampled) for such.
    ///
    /// # Panics
    /// If `level` is K or more.
    pub fn samples(&self, level: usize) -> u64 {
        self.parts[level].count()
    }

    /// How far independent samples are to be trusted with a replica's light, in [0, 1]: n / (n + 2)
    /// for n effective samples, `(sum of light)^2 / sum of squares`.
    ///
    /// Light that one sample in 100,000 meets is nothing to the first 50,000, and far too much once the first has
    /// met it, while chains may have come to it by small steps. But all ladders started in one population, which may
    /// have had too little of that light or too much. (In `ring-and-sphere` after 20 seconds bridges were off by
    /// 80 % of the specific light, about as much as the mean of two effective samples is.)
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

    /// Factor for each film, in addition to 1 / sweeps: it scales the film to the light that independent
    /// samples measured, blended with the [bridged](Self::bridged) normalisers to the extent that these
    /// samples are too few to be trusted.
    pub fn scales(&self, sweeps: u64) -> [f64; K] {
        let bridged = self.bridged();
        from_fn(|k| {
            let trust = self.trust(k);
            if self.held[k] > 0.0 {
                let own = self.parts[k].mean() * sweeps as f64 / self.held[k];
                trust * own + (1.0 - trust) * bridged[k]
            } else {
                0.0
            }
        })
    }

    /// The light of each film with these scales.
    fn lights(&self, sweeps: u64, scales: &[f64; K]) -> [f64; K] {
        from_fn(|k| scales[k] * self.held[k] / sweeps.max(1) as f64)
    }

    /// The light of films with these scales.
    pub fn light(&self, sweeps: u64, scales: &[f64; K]) -> f64 {
        self.lights(sweeps, scales).iter().sum()
    }
}

fn estimate(mean: &Mean) -> Estimate {
    Estimate {
        value: mean.mean(),
        standard_error: mean.standard_error(),
    }
}

mod error;
#[cfg(feature = "serde")]
mod serial;

#[cfg(test)]
mod tests {
    use kaustik_mcmc::{Draws, generator};

    use super::*;

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12 * a.abs().max(1.0)
    }

    #[test]
    fn films_are_scaled_to_what_independent_samples_say() {
        let (mut one, mut other) = (ReplicaShares::<3>::default(), ReplicaShares::default());
        for i in 0..400 {
            let half = if i % 2 == 0 { &mut one } else { &mut other };
            half.sample([1.0, if i < 100 { 3.0 } else { 0.0 }, 0.0]);
        }
        one.hold(0, 0.25, 1.0);
        other.hold(0, 0.75, 1.0);
        other.hold(1, 1.0, 3.0);
        // the second is twice as large as it was thought to be
        one.visit(0, 3.0, &[1.0, 2.0, 0.0]);
        other.visit(1, 3.0, &[1.0, 2.0, 0.0]);
        one.merge(&other);
        assert_eq!(
            one.bridged().map(f64::to_bits),
            [1.0, 2.0, 2.0].map(f64::to_bits)
        );
        let scales = one.scales(4);
        // 400 and 100 effective samples; the third film is empty
        assert!(close(scales[0], (400.0 * 4.0 + 2.0) / 402.0));
        assert!(close(scales[1], (100.0 * 3.0 + 2.0 * 2.0) / 102.0));
        assert!(close(scales[2], 0.0));
        assert!(close(one.light(4, &scales), (scales[0] + scales[1]) / 4.0));
        let whole = one.whole();
        assert!(close(whole.value, 1.75) && close(one.part(1).value, 0.75));
        assert!((whole.standard_error / (1.6875_f64 / 400.0).sqrt() - 1.0).abs() < 2e-3);
    }

    #[test]
    fn scouts_count_for_their_replica_alone() {
        let mut shares = ReplicaShares::<2>::default();
        for _ in 0..100 {
            shares.sample([1.0, 0.0]);
            for light in [0.0, 0.0, 2.0] {
                shares.scout(1, light);
            }
        }
        assert!(close(shares.part(0).value, 1.0) && close(shares.whole().value, 1.0));
        assert!(close(shares.part(1).value, 0.5));
        // as many samples again, of which only the mean is known
        assert_eq!(shares.samples(1), 400);
        let estimate = Estimate {
            value: 1.5,
            standard_error: shares.part(1).standard_error,
        };
        shares.sampled(1, &Mean::of(400, estimate));
        assert!(close(shares.part(1).value, 1.0) && shares.samples(1) == 800);
    }

    /// Densities 1, 2 on the left half and 4 on the right quarter, thought to be of integral 1, 2 and 2.
    #[test]
    fn bridges_need_no_nested_supports() {
        let mut rng = generator(34, 0);
        let mut shares = ReplicaShares::<3>::on([0, 0, 0]);
        for _ in 0..20_000 {
            for (level, [from, to]) in [[0.0, 1.0], [0.0, 0.5], [0.75, 1.0]].iter().enumerate() {
                let x = from + (to - from) * rng.uniform();
                let left = if x < 0.5 { 1.0 } else { 0.0 };
                let right = if x >= 0.75 { 2.0 } else { 0.0 };
                shares.visit(level, 1.0, &[1.0, left, right]);
            }
        }
        for (found, wanted) in shares.bridged().into_iter().zip([1.0, 0.5, 0.5]) {
            assert!((found / wanted - 1.0).abs() < 0.03, "{found} {wanted}");
        }
    }

    #[test]
    fn what_samples_have_hardly_met_is_left_to_the_bridges() {
        let mut shares = ReplicaShares::<1>::default();
        shares.sample([0.0]);
        shares.hold(0, 3.0, 1.0);
        assert!(close(shares.scales(6)[0], 1.0));
        shares.sample([8.0]); // one effective sample, a mean of 4
        assert!(close(shares.scales(6)[0], (8.0 + 2.0) / 3.0));
    }

    /// Densities 1, 2x and 3x^2 / 5 on [0, 1], thought to be of integral 1, 3 and 1.
    #[test]
    fn bridges_find_the_constants() {
        let mut rng = generator(33, 0);
        let mut shares = ReplicaShares::<3>::default();
        for _ in 0..100_000 {
            for level in 0..3 {
                let x = libm::pow(rng.uniform(), 1.0 / (level as f64 + 1.0));
                shares.visit(level, 1.0, &[1.0, 2.0 * x / 3.0, 0.6 * x * x]);
            }
        }
        for (found, wanted) in shares.bridged().into_iter().zip([1.0, 1.0 / 3.0, 0.2]) {
            assert!((found / wanted - 1.0).abs() < 0.02, "{found} {wanted}");
        }
    }
}
