//! Places where scouts of a meter have found light, for the first states of chains that follow it.

use std::ops::Range;

use kaustik_estimate::{PathTarget, ReplicaFamily, ScalarTarget, SpecularSplit};
use kaustik_mcmc::{Estimate, Exponential, Mutation, Point, Target, checked_densities};
use kaustik_path::{Class, Contributions, Find};
use rayon::prelude::*;

use super::samples::Scratch;
use super::{Fit, Meter, TRIALS};
use crate::RenderSettings;

/// Passes of a hunt, for as many particles as are usual; for more, as many times as many.
const PASSES: u64 = 6;
const USUAL_PARTICLES: u64 = 10_000;
/// How many times as many at most: no annealing has more particles.
const MOST_FOLD: u64 = 100;

/// Passes of a meter that are used for nothing else, so that where chains start does not depend on what scales their
/// picture.
pub(crate) struct Hunt<'a> {
    meter: Meter<'a>,
    passes: Range<u64>,
    target: PathTarget<'a>,
    /// Of what densities are made.
    scalar: ScalarTarget,
}

/// What they have found.
pub(crate) struct Places<'a> {
    hunt: Hunt<'a>,
    found: Vec<Place>,
}

/// A point of the cube.
struct Place {
    /// The scout's number, and which of its finds it is.
    step: u64,
    number: usize,
    /// Scalars of its classes of paths.
    classes: [f64; Class::COUNT],
    /// The mean of the sum over all places of this times a function of the point is the function's integral over where
    /// there is such light.
    weight: f64,
    /// The same times the light that is looked for, X + Y + Z.
    light: f64,
}

impl<'a> Hunt<'a> {
    /// For an attempt at an annealing of so many particles. `None` where there is nothing that a meter looks for.
    pub(crate) fn new(
        target: PathTarget<'a>,
        settings: &RenderSettings,
        (attempt, particles): (u32, u64),
    ) -> Option<Self> {
        let (meter, _) = Meter::prepared(target.scene, settings, Fit::ANY)?;
        // With fewer particles the grid has fewer cells instead.
        let passes = PASSES * (particles / USUAL_PARTICLES).clamp(1, MOST_FOLD);
        let first = TRIALS.end + u64::from(attempt) * PASSES * MOST_FOLD;
        Some(Self {
            meter,
            passes: first..first + passes,
            target,
            scalar: settings.options.target,
        })
    }

    /// Goes, and comes back with places where replicas of a family have densities; `None` if there are none.
    pub(crate) fn places<const K: usize>(self, family: &ReplicaFamily<K>) -> Option<Places<'a>> {
        let [first, last] = [self.passes.start, self.passes.end];
        let [first, last] = [first, last].map(|pass| pass * self.meter.samples_a_pass());
        let sound = |value: &Contributions| checked_densities(family, value).is_some();
        let found: Vec<Vec<Place>> = (0..(last - first) as usize)
            .into_par_iter()
            .with_min_len(256)
            .map_init(<(Scratch, Contributions)>::default, |scratch, at| {
                self.of_sample(first + at as u64, scratch, &sound)
            })
            .collect();
        let found: Vec<Place> = found.into_iter().flatten().collect();
        (!found.is_empty()).then_some(Places { hunt: self, found })
    }

    /// What the scout of this number finds.
    fn of_sample(
        &self,
        step: u64,
        (scratch, value): &mut (Scratch, Contributions),
        sound: &dyn Fn(&Contributions) -> bool,
    ) -> Vec<Place> {
        let samples = &self.meter.samples;
        let (at, joins) = self.meter.at(step);
        let (mut places, mut number) = (Vec::new(), 0);
        if joins {
            return places;
        }
        let passes = (self.passes.end - self.passes.start) as f64;
        let scouts = self.meter.scouts(at.cell) * samples.grid.count() as f64 * passes;
        samples.search(at, &mut scratch.point, &mut |mut find| {
            // A find stands for some lengths of the paths at its point; others may stand for the rest.
            let part = samples.light(&mut find, value);
            self.target.evaluate(find.u, value);
            let all = SpecularSplit::of(value, ScalarTarget::Xyz).specular;
            if part > 0.0 && all > 0.0 && sound(value) {
                let weight = find.weight * (part / all) / scouts;
                places.push(Place {
                    step,
                    number,
                    classes: value.by_class(self.scalar),
                    weight,
                    light: weight * all,
                });
            }
            number += 1;
        });
        places
    }
}

impl Places<'_> {
    /// The light, X + Y + Z, that such paths bring to the window in the mean.
    pub(crate) fn light(&self) -> f64 {
        self.found.iter().map(|place| place.light).sum()
    }

    /// Each find's share of the integral of a replica's density over where there is such light.
    pub(crate) fn shares<const K: usize>(
        &self,
        family: &ReplicaFamily<K>,
        level: usize,
    ) -> Vec<f64> {
        let share = |place: &Place| place.weight * family.of_classes(&place.classes)[level];
        self.found.iter().map(share).collect()
    }

    /// That integral. Its error is that of scouts that know nothing of each other, so rather too large.
    pub(crate) fn normaliser<const K: usize>(
        &self,
        family: &ReplicaFamily<K>,
        level: usize,
    ) -> Estimate {
        let of_scout = |places: &[Place]| {
            let shares = places.iter();
            let shares = shares.map(|p| p.weight * family.of_classes(&p.classes)[level]);
            shares.sum::<f64>()
        };
        let scouts = self.found.chunk_by(|a, b| a.step == b.step).map(of_scout);
        let (value, squares) =
            scouts.fold((0.0, 0.0), |(sum, squares), x| (sum + x, squares + x * x));
        Estimate {
            value,
            standard_error: squares.sqrt(),
        }
    }

    /// The place of a find, as a replica's first state.
    pub(crate) fn again<M: Mutation>(
        &self,
        found: usize,
        mutation: M,
    ) -> (Point<M>, Contributions) {
        let Hunt { meter, target, .. } = &self.hunt;
        let place = &self.found[found];
        let (mut point, mut value) = (Point::new(mutation), Contributions::default());
        let (mut walk, mut number) = (Point::new(Exponential::default()), 0);
        let (at, _) = meter.at(place.step);
        meter
            .samples
            .search(at, &mut walk, &mut |mut find: Find<'_>| {
                // A scout draws a coordinate when it is first asked for: as before, all that it finds is evaluated.
                if number <= place.number {
                    meter.samples.light(&mut find, &mut value);
                    let seeding = &mut point.seed(find.u);
                    target.evaluate(seeding, &mut value);
                }
                number += 1;
            });
        (point, value)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicU64;

    use kaustik_mcmc::{Mean, generator};

    use super::*;
    use crate::methods::relt::scouts::Scouts;
    use crate::methods::relt::start::replica_builder;
    use crate::{Method, small};

    const SIDE: u32 = 24;
    /// Replicas of the standard set, whose last follows such light.
    const K: usize = 4;

    /// Has `judge` see the places that a seed finds.
    fn hunted(
        words: &str,
        seed: u64,
        judge: impl FnOnce(&Places<'_>, &ReplicaFamily<K>, PathTarget<'_>, &RenderSettings),
    ) {
        let scene = small::scene(words, [SIDE; 2]);
        let settings = RenderSettings {
            seed,
            ..small::settings(Method::Relt, [SIDE; 2])
        };
        let (builder, nonfinite) = (replica_builder(&settings), AtomicU64::new(0));
        let target = PathTarget {
            scene: &scene,
            builder: &builder,
            nonfinite: &nonfinite,
        };
        let family = ReplicaFamily::new(&settings.options.replica_set(), settings.options.target);
        let hunt = Hunt::new(target, &settings, (0, 10_000)).expect("glass is seen");
        let places = hunt.places(&family).expect("light");
        judge(&places, &family, target, &settings);
    }

    /// By thousands of finds, on paths that meet light at more than one place too.
    #[test]
    fn places_and_scouts_know_the_same_integral() {
        for words in ["glass-cube?light=0.8", "water-cornell?light=0.8"] {
            // of densities, and of light
            let (mut places, mut scouts) = ([Mean::new(); 2], [Mean::new(); 2]);
            for seed in 0..8 {
                hunted(words, seed, |found, family, target, settings| {
                    let known = found.normaliser(family, K - 1);
                    let sum: f64 = found.shares(family, K - 1).iter().sum();
                    assert!((sum / known.value - 1.0).abs() < 1e-9);
                    places[0].push(known.value);
                    places[1].push(found.light());
                    let company = Scouts::send(target, *family, settings, 3, 1_000_000);
                    scouts[0].push(company.normaliser(K - 1).value);
                    let (light, sent) = company.light();
                    scouts[1].push(light.iter().sum::<f64>() / sent as f64);
                });
            }
            for (places, scouts) in places.iter().zip(&scouts) {
                let z = |factor: f64| {
                    let errors = (factor * places.standard_error()).hypot(scouts.standard_error());
                    (factor * places.mean() - scouts.mean()) / errors
                };
                assert!(
                    z(1.0).abs() < 4.0,
                    "{words}: {}, {places:?}, {scouts:?}",
                    z(1.0)
                );
                // The test of the test: each find counted for too much.
                assert!(z(1.3) > 4.0, "{words}: {}, {places:?}, {scouts:?}", z(1.3));
            }
        }
    }

    /// A chain that starts at a place is there, and goes on from there.
    #[test]
    fn a_place_is_found_again() {
        hunted("glass-cube?light=0.8", 0, |places, _, _, _| {
            let bits = |value: &Contributions| value.by_class(places.hunt.scalar).map(f64::to_bits);
            let target = places.hunt.target;
            for (index, place) in places.found.iter().enumerate().step_by(7) {
                let (mut point, value) = places.again(index, Exponential::default());
                assert_eq!(bits(&value), place.classes.map(f64::to_bits));
                let (mut here, mut rng) = (Contributions::default(), generator(1, 2));
                target.evaluate(&mut point.current(&mut rng), &mut here);
                assert_eq!(bits(&here), bits(&value));
            }
        });
    }
}
