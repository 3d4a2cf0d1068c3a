//! Primary sample space Metropolis light transport (Kelemen et al. 2002; spec: pss-and-pssmlt.md).

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use kaustik_estimate::{Bridge, KelemenDeposit, Mis, PathTarget, ScalarContribution, Scale};
use kaustik_film::{Counters, Film, Image, Quantum, develop};
use kaustik_mcmc::{
    Draws, Estimate, Exponential, Mean, Metropolis, Mutation, Pcg64Dxsm, Point, PointKernel, Pool,
    SampleGenerators, Statistics, Uniform, generator, sample, sample_generator,
};
use kaustik_path::{Bidirectional, Contributions, Endpoint, Form, PathBuilder, Unidirectional};
use kaustik_scene::Scene;
use rayon::prelude::*;

use crate::control::is_stopped;
use crate::direct_light::DirectLight;
use crate::engine::{Engine, Nonfinite, STRIDE, add_counters, add_nonfinite};
use crate::render::chain_builder_settings;
use crate::{
    Builder, ChainStatistics, Normaliser, Options, Place, RenderError, RenderSettings, SmallStep,
};

/// The pilot's samples come from a ladder that no render has.
const PILOT_LADDER: u64 = u64::MAX;
/// So does the choice of the starts.
const CHOICE_LADDER: u64 = u64::MAX - 1;
/// And so do the samples that fix the constant in the weights: it must not depend on the pool, or the
/// product of both would be biased (spec 4.4).
const CONSTANT_LADDER: u64 = u64::MAX - 2;
/// It needs to be no better than roughly right.
const CONSTANT_SHARE: u64 = 10;

/// Either kind of small step.
#[derive(Clone, Debug)]
enum Small {
    Kelemen(Exponential),
    Uniform(Uniform),
}

impl Mutation for Small {
    #[inline]
    fn mutate<D: Draws + ?Sized>(&self, x: f64, draws: &mut D) -> f64 {
        match self {
            Self::Kelemen(mutation) => mutation.mutate(x, draws),
            Self::Uniform(mutation) => mutation.mutate(x, draws),
        }
    }

    fn mixed_after(&self) -> u64 {
        match self {
            Self::Kelemen(mutation) => mutation.mixed_after(),
            Self::Uniform(mutation) => mutation.mixed_after(),
        }
    }
}

impl Small {
    fn new(step: SmallStep) -> Self {
        match step {
            SmallStep::Kelemen(s1, s2) => Self::Kelemen(Exponential::new(s1, s2)),
            SmallStep::Uniform(fraction) => Self::Uniform(Uniform::new(fraction)),
        }
    }
}

/// Chains on one pair of films.
pub(crate) struct PssmltEngine<'a> {
    scene: &'a Scene,
    builder: Box<dyn PathBuilder + 'a>,
    family: ScalarContribution,
    options: Options,
    chains: Vec<Chain>,
    chain_film: Film,
    large_film: Option<Film>,
    direct: Option<DirectLight<'a>>,
    pool: Mean,
    /// What the pool's samples bring to the bridge.
    pool_bridge: Bridge,
    /// The constant in the weights; 0 if the pilot saw nothing.
    b0: f64,
    scale: Scale,
    /// Raster area of the window in pixels.
    area: f64,
}

/// One ladder.
struct Chain {
    ladder: u32,
    nonfinite: Nonfinite,
    draws: Pcg64Dxsm,
    metropolis: Metropolis<Point<Small>, Contributions, 1>,
    bridge: Bridge,
}

impl<'a> PssmltEngine<'a> {
    /// Runs the pilot and starts the chains.
    pub(crate) fn new(scene: &'a Scene, settings: &RenderSettings) -> Result<Self, RenderError> {
        let options = settings.options;
        let builder: Box<dyn PathBuilder> = match options.builder {
            Builder::Unidirectional => Box::new(Unidirectional {
                settings: chain_builder_settings(settings),
                next_event: options.next_event,
            }),
            Builder::Endpoint => Box::new(Endpoint {
                settings: chain_builder_settings(settings),
            }),
            Builder::Simple => Box::new(bidirectional(settings, Form::Simple)),
            Builder::Bidirectional => Box::new(bidirectional(settings, Form::Full)),
        };
        let family = ScalarContribution {
            target: options.target,
            contribution: options.contribution,
        };
        let nonfinite = AtomicU64::new(0);
        let target = PathTarget {
            scene,
            builder: builder.as_ref(),
            nonfinite: &nonfinite,
        };
        let pool = Pool::new(pilot(
            target,
            family,
            settings,
            PILOT_LADDER,
            0..options.pilot,
        ));
        let b0 = match options.mis {
            Mis::Printed => pool.normaliser().mean(), // these weights want b itself
            Mis::Split | Mis::Off => {
                rough_constant(target, family, settings).unwrap_or_else(|| pool.normaliser().mean())
            }
        };
        let chains = start_chains(target, family, &pool, settings)?;
        let mut pool_bridge = Bridge::default();
        for density in pool.densities().iter().filter(|density| **density > 0.0) {
            pool_bridge.sample(1.0, density / b0);
        }
        let layout = settings.layout();
        let quantum = Quantum::from_mean(b0 / 3.0);
        let large_film = match options.mis {
            Mis::Split => Some(Film::with_layout(&layout, quantum)?),
            Mis::Printed | Mis::Off => None,
        };
        Ok(Self {
            scene,
            family,
            options,
            chains,
            chain_film: Film::with_layout(&layout, quantum)?,
            large_film,
            direct: DirectLight::new(scene, settings)?,
            pool: *pool.normaliser(),
            pool_bridge,
            b0,
            scale: Scale {
                width: f64::from(settings.width),
                height: f64::from(settings.height),
            },
            area: layout.extended_bounds().area(),
            builder,
        })
    }

    fn deposit(&self, bridge: Bridge) -> KelemenDeposit<'_> {
        KelemenDeposit {
            chain: &self.chain_film,
            large: self.large_film.as_ref(),
            scale: self.scale,
            b0: self.b0,
            p_large: self.options.p_large,
            mis: self.options.mis,
            bridge,
        }
    }

    /// Drives one chain on.
    fn drive(&self, chain: &mut Chain, steps: u64, stop: Option<&AtomicBool>) {
        let nonfinite = AtomicU64::new(0);
        let target = PathTarget {
            scene: self.scene,
            builder: self.builder.as_ref(),
            nonfinite: &nonfinite,
        };
        let kernel = PointKernel::new(target, self.options.p_large);
        let mut deposit = self.deposit(chain.bridge);
        for done in 0..steps {
            if done % STRIDE == 0 && is_stopped(stop) {
                break;
            }
            let step = chain.metropolis.statistics().steps;
            chain
                .metropolis
                .step(&kernel, &self.family, &mut chain.draws, &mut deposit);
            let found = nonfinite.load(Ordering::Relaxed);
            if found > 0 {
                nonfinite.store(0, Ordering::Relaxed);
                chain.nonfinite.count(found, step);
            }
        }
        chain.bridge = deposit.bridge;
    }

    /// All chains' statistics, in the order of the ladders.
    fn statistics(&self) -> Statistics<1> {
        let mut all = Statistics::new();
        for chain in &self.chains {
            all.merge(chain.metropolis.statistics());
        }
        all
    }

    /// The estimate of `b` that scales the image.
    fn normaliser(&self, statistics: &Statistics<1>) -> Estimate {
        let mut mean = self.pool;
        if self.options.normaliser != Normaliser::Initial {
            mean.merge(&statistics.independent[0]);
        }
        let plain = Estimate {
            value: mean.mean(),
            standard_error: mean.standard_error(),
        };
        match self.options.normaliser {
            Normaliser::Bridge => self.bridged(None).map_or(plain, |value| Estimate {
                value,
                standard_error: self.bridge_error(),
            }),
            _ => plain,
        }
    }

    /// `b` by the bridge between all independent samples and the chains, all or all but one.
    fn bridged(&self, left_out: Option<usize>) -> Option<f64> {
        let mut bridge = self.pool_bridge;
        let (mut samples, mut steps) = (self.pool.count(), 0);
        for (index, chain) in self.chains.iter().enumerate() {
            if left_out != Some(index) {
                let statistics = chain.metropolis.statistics();
                bridge.merge(&chain.bridge);
                samples += statistics.independent[0].count();
                steps += statistics.steps;
            }
        }
        Some(self.b0 * bridge.ratio(samples, steps as f64)?)
    }

    /// Its standard error: from leaving out one chain after the other (jackknife), and from the pool, which is the
    /// same for all.
    fn bridge_error(&self) -> f64 {
        let all = 0..self.chains.len();
        let without: Mean = all.filter_map(|index| self.bridged(Some(index))).collect();
        let chains = without.count() as f64;
        let of_chains = (without.variance() / chains).sqrt() * (chains - 1.0);
        let own: u64 = (self.chains.iter())
            .map(|chain| chain.metropolis.statistics().independent[0].count())
            .sum();
        let pool = self.pool.count();
        let share = pool as f64 / (pool + own) as f64;
        let of_pool = share * self.pool_bridge.relative_error(pool) * without.mean();
        of_chains.hypot(of_pool)
    }
}

fn bidirectional(settings: &RenderSettings, form: Form) -> Bidirectional {
    Bidirectional {
        settings: chain_builder_settings(settings),
        form,
        heuristic: settings.options.heuristic,
    }
}

/// Densities of independent samples of a ladder, in parallel, in the order of their indices; NaN where
/// there is none.
fn pilot(
    target: PathTarget<'_>,
    family: ScalarContribution,
    settings: &RenderSettings,
    ladder: u64,
    samples: Range<u64>,
) -> Vec<f64> {
    let generators = SampleGenerators::new(settings.seed, ladder);
    (samples.start as usize..samples.end as usize)
        .into_par_iter()
        .with_min_len(256)
        .map_init(Contributions::default, |value, index| {
            let draws = generators.at(index as u64);
            sample(&target, &family, draws, value).map_or(f64::NAN, |[density]| density)
        })
        .collect()
}

/// A rough estimate of b that knows nothing of the pool: samples of its own, a share of the pool's
/// number, and more until some see light. `None` if as many as the pool's see none.
fn rough_constant(
    target: PathTarget<'_>,
    family: ScalarContribution,
    settings: &RenderSettings,
) -> Option<f64> {
    let share = (settings.options.pilot / CONSTANT_SHARE).max(1);
    let mut mean = Mean::new();
    for round in 0..CONSTANT_SHARE {
        let samples = round * share..(round + 1) * share;
        pilot(target, family, settings, CONSTANT_LADDER, samples)
            .into_iter()
            .filter(|density| density.is_finite())
            .for_each(|density| mean.push(density));
        if mean.mean() > 0.0 {
            return Some(mean.mean());
        }
    }
    None
}

/// A chain for every ladder of this process; none if the pool saw nothing. All ladders choose, so that
/// a share of them starts as it would among all.
fn start_chains(
    target: PathTarget<'_>,
    family: ScalarContribution,
    pool: &Pool,
    settings: &RenderSettings,
) -> Result<Vec<Chain>, RenderError> {
    let mut choice = generator(settings.seed, CHOICE_LADDER);
    let range = settings.ladder_range();
    let mut chains = Vec::new();
    for ladder in 0..settings.options.ladders {
        let Some(start) = pool.choose(&mut choice) else {
            break;
        };
        if !range.contains(&ladder) {
            continue;
        }
        let mut draws = sample_generator(settings.seed, PILOT_LADDER, start.index);
        let small = Small::new(settings.options.small_step);
        chains.push(Chain {
            ladder,
            nonfinite: Nonfinite::default(),
            metropolis: Metropolis::rebuild(&target, &family, 0, small, &start, &mut draws)?,
            draws: generator(settings.seed, u64::from(ladder)),
            bridge: Bridge::default(),
        });
    }
    Ok(chains)
}

impl Engine for PssmltEngine<'_> {
    fn advance(&mut self, plan: &[u64], stop: Option<&AtomicBool>) -> u64 {
        let before = self.statistics().steps;
        let mut chains = std::mem::take(&mut self.chains);
        chains
            .par_iter_mut()
            .zip(plan)
            .with_max_len(1)
            .for_each(|(chain, &steps)| self.drive(chain, steps, stop));
        self.chains = chains;
        let steps = self.statistics().steps;
        if let Some(direct) = &mut self.direct {
            direct.keep_up(steps);
        }
        steps - before
    }

    fn develop(&mut self) -> Result<Image, RenderError> {
        let mut chains = std::mem::take(&mut self.chains);
        for chain in &mut chains {
            let mut deposit = self.deposit(chain.bridge);
            chain.metropolis.flush(&mut deposit);
            chain.bridge = deposit.bridge;
        }
        self.chains = chains;
        let statistics = self.statistics();
        let per_step = self.area / statistics.steps.max(1) as f64;
        let b = self.normaliser(&statistics).value;
        let scale = match self.options.mis {
            Mis::Printed => 1.0,
            Mis::Split | Mis::Off if self.b0 > 0.0 => b / self.b0,
            Mis::Split | Mis::Off => 0.0,
        };
        let mut films = vec![(&self.chain_film, scale * per_step)];
        films.extend(self.large_film.iter().map(|film| (film, per_step)));
        films.extend(self.direct.iter().map(DirectLight::part));
        Ok(develop(&films)?)
    }

    fn chain_statistics(&self) -> Option<ChainStatistics> {
        let statistics = self.statistics();
        let b = self.normaliser(&statistics);
        Some(ChainStatistics::new(
            &statistics,
            [b.value, b.standard_error],
            self.b0,
        ))
    }

    fn nonfinite(&self) -> (u64, Option<Place>) {
        let chains = self.chains.iter();
        let own = Nonfinite::all(chains.map(|chain| (chain.ladder, chain.nonfinite)));
        add_nonfinite(own, self.direct.as_ref().map(DirectLight::nonfinite))
    }

    fn film_counters(&self) -> Counters {
        let large = self
            .large_film
            .as_ref()
            .map(Film::counters)
            .unwrap_or_default();
        let direct = self.direct.as_ref().map(DirectLight::film_counters);
        add_counters(
            add_counters(self.chain_film.counters(), large),
            direct.unwrap_or_default(),
        )
    }

    fn is_lit(&self) -> bool {
        self.pool.mean() > 0.0 || self.direct.as_ref().is_some_and(DirectLight::is_lit)
    }
}
