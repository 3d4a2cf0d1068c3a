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
    /// The same times all light of the visit.
    squares: [f64; K],
    /// Visits of the replica below, by how much of a bridge is this replica's.
    up: [f64; K],
    /// Visits of this replica, by how much of the bridge is the one's below.
    down: [f64; K],
}

impl<const K: usize> Default for Shares<K> {
    fn default() -> Self {
        Self {
            parts: [Mean::new(); K],
            whole: Mean::new(),
            held: [0.0; K],
            squares: [0.0; K],
            up: [0.0; K],
            down: [0.0; K],
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

    /// The film of a replica was given so much light by a visit whose whole light is this.
    #[inline]
    pub fn hold(&mut self, level: usize, light: f64, whole: f64) {
        self.held[level] += light;
        self.squares[level] += light * whole;
    }

    /// A replica was somewhere, with this weight; `roughly` are the densities there over the rough constants.
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
        if level > 0 {
            self.down[level] += share(level - 1, level);
        }
        if level + 1 < K {
            self.up[level + 1] += share(level + 1, level);
        }
    }

    /// What the replicas tell about each other: `b_k / b_hat_k` (spec relt.md (7)) by Bennett's acceptance
    /// ratio (J. Comput. Phys. 22, 1976) from each to the next. Visits count by at most their weight: RELT eq. 10
    /// lets what the uniform replica met by chance count by its density, which may be ten thousand times the mean.
    /// And supports need not be nested. 1 where two replicas have nothing in common yet.
    pub fn bridged(&self) -> [f64; K] {
        let mut product = 1.0;
        from_fn(|k| {
            if k > 0 && self.up[k] > 0.0 && self.down[k] > 0.0 {
                product *= self.up[k] / self.down[k];
            }
            product
        })
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

    /// How far independent samples are to be trusted with a replica's light, in [0, 1]: n / (n + 8)
    /// for n effective samples, `(sum of light)^2 / sum of squares`.
    ///
    /// Light that one sample in 100,000 meets is nothing to the first 50,000, and far too much once the first has
    /// met it, while chains may have come to it by small steps. But most of many ladders have not, and
    /// their mean is too dim: a dozen samples are better already. (In `ring-and-sphere` after 20 seconds, with n + 100,
    /// ten seeds were 0.7 to 0.9 % too dark, and agreed.)
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

    /// What each film is to be multiplied by, on top of 1 over the number of sweeps that filled it: to hold
    /// what independent samples say, and as far as these are not to be trusted, what the [bridges](Self::bridged)
    /// do.
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

    /// Standard error of the light of independent samples, as the chains know it: the second moment of the
    /// light is what films hold of it, each times all light of its path. Samples that have not yet met the rare
    /// and bright see no spread; a chain that has been there does.
    pub fn foreseen_error(&self, sweeps: u64, scales: &[f64; K]) -> f64 {
        let samples = self.whole.count().max(1) as f64;
        let per_sweep = 1.0 / sweeps.max(1) as f64;
        let seconds = scales.iter().zip(&self.squares);
        let second: f64 = seconds.map(|(scale, sum)| scale * sum * per_sweep).sum();
        let light = self.light(sweeps, scales);
        ((second - light * light).max(0.0) / samples).sqrt()
    }

    /// The light of films with these scales.
    pub fn light(&self, sweeps: u64, scales: &[f64; K]) -> f64 {
        let light = scales
            .iter()
            .zip(&self.held)
            .map(|(scale, held)| scale * held);
        light.sum::<f64>() / sweeps.max(1) as f64
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
    use kaustik_mcmc::{Draws, generator};

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
        // 4,000 and 1,000 effective samples; the third film is empty
        assert!(close(scales[0], (4_000.0 * 4.0 + 8.0) / 4_008.0));
        assert!(close(scales[1], (1_000.0 * 3.0 + 8.0 * 2.0) / 1_008.0));
        assert!(close(scales[2], 0.0));
        assert!(close(one.light(4, &scales), (scales[0] + scales[1]) / 4.0));
        // second moments 1 and 9 / 4 in all, but for what the bridges say
        let foreseen = one.foreseen_error(4, &[4.0, 3.0, 0.0]);
        assert!(close(
            foreseen,
            ((1.0 + 2.25 - 1.75 * 1.75) / 4_000.0_f64).sqrt()
        ));
        let whole = one.whole();
        assert!(close(whole.value, 1.75) && close(one.part(1).value, 0.75));
        assert!((whole.standard_error / (1.6875_f64 / 4_000.0).sqrt() - 1.0).abs() < 1e-3);
    }

    #[test]
    fn what_samples_have_hardly_met_is_left_to_the_bridges() {
        let mut shares = Shares::<1>::default();
        shares.sample([0.0]);
        shares.hold(0, 3.0, 1.0);
        assert!(close(shares.scales(6)[0], 1.0));
        shares.sample([8.0]); // one effective sample, a mean of 4
        assert!(close(shares.scales(6)[0], (8.0 + 8.0) / 9.0));
    }

    /// Densities 1, 2x and 3x^2 / 5 on [0, 1], thought to be of integral 1, 3 and 1.
    #[test]
    fn bridges_find_the_constants() {
        let mut rng = generator(33, 0);
        let mut shares = Shares::<3>::default();
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
