//! One attempt at an annealing: particles go up from replica to replica.

use std::array::from_fn;

use kaustik_estimate::{PathTarget, ReplicaFamily, ReplicaSet, ScalarTarget, SpecularSplit};
use kaustik_mcmc::{
    Draws, Estimate, Extinct, Family, Ignore, LevelKernel, Pcg64Dxsm, Point, Population,
    Resampling, SampleGenerators, checked_densities, generator,
};
use kaustik_path::{Contributions, Sighting};
use kaustik_pss::{Coordinates, Stream};
use rayon::prelude::*;

use super::easy::Easy;
use super::kernels::{Mutation, kernels, mutation};
use super::scouts::{Scouts, scouting};
use super::start::{PoolSample, Started, State, samples};
use crate::beside::meter::{Hunt, Places};
use crate::sampling::shuffle::Shuffle;
use crate::sampling::streams;
use crate::{EvenSamples, Method, RenderSettings};

/// Small steps of every particle at a level: copies must come apart.
pub(crate) const MOVES: usize = 2;
/// The most particles of an attempt, which is what may be asked for at most.
const MOST_PARTICLES: u64 = 1_000_000;
/// Before an annealing so many scouts a particle go out, or fewer if fewer go out a sweep.
const FIRST_SCOUTS: u32 = 16;
/// The same where those of a meter go out as well, which find more in less time.
const FIRST_SCOUTS_BESIDE: u32 = 4;
/// A population of paths.
type Climbing<const K: usize> = Population<Point<Mutation>, Contributions, K>;

/// One attempt at an annealing.
pub(super) struct Climb<'a, const K: usize> {
    target: PathTarget<'a>,
    set: ReplicaSet,
    /// Why no chain need follow what scouts look for, if so.
    pub(super) easy: Option<Easy>,
    settings: &'a RenderSettings,
    family: ReplicaFamily<K>,
    attempt: u32,
    particles: u64,
    scouts: Scouts<'a, K>,
    /// Where a meter's scouts have found more of what those look for.
    places: Option<Places<'a>>,
    /// Independent samples, the particles before they climb, and where on the window each begins.
    samples: Vec<State>,
    rasters: Vec<[f64; 2]>,
}

/// An attempt on its way up.
struct Ascent<'a, const K: usize> {
    started: Started,
    /// By level; `None` where nobody is, or all have gone on.
    populations: Vec<Option<Climbing<K>>>,
    kernels: [LevelKernel<PathTarget<'a>, Mutation>; K],
    family: Elsewhere<K>,
    /// Decides what concerns a population as a whole.
    central: Pcg64Dxsm,
}

impl<'a, const K: usize> Climb<'a, K> {
    /// The first attempt is 0; each has twice the particles of the one before. What the first found to be `easy` or not, all
    /// do: its samples, which stay, are judged by the densities that follow from it.
    pub(super) fn new(
        target: PathTarget<'a>,
        set: &'a ReplicaSet,
        settings: &'a RenderSettings,
        attempt: u32,
        easy: Option<Option<Easy>>,
    ) -> Self {
        let family = ReplicaFamily::new(set, settings.options.target);
        let particles = (settings.particles() << attempt).min(MOST_PARTICLES);
        let hunt = Hunt::new(target, settings, (attempt, particles));
        let most = match hunt {
            Some(_) => FIRST_SCOUTS_BESIDE,
            None => FIRST_SCOUTS,
        };
        let count = match scouting(set) {
            Some(each) => particles * u64::from(each.min(most)),
            None => 0,
        };
        let ladder = streams::annealing(attempt, K + 1);
        let mut samples = samples(
            target,
            &family,
            &mutation(set, settings.options.steps, 0),
            settings.seed,
            streams::annealing(attempt, 0),
            (particles, None),
        )
        .unwrap_or_default();
        // A state has the coordinates that its path began with: nothing is drawn.
        let mut draws = generator(settings.seed, 0);
        let rasters = (samples.iter_mut())
            .map(|(point, _)| point.current(&mut draws).get2(Stream::Camera, 0))
            .collect();
        let mut climb = Self {
            target,
            set: *set,
            easy: None,
            settings,
            family,
            attempt,
            particles,
            scouts: Scouts::send(target, family, settings, ladder, count),
            places: None,
            samples,
            rasters,
        };
        match (easy.unwrap_or_else(|| climb.is_easy()), hunt) {
            (Some(easy), _) => climb.leave_specular(easy),
            (None, hunt) => climb.places = hunt.and_then(|hunt| hunt.places(&family)),
        }
        climb
    }

    /// Why independent samples may have the light of scouts, if so.
    fn is_easy(&self) -> Option<Easy> {
        let options = &self.settings.options;
        // As a renderer of its own an annealing has no even samples.
        if self.settings.method != Method::Relt || options.even == EvenSamples::Count(0) {
            return None;
        }
        Easy::judge(&self.scouts.light(), &self.pool())
    }

    /// Leaves light that is easy to find to independent samples.
    fn leave_specular(&mut self, easy: Easy) {
        self.easy = Some(easy);
        self.set = self.set.leaving_specular();
        self.family = ReplicaFamily::new(&self.set, self.settings.options.target);
        self.scouts.judge_by(self.family);
    }

    /// What is kept of the independent samples.
    fn pool(&self) -> Vec<PoolSample> {
        let samples = self.samples.iter().zip(&self.rasters);
        let kept = samples.map(|((_, value), &raster)| PoolSample {
            densities: all_densities(&self.family, value),
            light: SpecularSplit::of(value, ScalarTarget::Xyz),
            raster,
        });
        kept.collect()
    }

    /// How many replicas there are to climb to.
    fn count(&self) -> usize {
        K - usize::from(self.easy.is_some())
    }

    /// Goes up all levels. Also the first that nobody reached, and how far scouts saw.
    pub(super) fn run(&mut self) -> (Started, Option<Extinct>, Sighting) {
        let mut ascent = self.begin();
        let extinct = (1..self.count()).find_map(|level| self.climb(&mut ascent, level).err());
        let sighted = match &self.places {
            Some(_) => Sighting::Light,
            None => self.scouts.furthest,
        };
        (ascent.started, extinct, sighted)
    }

    /// Independent samples, and the uniform replica's states among them.
    fn begin(&mut self) -> Ascent<'a, K> {
        let mut started = self.known();
        let samples = std::mem::take(&mut self.samples);
        let Climb { settings, .. } = *self;
        let set = &self.set;
        let steps = settings.options.steps;
        let kernels = kernels::<K>(self.target, set, steps);
        let family = Elsewhere {
            all: self.family,
            scouted: self.scouts.count > 0,
        };
        let mut central = generator(settings.seed, streams::annealing(self.attempt, K));
        let mut bottom = Population::from_samples(samples, &family, Resampling::Systematic);
        let uniform = bottom.advance(0, &kernels[0], &mut central);
        debug_assert!(uniform.is_ok(), "all particles have the density 1");
        started.rough.push(Estimate::exact(1.0));
        (started.starts).push(self.choose(0, Some(&bottom), 1.0, &mut central));
        Ascent {
            started,
            populations: vec![Some(bottom)],
            kernels,
            family,
            central,
        }
    }

    /// What independent samples and scouts tell before anyone climbs.
    fn known(&self) -> Started {
        let pool = self.pool();
        let scouted = self.scouts.light();
        let light: f64 = pool.iter().map(|sample| sample.light.whole()).sum();
        let (found, sent) = &scouted;
        let of_scouts = found.iter().sum::<f64>() / (*sent).max(1) as f64;
        // Where no particle has met light, scouts may have.
        let mean = if light > 0.0 {
            light / self.particles as f64
        } else if of_scouts > 0.0 {
            of_scouts
        } else {
            self.places.as_ref().map_or(0.0, Places::light)
        };
        Started {
            starts: Vec::new(),
            rough: Vec::new(),
            pool,
            scouted,
            effective: vec![[self.particles as f64; 2]],
            mean,
            particles: self.particles,
            set: self.set,
            dropped: None,
        }
    }

    /// Takes particles from the level below to this one, and chooses the replica's states among them and
    /// what scouts found; an error if there is nobody.
    fn climb(&self, ascent: &mut Ascent<'_, K>, level: usize) -> Result<(), Extinct> {
        let Ascent {
            started,
            populations,
            kernels,
            family,
            central,
        } = ascent;
        let kernel = &kernels[level];
        let at_once = effective(started.pool.iter().map(|sample| sample.densities[level]));
        let mut population = self.climbers(populations, level);
        let mut elsewhere = Estimate::exact(0.0);
        let mut annealed = 0.0;
        if let Some(climbing) = &mut population {
            match climbing.advance(level, kernel, central) {
                Ok(stage) => {
                    (elsewhere, annealed) = (stage.normaliser, stage.effective);
                    self.spread(level, kernel, family, climbing);
                }
                Err(Extinct { .. }) => population = None,
            }
        }
        let there = self.scouted(level);
        if elsewhere.value + there.value <= 0.0 {
            return Err(Extinct { level });
        }
        started.effective.push([at_once, annealed]);
        started.rough.push(Estimate {
            value: elsewhere.value + there.value,
            standard_error: elsewhere.standard_error.hypot(there.standard_error),
        });
        let chosen = self.choose(level, population.as_ref(), elsewhere.value, central);
        started.starts.push(chosen);
        populations.push(population);
        Ok(())
    }

    /// The population that climbs to a level: taken from below, or copied if another climbs from there too.
    fn climbers(
        &self,
        populations: &mut [Option<Climbing<K>>],
        level: usize,
    ) -> Option<Climbing<K>> {
        let below = self.set.below();
        let from = &mut populations[below[level]];
        if below[level + 1..].contains(&below[level]) {
            from.clone()
        } else {
            from.take()
        }
    }

    /// Moves the particles of a level apart.
    fn spread(
        &self,
        level: usize,
        kernel: &LevelKernel<PathTarget<'_>, Mutation>,
        family: &Elsewhere<K>,
        population: &mut Climbing<K>,
    ) {
        let generators =
            SampleGenerators::new(self.settings.seed, streams::annealing(self.attempt, level));
        (population.particles_mut().par_iter_mut().enumerate())
            .with_min_len(64)
            .for_each(|(slot, particle)| {
                let mut draws = generators.at(slot as u64);
                for _ in 0..MOVES {
                    particle.step(kernel, family, &mut draws, &mut Ignore);
                }
            });
    }

    /// Integral of a replica's density over where scouts find light.
    fn scouted(&self, level: usize) -> Estimate {
        match &self.places {
            Some(places) => places.normaliser(&self.family, level),
            None => self.scouts.normaliser(level),
        }
    }

    /// Each find's share of that integral.
    fn shares_of_finds(&self, level: usize) -> Vec<f64> {
        match &self.places {
            Some(places) => places.shares(&self.family, level),
            None => self.scouts.shares(level),
        }
    }

    /// A find as a replica's first state.
    fn find(&self, found: usize, level: usize) -> State {
        let mutation = mutation(&self.set, self.settings.options.steps, level);
        match &self.places {
            Some(places) => places.again(found, mutation),
            None => self.scouts.again(found, mutation),
        }
    }

    /// A state for each ladder of this process: a particle, which stand for an integral of `elsewhere`, or what a
    /// scout found. All ladders choose, so that a share of them starts as it would among all.
    fn choose(
        &self,
        level: usize,
        population: Option<&Climbing<K>>,
        elsewhere: f64,
        draws: &mut Pcg64Dxsm,
    ) -> Vec<State> {
        let range = self.settings.ladder_range();
        let mut chosen = Vec::with_capacity(range.len());
        // Particles are all alike.
        let mut weights = vec![elsewhere];
        if level > 0 {
            weights.extend(self.shares_of_finds(level));
        }
        let ladders = self.settings.options.ladders as usize;
        for (ladder, choice) in (0..).zip(spread_evenly(&weights, ladders, draws)) {
            let state = match choice.checked_sub(1) {
                Some(found) => range.contains(&ladder).then(|| self.find(found, level)),
                None => population
                    .and_then(|population| population.choose(draws))
                    .filter(|_| range.contains(&ladder))
                    .map(|particle| (particle.state().clone(), particle.value().clone())),
            };
            chosen.extend(state);
        }
        chosen
    }
}

/// Systematic resampling: so many indices, of each as many as its weight's share, rounded up or down (Kitagawa 1996), in
/// random order.
fn spread_evenly(weights: &[f64], count: usize, draws: &mut Pcg64Dxsm) -> Vec<usize> {
    let (mut copies, mut sums) = (Vec::new(), Vec::new());
    Resampling::Systematic.copies_in_all(count, weights, &mut copies, &mut sums, draws);
    let copies = copies.iter().enumerate();
    let chosen: Vec<usize> = copies
        .flat_map(|(index, &copies)| std::iter::repeat_n(index, copies as usize))
        .collect();
    let order = Shuffle::new(count as u64, draws.uniform().to_bits());
    (0..count as u64)
        .map(|place| chosen[order.at(place) as usize])
        .collect()
}

/// Effective number of weighted samples: the square of the sum over the sum of squares.
pub(super) fn effective(weights: impl Iterator<Item = f64>) -> f64 {
    let (sum, squares) = weights.fold((0.0, 0.0), |(s, q), w| (s + w, q + w * w));
    if squares > 0.0 {
        sum * sum / squares
    } else {
        0.0
    }
}

/// The replicas' densities where scouts have not been: what they look for is left to them.
struct Elsewhere<const K: usize> {
    all: ReplicaFamily<K>,
    scouted: bool,
}

impl<const K: usize> Family<Contributions, K> for Elsewhere<K> {
    fn densities(&self, value: &Contributions) -> [f64; K] {
        let densities = self.all.densities(value);
        if self.scouted && SpecularSplit::of(value, ScalarTarget::Xyz).specular > 0.0 {
            from_fn(|k| if k == 0 { densities[0] } else { 0.0 })
        } else {
            densities
        }
    }
}

/// The densities of a value, with zeros for replicas that there are not; NaN and the like are zeros.
fn all_densities<const K: usize>(
    family: &ReplicaFamily<K>,
    value: &Contributions,
) -> [f64; ReplicaSet::MOST] {
    let known = checked_densities(family, value)
        .unwrap_or_else(|| from_fn(|k| f64::from(u8::from(k == 0))));
    from_fn(|k| known.get(k).copied().unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_spread_evenly() {
        let weights = [0.5, 0.0, 2.25, 1.0, 0.25];
        let (mut rng, mut sums, mut first) = (generator(5, 0), [0; 5], [0; 5]);
        const ROUNDS: u32 = 4000;
        for _ in 0..ROUNDS {
            let chosen = spread_evenly(&weights, 6, &mut rng);
            assert_eq!(chosen.len(), 6);
            for (index, weight) in weights.iter().enumerate() {
                let count = chosen.iter().filter(|i| **i == index).count();
                let due = weight * 1.5;
                assert!(
                    (count as f64 - due).abs() < 1.0,
                    "{index}: {count} of {due}"
                );
                sums[index] += count;
            }
            first[chosen[0]] += 1;
        }
        for (index, weight) in weights.iter().enumerate() {
            let share = weight / 4.0;
            let of_all = sums[index] as f64 / f64::from(6 * ROUNDS);
            let of_first = f64::from(first[index]) / f64::from(ROUNDS);
            assert!(
                (of_all - share).abs() < 0.01,
                "{index}: {of_all} of {share}"
            );
            // in any order: the first is as any other
            assert!(
                (of_first - share).abs() < 0.03,
                "{index}: {of_first} of {share}"
            );
        }
    }

    #[test]
    fn one_weight_is_always_chosen() {
        let mut rng = generator(5, 1);
        assert_eq!(spread_evenly(&[0.0, 3.0, 0.0], 3, &mut rng), [1; 3]);
        assert_eq!(spread_evenly(&[1e-300], 2, &mut rng), [0; 2]);
    }
}
