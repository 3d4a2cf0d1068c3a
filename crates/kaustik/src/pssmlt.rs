//! Primary sample space Metropolis light transport (Kelemen et al. 2002; spec: pss-and-pssmlt.md).

use std::cell::Cell;
use std::io;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use kaustik_estimate::{CountedTarget, KelemenDeposit, Mis, PathTarget, ScalarContribution, Scale};
use kaustik_film::{Counters, Film, Image, Quantum, develop};
use kaustik_mcmc::{
    Draws, Exponential, Mean, Metropolis, Mutation, Pcg64Dxsm, Point, PointKernel, Pool,
    SampleGenerators, Statistics, Uniform, generator, sample, sample_generator,
};
use kaustik_path::{Contributions, Event, PathBuilder, Rays, trace};
use kaustik_scene::Scene;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::builders::builder;
use crate::control::is_stopped;
use crate::engine::{Engine, Nonfinite, STRIDE, add_counters, add_nonfinite, add_rays};
use crate::lamps::Lamps;
use crate::state::{Keep, Reader, StateError, Writer};
use crate::{ChainStatistics, Normaliser, Options, Place, RenderError, RenderSettings, SmallStep};

/// The pilot's samples come from a ladder that no render has.
pub(crate) const PILOT_LADDER: u64 = u64::MAX;
/// So does the choice of the starts.
const CHOICE_LADDER: u64 = u64::MAX - 1;
/// And so do the samples that fix the constant in the weights: it must not depend on the pool, or the
/// product of both would be biased (spec 4.4).
const CONSTANT_LADDER: u64 = u64::MAX - 2;
/// It needs to be no better than roughly right.
const CONSTANT_SHARE: u64 = 10;
/// Where light is hard to find at all, so many times the pool's samples look for it.
const PATIENCE: u64 = 10;

/// Either kind of small step.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) enum Small {
    Kelemen(Exponential),
    Uniform(Uniform),
}

impl Mutation for Small {
    #[inline(always)]
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
    pub(crate) fn new(step: SmallStep) -> Self {
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
    lamps: Option<Lamps<'a>>,
    pool: Mean,
    /// The constant in the weights; 0 if neither pool nor pilot saw any light.
    b0: f64,
    scale: Scale,
    /// Raster area of the window in pixels.
    area: f64,
}

/// One ladder.
#[derive(Serialize, Deserialize)]
struct Chain {
    ladder: u32,
    nonfinite: Nonfinite,
    rays: Rays,
    draws: Pcg64Dxsm,
    metropolis: Metropolis<Point<Small>, Contributions, 1>,
}

impl<'a> PssmltEngine<'a> {
    /// Runs the pilot and starts the chains.
    pub(crate) fn new(scene: &'a Scene, settings: &RenderSettings) -> Result<Self, RenderError> {
        Self::with_builder(scene, settings, builder(scene, settings)?)
    }

    /// Over the paths of this builder.
    pub(crate) fn with_builder(
        scene: &'a Scene,
        settings: &RenderSettings,
        builder: Box<dyn PathBuilder + 'a>,
    ) -> Result<Self, RenderError> {
        let options = settings.options;
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
        // Kelemen's printed weights want b itself, the others a constant that knows nothing of the pool.
        let of_pool = Some(pool.normaliser().mean()).filter(|b| *b > 0.0);
        let rough = || rough_constant(target, family, settings);
        let b0 = match options.mis {
            Mis::Printed => of_pool.or_else(rough),
            Mis::Split | Mis::Off => rough().or(of_pool),
        }
        .unwrap_or(0.0);
        let chains = start_chains(target, family, &pool, settings)?;
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
            lamps: Lamps::new(scene, settings)?,
            pool: *pool.normaliser(),
            b0,
            scale: Scale {
                width: f64::from(settings.width),
                height: f64::from(settings.height),
            },
            area: layout.extended_bounds().area(),
            builder,
        })
    }

    fn deposit(&self) -> KelemenDeposit<'_> {
        KelemenDeposit {
            chain: &self.chain_film,
            large: self.large_film.as_ref(),
            scale: self.scale,
            b0: self.b0,
            p_large: self.options.p_large,
            mis: self.options.mis,
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
        let rays = Cell::new(chain.rays);
        let target = CountedTarget {
            target,
            rays: &rays,
        };
        let kernel = PointKernel::new(target, self.options.p_large);
        let mut deposit = self.deposit();
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
        chain.rays = rays.get();
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
    fn normaliser(&self, statistics: &Statistics<1>) -> Mean {
        let mut mean = self.pool;
        if self.options.normaliser == Normaliser::Running {
            mean.merge(&statistics.independent[0]);
        }
        mean
    }
}

/// Densities of independent samples of a ladder, in parallel, in the order of their indices; NaN where
/// there is none.
pub(crate) fn pilot(
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
/// number, and more until some see light. `None` if [`PATIENCE`] times as many as the pool's see none.
fn rough_constant(
    target: PathTarget<'_>,
    family: ScalarContribution,
    settings: &RenderSettings,
) -> Option<f64> {
    let share = (settings.options.pilot / CONSTANT_SHARE).max(1);
    let mut mean = Mean::new();
    for round in 0..PATIENCE * CONSTANT_SHARE {
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

/// A chain for every ladder of this process. All ladders choose, so that a share of them starts as it
/// would among all. After a pool that saw nothing they start in the dark: what their large steps find
/// is as right as ever, while the film of the chains counts for nothing (b = 0) until a running
/// normaliser knows better.
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
        let start = pool.choose(&mut choice);
        if !range.contains(&ladder) {
            continue;
        }
        let mut own = generator(settings.seed, u64::from(ladder));
        let small = Small::new(settings.options.small_step);
        let metropolis = match start {
            Some(start) => {
                let mut draws = sample_generator(settings.seed, PILOT_LADDER, start.index);
                Metropolis::rebuild(&target, &family, 0, small, &start, &mut draws)?
            }
            None => Metropolis::start(&target, &family, 0, small, &mut own),
        };
        chains.push(Chain {
            ladder,
            nonfinite: Nonfinite::default(),
            rays: Rays::default(),
            metropolis,
            draws: own,
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
        if let Some(lamps) = &mut self.lamps {
            lamps.keep_up(steps);
        }
        steps - before
    }

    fn develop(&mut self) -> Result<Image, RenderError> {
        let mut chains = std::mem::take(&mut self.chains);
        for chain in &mut chains {
            chain.metropolis.flush(&mut self.deposit());
        }
        self.chains = chains;
        let statistics = self.statistics();
        let per_step = self.area / statistics.steps.max(1) as f64;
        let b = self.normaliser(&statistics).mean();
        let scale = match self.options.mis {
            Mis::Printed => 1.0,
            Mis::Split | Mis::Off if self.b0 > 0.0 => b / self.b0,
            Mis::Split | Mis::Off => 0.0,
        };
        let mut films = vec![(&self.chain_film, scale * per_step)];
        films.extend(self.large_film.iter().map(|film| (film, per_step)));
        films.extend(self.lamps.iter().map(Lamps::part));
        Ok(develop(&films)?)
    }

    fn chain_statistics(&self) -> Option<ChainStatistics> {
        let statistics = self.statistics();
        let b = self.normaliser(&statistics);
        Some(ChainStatistics::new(
            &statistics,
            [b.mean(), b.standard_error()],
            self.b0,
        ))
    }

    fn nonfinite(&self) -> (u64, Vec<Place>) {
        let chains = self.chains.iter();
        let own = Nonfinite::all(chains.map(|chain| (chain.ladder, chain.nonfinite)));
        add_nonfinite(own, self.lamps.as_ref().map(Lamps::nonfinite))
    }

    /// The chain goes on to the step from its start; lamps have no part in it.
    fn replay(&mut self, Place { step, .. }: Place) -> Result<Vec<Event>, RenderError> {
        let mut chains = std::mem::take(&mut self.chains);
        let Some(chain) = chains.first_mut() else {
            // The pool saw no light: nothing is tried.
            return Ok(Vec::new());
        };
        self.drive(chain, step, None);
        Ok(trace(|| self.drive(chain, 1, None)).1)
    }

    fn rays(&self) -> Option<Rays> {
        let lamps = self.lamps.iter().map(Lamps::rays);
        let chains = self.chains.iter().map(|chain| chain.rays);
        Some(add_rays(chains.chain(lamps)))
    }

    fn film_counters(&self) -> Counters {
        let large = self.large_film.as_ref().map(Film::counters);
        let lamps = self.lamps.as_ref().map(Lamps::film_counters);
        let others = add_counters(large.unwrap_or_default(), lamps.unwrap_or_default());
        add_counters(self.chain_film.counters(), others)
    }

    fn is_lit(&self) -> bool {
        self.b0 > 0.0 || self.lamps.as_ref().is_some_and(Lamps::is_lit)
    }
}

/// Films and chains; what the pilots found is found again, and compared.
impl Keep for PssmltEngine<'_> {
    fn taken(&self) -> Vec<u64> {
        let chains = self.chains.iter();
        chains.map(|c| c.metropolis.statistics().steps).collect()
    }

    fn write(&self, out: &mut Writer<'_>) -> io::Result<()> {
        out.value(&(self.b0, self.pool))?;
        out.film(&self.chain_film)?;
        if let Some(film) = &self.large_film {
            out.film(film)?;
        }
        if let Some(lamps) = &self.lamps {
            lamps.write(out)?;
        }
        self.chains.iter().try_for_each(|chain| out.value(chain))
    }

    fn take_up(&mut self, from: &mut Reader<'_>) -> Result<(), StateError> {
        let (b0, pool): (f64, Mean) = from.value()?;
        if b0.to_bits() != self.b0.to_bits() || pool != self.pool {
            let (b, here) = (pool.mean(), self.pool.mean());
            return Err(StateError::Other(format!(
                "the pilot found {b0:e} and {b:e} for the state, {:e} and {here:e} here: this program computes other numbers",
                self.b0
            )));
        }
        from.film(&mut self.chain_film)?;
        if let Some(film) = &mut self.large_film {
            from.film(film)?;
        }
        let passes = self.lamps.as_mut().map(|lamps| lamps.take_up(from));
        let passes = passes.transpose()?;
        let ladders = from.ladders();
        let chains = self.chains.iter_mut();
        let mut taken = 0;
        for chain in chains.filter(|chain| ladders.contains(&chain.ladder)) {
            let kept: Chain = from.value()?;
            kept.check(chain.ladder, &self.family)?;
            taken += kept.metropolis.statistics().steps;
            *chain = kept;
        }
        if passes != self.lamps.as_ref().map(|lamps| lamps.due(taken)) {
            return Err(StateError::damaged(
                "its lamps do not keep up with its chains",
            ));
        }
        // What several shares are due together is more than the most of any.
        let steps = self.statistics().steps;
        if let Some(lamps) = &mut self.lamps {
            lamps.keep_up(steps);
        }
        Ok(())
    }
}

impl Chain {
    /// Refuses what no chain of this ladder can have written.
    fn check(&self, ladder: u32, family: &ScalarContribution) -> Result<(), StateError> {
        let statistics = self.metropolis.statistics();
        let steps = Reader::count(statistics.steps)?;
        let moves = statistics.moves.iter().map(|kind| kind.proposed);
        let counts = moves.chain([statistics.independent[0].count(), statistics.defects]);
        if self.ladder != ladder || counts.max() > Some(steps) {
            return Err(StateError::damaged("a chain does not agree with itself"));
        }
        self.nonfinite.checked()?;
        for rays in [self.rays.closest, self.rays.any] {
            Reader::count(rays)?;
        }
        if self.metropolis.density().to_bits() != family.of(self.metropolis.value()).to_bits() {
            return Err(StateError::damaged(
                "a chain's density is not that of its path",
            ));
        }
        Ok(())
    }
}
