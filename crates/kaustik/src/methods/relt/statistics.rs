//! What replicas tell about themselves.

use kaustik_estimate::ReplicaShares;
use kaustik_mcmc::{Acceptance, LadderStatistics, RunningNormalisers, Statistics};

use super::{ReltEngine, finite};
use crate::{ReplicaLevel, ReplicaStatistics};

/// The rate of what was tried at all.
fn tried(acceptance: &Acceptance) -> Option<f64> {
    (acceptance.proposed > 0).then(|| acceptance.rate())
}

/// What all replicas are compared by.
struct Compared<const K: usize> {
    running: RunningNormalisers<K>,
    /// Of the uniform replica.
    uniform: Statistics<K>,
    /// How far the normalisers of both are apart, in standard errors.
    apart: [f64; K],
    shares: ReplicaShares<K>,
    scales: [f64; K],
}

impl<const K: usize> ReltEngine<'_, K> {
    /// Of all ladders.
    pub(super) fn statistics(&self) -> ReplicaStatistics {
        let mut exchanges = LadderStatistics::new();
        let mut tours = [0; 2];
        for run in &self.runs {
            exchanges.merge(run.ladder.statistics());
            for (all, one) in tours.iter_mut().zip(run.tour_steps()) {
                *all += one;
            }
        }
        let (running, uniform) = (self.running(), self.level(0));
        let compared = Compared {
            apart: running.discrepancies(&uniform.independent),
            running,
            uniform,
            shares: self.shares(),
            scales: self.scales(),
        };
        let pairs = self.set.pairs(K);
        ReplicaStatistics {
            levels: (0..K).map(|k| self.replica(k, &compared)).collect(),
            sweeps: self.sweeps(),
            exchange_acceptance: (pairs.iter().map(|&(a, b)| tried(exchanges.swap(a, b))))
                .collect(),
            permutation_acceptance: tried(&exchanges.permutations),
            pairs: pairs.iter().map(|&(a, b)| [a + 1, b + 1]).collect(),
            even: self.sweeps() * u64::from(self.even),
            scouts: match self.specular_light {
                Some(_) => self.sweeps() * u64::from(self.set.scouts()),
                None => 0,
            },
            scouts_found: self.runs.iter().map(|run| run.found).sum(),
            scouts_followed: self.runs.iter().map(|run| run.followed).sum(),
            tours: self.sweeps() * u64::from(self.tours.count),
            tours_followed: self.runs.iter().map(|run| run.tours_followed).sum(),
            tour_steps: tours[0],
            tour_acceptance: tours[1] as f64 / tours[0].max(1) as f64,
            round_trips: exchanges.round_trips,
            particles: self.particles,
            dropped: self.dropped.clone(),
            normaliser: self.options.normaliser.name(),
        }
    }

    fn replica(&self, k: usize, all: &Compared<K>) -> ReplicaLevel {
        let statistics = self.level(k);
        let moves = if k == 0 {
            statistics.large()
        } else {
            statistics.small()
        };
        let steps = self.runs.iter().map(|run| {
            let point = run.ladder.replicas()[k].state();
            point.mutation().sizes().1
        });
        let (share, independent) = (all.shares.part(k), &all.uniform.independent[k]);
        ReplicaLevel {
            weights: self.set.rows()[k],
            rough: self.rough[k].value,
            rough_error: finite(self.rough[k].standard_error),
            normalisation: all.running.values()[k],
            normalisation_error: finite(all.running.estimates()[k].standard_error),
            independent: independent.mean(),
            independent_error: finite(independent.standard_error()),
            discrepancy: finite(all.apart[k]),
            share: share.value,
            share_error: finite(share.standard_error),
            scale: all.scales[k],
            acceptance: moves.rate(),
            effective_at_once: self.effective[k][0],
            effective_annealed: self.effective[k][1],
            step: steps.sum::<f64>() / self.runs.len().max(1) as f64,
        }
    }
}
