//! Where chains of photons start.

use kaustik_estimate::{PhotonLevels, PhotonTarget, PhotonValue};
use kaustik_mcmc::{
    Draws, Family, Independent, Ladder, Metropolis, Pcg64Dxsm, Point, Pool, Power,
    SampleGenerators, Target, generator,
};
use rayon::prelude::*;

use super::periods::Periods;
use super::step_sizes::FIRST_STEP;
use super::{Chains, PhotonChains};
use crate::RenderSettings;
use crate::engine::Nonfinite;
use crate::methods::photon::stage::Stage;
use crate::sampling::streams;

/// Chains take so many steps an iteration at least, in the mean over a ladder, or there are fewer ladders.
///
/// Much of the full target's mass is in states that the first chain of a ladder meets once in tens of thousands of steps. Until each ladder has
/// one at its top, its lower chains lose to the top what they find of them: what is left to these is too bright. Many
/// ladders do not mend that. Unit tests, which keep all that happens in an iteration, have several ladders of fewer steps.
const LEAST_STEPS: u64 = if cfg!(test) { 4096 } else { 31_250 };

impl<const K: usize> PhotonChains<K> {
    /// First states from uniform light paths, in proportion to each target; rough normalisers from the same.
    pub(super) fn start(&mut self, stage: &Stage<'_>, settings: &RenderSettings) {
        let pilot = Pilot {
            target: self.target(stage),
            levels: self.levels,
            generators: SampleGenerators::new(settings.seed, streams::PILOT),
        };
        let samples = pilot.samples(settings.options.pilot as usize);
        let pools: [Pool; K] =
            std::array::from_fn(|level| Pool::new(samples.iter().map(|sample| sample[level])));
        let least = 1.0 / samples.len() as f64;
        let rough = std::array::from_fn(|level| {
            let b = pools[level].normaliser().mean();
            if b > 0.0 { b } else { least }
        });
        // Every target but the uniform one is positive exactly where a path is visible.
        let visible = samples.iter().filter(|sample| sample[1] > 0.0).count() as f64 * least;
        let mut choice = generator(settings.seed, streams::CHOICE);
        let useful = stage.photons / (K as u64 * LEAST_STEPS);
        let count = u64::from(settings.options.ladders).min(useful).max(1);
        let ladder = |ladder| {
            let own = generator(settings.seed, ladder);
            pilot.ladder(&pools, &mut choice, own)
        };
        let ladders: Vec<_> = (0..count).map(ladder).collect();
        self.nonfinite = vec![Nonfinite::default(); ladders.len()];
        self.ladders = ladders;
        self.rough = rough;
        self.visible_at_start = visible.max(least);
        self.periods = Periods::new(self.options.pace, &self.levels, visible);
    }
}

/// Uniform light paths, each from a generator of its own.
pub(super) struct Pilot<'t, const K: usize> {
    pub(super) target: PhotonTarget<'t>,
    pub(super) levels: PhotonLevels<K>,
    pub(super) generators: SampleGenerators,
}

impl<const K: usize> Pilot<'_, K> {
    /// The densities of the first so many.
    pub(super) fn samples(&self, count: usize) -> Vec<[f64; K]> {
        let evaluate = |value: &mut PhotonValue, index: usize| {
            let draws = self.generators.at(index as u64);
            (self.target).evaluate(&mut Independent::new(draws), value);
            self.levels.densities(value)
        };
        (0..count)
            .into_par_iter()
            .with_min_len(256)
            .map_init(PhotonValue::default, evaluate)
            .collect()
    }

    /// A ladder of chains that start at samples, each chosen from the pool of its level.
    fn ladder(
        &self,
        pools: &[Pool; K],
        choice: &mut impl Draws,
        mut draws: Pcg64Dxsm,
    ) -> Chains<K> {
        let starts = std::array::from_fn(|level| {
            let chain = match pools[level].choose(choice) {
                Some(start) => self.chain(level, &mut self.generators.at(start.index)),
                // Nothing visible was found: wait for it.
                None => self.chain(level, &mut draws),
            };
            (chain.state().clone(), chain.value().clone())
        });
        Chains {
            ladder: Ladder::new(starts, &self.levels),
            draws,
            counts: [0.0; K],
            found: Nonfinite::default(),
        }
    }

    /// A chain at the sample that these draws make.
    fn chain(
        &self,
        level: usize,
        draws: &mut Pcg64Dxsm,
    ) -> Metropolis<Point<Power>, PhotonValue, K> {
        let first = Power::new(FIRST_STEP);
        Metropolis::start(&self.target, &self.levels, level, first, draws)
    }
}
