//! Scouts: walks from the camera alone that look for implicit specular paths that nothing else finds.

use kaustik_estimate::{PathTarget, ReplicaFamily, ReplicaSet, ScalarTarget, SpecularSplit};
use kaustik_mcmc::{
    Estimate, Exponential, Mean, Point, Region, SampleGenerators, Step, Target, checked_densities,
};
use kaustik_path::{BuilderSettings, Class, Contributions, Sighting, sight};
use kaustik_pss::Coordinates;
use kaustik_scene::Scene;
use rayon::prelude::*;

use super::kernels::Mutation;
use super::start::State;
use crate::RenderSettings;
use crate::methods::builders::builder_settings;

/// How many scouts a set sends for each independent sample; `None` without a replica to send them for.
pub(crate) fn scouting(set: &ReplicaSet) -> Option<u32> {
    Some(set.scouts()).filter(|scouts| set.is_specific() && *scouts > 0)
}

/// The part of the cube where there is implicit specular light that nothing else finds.
///
/// That a walk from the camera runs into a lamp behind glass or water by chance is what the specific replica is
/// there for, and what independent samples seldom see. To see whether one does takes no light
/// subpath and no connection.
#[derive(Clone, Copy)]
pub(crate) struct SpecularLight<'a> {
    scene: &'a Scene,
    settings: BuilderSettings,
}

impl<'a> SpecularLight<'a> {
    pub(crate) fn new(scene: &'a Scene, settings: &RenderSettings) -> Self {
        Self {
            scene,
            settings: builder_settings(settings),
        }
    }
}

impl Region<Contributions> for SpecularLight<'_> {
    #[inline]
    fn may_hold(&self, u: &mut dyn Coordinates) -> bool {
        sight(&self.settings, self.scene, u) == Sighting::Light
    }

    /// The light itself, X + Y + Z.
    #[inline]
    fn measure(&self, value: &Contributions) -> f64 {
        SpecularSplit::of(value, ScalarTarget::Xyz).specular
    }
}

/// What a first company of scouts has found.
pub(crate) struct Scouts<'a, const K: usize> {
    target: PathTarget<'a>,
    region: SpecularLight<'a>,
    generators: SampleGenerators,
    pub(crate) count: u64,
    /// The furthest that any saw.
    pub(crate) furthest: Sighting,
    family: ReplicaFamily<K>,
    found: Vec<Find>,
}

/// A point of the region.
struct Find {
    index: u64,
    /// Scalars of its classes of paths, of which densities are made.
    classes: [f64; Class::COUNT],
    light: f64,
}

impl<'a, const K: usize> Scouts<'a, K> {
    /// Sends so many, each with a generator of its own.
    pub(crate) fn send(
        target: PathTarget<'a>,
        family: ReplicaFamily<K>,
        settings: &RenderSettings,
        ladder: u64,
        count: u64,
    ) -> Self {
        let mut scouts = Self {
            target,
            region: SpecularLight::new(target.scene, settings),
            generators: SampleGenerators::new(settings.seed, ladder),
            count,
            // nobody has looked
            furthest: Sighting::Light,
            family,
            found: Vec::new(),
        };
        if count == 0 {
            return scouts;
        }
        let scratch = || (Point::new(Exponential::default()), Contributions::default());
        let all: Vec<(Sighting, Option<Find>)> = (0..count as usize)
            .into_par_iter()
            .with_min_len(256)
            .map_init(scratch, |(point, value), index| {
                let sighting = scouts.look(index as u64, point, value);
                let light = scouts.region.measure(value);
                let sound = checked_densities(&family, value).is_some();
                let found = sound && sighting == Sighting::Light && light > 0.0;
                let find = found.then(|| Find {
                    index: index as u64,
                    classes: value.by_class(settings.options.target),
                    light,
                });
                (sighting, find)
            })
            .collect();
        let furthest = all.iter().map(|(sighting, _)| *sighting).max();
        scouts.furthest = furthest.unwrap_or(Sighting::Plain);
        scouts.found = all.into_iter().filter_map(|(_, find)| find).collect();
        scouts
    }

    /// Goes where a scout goes; evaluates what it sees light at.
    fn look(&self, index: u64, point: &mut Point<Mutation>, value: &mut Contributions) -> Sighting {
        let mut draws = self.generators.at(index);
        let mut proposal = point.propose(Step::Large, &mut draws);
        let SpecularLight { scene, settings } = &self.region;
        let sighting = sight(settings, scene, &mut proposal);
        value.clear();
        if sighting == Sighting::Light {
            self.target.evaluate(&mut proposal, value);
            proposal.decide(1.0);
        }
        sighting
    }

    /// The place of a find, as a replica's first state.
    pub(crate) fn again(&self, found: usize, mutation: Mutation) -> State {
        let (mut point, mut value) = (Point::new(mutation), Contributions::default());
        self.look(self.found[found].index, &mut point, &mut value);
        (point, value)
    }

    /// Integral of a replica's density over the region.
    pub(crate) fn normaliser(&self, level: usize) -> Estimate {
        let mut mean: Mean = self.densities(level).collect();
        mean.push_zeros(self.count - self.found.len() as u64);
        Estimate {
            value: mean.mean(),
            standard_error: if self.count == 0 {
                0.0
            } else {
                mean.standard_error()
            },
        }
    }

    /// Each find's share of [`normaliser`](Self::normaliser).
    pub(crate) fn shares(&self, level: usize) -> Vec<f64> {
        let sent = self.count as f64;
        self.densities(level)
            .map(|density| density / sent)
            .collect()
    }

    /// A replica's density at each find.
    fn densities(&self, level: usize) -> impl Iterator<Item = f64> {
        let density = move |find: &Find| self.family.of_classes(&find.classes)[level];
        self.found.iter().map(density)
    }

    /// Judges what they found by another family.
    pub(crate) fn judge_by(&mut self, family: ReplicaFamily<K>) {
        self.family = family;
    }

    /// Implicit specular light of each find, and how many were sent.
    pub(crate) fn light(&self) -> (Vec<f64>, u64) {
        let light = self.found.iter().map(|find| find.light);
        (light.collect(), self.count)
    }
}
