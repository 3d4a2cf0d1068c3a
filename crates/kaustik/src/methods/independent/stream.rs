//! One ladder of independent samples.

use std::sync::atomic::AtomicBool;

use kaustik_estimate::Scale;
use kaustik_film::Film;
use kaustik_mcmc::{Independent, SampleGenerators};
use kaustik_path::{Contributions, PathBuilder, RayCounts};
use kaustik_pss::Coordinates;
use kaustik_scene::Scene;

use crate::control::is_stopped;
use crate::engine::{Nonfinite, STRIDE};
use crate::methods::erpt_pss::{Chains, Paths, PssRedistribution};
use crate::sampling::cells::{Cells, Tour};
use crate::sampling::stratified::mix;

/// One ladder: sample `step` is made from (seed, ladder, step) alone.
pub(super) struct SampleStream {
    pub(super) ladder: u32,
    pub(super) step: u64,
    pub(super) generators: SampleGenerators,
    pub(super) value: Contributions,
    pub(super) nonfinite: Nonfinite,
    pub(super) rays: RayCounts,
    /// Runs chains from the samples, where the method does.
    pub(super) chains: Option<Box<Chains>>,
}

/// What a stream works with.
pub(super) struct Job<'a> {
    pub(super) seed: u64,
    pub(super) scene: &'a Scene,
    pub(super) builder: &'a dyn PathBuilder,
    pub(super) film: &'a Film,
    pub(super) scale: Scale,
    pub(super) cells: Option<Cells>,
    pub(super) stop: Option<&'a AtomicBool>,
    pub(super) redistribution: Option<&'a PssRedistribution>,
}

impl SampleStream {
    pub(super) fn run(&mut self, job: &Job<'_>, steps: u64) {
        let mut tour = job
            .cells
            .map(|cells| Tour::new(&cells, self.ladder, self.step));
        let seed = mix(job.seed);
        // The chains of a sample are long, and broken off as well: such a sample is none.
        let stride = if self.chains.is_some() { 1 } else { STRIDE };
        for done in 0..steps {
            if done % stride == 0 && is_stopped(job.stop) {
                return;
            }
            let mut coordinates = Independent::new(self.generators.at(self.step));
            match &mut tour {
                None => self.sample(job, &mut coordinates),
                Some(tour) => {
                    let mut coordinates = tour.confine(seed, coordinates);
                    tour.go_on();
                    self.sample(job, &mut coordinates);
                }
            }
            if self.chains.is_some() && is_stopped(job.stop) {
                return;
            }
            self.step += 1;
        }
    }

    /// One sample, and where its light goes.
    #[inline]
    fn sample<C: Coordinates>(&mut self, job: &Job<'_>, coordinates: &mut C) {
        let (scene, builder) = (job.scene, job.builder);
        let nonfinite = match (job.redistribution, &mut self.chains) {
            (Some(redistribution), Some(chains)) => {
                let place = Paths {
                    scene,
                    builder,
                    film: job.film,
                    scale: job.scale,
                    stop: job.stop,
                };
                chains.run(redistribution, &place, coordinates, self.step)
            }
            _ => {
                builder.build(scene, coordinates, &mut self.value);
                job.scale.splat(job.film, &self.value, 1.0);
                self.rays += self.value.rays();
                u64::from(self.value.nonfinite())
            }
        };
        self.nonfinite.count(nonfinite, self.step);
    }

    /// Whole passes over the ladder's cells; `None` in the middle of one.
    pub(super) fn passes(&self, cells: &Cells) -> Option<u64> {
        let [first, end] = cells.of_ladder(self.ladder);
        match end - first {
            0 => Some(u64::MAX),
            count => self.step.is_multiple_of(count).then_some(self.step / count),
        }
    }

    /// Samples that the ladder's cell number `index` has had.
    pub(super) fn visits(&self, cells: &Cells, index: u64) -> u64 {
        let [first, end] = cells.of_ladder(self.ladder);
        let count = end - first;
        self.step / count + u64::from(index < self.step % count)
    }
}
