//! What a visit of an annealed particle adds to the film.

use kaustik_estimate::{ReplicaWeights, ScalarTarget, Scale, SpecularSplit};
use kaustik_film::Film;
use kaustik_mcmc::{Mean, Recorder, Visit};
use kaustik_path::{Class, Contributions};

use crate::engine::Nonfinite;

/// Takes the visits of some particles of a level.
pub(super) struct AnnealedDeposit<'a, const K: usize> {
    pub(super) film: &'a Film,
    pub(super) scale: Scale,
    pub(super) weights: ReplicaWeights<K>,
    /// `Z_k / b_hat_k` over the number of visits of the level in the round.
    pub(super) factor: f64,
    pub(super) gathered: Gathered<K>,
}

/// What particles have told.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gathered<const K: usize> {
    /// Light (X + Y + Z) that went to the film.
    pub(super) light: f64,
    pub(super) moves: u64,
    pub(super) accepted: u64,
    /// Densities of independent samples, by level.
    pub(super) densities: [Mean; K],
    /// What was left out.
    pub(super) nonfinite: Nonfinite,
}

impl<const K: usize> Default for Gathered<K> {
    fn default() -> Self {
        Self {
            light: 0.0,
            moves: 0,
            accepted: 0,
            densities: [Mean::new(); K],
            nonfinite: Nonfinite::default(),
        }
    }
}

impl<const K: usize> Gathered<K> {
    /// The sum of all, in their order.
    pub(super) fn all(parts: Vec<Self>) -> Self {
        let mut all = Self::default();
        for part in parts {
            all.light += part.light;
            all.moves += part.moves;
            all.accepted += part.accepted;
            all.nonfinite = all.nonfinite.and(part.nonfinite);
            for (mean, other) in all.densities.iter_mut().zip(&part.densities) {
                mean.merge(other);
            }
        }
        all
    }
}

impl<const K: usize> AnnealedDeposit<'_, K> {
    /// An independent sample.
    pub(super) fn sample(&mut self, value: &Contributions, densities: &[f64; K]) {
        for (mean, density) in self.gathered.densities.iter_mut().zip(densities) {
            mean.push(*density);
        }
        self.record(Visit {
            level: 0,
            value,
            densities,
            weight: 1.0,
            independent: 0.0,
        });
    }
}

impl<const K: usize> Recorder<Contributions, K> for AnnealedDeposit<'_, K> {
    #[inline]
    fn record(&mut self, visit: Visit<'_, Contributions, K>) {
        let weight = visit.weight * self.factor;
        if weight <= 0.0 || visit.density() <= 0.0 || visit.value.splats().is_empty() {
            return;
        }
        let weights = &self.weights;
        let light = SpecularSplit::of(visit.value, ScalarTarget::Xyz);
        let (film, scale) = (self.film, self.scale);
        if visit.level >= weights.shared() {
            let weight = weight * weights.specific_factor(visit.density());
            scale.splat_classes(film, visit.value, weight, |class| class == Class::L0);
            self.gathered.light += weight * light.specular;
        } else {
            let weight = weight * weights.factor(visit.level, visit.densities);
            if weights.shared() == K {
                scale.splat(film, visit.value, weight);
                self.gathered.light += weight * light.whole();
            } else {
                scale.splat_classes(film, visit.value, weight, |class| class != Class::L0);
                self.gathered.light += weight * light.other;
            }
        }
    }
}
