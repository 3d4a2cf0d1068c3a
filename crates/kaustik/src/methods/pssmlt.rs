//! Primary sample space Metropolis light transport (Kelemen et al. 2002).

mod keep;
mod pilot;
mod small;

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use kaustik_estimate::{CountedTarget, KelemenDeposit, Mis, PathTarget, ScalarContribution, Scale};
use kaustik_film::{Counters, Film, Image, Quantum, develop};
use kaustik_mcmc::{
    Estimate, Family, Mean, Metropolis, Pcg64Dxsm, Point, PointKernel, Pool, Statistics,
};
use kaustik_path::{Contributions, Event, PathBuilder, RayCounts};
use kaustik_scene::Scene;
use serde::{Deserialize, Serialize};

use crate::beside::Besides;
use crate::beside::lamps::Lamps;
use crate::beside::meter::{Fit, Meter, OwnSamples};
use crate::chains::{self, LadderChain};
use crate::control::is_stopped;
use crate::engine::{Engine, Nonfinite, STRIDE, add_counters, add_nonfinite, add_rays};
use crate::methods::builders::builder;
use crate::sampling::streams;
use crate::{
    Builder, ChainStatistics, Method, Normaliser, Options, RenderError, RenderSettings, StepId,
};
use pilot::{rough_constant, start_chains};

pub(crate) use pilot::pilot;
pub(crate) use small::Small;

/// Chains on one pair of films, which follow a density of what a point contributes.
pub(crate) struct PssmltEngine<'a, F = ScalarContribution> {
    scene: &'a Scene,
    builder: Box<dyn PathBuilder + 'a>,
    family: F,
    options: Options,
    chains: Vec<Chain>,
    chain_film: Film,
    large_film: Option<Film>,
    besides: Besides<'a>,
    pool: Mean,
    /// The constant in the weights; 0 if neither pool nor pilot saw any light.
    b0: f64,
    scale: Scale,
    /// Raster area of the window in pixels.
    area: f64,
}

/// Mutations for each cell of a pass of a [`Meter`]: a tenth to a fifth of the time.
fn mutations_a_cell(settings: &RenderSettings) -> u64 {
    match settings.options.builder {
        Builder::Bidirectional if settings.method == Method::Pssmlt => 40,
        _ => 160,
    }
}

/// One ladder.
#[derive(Serialize, Deserialize)]
struct Chain {
    ladder: u32,
    nonfinite: Nonfinite,
    rays: RayCounts,
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
        let besides = Besides::of_lamps(Lamps::new(scene, settings)?);
        let mut engine = Self::of_family(scene, settings, builder, family, besides)?;
        if engine.b0 > 0.0 {
            let own = OwnSamples {
                variance: engine.pool.variance(),
                per_mutation: options.p_large,
            };
            let fit = Fit {
                mutations_a_cell: mutations_a_cell(settings),
                unit: 1.0,
            };
            engine.besides.meter = Meter::new(scene, settings, own, fit);
        }
        Ok(engine)
    }
}

impl<'a, F: Family<Contributions, 1> + Send + Sync> PssmltEngine<'a, F> {
    /// Over the paths of this builder, by the density of this family.
    pub(crate) fn of_family(
        scene: &'a Scene,
        settings: &RenderSettings,
        builder: Box<dyn PathBuilder + 'a>,
        family: F,
        besides: Besides<'a>,
    ) -> Result<Self, RenderError> {
        let options = settings.options;
        let nonfinite = AtomicU64::new(0);
        let target = PathTarget {
            scene,
            builder: builder.as_ref(),
            nonfinite: &nonfinite,
        };
        let pool = Pool::new(pilot(
            target,
            &family,
            settings,
            streams::PILOT,
            0..settings.pilot(),
        ));
        let b0 = constant(&options, &pool, || {
            rough_constant(target, &family, settings)
        });
        let chains = start_chains(target, &family, &pool, settings)?;
        let layout = settings.layout();
        let quantum = Quantum::from_sum_of_xyz(b0);
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
            besides,
            pool: *pool.normaliser(),
            b0,
            scale: settings.scale(),
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

    fn statistics(&self) -> Statistics<1> {
        chains::statistics(&self.chains)
    }

    /// The estimate of `b` that scales the image.
    fn normaliser(&self, statistics: &Statistics<1>) -> Estimate {
        // Printed weights have the pool's in them: no other scales what they gave.
        if self.options.mis == Mis::Printed {
            return self.pool.into();
        }
        let own = &statistics.independent[0];
        if let Some(meter) = &self.besides.meter {
            return meter.with(own);
        }
        let mut mean = self.pool;
        if self.options.normaliser == Normaliser::Running {
            mean.merge(own);
        }
        mean.into()
    }
}

/// The constant in the weights; 0 if nobody who may be asked saw any light.
///
/// Kelemen's printed weights want b itself; without weights of large steps it cancels. The split ones want a constant that
/// knows nothing of the pool, or pictures whose pool was lucky are too bright and no others too dark. A running normaliser
/// outgrows that.
fn constant(options: &Options, pool: &Pool, rough: impl Fn() -> Option<f64>) -> f64 {
    let of_pool = Some(pool.normaliser().mean()).filter(|b| *b > 0.0);
    match (options.mis, options.normaliser) {
        (Mis::Printed | Mis::Off, _) => of_pool.or_else(rough),
        (Mis::Split, Normaliser::Running) => rough().or(of_pool),
        (Mis::Split, _) => rough(),
    }
    .unwrap_or(0.0)
}

impl LadderChain for Chain {
    fn ladder(&self) -> u32 {
        self.ladder
    }

    fn statistics(&self) -> &Statistics<1> {
        self.metropolis.statistics()
    }
}

impl<F: Family<Contributions, 1> + Send + Sync> Engine for PssmltEngine<'_, F> {
    fn advance(&mut self, plan: &[u64], stop: Option<&AtomicBool>) -> u64 {
        let mut chains = std::mem::take(&mut self.chains);
        let [taken, steps] = chains::advance(&mut chains, plan, |chain, steps| {
            self.drive(chain, steps, stop);
        });
        self.chains = chains;
        self.besides.keep_up(steps);
        taken
    }

    fn develop(&mut self) -> Result<Image, RenderError> {
        let mut chains = std::mem::take(&mut self.chains);
        for chain in &mut chains {
            chain.metropolis.flush(&mut self.deposit());
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
        films.extend(self.besides.parts());
        Ok(develop(&films)?)
    }

    fn chain_statistics(&self) -> Option<ChainStatistics> {
        let statistics = self.statistics();
        let b = self.normaliser(&statistics);
        let metered =
            (self.besides.meter.as_ref()).map(|meter| meter.share(&statistics.independent[0]));
        Some(ChainStatistics {
            metered: metered.unwrap_or_default(),
            ..ChainStatistics::new(&statistics, [b.value, b.standard_error], self.b0)
        })
    }

    fn nonfinite(&self) -> (u64, Vec<StepId>) {
        let chains = self.chains.iter();
        let own = Nonfinite::all(chains.map(|chain| (chain.ladder, chain.nonfinite)));
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

    fn rays(&self) -> Option<RayCounts> {
        let chains = self.chains.iter().map(|chain| chain.rays);
        Some(add_rays(chains.chain([self.besides.rays()])))
    }

    fn film_counters(&self) -> Counters {
        let large = self.large_film.as_ref().map(Film::counters);
        let others = add_counters(large.unwrap_or_default(), self.besides.film_counters());
        add_counters(self.chain_film.counters(), others)
    }

    fn is_lit(&self) -> bool {
        self.b0 > 0.0 || self.pool.mean() > 0.0 || self.besides.is_lit()
    }
}
