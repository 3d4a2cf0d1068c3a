//! The samples and chains of one ladder.

use std::sync::atomic::AtomicBool;

use glam::DVec2;
use kaustik_mcmc::{
    Deposit, Draws, Independent, Mean, Redistribution, RedistributionStatistics, Redistributor,
    SampleGenerators,
};
use kaustik_mutate::{Path, PathSpace, Told};
use kaustik_path::{Event, Role, trace};
use kaustik_pss::{Coordinates, Stream as Axis};
use serde::{Deserialize, Serialize};

use super::films::Films;
use super::perturbations::{NAMES, Perturbations};
use super::starts::Starter;
use crate::carried::Carried;
use crate::control::is_stopped;
use crate::engine::Nonfinite;
use crate::methods::erpt_pss::{UntilStopped, check_redistribution, redistribution};
use crate::sampling::cells::{Cells, Tour};
use crate::sampling::stratified::mix;
use crate::sampling::streams;
use crate::state::{Reader, StateError};
use crate::statistics::energy::{EnergySums, add};
use crate::{Colours, Energy, Options, RenderSettings};

/// What all ladders have in common.
pub(crate) struct Job<'a> {
    pub(crate) space: &'a PathSpace<'a>,
    pub(crate) options: &'a Options,
    pub(crate) perturbations: Perturbations<'a>,
    pub(crate) films: &'a Films,
    pub(crate) cells: Cells,
    pub(crate) seed: u64,
    /// Light to be spread of a pilot's samples.
    pub(crate) pilot: f64,
    /// Breaks a pass off.
    pub(crate) stop: Option<&'a AtomicBool>,
}

/// One ladder: sample `step` and its chains are made from (seed, ladder, step), and with
/// [`Energy::Passes`] from the samples of the passes before.
pub(crate) struct Stream {
    pub(crate) ladder: u32,
    pub(crate) step: u64,
    samples: SampleGenerators,
    chains: SampleGenerators,
    plan: Option<Redistribution>,
    pub(crate) redistributor: Redistributor<(), Path>,
    carried: Carried,
    pub(crate) light: Light,
    pub(crate) nonfinite: Nonfinite,
}

/// What there is of a stream between two passes.
#[derive(Serialize, Deserialize)]
pub(crate) struct Kept {
    ladder: u32,
    step: u64,
    statistics: RedistributionStatistics,
    light: Light,
    nonfinite: Nonfinite,
    carried: Carried,
}

/// Sums of light over samples.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Light {
    /// Scalar of each sample: what is to be spread, and all.
    pub(crate) spread: Mean,
    pub(crate) all: Mean,
    pub(crate) sums: EnergySums,
}

impl Light {
    pub(crate) fn merge(&mut self, other: &Self) {
        self.spread.merge(&other.spread);
        self.all.merge(&other.all);
        self.sums.merge(&other.sums);
    }
}

impl Stream {
    pub(crate) fn new(
        settings: &RenderSettings,
        ladder: u32,
        plan: Option<Redistribution>,
    ) -> Self {
        let seed = settings.seed;
        Self {
            ladder,
            step: 0,
            samples: SampleGenerators::new(seed, u64::from(ladder)),
            chains: SampleGenerators::new(seed, streams::chains(ladder)),
            plan,
            redistributor: Redistributor::new(),
            carried: Carried::new(settings, ladder),
            light: Light::default(),
            nonfinite: Nonfinite::default(),
        }
    }

    pub(crate) fn kept(&self) -> Kept {
        Kept {
            ladder: self.ladder,
            step: self.step,
            statistics: self.redistributor.statistics().clone(),
            light: self.light,
            nonfinite: self.nonfinite,
            carried: self.carried.clone(),
        }
    }

    /// Refuses what no stream of this ladder has written; passes are whole.
    pub(crate) fn take_up(&mut self, kept: Kept, cells: &Cells) -> Result<(), StateError> {
        let [first, end] = cells.of_ladder(self.ladder);
        let (step, light) = (Reader::count(kept.step)?, &kept.light);
        check_redistribution(&kept.statistics)?;
        let sums = [light.spread.count(), light.all.count()];
        if kept.ladder != self.ladder || step % (end - first).max(1) != 0 || sums != [step; 2] {
            return Err(StateError::damaged("a stream does not agree with itself"));
        }
        self.go_to(Kept {
            nonfinite: kept.nonfinite.checked()?,
            carried: self.carried.checked(kept.carried)?,
            ..kept
        });
        Ok(())
    }

    /// As the one was that has left this behind.
    pub(crate) fn go_to(&mut self, kept: Kept) {
        self.carried = kept.carried;
        self.step = kept.step;
        self.redistributor = Redistributor::new().with_statistics(kept.statistics);
        self.light = kept.light;
        self.nonfinite = kept.nonfinite;
    }

    pub(crate) fn run(&mut self, job: &Job<'_>, steps: u64) {
        if steps == 0 {
            return;
        }
        let mut tour = Tour::new(&job.cells, self.ladder, self.step);
        let seed = mix(job.seed);
        let mut starter = Starter::new(job.space, job.options);
        for _ in 0..steps {
            if is_stopped(job.stop) {
                return;
            }
            if tour.begins() && job.options.energy == Energy::Passes {
                self.plan = redistribution(job.options, self.expected(job));
            }
            let mut draws = self.samples.at(self.step);
            // All that is asked of these is stratified: nothing is drawn twice.
            let mut at = tour.confine(seed, Independent::new(self.samples.at(self.step)));
            let [x, y] = at.get2(Axis::Camera, 0);
            let start = (DVec2::new(x, y), at.get(Axis::Wavelength, 0));
            tour.go_on();
            let share = self.carried.at(self.step);
            self.redistributor.carry(share.as_deref().copied());
            let mut spread = Spread {
                job,
                plan: self.plan.as_ref(),
                redistributor: &mut self.redistributor,
                light: &mut self.light,
                draws: self.chains.at(self.step),
                sample: [0.0; 2],
                bad: 0,
            };
            let before = spread.redistributor.statistics().chain.defects;
            starter.sample(start, &mut draws, &mut |path, weight| {
                spread.start(path, weight);
            });
            let ([some, all], bad) = (spread.sample, spread.bad);
            if let (Some(share), Some(left)) = (share, self.redistributor.carried()) {
                *share = left;
            }
            // A sample whose chains may have been broken off is none.
            if is_stopped(job.stop) {
                return;
            }
            self.light.spread.push(some);
            self.light.all.push(all);
            let defects = self.redistributor.statistics().chain.defects - before;
            self.nonfinite.count(bad + defects, self.step);
            self.step += 1;
        }
    }

    /// Tells what happens in the sample of this number. How many chains it has follows from the samples of
    /// its cell before it, with [`Energy::Passes`] from all samples before it: these are taken first.
    pub(crate) fn replay(&mut self, job: &Job<'_>, step: u64) -> Vec<Event> {
        match job.options.energy {
            Energy::Pilot => self.carry_to(job, step),
            Energy::Passes => self.run(job, step),
        }
        trace(|| self.run(job, 1)).1
    }

    /// To before this sample, by way of those of its cell alone.
    fn carry_to(&mut self, job: &Job<'_>, step: u64) {
        let [first, end] = job.cells.of_ladder(self.ladder);
        let count = end - first;
        for earlier in (step % count..step).step_by(count as usize) {
            self.step = earlier;
            self.run(job, 1);
        }
        self.step = step;
    }

    /// Light of a sample by all passes so far; the pilot counts as one of them.
    fn expected(&self, job: &Job<'_>) -> f64 {
        let [first, end] = job.cells.of_ladder(self.ladder);
        let (pass, so_far) = ((end - first) as f64, self.light.spread);
        let count = so_far.count() as f64;
        (job.pilot * pass + so_far.mean() * count) / (pass + count)
    }
}

/// One sample's light on its way.
struct Spread<'a, D> {
    job: &'a Job<'a>,
    plan: Option<&'a Redistribution>,
    redistributor: &'a mut Redistributor<(), Path>,
    light: &'a mut Light,
    draws: D,
    /// Scalar of the light to be spread, and of all.
    sample: [f64; 2],
    /// Paths whose weight was no number.
    bad: u64,
}

impl<D: Draws> Spread<'_, D> {
    /// One of the sample's paths with its weight.
    fn start(&mut self, path: &Path, weight: f64) {
        if path.edges() > 0 {
            self.job.space.tell(path, Role::Sampled(weight));
        }
        if !weight.is_finite() {
            self.bad += 1;
            return;
        }
        if weight <= 0.0 {
            return;
        }
        self.sample[1] += weight;
        let spread = self.job.perturbations.suit(path);
        if spread {
            self.sample[0] += weight;
        }
        match self.plan.filter(|_| spread) {
            Some(plan) => self.run_chains(plan, path, weight),
            None => {
                add(&mut self.light.sums.unperturbed, path.colour(), weight);
                self.job.films.leave(path, weight);
            }
        }
    }

    /// Spreads a path's weight over chains that begin there.
    fn run_chains(&mut self, plan: &Redistribution, path: &Path, weight: f64) {
        let (options, films) = (self.job.options, self.job.films);
        let light = &mut self.light.sums;
        add(&mut light.seeded, path.colour(), weight);
        let printed = options.deposit == Colours::Printed;
        let deposit = |deposit: Deposit<'_, Path>| {
            let of = if printed { path } else { deposit.value };
            let colour = of.colour();
            add(
                &mut light.deposited,
                colour,
                deposit.weight() + deposit.held,
            );
            films.deposit(&deposit, colour);
        };
        let stop = self.job.stop;
        let mut deposit = UntilStopped { deposit, stop };
        let Self {
            job,
            redistributor,
            draws,
            ..
        } = self;
        // Perturbations keep the time: all chains of a path are at its instant.
        job.space.at(path.time(), |space| {
            let family = |path: &Path| [path.density()];
            let kernel = Told {
                kernel: job.perturbations.within(space).kernel(),
                family,
                space,
                names: &NAMES,
            };
            redistributor.run(
                plan,
                (&(), path, weight),
                &kernel,
                &family,
                draws,
                &mut deposit,
            );
        });
    }
}
