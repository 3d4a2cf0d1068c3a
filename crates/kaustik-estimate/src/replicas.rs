//! Replica exchange light transport: densities of the replicas, weights of their samples.

use kaustik_film::Film;
use kaustik_mcmc::{Family, Recorder, TourRecorder, Visit};
use kaustik_path::{Class, Contributions, ScalarTarget};

use crate::{ReplicaSet, ReplicaShares, Scale, SpecularSplit};

/// The densities of K replicas: `q_0 = 1`, `q_k = sum of d_{k,n} L_n` (RELT eq. 19, which counts
/// from 1; [`ReplicaSet::weights`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReplicaFamily<const K: usize> {
    weights: [[f64; Class::COUNT]; K],
    target: ScalarTarget,
}

impl<const K: usize> ReplicaFamily<K> {
    /// The first K replicas of a set.
    ///
    /// # Panics
    /// If the set has fewer.
    pub fn new(set: &ReplicaSet, target: ScalarTarget) -> Self {
        Self {
            weights: std::array::from_fn(|k| set.weights(k)),
            target,
        }
    }

    /// The densities where the scalars of the classes of paths are these.
    #[inline]
    pub fn of_classes(&self, classes: &[f64; Class::COUNT]) -> [f64; K] {
        let mut densities = [1.0; K];
        for (density, weights) in densities.iter_mut().zip(&self.weights).skip(1) {
            *density = weights.iter().zip(classes).map(|(d, l)| d * l).sum();
        }
        densities
    }
}

impl<const K: usize> Family<Contributions, K> for ReplicaFamily<K> {
    #[inline]
    fn densities(&self, value: &Contributions) -> [f64; K] {
        self.of_classes(&value.by_class(self.target))
    }
}

/// The density of the specific replica without that of joined paths: of implicit specular paths that nothing else finds
/// ([`Class::L0`]), which a walk from the camera alone tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpecificFamily {
    weight: f64,
    target: ScalarTarget,
}

impl SpecificFamily {
    /// Of the last replica of a set.
    pub fn new(set: &ReplicaSet, target: ScalarTarget) -> Self {
        Self {
            weight: set.weights(set.count() - 1)[Class::L0 as usize],
            target,
        }
    }
}

impl Family<Contributions, 1> for SpecificFamily {
    #[inline]
    fn densities(&self, value: &Contributions) -> [f64; 1] {
        [self.weight * value.by_class(self.target)[Class::L0 as usize]]
    }
}

/// The fixed parts of the heuristic that combines the replicas (RELT eq. 22 and 23, with constants that
/// are fixed before the run in place of the normalisers).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReplicaWeights<const K: usize> {
    /// `1 / b_hat_k`.
    inverse: [f64; K],
    /// `v_k n_k / b_hat_k`, with `v_k` the [worth](Self::with_worth) of a visit.
    counted: [f64; K],
    /// For how much of an independent sample a visit counts.
    worth: [f64; K],
    beta: f64,
    /// Replicas `0..shared` take part in the heuristic.
    shared: usize,
}

impl<const K: usize> ReplicaWeights<K> {
    /// From constants `b_hat_k` > 0 that never change, and the exponent `beta` >= 1.
    ///
    /// `specific`: the last replica is kept out of the heuristic, for implicit specular paths alone.
    ///
    /// # Panics
    /// If a constant is not positive and finite, `beta` is below 1, or all replicas would be kept out.
    pub fn new(rough: [f64; K], beta: f64, specific: bool) -> Self {
        assert!(
            rough.iter().all(|b| *b > 0.0 && b.is_finite()),
            "constants {rough:?}"
        );
        assert!(beta >= 1.0, "beta is {beta}");
        let shared = K - usize::from(specific);
        assert!(shared > 0, "no replica for the heuristic");
        Self {
            inverse: rough.map(|b| 1.0 / b),
            counted: rough.map(|b| 1.0 / b),
            worth: [1.0; K],
            beta,
            shared,
        }
    }

    /// With `n_k` samples of replica k for each sweep in place of one: the heuristic counts them.
    ///
    /// # Panics
    /// If a number is not positive and finite.
    #[must_use]
    pub fn with_counts(self, counts: [f64; K]) -> Self {
        assert!(
            counts.iter().all(|n| *n > 0.0 && n.is_finite()),
            "numbers of samples {counts:?}"
        );
        Self {
            counted: std::array::from_fn(|k| self.worth[k] * counts[k] * self.inverse[k]),
            ..self
        }
    }

    /// Sets how much of an independent sample one visit of replica k counts for in the heuristic;
    /// successive visits of a chain are correlated. The default is 1. Any positive values leave the
    /// estimate unbiased.
    ///
    /// # Panics
    /// If a number is not positive and finite.
    #[must_use]
    pub fn with_worth(self, worth: [f64; K]) -> Self {
        assert!(
            worth.iter().all(|w| *w > 0.0 && w.is_finite()),
            "worths {worth:?}"
        );
        Self {
            counted: std::array::from_fn(|k| worth[k] / self.worth[k] * self.counted[k]),
            worth,
            ..self
        }
    }

    /// How many replicas share paths by the heuristic: all, or all but the specific one.
    pub fn shared(&self) -> usize {
        self.shared
    }

    /// `x^exponent`; the usual exponents cost no logarithm.
    #[inline]
    #[expect(
        clippy::float_cmp,
        reason = "only these very exponents have a shortcut"
    )]
    fn power(x: f64, exponent: f64) -> f64 {
        if exponent == 2.0 {
            x * x
        } else if exponent == 1.0 {
            x
        } else if exponent == 0.0 {
            1.0
        } else {
            libm::pow(x, exponent)
        }
    }

    /// What each sample of a sharing replica is multiplied by: `v_k (v_k n_k q_k/b_hat_k)^(beta-1) / D` (RELT eq. 23 with
    /// `n_k` samples of replica k that count for `v_k`), D being the sum of `(v_k n_k q_k/b_hat_k)^beta`.
    #[inline]
    pub fn factor(&self, level: usize, densities: &[f64; K]) -> f64 {
        let (expected, most) = self.expected(densities);
        let powers = expected.iter().take(self.shared);
        let sum: f64 = powers.map(|&x| Self::power(x, self.beta)).sum();
        self.worth[level] * Self::power(expected[level], self.beta - 1.0) / (sum * most)
    }

    /// `v_k n_k q_k/b_hat_k` of each replica over the largest of those that share, and the largest: no power of them is
    /// too large for a number.
    #[inline]
    fn expected(&self, densities: &[f64; K]) -> ([f64; K], f64) {
        let expected: [f64; K] = std::array::from_fn(|k| densities[k] * self.counted[k]);
        let most = expected[..self.shared].iter().copied().fold(0.0, f64::max);
        (expected.map(|x| x / most), most)
    }

    /// Densities over the rough constants.
    #[inline]
    pub fn roughly(&self, densities: &[f64; K]) -> [f64; K] {
        std::array::from_fn(|k| densities[k] * self.inverse[k])
    }

    /// Splits the light of a point among the replicas, given the scalar of its implicit specular light and
    /// of all other light. The parts add up to the whole.
    #[inline]
    pub fn share(&self, densities: &[f64; K], light: SpecularSplit) -> [f64; K] {
        let common = if self.shared == K {
            light.whole()
        } else {
            light.other
        };
        let (expected, _) = self.expected(densities);
        let mut terms = expected.map(|x| Self::power(x, self.beta));
        let sum: f64 = terms[..self.shared].iter().sum();
        for term in &mut terms {
            *term *= common / sum;
        }
        if self.shared < K {
            terms[K - 1] = light.specular;
        }
        terms
    }

    /// What implicit specular light of a sample of the specific replica is multiplied by:
    /// `b_hat_K / q_K` with its density there, as no other replica shows that light.
    #[inline]
    pub fn specific_factor(&self, density: f64) -> f64 {
        1.0 / (density * self.inverse[K - 1])
    }
}

/// Takes the visits of ladders of K replicas: one film each.
///
/// After N sweeps the image is `area / N * sum of scale_k * film_k`, `area` being the raster area in
/// pixels and `scale_k` the replica's of [`ReplicaShares::scales`], or `b_k / b_hat_k`.
///
/// Without a specific replica every visit goes to its replica's film, weighted by
/// [`factor`](ReplicaWeights::factor). With one, implicit specular light that nothing else finds ([`Class::L0`]) goes to
/// the last film alone, from visits of the last replica; all other light from visits of the other
/// replicas to theirs. (The heuristic would leave that light to the replicas that seldom meet it.)
#[derive(Debug)]
pub struct ReplicaDeposit<'a, const K: usize> {
    /// A film for each replica.
    pub films: &'a [Film; K],
    /// Raster to pixels.
    pub scale: Scale,
    /// The heuristic.
    pub weights: ReplicaWeights<K>,
    /// What the films are given, and what independent samples (visits of replica 0) say they should hold.
    pub shares: ReplicaShares<K>,
    /// 1 over the samples of each replica a sweep. [`weights`](Self::weights) know of those of the replicas that share
    /// paths ([`ReplicaWeights::with_counts`]).
    pub each: [f64; K],
    /// 1 over the visits of the specific replica and of its [tours](kaustik_mcmc::Touring) a sweep.
    pub each_specific: f64,
}

impl<const K: usize> Recorder<Contributions, K> for ReplicaDeposit<'_, K> {
    #[inline]
    fn record(&mut self, visit: Visit<'_, Contributions, K>) {
        if visit.independent <= 0.0 && visit.value.splats().is_empty() {
            return;
        }
        let light = SpecularSplit::of(visit.value, ScalarTarget::Xyz);
        let whole = light.whole();
        if visit.independent > 0.0 {
            let parts = self.weights.share(visit.densities, light);
            self.shares.sample(parts);
        }
        if visit.weight <= 0.0 || visit.density() <= 0.0 || whole <= 0.0 {
            return;
        }
        let roughly = self.weights.roughly(visit.densities);
        let sojourn = visit.weight * self.each[visit.level];
        self.shares.visit(visit.level, sojourn, &roughly);
        let film = &self.films[visit.level];
        let weights = &self.weights;
        if visit.level < weights.shared {
            let weight = visit.weight * weights.factor(visit.level, visit.densities);
            if weights.shared == K {
                self.scale.splat(film, visit.value, weight);
                self.shares.hold(visit.level, weight * whole, whole);
            } else if light.other > 0.0 {
                (self.scale).splat_classes(film, visit.value, weight, |class| class != Class::L0);
                self.shares.hold(visit.level, weight * light.other, whole);
            }
        } else if light.specular > 0.0 {
            self.specific(
                visit.value,
                visit.weight,
                visit.density(),
                light.specular,
                whole,
            );
        }
    }
}

impl<const K: usize> TourRecorder<Contributions> for ReplicaDeposit<'_, K> {
    #[inline]
    fn record_tour(&mut self, visit: Visit<'_, Contributions, 1>) {
        let light = SpecularSplit::of(visit.value, ScalarTarget::Xyz);
        if visit.weight > 0.0 && light.specular > 0.0 {
            let whole = light.specular;
            self.specific(
                visit.value,
                visit.weight,
                visit.density(),
                light.specular,
                whole,
            );
        }
    }
}

impl<const K: usize> ReplicaDeposit<'_, K> {
    /// Gives the specific replica's film what a visit shows.
    #[inline]
    fn specific(
        &mut self,
        value: &Contributions,
        weight: f64,
        density: f64,
        light: f64,
        whole: f64,
    ) {
        let weight = weight * self.each_specific * self.weights.specific_factor(density);
        let film = &self.films[K - 1];
        (self.scale).splat_classes(film, value, weight, |class| class == Class::L0);
        self.shares.hold(K - 1, weight * light, whole);
    }
}

#[cfg(test)]
mod sides_tests;
#[cfg(test)]
mod tests;
