//! Starts of chains: independent paths by walks from both sides.

use std::ops::RangeInclusive;

use kaustik_bsdf::Lobe;
use kaustik_mcmc::Draws;
use kaustik_path::Role;
use kaustik_scene::EmitterPoint;
use kaustik_spectrum::Wavelengths;

use crate::vertex::Place;
use crate::walk::Way;
use crate::{Path, PathSpace};

/// Independent paths: a walk from an emitter and one from the eye, joined in every way (Veach 1997 ch. 10).
///
/// Of one sample's paths, each weighted with f over the sum of the densities of all strategies that
/// make it (the balance heuristic), one is kept, chosen by its weight. The sum is an unbiased estimate of
/// the integral of f, and a path chosen from a pool of samples by their sums is, over all
/// pools of a given sum, distributed as f (Veach 1997 ch. 11).
#[derive(Clone, Debug)]
pub struct Seeds<'a> {
    space: &'a PathSpace<'a>,
    /// Vertices from the light are at its front, those from the eye at its end.
    light: Path,
    eye: Path,
    joined: Path,
    /// Chance with which the walk from the light made so many vertices.
    light_survival: Vec<f64>,
    eye_survival: Vec<f64>,
}

/// Walks of fewer vertices always go on.
const FIRST_ROULETTE: usize = 4;
/// Least and largest probability of going on.
const SURVIVAL: RangeInclusive<f64> = 0.05..=0.95;

impl<'a> Seeds<'a> {
    /// In a scene; holds the memory of the walks.
    pub fn new(space: &'a PathSpace<'a>) -> Self {
        Self {
            space,
            light: Path::default(),
            eye: Path::default(),
            joined: Path::default(),
            light_survival: Vec::new(),
            eye_survival: Vec::new(),
        }
    }

    /// Makes a sample, all of it at one time, and writes one of its paths into `path`; returns the sum of the
    /// weighted densities of all. 0 if there is none. A path whose density is not a number makes the result
    /// not a number.
    pub fn sample<D: Draws + ?Sized>(&mut self, path: &mut Path, draws: &mut D) -> f64 {
        let wavelength_u = draws.uniform();
        for walk in [&mut self.light, &mut self.eye] {
            walk.wavelength_u = wavelength_u;
            walk.wavelengths = Wavelengths::sample(wavelength_u, self.space.settings.wavelengths);
        }
        let time = self.space.draw_time(draws);
        (self.light.time, self.eye.time) = (time, time);
        path.resize(0);
        path.density = 0.0;
        let space = self.space;
        space.at(time, |space| self.walk(space, path, draws))
    }

    /// Both walks and all their joints, in a scene that stands at their time.
    fn walk<D: Draws + ?Sized>(
        &mut self,
        space: &PathSpace<'_>,
        path: &mut Path,
        draws: &mut D,
    ) -> f64 {
        self.walk_from_light(space, draws);
        let escaped = self.walk_from_eye(space, draws);
        let mut sum = 0.0;
        for t in 1..=self.eye_survival.len() {
            let ends = (t > 1 && self.emits(space, t)) || (escaped && t == self.eye_survival.len());
            if ends {
                self.add(space, [0, t], &mut sum, path, draws);
            }
            if !(escaped && t == self.eye_survival.len()) {
                for s in 1..=self.light_survival.len() {
                    self.add(space, [s, t], &mut sum, path, draws);
                }
            }
        }
        sum
    }

    fn most(&self) -> usize {
        self.space.settings.max_edges as usize
    }

    fn walk_from_light<D: Draws + ?Sized>(&mut self, space: &PathSpace<'_>, draws: &mut D) {
        let most = self.most();
        self.light_survival.clear();
        self.light.resize(most + 2);
        if !space.begin_at_light(&mut self.light, draws) {
            return;
        }
        let mut survived = 1.0;
        self.light_survival.push(survived);
        for i in 1..most {
            let Some(survival) = survives(&self.light, i - 1, i, draws) else {
                return;
            };
            survived *= survival;
            if !space.scatter(&mut self.light, i - 1, Way::ToEye, draws) {
                return;
            }
            self.light_survival.push(survived);
        }
    }

    /// Tells whether the last vertex is an emitter infinitely far away.
    fn walk_from_eye<D: Draws + ?Sized>(&mut self, space: &PathSpace<'_>, draws: &mut D) -> bool {
        // Slot 0 stays free: what is written there is an emitter, and here it is not known yet.
        let last = self.most() + 1;
        self.eye_survival.clear();
        self.eye.resize(last + 1);
        space.begin_at_lens(&mut self.eye, draws);
        let mut survived = 1.0;
        self.eye_survival.push(survived);
        for i in (1..last).rev() {
            let vertices = last - i;
            let Some(survival) = survives(&self.eye, i + 1, vertices, draws) else {
                return false;
            };
            survived *= survival;
            let made = match vertices {
                1 => space.leave_lens(&mut self.eye, draws),
                _ => space.scatter(&mut self.eye, i + 1, Way::ToLight, draws),
            };
            if !made {
                return false;
            }
            self.eye_survival.push(survived);
            if self.eye.at(i).is_environment() {
                return true;
            }
        }
        false
    }

    /// Does the last of so many vertices from the eye emit?
    fn emits(&self, space: &PathSpace<'_>, t: usize) -> bool {
        let vertex = self.eye.at(self.eye.len() - t);
        vertex.place == Place::Surface && space.scene.is_emitter(&vertex.vertex)
    }

    /// Tries the path of `s` vertices from the light and `t` from the eye.
    fn add<D: Draws + ?Sized>(
        &mut self,
        space: &PathSpace<'_>,
        [s, t]: [usize; 2],
        sum: &mut f64,
        path: &mut Path,
        draws: &mut D,
    ) {
        let n = s + t;
        if !space.lengths().contains(&(n - 1)) {
            return;
        }
        let joined = &mut self.joined;
        joined.resize(n);
        joined.tune(&self.eye);
        joined.raster = self.eye.raster;
        joined.importance = self.eye.importance;
        joined.copy(0, &self.light, 0..s);
        joined.copy(s, &self.eye, self.eye.len() - t..self.eye.len());
        let lit = if s == 0 {
            let first = joined.at_mut(0);
            first.specular = false;
            if first.place == Place::Surface {
                first.place = Place::Emitter(EmitterPoint::Surface);
            }
            space.refresh(joined, 0)
        } else {
            space.join(joined, s - 1)
        };
        if !(lit && space.evaluate(joined)) {
            return;
        }
        let survived =
            self.eye_survival[t - 1] * s.checked_sub(1).map_or(1.0, |s| self.light_survival[s]);
        let weight = joined.density / (space.all_ways(joined, 0, n) * survived);
        if !weight.is_finite() {
            space.tell(joined, Role::Sampled(weight));
        }
        let before = *sum;
        *sum += weight;
        if weight.is_finite() && draws.index(&[before, weight]) == 1 {
            std::mem::swap(path, joined);
        }
    }
}

/// Roulette at vertex `i` of a walk of so many vertices: `None` if it ends, else the chance of going on.
pub(crate) fn survives<D: Draws + ?Sized>(
    walk: &Path,
    i: usize,
    vertices: usize,
    draws: &mut D,
) -> Option<f64> {
    let vertex = walk.at(i);
    if vertices < FIRST_ROULETTE || vertex.place != Place::Surface {
        return Some(1.0);
    }
    let albedo = f64::from(vertex.bsdf.albedo(glam::DVec3::Z).max());
    let survival = albedo.clamp(*SURVIVAL.start(), *SURVIVAL.end());
    (draws.index(&[survival, 1.0 - survival]) == 0).then_some(survival)
}
