//! Replica exchange light transport (Kitaoka, Kitamura and Kishino 2009).

pub(crate) mod climb;
mod easy;
mod even;
mod keep;
pub(crate) mod kernels;
mod noise;
mod run;
mod scales;
pub(crate) mod scouts;
pub(crate) mod start;
mod statistics;

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use kaustik_estimate::{
    PathTarget, ReplicaDeposit, ReplicaFamily, ReplicaSet, ReplicaShares, ReplicaWeights, Scale,
    SpecificFamily,
};
use kaustik_film::{Counters, Film, FilmError, Image, Layer, Layout, Quantum, develop};
use kaustik_mcmc::{Estimate, Statistics, Touring};
use kaustik_path::{Bidirectional, Event, Unjoined, trace};
use kaustik_pss::Stream;
use kaustik_scene::Scene;
use rayon::prelude::*;

use crate::beside::Besides;
use crate::beside::lamps::Lamps;
use crate::beside::meter::{Fit, Meter, OwnSamples};
use crate::control::is_stopped;
use crate::engine::{Engine, Nonfinite, STRIDE, add_counters, add_nonfinite};
use crate::{
    ChainStatistics, EvenSamples, Options, RenderError, RenderSettings, ReplicaStatistics, StepId,
    Steps,
};
use kernels::kernels;
use run::{Run, Tours, pool, runs};
use scouts::{SpecularLight, scouting};
use start::{Started, for_so_many_replicas, replica_builder, start};

/// Sweeps of a ladder between two changes of its step sizes. Rounds of 16 were seen to bias a chain by
/// 20 %, rounds of 1,000 within its error.
const ADAPTATION_ROUND: u64 = 1_000;

/// Samples of all replicas for each cell of a pass of the meter: a fifth to a quarter of the time.
const METERED: u64 = 32;

/// Beside even samples a visit of a chain counts in the heuristic for so much of an independent sample.
///
/// Successive visits are alike, and a chain that has not come round yet shows too much of some light and too little of
/// other. Measured: `docs/experiments/relt.md`.
const VISIT: f64 = 1.0 / 16.0;

/// Anneals, decides which replicas run, and starts the ladders.
pub(crate) fn engine<'a>(
    scene: &'a Scene,
    settings: &RenderSettings,
) -> Result<Box<dyn Engine + 'a>, RenderError> {
    let builder = replica_builder(settings);
    let started = start(scene, &builder, settings);
    Ok(for_so_many_replicas!(
        ReltEngine, scene, builder, settings, started
    ))
}

/// Ladders of K replicas on K films.
struct ReltEngine<'a, const K: usize> {
    scene: &'a Scene,
    builder: Bidirectional,
    options: Options,
    set: ReplicaSet,
    family: ReplicaFamily<K>,
    weights: ReplicaWeights<K>,
    rough: [Estimate; K],
    runs: Vec<Run<K>>,
    films: [Film; K],
    /// Its meter tells how much light the specific replica has, where scouts alone do not.
    besides: Besides<'a>,
    scale: Scale,
    /// Raster area of the window in pixels.
    area: f64,
    /// What the first population and the first scouts say of the light of each replica.
    pool: ReplicaShares<K>,
    /// What scouts look for, if there are any.
    specular_light: Option<SpecularLight<'a>>,
    /// Samples of each replica a sweep.
    counts: [f64; K],
    /// How many of the first's are spread evenly.
    even: u32,
    /// Tours of the specific replica.
    tours: Tours,
    particles: u64,
    effective: Vec<[f64; 2]>,
    dropped: Option<String>,
    lit: bool,
}

impl<'a, const K: usize> ReltEngine<'a, K> {
    fn new(
        scene: &'a Scene,
        builder: Bidirectional,
        settings: &RenderSettings,
        started: Started,
    ) -> Result<Self, RenderError> {
        let options = settings.options;
        let set = started.set;
        let family = ReplicaFamily::new(&set, options.target);
        let rough: [Estimate; K] = std::array::from_fn(|k| started.rough[k]);
        // Without its replica, implicit specular light goes back to the others.
        let specific = set.is_specific() && K == set.count();
        let layout = settings.layout();
        let quantum = Quantum::from_sum_of_xyz(started.mean);
        let films = films(&layout, quantum)?;
        let even = match options.even {
            EvenSamples::Auto => even::samples_a_sweep::<K>(settings, &started, specific),
            EvenSamples::Count(count) => count,
        };
        let mut counts: [f64; K] = std::array::from_fn(|k| f64::from(set.repeats()[k]));
        counts[0] += f64::from(even);
        let weights =
            ReplicaWeights::new(rough.map(|b| b.value), options.beta, specific).with_counts(counts);
        let weights = if even > 0 {
            weights.with_worth(std::array::from_fn(|k| if k == 0 { 1.0 } else { VISIT }))
        } else {
            weights
        };
        let pool = pool(&weights, &set, &started);
        let scouts = scouting(&set).filter(|_| specific);
        let meter = scouts.and_then(|scouts| {
            let cost: f64 = counts.iter().sum();
            meter(scene, settings, f64::from(scouts) / cost)
        });
        Ok(Self {
            besides: Besides {
                lamps: Lamps::new(scene, settings)?,
                meter,
            },
            scene,
            builder,
            options,
            set,
            family,
            weights,
            pool,
            specular_light: scouts.map(|_| SpecularLight::new(scene, settings)),
            counts,
            even,
            // through a lens with area the full form shares that light with walks that fall on the lens
            tours: Tours::of(&set, specific && !scene.camera().has_aperture()),
            rough,
            lit: started.mean > 0.0,
            particles: started.particles,
            effective: started.effective.clone(),
            dropped: started.dropped.clone(),
            runs: runs(&family, &set, settings, started),
            films,
            scale: settings.scale(),
            area: layout.extended_bounds().area(),
        })
    }

    /// How visits become splats: one of replica k weighs `1 / counts[k]` of a sweep, so that each film is a mean over sweeps; one to implicit
    /// specular light of the last replica weighs one over its steps and those of its tours.
    fn deposit(&self, shares: ReplicaShares<K>) -> ReplicaDeposit<'_, K> {
        ReplicaDeposit {
            films: &self.films,
            scale: self.scale,
            weights: self.weights,
            shares,
            each: self.counts.map(|n| 1.0 / n),
            each_specific: 1.0 / (self.counts[K - 1] + self.tours.steps()),
        }
    }

    /// Samples of all replicas in a sweep.
    fn cost(&self) -> u64 {
        let steps = self.set.repeats()[..K].iter().copied().map(u64::from);
        steps.sum::<u64>() + u64::from(self.even)
    }

    /// Drives one ladder on.
    fn drive(&self, run: &mut Run<K>, sweeps: u64, stop: Option<&AtomicBool>) {
        let nonfinite = AtomicU64::new(0);
        let target = PathTarget {
            scene: self.scene,
            builder: &self.builder,
            nonfinite: &nonfinite,
        };
        let kernels = kernels::<K>(target, &self.set, self.options.steps);
        let unjoined = Unjoined {
            settings: self.builder.settings,
        };
        let surrogate = PathTarget {
            builder: &unjoined,
            ..target
        };
        let touring = Touring {
            target: &target,
            surrogate: &surrogate,
            density: &SpecificFamily::new(&self.set, self.options.target),
            still: &[Stream::Light, Stream::Connection, Stream::Technique],
            steps: self.tours.each,
        };
        let mut deposit = self.deposit(run.shares);
        // A look at the stop flag comes as often as elsewhere.
        let stride = (STRIDE / self.cost()).max(1);
        for done in 0..sweeps {
            if done % stride == 0 && is_stopped(stop) {
                break;
            }
            for (level, kernel) in kernels.iter().enumerate() {
                let tours = if level + 1 == K { self.tours.count } else { 0 };
                for _ in tours..self.set.repeats()[level] {
                    (run.ladder).step_at(level, kernel, &self.family, &mut run.draws, &mut deposit);
                }
            }
            run.tour(self.tours.count, &touring, &self.family, &mut deposit);
            if let Some(region) = &self.specular_light {
                run.scout(
                    self.set.scouts(),
                    (&target, region),
                    &self.family,
                    &mut deposit,
                );
            }
            (run.even).samples(self.even, &target, &self.family, &mut deposit);
            (run.ladder).exchange(&kernels, &mut run.draws, &mut deposit);
            let found = nonfinite.load(Ordering::Relaxed);
            if found > 0 {
                nonfinite.store(0, Ordering::Relaxed);
                run.nonfinite.count(found, run.sweeps * self.cost());
            }
            run.sweeps += 1;
            if self.options.steps == Steps::Adapted && run.sweeps.is_multiple_of(ADAPTATION_ROUND) {
                run.adapt();
            }
        }
        run.shares = deposit.shares;
    }

    fn sweeps(&self) -> u64 {
        self.runs.iter().map(|run| run.sweeps).sum()
    }

    /// A replica's statistics in all ladders, in their order.
    fn level(&self, level: usize) -> Statistics<K> {
        let mut all = Statistics::new();
        for run in &self.runs {
            all.merge(run.ladder.replicas()[level].statistics());
        }
        all
    }

    /// Films with what turns them into parts of the picture.
    fn parts(&self) -> Vec<(&Film, f64)> {
        let per_sweep = self.area / self.sweeps().max(1) as f64;
        let scales = self.scales().map(|scale| scale * per_sweep);
        self.films.iter().zip(scales).collect()
    }
}

impl<const K: usize> Engine for ReltEngine<'_, K> {
    fn advance(&mut self, plan: &[u64], stop: Option<&AtomicBool>) -> u64 {
        let (before, cost) = (self.sweeps(), self.cost());
        let mut runs = std::mem::take(&mut self.runs);
        runs.par_iter_mut()
            .zip(plan)
            .with_max_len(1)
            .for_each(|(run, &steps)| self.drive(run, steps / self.cost(), stop));
        self.runs = runs;
        let sweeps = self.sweeps();
        self.besides.keep_up(sweeps * cost);
        (sweeps - before) * cost
    }

    fn planned(&self, ladder: u32, settings: &RenderSettings) -> u64 {
        settings.planned_sweeps(ladder, self.cost())
    }

    fn grain(&self, _ladder: u32) -> u64 {
        self.cost()
    }

    fn develop(&mut self) -> Result<Image, RenderError> {
        let mut runs = std::mem::take(&mut self.runs);
        for run in &mut runs {
            let mut deposit = self.deposit(run.shares);
            run.ladder.flush(&mut deposit);
            run.shares = deposit.shares;
        }
        self.runs = runs;
        let mut parts = self.parts();
        parts.extend(self.besides.parts());
        Ok(develop(&parts)?)
    }

    fn layers(&self) -> Result<Vec<Layer>, RenderError> {
        let mut layers = Vec::with_capacity(K);
        for (index, part) in self.parts().into_iter().enumerate() {
            layers.push(layer(&format!("replica-{}", index + 1), part)?);
        }
        for part in self.besides.parts() {
            layers.push(layer("direct", part)?);
        }
        Ok(layers)
    }

    fn chain_statistics(&self) -> Option<ChainStatistics> {
        let mut all = Statistics::new();
        for level in 0..K {
            all.merge(&self.level(level));
        }
        let b = self.brightness();
        let metered = self.besides.meter.as_ref().map(|meter| {
            let all = self.shares().samples(K - 1);
            meter.in_scouts().count() as f64 / all as f64
        });
        Some(ChainStatistics {
            metered: metered.unwrap_or_default(),
            ..ChainStatistics::new(
                &all,
                [b.value, b.standard_error],
                self.rough[full_replica::<K>()].value,
            )
        })
    }

    fn replica_statistics(&self) -> Option<ReplicaStatistics> {
        Some(self.statistics())
    }

    /// All that is evaluated in the sweep of this step.
    fn replay(&mut self, StepId { step, .. }: StepId) -> Result<Vec<Event>, RenderError> {
        let mut runs = std::mem::take(&mut self.runs);
        let Some(run) = runs.first_mut() else {
            return Ok(Vec::new());
        };
        self.drive(run, step / self.cost(), None);
        Ok(trace(|| self.drive(run, 1, None)).1)
    }

    fn nonfinite(&self) -> (u64, Vec<StepId>) {
        let own = Nonfinite::all(self.runs.iter().map(|run| (run.index, run.nonfinite)));
        add_nonfinite(own, Some(self.besides.nonfinite()))
    }

    fn film_counters(&self) -> Counters {
        (self.films.iter().map(Film::counters))
            .chain([self.besides.film_counters()])
            .fold(Counters::default(), add_counters)
    }

    fn is_lit(&self) -> bool {
        self.lit || self.besides.is_lit()
    }
}

/// A film for each replica.
fn films<const K: usize>(layout: &Layout, quantum: Quantum) -> Result<[Film; K], FilmError> {
    let films = (0..K).map(|_| Film::with_layout(layout, quantum));
    let films: Vec<Film> = films.collect::<Result<_, _>>()?;
    let Ok(films) = films.try_into() else {
        unreachable!("K films were made");
    };
    Ok(films)
}

/// What tells how much light the specific replica has, beside so many scouts for each sample of a sweep.
fn meter<'a>(scene: &'a Scene, settings: &RenderSettings, scouts: f64) -> Option<Meter<'a>> {
    let own = OwnSamples {
        variance: 0.0,
        per_mutation: scouts,
    };
    let fit = Fit {
        mutations_a_cell: METERED,
        unit: 1.0,
    };
    Meter::new(scene, settings, own, fit)
}

/// A film as a layer.
pub(crate) fn layer(name: &str, part: (&Film, f64)) -> Result<Layer, RenderError> {
    let image = develop(&[part])?;
    let channels = ["R", "G", "B"].into_iter().zip(image.rgb());
    let channels = channels.map(|(channel, plane)| (channel, plane.to_vec()));
    Ok(Layer::new(name, channels.collect()))
}

/// The full replica, to whose normaliser others are compared: the one after the uniform replica,
/// unless annealing reached none but that.
pub(crate) const fn full_replica<const K: usize>() -> usize {
    if K > 1 { 1 } else { 0 }
}

/// JSON knows neither infinity nor NaN.
pub(crate) fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}
