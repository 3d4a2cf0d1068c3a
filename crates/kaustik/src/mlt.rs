//! Metropolis light transport on paths (Veach and Guibas 1997; spec: path-space-mlt.md).
//!
//! A pool of independent samples, each a pair of walks joined in every way, estimates b, the integral of the
//! paths' density; each chain starts at a path chosen from the pool in proportion to its weight, so
//! that b / M times the visits of M mutations are an unbiased picture from the first step on. Between
//! mutations further samples are made, so that b becomes better while the picture does.

use std::io;
use std::ops::Range;
use std::sync::atomic::AtomicBool;

use glam::DVec2;
use kaustik_film::{Counters, Film, Image, Quantum, develop};
use kaustik_mcmc::{
    Mean, Metropolis, Mixture, Move, Pcg64Dxsm, Pool, SampleGenerators, Statistics, Visit,
    generator, sample_generator,
};
use kaustik_mutate::{
    BidirectionalMutation, CausticPerturbation, EveryPerturbation, LensMutation, LensPerturbation,
    Path, PathSpace, Radii, Run, Seeds, TimeMutation, Told, WavelengthMutation, WrittenPath,
};
use kaustik_path::{Event, Role, trace};
use kaustik_scene::Scene;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::control::is_stopped;
use crate::engine::{Engine, Nonfinite, STRIDE, add_counters, add_nonfinite};
use crate::lamps::Lamps;
use crate::render::builder_settings;
use crate::state::{Keep, Reader, StateError, Writer};
use crate::{
    ChainStatistics, Jitter, MutationStatistics, Mutations, Normaliser, Options, Place,
    RenderError, RenderSettings,
};

/// The pool's samples come from a ladder that no render has.
const POOL_LADDER: u64 = u64::MAX;
/// So does the choice of the starts.
const CHOICE_LADDER: u64 = u64::MAX - 1;
/// And so do the samples between mutations, from here on one ladder for each chain.
const FRESH_LADDERS: u64 = u64::MAX - 65_536;
/// A sample for so many mutations: it takes the time of a few.
const EACH: u64 = 64;

/// How many kinds of mutations there are.
const KINDS: usize = Mutations::NAMES.len();

/// How often each is made where it suits, in the order of their names: the two that trace no part that a
/// perturbation keeps, and the one that traces nothing, need to come by only now and then.
const SHARES: [f64; KINDS] = [1.0, 1.0, 1.0, 1.0, 0.25, 0.25, 0.5, 1.0];

/// Chains on a film.
pub(crate) struct MltEngine<'a> {
    space: PathSpace<'a>,
    options: Options,
    chains: Vec<Chain>,
    film: Film,
    lamps: Option<Lamps<'a>>,
    pool: Mean,
    size: DVec2,
    /// Of this process; where the pool is dark they have no chains.
    ladders: Range<u32>,
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

/// The family of one density.
fn density(path: &Path) -> [f64; 1] {
    [path.density()]
}

impl<'a> MltEngine<'a> {
    /// Fills the pool and starts the chains.
    pub(crate) fn new(scene: &'a Scene, settings: &RenderSettings) -> Result<Self, RenderError> {
        let options = settings.options;
        let size = DVec2::new(f64::from(settings.width), f64::from(settings.height));
        let space = PathSpace {
            scene,
            settings: builder_settings(settings),
            target: options.target,
            pixels: size,
        };
        let pool = Pool::new(pool(&space, settings));
        let b = pool.normaliser().mean();
        Ok(Self {
            chains: start_chains(&space, &pool, settings),
            film: Film::with_layout(&settings.layout(), Quantum::from_mean(b / 3.0))?,
            lamps: Lamps::new(scene, settings)?,
            pool: *pool.normaliser(),
            space,
            options,
            size,
            ladders: settings.ladder_range(),
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
        let radii = self.options.jitter.radii(self.size, Jitter::Veach);
        let [least, most] = self.options.angles;
        let angles = Radii { least, most };
        let lens = |run| LensPerturbation {
            space,
            radii,
            angles,
            run,
        };
        let (single, multiple) = (lens(Run::Single), lens(Run::Multiple));
        let caustic = CausticPerturbation { space, radii };
        let (subpath, wavelengths) = (LensMutation { space }, WavelengthMutation { space });
        let time = TimeMutation { space };
        let made = self.options.mutations;
        let every = EveryPerturbation {
            space,
            fraction: made.fraction,
        };
        let suits = |path: &Path| {
            let suited = [
                true,
                made.holds(1) && single.suits(path),
                made.holds(2) && multiple.suits(path),
                made.holds(3) && caustic.suits(path),
                made.holds(4) && subpath.suits(path),
                made.holds(5) && wavelengths.suits(path),
                made.holds(6) && time.suits(path),
                made.holds(Mutations::EVERY) && every.suits(path),
            ];
            std::array::from_fn(|i| {
                if suited[i] && made.holds(i) {
                    SHARES[i]
                } else {
                    0.0
                }
            })
        };
        let kernels = (
            BidirectionalMutation { space },
            single,
            multiple,
            caustic,
            subpath,
            wavelengths,
            time,
            every,
        );
        let kernel = Told {
            kernel: Mixture::<_, _, KINDS>::new(kernels, suits),
            space,
            names: &Mutations::NAMES,
        };
        let mut record = |visit: Visit<'_, Path, 1>| self.deposit(&visit);
        let running = self.options.normaliser == Normaliser::Running;
        let instant = chain.metropolis.value().time();
        for done in 0..steps {
            let moved_on = chain.metropolis.value().time().total_cmp(&instant).is_ne();
            if moved_on || (done % STRIDE == 0 && is_stopped(stop)) {
                return done;
            }
            let step = chain.metropolis.statistics().steps;
            if running && step % EACH == 0 {
                let weight = seeds.sample(path, &mut chain.fresh);
                if weight > 0.0 {
                    space.tell(path, Role::Sampled(weight));
                }
                chain.see(weight, step);
            }
            (chain.metropolis).step(&kernel, &density, &mut chain.draws, &mut record);
        }
        steps
    }

    /// The estimate of `b` that scales the image: independent samples all, and so its standard error is
    /// theirs.
    fn normaliser(&self) -> Mean {
        let mut mean = self.pool;
        for chain in &self.chains {
            mean.merge(&chain.independent);
        }
        mean
    }

    /// Adds the pool's `b` times the path's colour, whose scalar is 1, at its raster point.
    fn deposit(&self, visit: &Visit<'_, Path, 1>) {
        let at = visit.value.raster() * self.size;
        let weight = visit.weight * self.pool.mean();
        if weight > 0.0 {
            (self.film).splat_weighted(at.x, at.y, visit.value.colour(), weight);
        }
    }

    /// All chains' statistics, in the order of the ladders.
    fn statistics(&self) -> Statistics<1> {
        let mut all = Statistics::new();
        for chain in &self.chains {
            all.merge(chain.metropolis.statistics());
        }
        all
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

/// Weights of independent samples, in parallel, in the order of their indices.
fn pool(space: &PathSpace<'_>, settings: &RenderSettings) -> Vec<f64> {
    let generators = SampleGenerators::new(settings.seed, POOL_LADDER);
    (0..settings.options.pilot as usize)
        .into_par_iter()
        .with_min_len(256)
        .map_init(
            || (Seeds::new(space), Path::default()),
            |(seeds, path), index| seeds.sample(path, &mut generators.at(index as u64)),
        )
        .collect()
}

/// A chain for every ladder of this process; none if the pool saw nothing. All ladders choose, so that a
/// share of them starts as it would among all.
fn start_chains(space: &PathSpace<'_>, pool: &Pool, settings: &RenderSettings) -> Vec<Chain> {
    let mut choice = generator(settings.seed, CHOICE_LADDER);
    let range = settings.ladder_range();
    let mut seeds = Seeds::new(space);
    let mut chains = Vec::new();
    for ladder in 0..settings.options.ladders {
        let Some(start) = pool.choose(&mut choice) else {
            break;
        };
        if !range.contains(&ladder) {
            continue;
        }
        let mut path = Path::default();
        let mut draws = sample_generator(settings.seed, POOL_LADDER, start.index);
        seeds.sample(&mut path, &mut draws);
        chains.push(Chain {
            ladder,
            nonfinite: Nonfinite::default(),
            draws: generator(settings.seed, u64::from(ladder)),
            fresh: generator(settings.seed, FRESH_LADDERS + u64::from(ladder)),
            independent: Mean::new(),
            metropolis: Metropolis::at((), path, &density, 0),
        });
    }
    chains
}

impl Engine for MltEngine<'_> {
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
            let mut record = |visit: Visit<'_, Path, 1>| self.deposit(&visit);
            chain.metropolis.flush(&mut record);
        }
        self.chains = chains;
        let steps = self.statistics().steps.max(1);
        let per_step = self.size.element_product() / steps as f64;
        // where the pool saw no light the film is empty
        let scale = match self.pool.mean() {
            mean if mean > 0.0 => self.normaliser().mean() / mean,
            _ => 0.0,
        };
        let mut films = vec![(&self.film, scale * per_step)];
        films.extend(self.lamps.iter().map(Lamps::part));
        Ok(develop(&films)?)
    }

    fn chain_statistics(&self) -> Option<ChainStatistics> {
        let statistics = self.statistics();
        let b = self.normaliser();
        Some(ChainStatistics {
            // What keeps most of a path, and what may make all of it anew.
            small_acceptance: rate(&statistics, &[1, 2, 3, Mutations::EVERY]),
            large_acceptance: rate(&statistics, &[0]),
            ..ChainStatistics::new(
                &statistics,
                [b.mean(), b.standard_error()],
                self.pool.mean(),
            )
        })
    }

    fn mutation_statistics(&self) -> Vec<MutationStatistics> {
        let statistics = self.statistics();
        let kinds = Mutations::NAMES.iter().zip(&statistics.moves);
        kinds
            .map(|(name, moves)| MutationStatistics {
                name,
                proposed: moves.proposed,
                acceptance: moves.rate(),
            })
            .collect()
    }

    fn nonfinite(&self) -> (u64, Vec<Place>) {
        let places = self.chains.iter().filter_map(|chain| {
            let step = chain.metropolis.statistics().first_defect?;
            let ladder = chain.ladder;
            Some(Place { ladder, step })
        });
        let proposed = (self.statistics().defects, places.collect());
        let chains = self.chains.iter();
        let fresh = Nonfinite::all(chains.map(|chain| (chain.ladder, chain.nonfinite)));
        let own = add_nonfinite(proposed, Some(fresh));
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

    fn film_counters(&self) -> Counters {
        let lamps = self.lamps.as_ref().map(Lamps::film_counters);
        add_counters(self.film.counters(), lamps.unwrap_or_default())
    }

    fn is_lit(&self) -> bool {
        self.pool.mean() > 0.0 || self.lamps.as_ref().is_some_and(Lamps::is_lit)
    }
}

/// Film and chains; the pool is filled again, and compared.
impl Keep for MltEngine<'_> {
    fn taken(&self) -> Vec<u64> {
        let mut taken = vec![0; self.ladders.len()];
        let chains = self.chains.iter().map(|c| c.metropolis.statistics().steps);
        taken
            .iter_mut()
            .zip(chains)
            .for_each(|(taken, steps)| *taken = steps);
        taken
    }

    fn write(&self, out: &mut Writer<'_>) -> io::Result<()> {
        out.value(&self.pool)?;
        out.film(&self.film)?;
        if let Some(lamps) = &self.lamps {
            lamps.write(out)?;
        }
        (self.chains.iter()).try_for_each(|chain| out.value(&chain.written()))
    }

    fn take_up(&mut self, from: &mut Reader<'_>) -> Result<(), StateError> {
        let pool: Mean = from.value()?;
        if pool != self.pool {
            return Err(StateError::pilot(pool.mean(), self.pool.mean()));
        }
        from.film(&mut self.film)?;
        let passes = self.lamps.as_mut().map(|lamps| lamps.take_up(from));
        let passes = passes.transpose()?;
        let ladders = from.ladders();
        let mut taken = 0;
        for chain in (self.chains.iter_mut()).filter(|c| ladders.contains(&c.ladder)) {
            *chain = from.value::<Kept>()?.checked(chain.ladder, &self.space)?;
            taken += chain.metropolis.statistics().steps;
        }
        if passes != self.lamps.as_ref().map(|lamps| lamps.due(taken)) {
            return Err(StateError::damaged(
                "its lamps do not keep up with its chains",
            ));
        }
        let steps = self.statistics().steps;
        if let Some(lamps) = &mut self.lamps {
            lamps.keep_up(steps);
        }
        Ok(())
    }
}

impl Chain {
    fn written(&self) -> Kept {
        Chain {
            ladder: self.ladder,
            nonfinite: self.nonfinite,
            draws: self.draws.clone(),
            fresh: self.fresh.clone(),
            independent: self.independent,
            metropolis: (self.metropolis).with_value(self.metropolis.value().written()),
        }
    }
}

impl Kept {
    /// Refuses what no chain of this ladder can have written.
    fn checked(self, ladder: u32, space: &PathSpace<'_>) -> Result<Chain, StateError> {
        let statistics = self.metropolis.statistics();
        let steps = Reader::count(statistics.steps)?;
        let moves = statistics.moves.iter().map(|kind| kind.proposed);
        let counts = moves.chain([self.independent.count(), statistics.defects]);
        if self.ladder != ladder || counts.max() > Some(steps) {
            return Err(StateError::damaged("a chain does not agree with itself"));
        }
        let path = space.read(self.metropolis.value());
        let path = path.filter(|p| p.density().to_bits() == self.metropolis.density().to_bits());
        let path =
            path.ok_or_else(|| StateError::damaged("a chain's path is none of the scene"))?;
        Ok(Chain {
            ladder,
            nonfinite: self.nonfinite.checked()?,
            draws: self.draws,
            fresh: self.fresh,
            independent: self.independent,
            metropolis: self.metropolis.with_value(path),
        })
    }
}

/// Mean acceptance of several kinds.
fn rate(statistics: &Statistics<1>, kinds: &[usize]) -> f64 {
    let sum = |of: fn(&kaustik_mcmc::Acceptance) -> f64| -> f64 {
        kinds.iter().map(|&kind| of(&statistics.moves[kind])).sum()
    };
    sum(|moves| moves.expected) / sum(|moves| moves.proposed as f64).max(1.0)
}

const _: () = assert!(KINDS <= Move::KINDS);
