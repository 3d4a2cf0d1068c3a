//! Population annealing alone as a renderer (RELT sec. 6; spec: relt.md 7).

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use kaustik_estimate::{PathTarget, ReplicaFamily, ReplicaSet, ReplicaWeights, Scale};
use kaustik_film::{Counters, Film, Image, Layer, Quantum, develop};
use kaustik_mcmc::{
    Estimate, Extinct, LevelKernel, Mean, Metropolis, Point, Population, Resampling,
    SampleGenerators, generator,
};
use kaustik_path::{Bidirectional, Contributions};
use kaustik_scene::Scene;
use rayon::prelude::*;

use crate::control::is_stopped;
use crate::engine::{Engine, add_counters, add_nonfinite};
use crate::lamps::Lamps;
use crate::relt::start::{
    MOVES, Mutation, Started, for_so_many_replicas, kernels, mutation, replica_builder, samples,
    start,
};
use crate::relt::{known, layer};
use crate::{
    Budget, ChainStatistics, Place, RenderError, RenderSettings, ReplicaLevel, ReplicaStatistics,
    Steps,
};
use deposit::{AnnealedDeposit, Gathered};

mod deposit;

/// Particles that one thread moves at a time.
const CHUNK: usize = 64;

/// Anneals once for the constants of the weights and to see which replicas there are.
pub(crate) fn engine<'a>(
    scene: &'a Scene,
    settings: &RenderSettings,
) -> Result<Box<dyn Engine + 'a>, RenderError> {
    let set = settings.options.replica_set();
    if !set.is_line() {
        return Err(RenderError::Setting {
            what: "replicas",
            found: set.to_string(),
            expected: "replicas that each stand on the one before: populations climb a line"
                .to_owned(),
        });
    }
    let builder = replica_builder(settings);
    let started = start(scene, &builder, settings);
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
/// every round's picture is unbiased (spec relt.md (9)), extinct ones with their zeros included, and rounds are
/// independent. So nothing is ever to be forgotten, and nothing found is kept.
struct AnnealingEngine<'a, const K: usize> {
    scene: &'a Scene,
    builder: Bidirectional,
    set: ReplicaSet,
    steps: Steps,
    family: ReplicaFamily<K>,
    weights: ReplicaWeights<K>,
    rough: [Estimate; K],
    film: Film,
    direct: Option<Lamps<'a>>,
    scale: Scale,
    /// Raster area of the window in pixels.
    area: f64,
    seed: u64,
    /// All rounds of this process belong to its first ladder.
    ladder: u32,
    particles: u64,
    effective: Vec<[f64; 2]>,
    dropped: Option<String>,
    lit: bool,
    rounds: u64,
    levels: [Level; K],
    /// Light of each round.
    light: Mean,
    nonfinite: AtomicU64,
}

/// What rounds have told of a level.
#[derive(Clone, Copy, Debug, Default)]
struct Level {
    /// `Z_k` of each round, zero where the population died before.
    normaliser: Mean,
    /// The density of independent samples.
    independent: Mean,
    /// Light of the level in each round.
    share: Mean,
    moves: u64,
    accepted: u64,
}

impl<'a, const K: usize> AnnealingEngine<'a, K> {
    fn new(
        scene: &'a Scene,
        builder: Bidirectional,
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
            film: Film::with_layout(&layout, Quantum::from_mean(started.mean / 3.0))?,
            direct: Lamps::new(scene, settings)?,
            scale: Scale {
                width: f64::from(settings.width),
                height: f64::from(settings.height),
            },
            area: layout.extended_bounds().area(),
            seed: settings.seed,
            ladder: settings.ladder_range().start,
            particles: options.particles,
            effective: started.effective,
            dropped: started.dropped,
            lit: started.mean > 0.0,
            rounds: 0,
            levels: [Level::default(); K],
            light: Mean::new(),
            nonfinite: AtomicU64::new(0),
        })
    }

    /// Paths that a round evaluates.
    fn cost(&self) -> u64 {
        self.particles * (1 + (K as u64 - 1) * MOVES as u64)
    }

    /// A ladder that nothing else has, for the generators of a level of a round.
    fn ladder(&self, round: u64, level: usize) -> u64 {
        (u64::from(self.ladder) + 1) << 40 | round << 4 | level as u64
    }

    /// One population from the bottom to the top.
    fn round(&mut self) {
        let nonfinite = AtomicU64::new(0);
        let target = PathTarget {
            scene: self.scene,
            builder: &self.builder,
            nonfinite: &nonfinite,
        };
        let kernels = kernels::<K>(target, &self.set, self.steps);
        let bottom = self.ladder(self.rounds, 0);
        let first = mutation(&self.set, self.steps, 0);
        let samples = samples(
            target,
            &self.family,
            &first,
            self.seed,
            bottom,
            self.particles,
        );
        let mut population =
            Population::from_samples(samples, &self.family, Resampling::Systematic);
        let mut central = generator(self.seed, self.ladder(self.rounds, K));
        let mut light = [0.0; K];
        let mut normalisers = [0.0; K];
        for (level, kernel) in kernels.iter().enumerate() {
            match population.advance(level, kernel, &mut central) {
                Ok(stage) => normalisers[level] = stage.normaliser.value,
                Err(Extinct { .. }) => break,
            }
            let gathered = if level == 0 {
                self.show(population.particles())
            } else {
                self.climb(level, normalisers[level], kernel, &mut population)
            };
            light[level] = gathered.light;
            self.levels[level].moves += gathered.moves;
            self.levels[level].accepted += gathered.accepted;
            for (of, mean) in self.levels.iter_mut().zip(&gathered.densities) {
                of.independent.merge(mean);
            }
        }
        for (k, level) in self.levels.iter_mut().enumerate() {
            level.normaliser.push(normalisers[k]);
            level.share.push(light[k]);
        }
        self.light.push(light.iter().sum());
        let found = nonfinite.load(Ordering::Relaxed);
        self.nonfinite.fetch_add(found, Ordering::Relaxed);
        self.rounds += 1;
    }

    fn deposit(&self, level: usize, normaliser: f64, each: u64) -> AnnealedDeposit<'_, K> {
        AnnealedDeposit {
            film: &self.film,
            scale: self.scale,
            weights: self.weights,
            // spec (9), over what stands in the weights: of all the visits of a level
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
        level: usize,
        normaliser: f64,
        kernel: &LevelKernel<PathTarget<'_>, Mutation>,
        population: &mut Population<Point<Mutation>, Contributions, K>,
    ) -> Gathered<K> {
        let generators = SampleGenerators::new(self.seed, self.ladder(self.rounds, level));
        let climb = |(chunk, particles): (usize, &mut [Particle<K>])| {
            let mut deposit = self.deposit(level, normaliser, MOVES as u64);
            for (at, particle) in particles.iter_mut().enumerate() {
                let mut draws = generators.at((chunk * CHUNK + at) as u64);
                for _ in 0..MOVES {
                    let accepted = particle.step(kernel, &self.family, &mut draws, &mut deposit);
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

/// A path that climbs.
type Particle<const K: usize> = Metropolis<Point<Mutation>, Contributions, K>;

impl<const K: usize> Engine for AnnealingEngine<'_, K> {
    fn advance(&mut self, plan: &[u64], stop: Option<&AtomicBool>) -> u64 {
        let rounds = plan.iter().sum::<u64>() / self.cost();
        let before = self.rounds;
        for _ in 0..rounds {
            if is_stopped(stop) {
                break;
            }
            self.round();
        }
        let steps = self.rounds * self.cost();
        if let Some(direct) = &mut self.direct {
            direct.keep_up(steps);
        }
        (self.rounds - before) * self.cost()
    }

    fn planned(&self, ladder: u32, settings: &RenderSettings) -> u64 {
        if ladder != self.ladder {
            return 0;
        }
        let cost = self.cost();
        match settings.budget {
            Budget::Time(_) => u64::MAX / cost * cost,
            // a share of the ladders is a share of the rounds, but one at least
            Budget::PerPixel(_) | Budget::Total(_) => {
                let share = settings
                    .ladder_range()
                    .map(|ladder| settings.planned(ladder));
                let steps: u64 = share.sum();
                (steps / cost).max(u64::from(steps > 0)) * cost
            }
        }
    }

    fn grain(&self, _ladder: u32) -> u64 {
        self.cost()
    }

    fn develop(&mut self) -> Result<Image, RenderError> {
        let mut parts = vec![(&self.film, self.area / self.rounds.max(1) as f64)];
        parts.extend(self.direct.iter().map(Lamps::part));
        Ok(develop(&parts)?)
    }

    fn layers(&self) -> Result<Vec<Layer>, RenderError> {
        let direct = self.direct.iter().map(|d| layer("direct", d.part()));
        direct.collect()
    }

    fn chain_statistics(&self) -> Option<ChainStatistics> {
        let sum = |of: fn(&Level) -> u64| self.levels.iter().map(of).sum::<u64>();
        let moves = sum(|level| level.moves).max(1);
        Some(ChainStatistics {
            small_acceptance: sum(|level| level.accepted) as f64 / moves as f64,
            large_acceptance: 1.0,
            normalisation: self.light.mean(),
            normalisation_error: self.light.standard_error(),
            b0: self.rough[1.min(K - 1)].value,
            longest_stay: 0,
            defects: 0,
        })
    }

    fn replica_statistics(&self) -> Option<ReplicaStatistics> {
        let level = |(k, level): (usize, &Level)| ReplicaLevel {
            weights: self.set.rows()[k],
            rough: self.rough[k].value,
            rough_error: known(self.rough[k].standard_error),
            normalisation: level.normaliser.mean(),
            normalisation_error: known(level.normaliser.standard_error()),
            independent: level.independent.mean(),
            independent_error: known(level.independent.standard_error()),
            // both are unbiased, and made of the same samples
            discrepancy: None,
            share: level.share.mean(),
            share_error: known(level.share.standard_error()),
            scale: 1.0,
            effective_at_once: self.effective[k][0],
            effective_annealed: self.effective[k][1],
            acceptance: level.accepted as f64 / level.moves.max(1) as f64,
            step: mutation(&self.set, self.steps, k).sizes().1,
        };
        Some(ReplicaStatistics {
            levels: self.levels.iter().enumerate().map(level).collect(),
            sweeps: self.rounds,
            exchange_acceptance: Vec::new(),
            pairs: Vec::new(),
            even: 0,
            scouts: 0,
            scouts_found: 0,
            scouts_followed: 0,
            round_trips: 0,
            particles: self.particles,
            dropped: self.dropped.clone(),
            normaliser: "initial",
        })
    }

    fn nonfinite(&self) -> (u64, Vec<Place>) {
        let own = (self.nonfinite.load(Ordering::Relaxed), Vec::new());
        add_nonfinite(own, self.direct.as_ref().map(Lamps::nonfinite))
    }

    fn film_counters(&self) -> Counters {
        let direct = self.direct.as_ref().map(Lamps::film_counters);
        add_counters(self.film.counters(), direct.unwrap_or_default())
    }

    fn is_lit(&self) -> bool {
        self.lit || self.direct.as_ref().is_some_and(Lamps::is_lit)
    }
}
