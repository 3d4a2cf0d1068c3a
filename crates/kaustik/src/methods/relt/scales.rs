//! What the replicas' films are scaled by, and how well that is known.

use kaustik_estimate::ReplicaShares;
use kaustik_mcmc::{Estimate, RoughNormalisers, RunningNormalisers, SteppingStone};

use super::run::below;
use super::{ReltEngine, full_replica};
use crate::Normaliser;

/// So many ladders make their spread a better measure of errors than the spread of batches within each.
const LADDERS_FOR_ERRORS: usize = 16;

impl<const K: usize> ReltEngine<'_, K> {
    /// The normalisers of all ladders together (RELT eq. 10): pooled before the product is formed.
    pub(super) fn running(&self) -> RunningNormalisers<K> {
        let mut all = SteppingStone::on(below(&self.set));
        for run in &self.runs {
            let stone = run.ladder.stepping_stone();
            if self.runs.len() < LADDERS_FOR_ERRORS {
                all.merge(stone);
            } else {
                all.merge_as_one(stone);
            }
        }
        all.normalisers(1.0)
    }

    /// What all ladders know of the light of each replica: the pool, and passes of the meter.
    pub(super) fn known(&self) -> ReplicaShares<K> {
        let mut known = self.pool;
        if let Some(meter) = &self.besides.meter {
            known.sampled(K - 1, &meter.in_scouts());
        }
        known
    }

    /// The light of each replica by independent samples, and what the films hold.
    pub(super) fn shares(&self) -> ReplicaShares<K> {
        let mut all = self.known();
        for run in &self.runs {
            all.merge(&run.shares);
        }
        all
    }

    /// Has it made more sweeps than its annealing had particles? Before, the rough constants are better than
    /// those of eq. 10.
    fn is_past_annealing(&self) -> bool {
        self.sweeps() >= self.particles
    }

    /// What a film per sweep is multiplied by.
    pub(super) fn scales(&self) -> [f64; K] {
        match self.options.normaliser {
            Normaliser::Running => self.shares().scales(self.sweeps()),
            Normaliser::Exchange if self.is_past_annealing() => {
                let rough = RoughNormalisers::guess(self.rough.map(|b| b.value));
                self.running().over(&rough)
            }
            Normaliser::Exchange | Normaliser::Initial => [1.0; K],
        }
    }

    /// The light (X + Y + Z) of all films. Scaled by other than independent samples, it has the error of the full
    /// replica's normaliser.
    pub(super) fn brightness(&self) -> Estimate {
        let (shares, sweeps) = (self.shares(), self.sweeps());
        let value = shares.light(sweeps, &self.scales());
        let full = full_replica::<K>();
        let relative = match self.options.normaliser {
            Normaliser::Running => {
                return Estimate {
                    value,
                    standard_error: self.error_of_light(),
                };
            }
            Normaliser::Exchange if self.is_past_annealing() => {
                self.running().estimates()[full].relative_error()
            }
            Normaliser::Exchange | Normaliser::Initial => self.rough[full].relative_error(),
        };
        Estimate {
            value,
            standard_error: value * relative,
        }
    }

    fn error_of_light(&self) -> f64 {
        let ladders = self.runs.iter().map(|run| (run.shares, run.sweeps));
        let ladders: Vec<_> = ladders.collect();
        ReplicaShares::error_of_light(&self.known(), &ladders, self.weights.shared())
    }
}
