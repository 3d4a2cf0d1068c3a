//! How large small steps are: they learn before the first iteration, and between iterations.

use kaustik_mcmc::{Acceptance, AcceptanceAdaptation, Ignore, Power};
use rayon::prelude::*;

use super::{Chains, PhotonChains, kernels};
use crate::methods::photon::stage::Stage;

/// Before the first iteration step sizes learn for so many rounds at most.
const WARM_UP_ROUNDS: u64 = 48;
/// Sweeps of each.
const WARM_UP_SWEEPS: u64 = 64;
/// It ends when every level accepts as much as it should, but for this much.
const WARM: f64 = 0.04;
/// Size of the first steps: between what suits a scene of which all is seen and one of which a thousandth is.
pub(super) const FIRST_STEP: f64 = 0.1;
/// By how much step sizes learn from an iteration, and how fast that falls with their number.
const GAIN: f64 = 1.0;
const GAIN_DECAY: f64 = 0.6;

/// What finds the step size of a chain that is to accept so many small steps.
pub(super) fn adaptation(acceptance: f64) -> AcceptanceAdaptation<Power> {
    AcceptanceAdaptation::new(Power::new(FIRST_STEP))
        .with_target(acceptance)
        .with_gain(GAIN, GAIN_DECAY)
        .in_logarithms()
}

impl<const K: usize> PhotonChains<K> {
    /// Finds step sizes for the first targets. Then learning begins anew: targets get narrower with every
    /// iteration that knows more regions.
    pub(super) fn warm_up(&mut self, stage: &Stage<'_>) {
        let wanted = self.options.acceptance;
        for _ in 0..WARM_UP_ROUNDS {
            let before: [Acceptance; K] = std::array::from_fn(|level| self.small_steps(level));
            self.sweep_all(stage, WARM_UP_SWEEPS);
            let is_warm = |level: usize| {
                let off = self.small_steps(level).since(&before[level]).rate() - wanted;
                let size = self.adaptations[level].mutation().size();
                // steps that go everywhere cannot be rejected more often
                off.abs() < WARM || off > 0.0 && size >= 1.0
            };
            let warm = (1..K).all(is_warm);
            self.adapt();
            if warm {
                break;
            }
        }
        for adaptation in &mut self.adaptations {
            adaptation.begin_anew();
        }
    }

    /// Sweeps that tell nothing.
    fn sweep_all(&mut self, stage: &Stage<'_>, sweeps: u64) {
        let mut ladders = std::mem::take(&mut self.ladders);
        let target = self.target(stage);
        let kernels = kernels::<K>(&target);
        ladders.par_iter_mut().with_max_len(1).for_each(|chains| {
            let Chains { ladder, draws, .. } = chains;
            for _ in 0..sweeps {
                ladder.sweep(&kernels, &self.levels, draws, &mut Ignore);
            }
        });
        self.ladders = ladders;
    }

    /// New step sizes for every level, from what all ladders have accepted.
    pub(super) fn adapt(&mut self) {
        for level in 1..K {
            let total = self.small_steps(level);
            let mutation = self.adaptations[level].end_round(&total);
            for chains in &mut self.ladders {
                (chains.ladder).set_mutation(level, mutation, &mut chains.draws);
            }
        }
    }

    pub(super) fn small_steps(&self, level: usize) -> Acceptance {
        let mut total = Acceptance::default();
        for chains in &self.ladders {
            total.merge(chains.ladder.replicas()[level].statistics().small());
        }
        total
    }
}
