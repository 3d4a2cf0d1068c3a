//! Metropolis light transport on paths (Veach and Guibas 1997).
//!
//! A pool of independent samples, each a pair of walks joined in every way, estimates b, the integral of the
//! paths' density; each chain starts at a path chosen from the pool in proportion to its weight, so
//! that b / M times the visits of M mutations are an unbiased picture from the first step on. Between
//! mutations further samples are made, so that b becomes better while the picture does: with them the picture is
//! consistent; `normaliser=initial` does without them and is unbiased.

mod keep;
mod mixture;
mod pool;

use std::ops::Range;
use std::sync::atomic::AtomicBool;

use glam::DVec2;
use kaustik_estimate::RasterMap;
use kaustik_film::{Counters, Film, Image, Quantum, develop};
use kaustik_mcmc::{Estimate, Mean, Metropolis, Pcg64Dxsm, Pool, Statistics, Visit};
use kaustik_mutate::{Path, PathSpace, Seeds, Told, WrittenPath};
use kaustik_path::{Event, Role};
use kaustik_scene::Scene;
use serde::{Deserialize, Serialize};

use crate::beside::Besides;
use crate::beside::lamps::Lamps;
use crate::beside::meter::{Fit, Meter, OwnSamples};
use crate::chains::{self, LadderChain};
use crate::control::is_stopped;
use crate::engine::{Engine, Nonfinite, STRIDE, add_counters, add_nonfinite};
use crate::methods::path_space::path_space;
use crate::{
    ChainStatistics, MutationKind, MutationStatistics, Normaliser, Options, RenderError,
    RenderSettings, StepId,
};
use mixture::mixture;

/// A sample for so many mutations: it takes the time of a few.
const EACH: u64 = 64;
/// Mutations for each cell of a pass of a [`Meter`]: a fifth of the time or so.
const METERED: u64 = 320;

/// Chains on a film.
pub(crate) struct MltEngine<'a> {
    space: PathSpace<'a>,
    options: Options,
    /// What the density of a path is multiplied by, where it falls.
    map: RasterMap,
    chains: Vec<Chain>,
    film: Film,
    besides: Besides<'a>,
    pool: Mean,
    size: DVec2,
    /// Of this process; where the pool is dark they have no chains.
    ladders: Range<u32>,
    /// Steps that ladders without chains were given: lamps keep up with them, and a budget comes to its end.
    idle: Vec<u64>,
}

/// One ladder; its path in this form or in that to be written.
#[derive(Serialize, Deserialize)]
struct Chain<M = Metropolis<(), Path, 1>> {
    ladder: u32,
    nonfinite: Nonfinite,
    draws: Pcg64Dxsm,
    /// Makes the samples between mutations.
    fresh: Pcg64Dxsm,
    independent: Mean,
    metropolis: M,
}

/// As it is kept.
type Kept = Chain<Metropolis<(), WrittenPath, 1>>;

/// The weight of a path's place in the image.
fn weight(map: &RasterMap, path: &Path) -> f64 {
    let raster = path.raster();
    map.at([raster.x, raster.y])
}

/// The family of one density.
fn density(map: &RasterMap) -> impl Fn(&Path) -> [f64; 1] {
    |path| [path.density() * weight(map, path)]
}

impl<'a> MltEngine<'a> {
    /// Fills the pool and starts the chains.
    pub(crate) fn new(scene: &'a Scene, settings: &RenderSettings) -> Result<Self, RenderError> {
        let besides = Besides::of_lamps(Lamps::new(scene, settings)?);
        let mut engine = Self::with_map(scene, settings, RasterMap::even(), besides)?;
        if engine.pool.mean() > 0.0 {
            let own = OwnSamples {
                variance: engine.pool.variance(),
                per_mutation: 1.0 / EACH as f64,
            };
            let fit = Fit {
                mutations_a_cell: METERED,
                unit: engine.space.settings.window_area(),
            };
            engine.besides.meter = Meter::new(scene, settings, own, fit);
        }
        Ok(engine)
    }

    /// With these weights on the image.
    pub(crate) fn with_map(
        scene: &'a Scene,
        settings: &RenderSettings,
        map: RasterMap,
        besides: Besides<'a>,
    ) -> Result<Self, RenderError> {
        let options = settings.options;
        let size = DVec2::new(f64::from(settings.width), f64::from(settings.height));
        let space = path_space(scene, settings)?;
        let pool = Pool::new(pool::weights(&space, &map, settings));
        let b = pool.normaliser().mean();
        Ok(Self {
            chains: pool::start_chains(&space, &map, &pool, settings),
            film: Film::with_layout(&settings.layout(), Quantum::from_sum_of_xyz(b))?,
            besides,
            pool: *pool.normaliser(),
            space,
            options,
            map,
            size,
            ladders: settings.ladder_range(),
            idle: vec![0; settings.ladder_range().len()],
        })
    }

    fn drive(&self, chain: &mut Chain, steps: u64, stop: Option<&AtomicBool>) {
        let (mut seeds, mut path) = (Seeds::new(&self.space), Path::default());
        let mut left = steps;
        while left > 0 {
            let fresh = (&mut seeds, &mut path);
            let time = chain.metropolis.value().time();
            let drive = |space: &PathSpace<'_>| self.drive_at(space, chain, fresh, left, stop);
            match self.space.at(time, drive) {
                0 => return,
                taken => left -= taken,
            }
        }
    }

    /// Drives the chain for as long as its path stays at its time, where the space is: so much longer than a
    /// step that nothing is lost by going there. Returns the steps taken, none where it was stopped at once.
    fn drive_at(
        &self,
        space: &PathSpace<'_>,
        chain: &mut Chain,
        (seeds, path): (&mut Seeds<'_>, &mut Path),
        steps: u64,
        stop: Option<&AtomicBool>,
    ) -> u64 {
        let kernel = Told {
            kernel: mixture(space, &self.options, self.size),
            family: density(&self.map),
            space,
            names: &MutationKind::NAMES,
        };
        let density = density(&self.map);
        let mut record = |visit: Visit<'_, Path, 1>| self.deposit(&visit);
        let running = self.options.normaliser == Normaliser::Running
            && !self.besides.meter.as_ref().is_some_and(Meter::is_alone);
        let instant = chain.metropolis.value().time();
        for done in 0..steps {
            let moved_on = chain.metropolis.value().time().total_cmp(&instant).is_ne();
            if moved_on || (done % STRIDE == 0 && is_stopped(stop)) {
                return done;
            }
            let step = chain.metropolis.statistics().steps;
            if running && step % EACH == 0 {
                let sampled = seeds.sample(path, &mut chain.fresh);
                if sampled > 0.0 {
                    space.tell(path, Role::Sampled(sampled));
                }
                chain.see(sampled * weight(&self.map, path), step);
            }
            (chain.metropolis).step(&kernel, &density, &mut chain.draws, &mut record);
        }
        steps
    }

    /// These and the samples between mutations, of which there are none where a meter does without them.
    fn with_own(&self, mut mean: Mean) -> Mean {
        for chain in &self.chains {
            mean.merge(&chain.independent);
        }
        mean
    }

    /// The estimate of `b` that scales the image: independent samples all, and so its standard error is
    /// theirs.
    fn normaliser(&self) -> Estimate {
        match &self.besides.meter {
            Some(meter) => meter.with(&self.with_own(Mean::new())),
            None => self.with_own(self.pool).into(),
        }
    }

    /// Adds the pool's `b` times the path's colour, whose scalar is 1, at its raster point, over the weight
    /// that its density has there.
    fn deposit(&self, visit: &Visit<'_, Path, 1>) {
        let at = visit.value.raster() * self.size;
        let weight = visit.weight * self.pool.mean() / weight(&self.map, visit.value);
        if weight > 0.0 {
            (self.film).splat_weighted(at.x, at.y, visit.value.colour(), weight);
        }
    }

    fn statistics(&self) -> Statistics<1> {
        chains::statistics(&self.chains)
    }

    /// Counts steps without a chain: how many there are now, and in all.
    fn idle(&mut self, plan: &[u64]) -> [u64; 2] {
        for (idle, n) in self.idle.iter_mut().zip(plan) {
            *idle = idle.saturating_add(*n);
        }
        [plan, &self.idle].map(|steps| steps.iter().copied().fold(0, u64::saturating_add))
    }
}

impl<V: Default> LadderChain for Chain<Metropolis<(), V, 1>> {
    fn ladder(&self) -> u32 {
        self.ladder
    }

    fn statistics(&self) -> &Statistics<1> {
        self.metropolis.statistics()
    }
}

impl Chain {
    /// Counts a sample made between mutations.
    fn see(&mut self, weight: f64, step: u64) {
        if weight.is_finite() {
            self.independent.push(weight);
        } else {
            self.nonfinite.count(1, step);
        }
    }
}

impl Engine for MltEngine<'_> {
    fn advance(&mut self, plan: &[u64], stop: Option<&AtomicBool>) -> u64 {
        let mut chains = std::mem::take(&mut self.chains);
        let [taken, steps] = match chains.is_empty() {
            true => self.idle(plan),
            false => chains::advance(&mut chains, plan, |chain, steps| {
                self.drive(chain, steps, stop);
            }),
        };
        self.chains = chains;
        self.besides.keep_up(steps);
        taken
    }

    fn develop(&mut self) -> Result<Image, RenderError> {
        let mut chains = std::mem::take(&mut self.chains);
        for chain in &mut chains {
            let mut record = |visit: Visit<'_, Path, 1>| self.deposit(&visit);
            chain.metropolis.flush(&mut record);
        }
        self.chains = chains;
        let steps = self.statistics().steps.max(1);
        let per_step = self.size.element_product() / steps as f64;
        // where the pool saw no light the film is empty
        let scale = match self.pool.mean() {
            mean if mean > 0.0 => self.normaliser().value / mean,
            _ => 0.0,
        };
        let mut films = vec![(&self.film, scale * per_step)];
        films.extend(self.besides.parts());
        Ok(develop(&films)?)
    }

    fn chain_statistics(&self) -> Option<ChainStatistics> {
        let statistics = self.statistics();
        let b = self.normaliser();
        Some(ChainStatistics {
            // What keeps most of a path, and what may make all of it anew.
            small_acceptance: rate(
                &statistics,
                &[
                    MutationKind::Lens,
                    MutationKind::Multichain,
                    MutationKind::Caustic,
                    MutationKind::Every,
                ],
            ),
            large_acceptance: rate(&statistics, &[MutationKind::Bidirectional]),
            metered: (self.besides.meter.as_ref())
                .map_or(0.0, |meter| meter.share(&self.with_own(Mean::new()))),
            ..ChainStatistics::new(&statistics, [b.value, b.standard_error], self.pool.mean())
        })
    }

    fn mutation_statistics(&self) -> Vec<MutationStatistics> {
        let statistics = self.statistics();
        let kinds = MutationKind::NAMES.iter().zip(&statistics.moves);
        kinds
            .map(|(name, moves)| MutationStatistics {
                name,
                proposed: moves.proposed,
                acceptance: moves.rate(),
            })
            .collect()
    }

    fn nonfinite(&self) -> (u64, Vec<StepId>) {
        let places = self.chains.iter().filter_map(|chain| {
            let step = chain.metropolis.statistics().first_defect?;
            let ladder = chain.ladder;
            Some(StepId { ladder, step })
        });
        let proposed = (self.statistics().defects, places.collect());
        let chains = self.chains.iter();
        let fresh = Nonfinite::all(chains.map(|chain| (chain.ladder, chain.nonfinite)));
        let own = add_nonfinite(proposed, Some(fresh));
        add_nonfinite(own, Some(self.besides.nonfinite()))
    }

    /// What is beside the chains has no part in it.
    fn replay(&mut self, place: StepId) -> Result<Vec<Event>, RenderError> {
        let mut chains = std::mem::take(&mut self.chains);
        let events = chains::replay(&mut chains, place, |chain, steps| {
            self.drive(chain, steps, None);
        });
        self.chains = chains;
        Ok(events)
    }

    fn film_counters(&self) -> Counters {
        add_counters(self.film.counters(), self.besides.film_counters())
    }

    fn is_lit(&self) -> bool {
        // without chains lamps go on looking for what their first pass has not met
        let may_find = self.besides.lamps.is_some() && self.space.scene.has_light();
        self.pool.mean() > 0.0 || may_find
    }
}

/// Mean acceptance of several kinds.
fn rate(statistics: &Statistics<1>, kinds: &[MutationKind]) -> f64 {
    let sum = |of: fn(&kaustik_mcmc::Acceptance) -> f64| -> f64 {
        (kinds.iter())
            .map(|&kind| of(&statistics.moves[kind as usize]))
            .sum()
    };
    sum(|moves| moves.expected) / sum(|moves| moves.proposed as f64).max(1.0)
}
