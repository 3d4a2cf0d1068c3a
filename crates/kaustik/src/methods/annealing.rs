//! Population annealing alone as a renderer (RELT sec. 6).

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use kaustik_estimate::{PathTarget, ReplicaFamily, ReplicaSet, ReplicaWeights, Scale};
use kaustik_film::{Counters, Film, Image, Layer, Quantum, develop};
use kaustik_mcmc::{
    Estimate, Extinct, Metropolis, Point, Population, Resampling, SampleGenerators, generator,
};
use kaustik_path::{Contributions, Event, PathBuilder};
use kaustik_scene::Scene;
use rayon::prelude::*;

use crate::beside::Besides;
use crate::beside::lamps::Lamps;
use crate::control::is_stopped;
use crate::engine::{Engine, Nonfinite, add_counters, add_nonfinite};
use crate::mark::FilmMark;
use crate::methods::relt::climb::MOVES;
use crate::methods::relt::kernels::{Mutation, kernel, kernels, mutation};
use crate::methods::relt::start::{
    Started, State, for_so_many_replicas, replica_builder, samples, start,
};
use crate::methods::relt::{finite, full_replica, layer};
use crate::{
    Budget, ChainStatistics, RenderError, RenderSettings, ReplicaLevel, ReplicaStatistics, StepId,
    Steps,
};
use deposit::{AnnealedDeposit, Gathered};
use step::Step;
use told::{Level, Told};

mod deposit;
mod keep;
mod replay;
mod step;
mod told;

/// Particles that one thread moves at a time.
const CHUNK: usize = 64;

/// Anneals once for the constants of the weights and to see which replicas there are.
pub(crate) fn engine<'a>(
    scene: &'a Scene,
    settings: &RenderSettings,
) -> Result<Box<dyn Engine + 'a>, RenderError> {
    with_builder(scene, settings, Box::new(replica_builder(settings)))
}

/// The same with any builder.
pub(crate) fn with_builder<'a>(
    scene: &'a Scene,
    settings: &RenderSettings,
    builder: Box<dyn PathBuilder + 'a>,
) -> Result<Box<dyn Engine + 'a>, RenderError> {
    let started = start(scene, builder.as_ref(), settings);
    Ok(for_so_many_replicas!(
        AnnealingEngine,
        scene,
        builder,
        settings,
        started
    ))
}

/// Fresh populations, one after the other, on one film.
///
/// A round draws N independent paths and takes them up all levels. Of every level k, all that its particles
/// visit is splatted with the round's own `Z_k`: for any weights that sum to 1 and were fixed before,
/// every round's picture is unbiased, extinct ones with their zeros included, and rounds are
/// independent. So nothing is ever to be forgotten, and nothing found is kept. Ladders take rounds in turn.
struct AnnealingEngine<'a, const K: usize> {
    scene: &'a Scene,
    builder: Box<dyn PathBuilder + 'a>,
    set: ReplicaSet,
    steps: Steps,
    family: ReplicaFamily<K>,
    weights: ReplicaWeights<K>,
    rough: [Estimate; K],
    film: Film,
    besides: Besides<'a>,
    scale: Scale,
    /// Raster area of the window in pixels.
    area: f64,
    seed: u64,
    particles: u64,
    effective: Vec<[f64; 2]>,
    dropped: Option<String>,
    lit: bool,
    /// Ladders of the whole: round r belongs to ladder r modulo their number.
    of: u32,
    /// Those of this process.
    told: Vec<Told<K>>,
    /// Where the last round ended.
    mark: FilmMark,
}

impl<'a, const K: usize> AnnealingEngine<'a, K> {
    fn new(
        scene: &'a Scene,
        builder: Box<dyn PathBuilder + 'a>,
        settings: &RenderSettings,
        started: Started,
    ) -> Result<Self, RenderError> {
        let options = settings.options;
        let set = options.replica_set();
        let rough: [Estimate; K] = std::array::from_fn(|k| started.rough[k]);
        let specific = set.is_specific() && K == set.count();
        let layout = settings.layout();
        Ok(Self {
            scene,
            builder,
            set,
            steps: options.steps,
            family: ReplicaFamily::new(&set, options.target),
            weights: ReplicaWeights::new(rough.map(|b| b.value), options.beta, specific),
            rough,
            film: Film::with_layout(&layout, Quantum::from_sum_of_xyz(started.mean))?,
            besides: Besides::of_lamps(Lamps::new(scene, settings)?),
            scale: settings.scale(),
            area: layout.extended_bounds().area(),
            seed: settings.seed,
            particles: options.particles,
            effective: started.effective,
            dropped: started.dropped,
            lit: started.mean > 0.0,
            of: options.ladders,
            told: settings.ladder_range().map(Told::of).collect(),
            mark: FilmMark::default(),
        })
    }

    /// Rounds of all ladders of this process.
    fn rounds(&self) -> u64 {
        self.told.iter().map(|told| told.rounds).sum()
    }

    /// The rounds of all ladders, in their order.
    fn told(&self) -> Told<K> {
        let mut all = Told::of(0);
        self.told.iter().for_each(|told| all.merge(told));
        all
    }

    /// How many of the first so many rounds of the whole fall to the ladders of this process.
    fn share(&self, rounds: u64) -> u64 {
        let of = u64::from(self.of);
        let shares = self.told.iter().map(|told| {
            let (all, rest) = (rounds / of, rounds % of);
            all + u64::from(u64::from(told.ladder) < rest)
        });
        shares.sum()
    }

    /// Paths that a round evaluates.
    fn cost(&self) -> u64 {
        self.particles * (1 + (K as u64 - 1) * MOVES as u64)
    }

    /// One population from the bottom to the top: the next round of the whole that falls to this process.
    /// `false`: it was stopped, and nothing of it is left.
    fn round(&mut self, stop: Option<&AtomicBool>) -> bool {
        let next = (0..self.told.len()).min_by_key(|&at| self.told[at].rounds);
        let Some(at) = next else {
            return true;
        };
        let before = stop.map(|_| self.told[at].clone());
        if before.is_some() {
            self.mark.set(&self.film);
        }
        self.climb_all(at, stop);
        match before {
            Some(before) if is_stopped(stop) => {
                self.mark.take_back(&mut self.film);
                self.told[at] = before;
                false
            }
            _ => true,
        }
    }

    /// The next round of one of the ladders; only a part of it if it is stopped.
    fn climb_all(&mut self, at: usize, stop: Option<&AtomicBool>) {
        let told = self.told[at].next();
        let round = self.told[at].rounds;
        let nonfinite = AtomicU64::new(0);
        let target = target(self.scene, self.builder.as_ref(), &nonfinite);
        let kernels = kernels::<K>(target, &self.set, self.steps);
        let Some(samples) = self.samples(target, told(0), stop) else {
            return;
        };
        let mut faults = self.faults(round, &samples);
        let mut population =
            Population::from_samples(samples, &self.family, Resampling::Systematic);
        let mut central = generator(self.seed, told(K));
        let mut light = [0.0; K];
        let mut normalisers = [0.0; K];
        for (level, kernel) in kernels.iter().enumerate() {
            if is_stopped(stop) {
                return;
            }
            match population.advance(level, kernel, &mut central) {
                Ok(stage) => normalisers[level] = stage.normaliser.value,
                Err(Extinct { .. }) => break,
            }
            let gathered = if level == 0 {
                self.show(population.particles())
            } else {
                let generators = SampleGenerators::new(self.seed, told(level));
                let of = (round, level, normalisers[level]);
                self.climb(of, &generators, &mut population, stop)
            };
            faults = faults.and(gathered.nonfinite);
            light[level] = gathered.light;
            self.told[at].gather(level, &gathered);
        }
        self.told[at].end_round(&normalisers, &light, faults);
    }

    /// A round's independent samples, from generators of this ladder; `None` if it was stopped.
    fn samples(
        &self,
        target: PathTarget<'_>,
        ladder: u64,
        stop: Option<&AtomicBool>,
    ) -> Option<Vec<State>> {
        let first = mutation(&self.set, self.steps, 0);
        let count = (self.particles, stop);
        samples(target, &self.family, &first, self.seed, ladder, count)
    }

    /// What was not finite in the samples of a round.
    fn faults(&self, round: u64, samples: &[State]) -> Nonfinite {
        let mut faults = Nonfinite::default();
        for ((_, value), at) in samples.iter().zip(0..) {
            let step = self.number(Step::sample(round, at));
            faults.count(u64::from(value.nonfinite()), step);
        }
        faults
    }

    /// The number of a step among all of its ladder.
    fn number(&self, step: Step) -> u64 {
        step.number(self.particles, self.cost())
    }

    fn deposit(&self, level: usize, normaliser: f64, each: u64) -> AnnealedDeposit<'_, K> {
        AnnealedDeposit {
            film: &self.film,
            scale: self.scale,
            weights: self.weights,
            // the round's normaliser over the constant in the weights: of all the visits of a level
            factor: normaliser / self.rough[level].value / (self.particles * each) as f64,
            gathered: Gathered::default(),
        }
    }

    /// Splats the independent samples.
    fn show(&self, particles: &[Particle<K>]) -> Gathered<K> {
        let show = |particles: &[Particle<K>]| {
            let mut deposit = self.deposit(0, 1.0, 1);
            for particle in particles {
                deposit.sample(particle.value(), particle.densities());
            }
            deposit.gathered
        };
        Gathered::all(particles.par_chunks(CHUNK).map(show).collect())
    }

    /// Moves the particles under their level's density and splats what they visit.
    fn climb(
        &self,
        (round, level, normaliser): (u64, usize, f64),
        generators: &SampleGenerators,
        population: &mut Climbing<K>,
        stop: Option<&AtomicBool>,
    ) -> Gathered<K> {
        let climb = |(chunk, particles): (usize, &mut [Particle<K>])| {
            let mut deposit = self.deposit(level, normaliser, MOVES as u64);
            if is_stopped(stop) {
                return deposit.gathered;
            }
            // Its own, so that each fault is known to be of the step that has just been taken.
            let nonfinite = AtomicU64::new(0);
            let target = target(self.scene, self.builder.as_ref(), &nonfinite);
            let kernel = kernel(target, &self.set, self.steps, level);
            for (particle, at) in particles.iter_mut().zip((chunk * CHUNK) as u64..) {
                let mut draws = generators.at(at);
                for step in 0..MOVES as u64 {
                    let accepted = particle.step(&kernel, &self.family, &mut draws, &mut deposit);
                    if nonfinite.load(Ordering::Relaxed) > 0 {
                        let faults = nonfinite.swap(0, Ordering::Relaxed);
                        let number = self.number(Step::new(round, level, at, step));
                        deposit.gathered.nonfinite.count(faults, number);
                    }
                    deposit.gathered.accepted += u64::from(accepted);
                    deposit.gathered.moves += 1;
                }
                particle.flush(&mut deposit);
            }
            deposit.gathered
        };
        let chunks = population.particles_mut().par_chunks_mut(CHUNK).enumerate();
        Gathered::all(chunks.map(climb).collect())
    }
}

fn target<'a>(
    scene: &'a Scene,
    builder: &'a dyn PathBuilder,
    nonfinite: &'a AtomicU64,
) -> PathTarget<'a> {
    PathTarget {
        scene,
        builder,
        nonfinite,
    }
}

/// A path that climbs.
type Particle<const K: usize> = Metropolis<Point<Mutation>, Contributions, K>;

/// A round's paths.
type Climbing<const K: usize> = Population<Point<Mutation>, Contributions, K>;

impl<const K: usize> Engine for AnnealingEngine<'_, K> {
    fn advance(&mut self, plan: &[u64], stop: Option<&AtomicBool>) -> u64 {
        let rounds = plan.iter().sum::<u64>() / self.cost();
        let before = self.rounds();
        for _ in 0..rounds {
            if is_stopped(stop) || !self.round(stop) {
                break;
            }
        }
        let steps = self.rounds() * self.cost();
        self.besides.keep_up(steps);
        steps - before * self.cost()
    }

    /// All rounds of this process, on the account of its first ladder.
    fn planned(&self, ladder: u32, settings: &RenderSettings) -> u64 {
        if ladder != settings.ladder_range().start {
            return 0;
        }
        let cost = self.cost();
        let steps = match settings.budget {
            Budget::Time(_) => return u64::MAX / cost * cost,
            Budget::PerPixel(n) => n.saturating_mul(settings.pixels()),
            Budget::Total(n) => n,
        };
        // one at least
        self.share((steps / cost).max(u64::from(steps > 0))) * cost
    }

    fn grain(&self, _ladder: u32) -> u64 {
        self.cost()
    }

    fn develop(&mut self) -> Result<Image, RenderError> {
        let mut parts = vec![(&self.film, self.area / self.rounds().max(1) as f64)];
        parts.extend(self.besides.parts());
        Ok(develop(&parts)?)
    }

    fn holds_back(&self) -> bool {
        false
    }

    fn layers(&self) -> Result<Vec<Layer>, RenderError> {
        let direct = self.besides.parts().map(|part| layer("direct", part));
        direct.collect()
    }

    fn chain_statistics(&self) -> Option<ChainStatistics> {
        let told = self.told();
        let sum = |of: fn(&Level) -> u64| told.levels.iter().map(of).sum::<u64>();
        let moves = sum(|level| level.moves).max(1);
        Some(ChainStatistics {
            small_acceptance: sum(|level| level.accepted) as f64 / moves as f64,
            large_acceptance: 1.0,
            normalisation: told.light.mean(),
            normalisation_error: told.light.standard_error(),
            metered: 0.0,
            b0: self.rough[full_replica::<K>()].value,
            longest_stay: 0,
            defects: 0,
        })
    }

    fn replica_statistics(&self) -> Option<ReplicaStatistics> {
        let told = self.told();
        let level = |(k, level): (usize, &Level)| ReplicaLevel {
            weights: self.set.rows()[k],
            rough: self.rough[k].value,
            rough_error: finite(self.rough[k].standard_error),
            normalisation: level.normaliser.mean(),
            normalisation_error: finite(level.normaliser.standard_error()),
            independent: level.independent.mean(),
            independent_error: finite(level.independent.standard_error()),
            // both are unbiased, and made of the same samples
            discrepancy: None,
            share: level.share.mean(),
            share_error: finite(level.share.standard_error()),
            scale: 1.0,
            effective_at_once: self.effective[k][0],
            effective_annealed: self.effective[k][1],
            acceptance: level.accepted as f64 / level.moves.max(1) as f64,
            step: mutation(&self.set, self.steps, k).sizes().1,
        };
        Some(ReplicaStatistics {
            levels: told.levels.iter().enumerate().map(level).collect(),
            sweeps: told.rounds,
            exchange_acceptance: Vec::new(),
            permutation_acceptance: None,
            pairs: Vec::new(),
            even: 0,
            scouts: 0,
            scouts_found: 0,
            scouts_followed: 0,
            tours: 0,
            tours_followed: 0,
            tour_steps: 0,
            tour_acceptance: 0.0,
            round_trips: 0,
            particles: self.particles,
            dropped: self.dropped.clone(),
            normaliser: "initial",
        })
    }

    fn nonfinite(&self) -> (u64, Vec<StepId>) {
        let told = self.told.iter();
        let own = Nonfinite::all(told.map(|told| (told.ladder, told.nonfinite)));
        add_nonfinite(own, Some(self.besides.nonfinite()))
    }

    fn replay(&mut self, place: StepId) -> Result<Vec<Event>, RenderError> {
        self.told_again(place)
    }

    fn film_counters(&self) -> Counters {
        add_counters(self.film.counters(), self.besides.film_counters())
    }

    fn is_lit(&self) -> bool {
        self.lit || self.besides.is_lit()
    }
}
