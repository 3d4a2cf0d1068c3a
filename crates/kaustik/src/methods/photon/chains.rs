//! Photons of Markov chains that exchange states (Hachisuka and Jensen 2011; Gruson et al. 2016, sec. 4.4).

mod iteration;
mod keep;
mod mark;
mod periods;
mod replay;
mod start;
mod step_sizes;
mod sums;
#[cfg(test)]
mod tests;

use std::io;
use std::sync::atomic::AtomicBool;

use kaustik_estimate::{
    Combine, PhotonLevels, PhotonTarget, PhotonTargetKind, PhotonValue, Sharing,
};
use kaustik_film::{Counters, Film, Image, Layer, Quantum};
use kaustik_mcmc::{
    AcceptanceAdaptation, Draws, Ladder, Mean, Pcg64Dxsm, Point, PointKernel, Power, Statistics,
    generator,
};
use kaustik_path::Event;
use kaustik_spectrum::{Rgb, Xyz};
use rayon::prelude::*;

use super::Tracer;
use super::maps::Maps;
use super::stage::Stage;
use super::targets::{Space, Targets};
use crate::control::is_stopped;
use crate::engine::{Nonfinite, add_counters};
use crate::sampling::streams;
use crate::settings::photon_options::Normalisation;
use crate::state::{Reader, StateError, Writer};
use crate::statistics::{PhotonLevel, PhotonStatistics};
use crate::{ChainStatistics, PhotonOptions, RenderError, RenderSettings, StepId};
use iteration::{Course, Iteration, Unheard};
use periods::Periods;

/// Steps of each chain that tell nothing where targets change little: new points take a few from the dark.
const LEAST_BURN_IN: u64 = 64;
/// Where they go by the points, one step of so many of the last chain. In each iteration other states are the rare ones of high targets:
/// as long as the last chain is not yet in one, what it brings of all others is too bright.
const BURNT_IN: u64 = 16;

/// Ladders of K chains each: the first draws uniform light paths, the others follow targets.
pub(super) struct PhotonChains<const K: usize> {
    levels: PhotonLevels<K>,
    options: PhotonOptions,
    ladders: Vec<Chains<K>>,
    periods: Periods<K>,
    /// One for each level but the last, which is lent `spare`. Empty between two iterations, except
    /// for the uniform level's where visibility's normaliser is still to come.
    films: Vec<Film>,
    first: mark::First,
    targets: Targets<K>,
    adaptations: [AcceptanceAdaptation<Power>; K],
    /// Rough normalisers: those of the iteration before.
    rough: [f64; K],
    /// The unit of contributions of single photons of uniform light paths.
    quantum: Quantum,
    /// Share of uniform light paths that are visible, by the samples of the start; never 0.
    visible_at_start: f64,
    /// XYZ of each pixel, summed over iterations. Where visibility's normaliser comes only at the end: of all
    /// chains but the first, not yet multiplied by it.
    sums: Vec<[f64; 3]>,
    /// Of visibility, over iterations; `None` where each iteration has its own.
    visible: Option<Mean>,
    /// Iterations in which any chain but the first was lit: what waits for visibility's normaliser is their mean.
    lit: u64,
    revival: Pcg64Dxsm,
    maps: Option<Maps>,
    iterations: u64,
    /// Of each ladder.
    nonfinite: Vec<Nonfinite>,
    /// What films of iterations before have left out.
    counters: Counters,
    /// Of the last iteration: normalisers, their errors.
    normalisers: [[f64; 2]; K],
    /// Of the power of photons, relative.
    power_spread: f64,
}

/// One ladder with its generator.
struct Chains<const K: usize> {
    draws: Pcg64Dxsm,
    ladder: Ladder<Point<Power>, PhotonValue, K>,
    counts: [f64; K],
    /// Faults of the last iteration.
    found: Nonfinite,
}

impl<const K: usize> PhotonChains<K> {
    /// For a stage whose first iteration has begun: chooses the first states and lets step sizes learn.
    pub(super) fn new(
        stage: &Stage<'_>,
        settings: &RenderSettings,
        levels: PhotonLevels<K>,
        space: Space,
    ) -> Result<Self, RenderError> {
        let options = settings.options.photon;
        // Before there are films: a look at where points are takes memory of its own.
        let mut targets = Targets::new(stage, options, &levels, space);
        targets.assign(stage);
        let power = stage.power();
        let quantum = stage.quantum(&power);
        let films = (1..K).map(|_| Film::with_layout(&settings.layout(), quantum));
        let films = films.collect::<Result<_, _>>()?;
        // One share of visible paths for all iterations is roughly right at best (decision 026); where something moves or
        // discs shrink it is not even that.
        let progressive = options.normalisation == Normalisation::Progressive
            && levels.0.get(1) == Some(&PhotonTargetKind::Visibility)
            && !stage.moves()
            && options.reduction.is_none();
        let adaptation = step_sizes::adaptation(options.acceptance);
        let mut chains = Self {
            levels,
            options,
            ladders: Vec::new(),
            // until it is known how much is visible
            periods: Periods::new(options.pace, &levels, 0.0),
            films,
            first: mark::First::default(),
            targets,
            adaptations: std::array::from_fn(|_| adaptation.clone()),
            rough: [1.0; K],
            quantum,
            visible_at_start: 1.0,
            sums: vec![[0.0; 3]; settings.pixels() as usize],
            visible: progressive.then(Mean::new),
            lit: 0,
            revival: generator(settings.seed, streams::REVIVAL),
            maps: options.maps.then(|| Maps::new(settings)),
            iterations: 0,
            nonfinite: Vec::new(),
            counters: Counters::default(),
            normalisers: [[0.0; 2]; K],
            power_spread: spread(&power),
        };
        chains.start(stage, settings);
        chains.warm_up(stage);
        Ok(chains)
    }

    fn target<'t>(&'t self, stage: &'t Stage<'_>) -> PhotonTarget<'t> {
        PhotonTarget {
            scene: stage.scene(),
            tracing: stage.tracing,
            map: stage.map(),
            targets: self.targets.of_points(),
        }
    }

    /// Reads states under targets that have changed. Where other wavelengths or points have left a chain in
    /// the dark, it goes on from where another one of its level is; of another level if there is none.
    fn read_anew(&mut self, stage: &Stage<'_>) {
        let mut ladders = std::mem::take(&mut self.ladders);
        let target = self.target(stage);
        (ladders.par_iter_mut().with_max_len(1)).for_each(|chains| {
            let Chains { ladder, draws, .. } = chains;
            ladder.evaluate_anew(&target, &self.levels, draws);
        });
        let lit = |ladders: &[Chains<K>], ladder: usize, level: usize| {
            let replica: &Ladder<_, _, K> = &ladders[ladder].ladder;
            replica.replicas()[level].density() > 0.0
        };
        let all = || (1..K).flat_map(|level| (0..ladders.len()).map(move |l| (l, level)));
        let living: Vec<_> = all()
            .filter(|&(l, level)| lit(&ladders, l, level))
            .collect();
        let dark: Vec<_> = all()
            .filter(|&(l, level)| !lit(&ladders, l, level))
            .collect();
        for (ladder, level) in dark {
            let own = living.iter().filter(|from| from.1 == level);
            let mut own: Vec<_> = own.collect();
            if own.is_empty() {
                own = living.iter().collect();
            }
            if own.is_empty() {
                break;
            }
            let &(from, at) = own[(self.revival.uniform() * own.len() as f64) as usize];
            let Chains { ladder: source, .. } = &ladders[from];
            let source = source.replicas()[at].clone();
            let Chains {
                ladder: chains,
                draws,
                ..
            } = &mut ladders[ladder];
            chains.restart_from(level, &source, draws);
        }
        self.ladders = ladders;
    }

    /// The iteration itself: chains go on from where they were, under targets that have changed. `false`: it was
    /// stopped.
    fn run(&mut self, stage: &Stage<'_>, spare: &Film, stop: Option<&AtomicBool>) -> bool {
        self.read_anew(stage);
        let mut ladders = std::mem::take(&mut self.ladders);
        let iteration = self.shared(stage, spare, ladders.len());
        ladders
            .par_iter_mut()
            .enumerate()
            .with_max_len(1)
            .for_each(|(index, chains)| iteration.run(index, chains, &mut Unheard { stop }));
        self.ladders = ladders;
        // The flag stays up: without it no ladder went home early.
        !is_stopped(stop)
    }

    /// What so many ladders share in the iteration that the stage has begun.
    fn shared<'t>(
        &'t self,
        stage: &'t Stage<'_>,
        spare: &'t Film,
        ladders: usize,
    ) -> Iteration<'t, K> {
        Iteration {
            target: self.target(stage),
            levels: &self.levels,
            number: self.iterations,
            course: self.course(stage, ladders),
            scale: stage.scale,
            films: std::array::from_fn(|level| self.films.get(level).unwrap_or(spare)),
            sharing: self.sharing(),
            regions: self.targets.sums(),
            visits_to_a_witness: self.periods.visits_to_a_witness(),
            touches: self.maps.as_ref().map(Maps::touches),
        }
    }

    fn sharing(&self) -> Sharing<K> {
        let (combine, mut samples) = (self.options.combine, self.periods.rates());
        // Means of what each chain estimates by itself, as in the paper, go by the samples that there are.
        if combine == Combine::Balance {
            for (samples, worth) in samples.iter_mut().zip(self.periods.worths()) {
                *samples *= worth;
            }
        }
        Sharing {
            combine,
            rough: self.rough,
            samples,
        }
    }

    /// The sweeps that so many ladders take in any iteration.
    fn course(&self, stage: &Stage<'_>, ladders: usize) -> Course<K> {
        let mut course = Course {
            burn_in: LEAST_BURN_IN,
            sweeps: self.periods.sweeps(stage.photons),
            ladders: ladders as u64,
            periods: self.periods,
        };
        if self.levels.ask_of_points() {
            let steps = course.count(K - 1) / course.ladders;
            course.burn_in = course.burn_in.max(steps / BURNT_IN);
        }
        course.burn_in = self.options.burn_in.unwrap_or(course.burn_in);
        course
    }

    /// The unit of a level's film in this iteration. Where few light paths are visible, those that chains visit each stand for
    /// little: by the balance heuristic a visit weighs as much as all visible paths at most, times the chains' relative numbers of samples. In the unit of whole
    /// photons it would be rounded away.
    fn quantum(&self, level: usize) -> Quantum {
        let weighs_little = level > 0 || self.options.combine == Combine::Balance;
        if !weighs_little {
            return self.quantum;
        }
        let of_chain = (self.levels.0.iter().zip(self.rough))
            .find(|(kind, _)| **kind == PhotonTargetKind::Visibility);
        let visible = of_chain.map_or(self.visible_at_start, |(_, share)| share);
        self.quantum.scaled(visible.min(1.0))
    }

    /// Black films in their units, but for one that goes on.
    fn renew_films(&mut self, spare: &mut Film) {
        let units: [Quantum; K] = std::array::from_fn(|level| self.quantum(level));
        let goes_on = usize::from(self.visible.is_some());
        let films = self.films.iter_mut().chain(std::iter::once(spare));
        for (film, unit) in films.zip(units).skip(goes_on) {
            film.renew(unit);
        }
    }

    /// Targets of the points of the iteration that the stage has begun.
    fn begin(&mut self, stage: &Stage<'_>) {
        let grown = self.targets.assign(stage);
        for (rough, kind) in self.rough.iter_mut().zip(self.levels.0) {
            *rough *= grown[kind as usize];
        }
        self.targets.expect(&self.levels, &self.rough);
        if let Some(maps) = &mut self.maps {
            maps.begin(stage);
        }
    }
}

/// Standard deviation over the mean; 0 where nothing is known.
fn spread(of: &Mean) -> f64 {
    if of.count() > 1 && of.mean() > 0.0 {
        of.variance().sqrt() / of.mean()
    } else {
        0.0
    }
}

/// Large steps for the first level, small ones for all others.
fn kernels<'t, const K: usize>(
    target: &'t PhotonTarget<'t>,
) -> [PointKernel<&'t PhotonTarget<'t>>; K] {
    std::array::from_fn(|level| PointKernel::new(target, if level == 0 { 1.0 } else { 0.0 }))
}

impl<const K: usize> Tracer for PhotonChains<K> {
    fn trace(&mut self, stage: &Stage<'_>, spare: &mut Film, stop: Option<&AtomicBool>) -> bool {
        let mark = stop.is_some().then(|| self.mark());
        self.begin(stage);
        self.renew_films(spare);
        if !self.run(stage, spare, stop) {
            if let Some(mark) = mark {
                self.take_back(mark);
            }
            return false;
        }
        self.iterations += 1;
        if let Some(maps) = &mut self.maps {
            maps.end(stage);
        }
        let factors = self.normalise();
        self.collect(spare, &factors.of_films);
        self.targets.learn(&factors.of_all);
        for (nonfinite, chains) in self.nonfinite.iter_mut().zip(&self.ladders) {
            *nonfinite = nonfinite.and(chains.found);
        }
        for level in 0..K {
            if self.normalisers[level][0] > 0.0 {
                self.rough[level] = self.normalisers[level][0];
            }
        }
        self.adapt();
        true
    }

    fn write(&self, out: &mut Writer<'_>) -> io::Result<()> {
        self.write_down(out)
    }

    fn take_up(&mut self, from: &mut Reader<'_>, iterations: u64) -> Result<(), StateError> {
        self.take_from(from, iterations)
    }

    fn add_to(&mut self, stage: &Stage<'_>, image: &mut Image) -> Result<(), RenderError> {
        self.first = mark::First::default();
        let factor = stage.cell_area() / self.iterations.max(1) as f64;
        // The first chain's normaliser is 1.
        let first = 1.0 / self.course(stage, self.ladders.len()).count(0) as f64;
        let pixels = self.total(first);
        image.add_pixels(pixels.map(|sum| Rgb::from(Xyz(sum.map(|v| (v * factor) as f32))).0));
        Ok(())
    }

    fn layers(&self, stage: &Stage<'_>) -> Vec<Layer> {
        let maps = self.maps.as_ref();
        maps.map_or(Vec::new(), |maps| maps.layers(stage, &self.targets))
    }

    fn chain_statistics(&self) -> Option<ChainStatistics> {
        let mut all = Statistics::new();
        for chains in &self.ladders {
            for replica in &chains.ladder.replicas()[1..] {
                all.merge(replica.statistics());
            }
        }
        Some(ChainStatistics::new(
            &all,
            self.normalisers[K - 1],
            self.rough[K - 1],
        ))
    }

    fn photon_statistics(&self) -> Option<PhotonStatistics> {
        let level = |level: usize| PhotonLevel {
            target: self.targets.name(self.levels.0[level]),
            normaliser: self.normalisers[level][0],
            error: self.normalisers[level][1],
            acceptance: self.small_steps(level).rate(),
            step_size: self.adaptations[level].mutation().size(),
        };
        Some(PhotonStatistics {
            iterations: self.iterations,
            regions: self.targets.cut(),
            power_spread: self.power_spread,
            levels: (0..K).map(level).collect(),
        })
    }

    fn iteration(&self, stage: &Stage<'_>, place: StepId) -> Option<u64> {
        let at = self.step(stage, place)?;
        Some(at.iteration)
    }

    fn replay(&mut self, stage: &mut Stage<'_>, spare: &mut Film, place: StepId) -> Vec<Event> {
        self.show(stage, spare, place)
    }

    fn nonfinite(&self) -> (u64, Vec<StepId>) {
        Nonfinite::all((0..).zip(self.nonfinite.iter().copied()))
    }

    fn film_counters(&self) -> Counters {
        add_counters(self.counters, self.films[0].counters())
    }
}
