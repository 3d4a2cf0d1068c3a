//! Starts of chains: independent paths by walks from both sides.

use std::ops::RangeInclusive;

use kaustik_bsdf::Lobe;
use kaustik_mcmc::Draws;
use kaustik_path::Role;
use kaustik_scene::EmitterPoint;
use kaustik_spectrum::{Wavelengths, Xyz};

use crate::vertex::VertexKind;
use crate::vertices::Pieces;
use crate::walk::WalkDirection;
use crate::ways::{Ways, WaysOn};
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
    /// Where emitters are chosen by place: those found from the vertices of the eye, by how many of these there are up to there.
    beside: Path,
    /// Which of them there are.
    found: Vec<bool>,
    /// The two vertices at the joint, which see other directions than in their walks. Where the walk from the eye has
    /// run into an emitter, its last two: the emitter is no scattering surface then.
    joint: Path,
    /// The path, put together when it is kept.
    joined: Path,
    /// Chance with which the walk from the light made so many vertices.
    light_survival: Vec<f64>,
    eye_survival: Vec<f64>,
    /// By the number of vertices from the light: ways to make those of them that no joint changes.
    before: Vec<Ways>,
    /// The same by the number of vertices from the eye.
    after: Vec<WaysOn>,
}

/// Vertices of each walk whose densities a joint changes: it turns the directions at the two that it joins, and with these how either
/// walk would make them and the next on each side.
const TOUCHED: usize = 2;

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
            beside: Path::default(),
            found: Vec::new(),
            joint: Path::default(),
            joined: Path::default(),
            light_survival: Vec::new(),
            eye_survival: Vec::new(),
            before: Vec::new(),
            after: Vec::new(),
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
        self.look_for_emitters(space, draws);
        self.sum_ways(space);
        let mut sum = 0.0;
        for t in 1..=self.eye_survival.len() {
            for s in 0..=self.light_survival.len().max(1) {
                if self.may_join(space, [s, t], escaped) {
                    self.add(space, [s, t], &mut sum, path, draws);
                }
            }
        }
        sum
    }

    /// Do so many vertices of each walk make a path of an allowed length, if they see each other? Without any from
    /// the light the walk from the eye must end in an emitter; one that has escaped has no surface to be joined at.
    fn may_join(&self, space: &PathSpace<'_>, [s, t]: [usize; 2], escaped: bool) -> bool {
        let outside = escaped && t == self.eye_survival.len();
        let ends = match s {
            0 => {
                let specular = (2..t).map(|t| self.eye.at(self.eye.len() - t).specular);
                (outside || (t > 1 && self.emits(space, t))) && space.admits(specular)
            }
            1 if !self.has_emitter(t) => false,
            // two ends that see each other: nothing between them but what is specular
            _ => !outside && (s + t > 2 || space.admits(std::iter::empty())),
        };
        ends && space.lengths().contains(&(s + t - 1))
    }

    /// Chance with which the walks made so many vertices.
    fn survival(&self, [s, t]: [usize; 2]) -> f64 {
        // The first vertex of a walk is there for sure.
        let of_light = (self.light_survival.get(s.saturating_sub(1)).copied()).unwrap_or(1.0);
        self.eye_survival[t - 1] * of_light
    }

    /// Is the one vertex from the light that so many from the eye are joined to not the first of the walk, but one of their own?
    fn is_beside(&self, t: usize) -> bool {
        (2..self.found.len()).contains(&t)
    }

    fn has_emitter(&self, t: usize) -> bool {
        match self.is_beside(t) {
            true => self.found[t],
            false => !self.light_survival.is_empty(),
        }
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
            if !space.scatter(&mut self.light, i - 1, WalkDirection::ToEye, draws) {
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
                _ => space.scatter(&mut self.eye, i + 1, WalkDirection::ToLight, draws),
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

    /// An emitter for each vertex of the eye but the lens, where emitters are chosen by place.
    fn look_for_emitters<D: Draws + ?Sized>(&mut self, space: &PathSpace<'_>, draws: &mut D) {
        self.found.clear();
        if !space.scene.chooses_emitters_by_place() {
            return;
        }
        let most = self.eye_survival.len();
        self.beside.resize(most + 1);
        self.found.resize(most + 1, false);
        for t in 2..=most {
            let vertex = self.eye.at(self.eye.len() - t);
            if vertex.kind == VertexKind::Surface {
                let from = Some(vertex.vertex.position);
                self.found[t] = space.draw_emitter(self.beside.at_mut(t), from, draws);
            }
        }
    }

    /// Does the last of so many vertices from the eye emit?
    fn emits(&self, space: &PathSpace<'_>, t: usize) -> bool {
        let vertex = self.eye.at(self.eye.len() - t);
        vertex.kind == VertexKind::Surface && space.scene.is_emitter(&vertex.vertex)
    }

    /// Sums up the ways to make what each walk has, but for the vertices that a joint touches: with these
    /// sums a path is weighted in the same time however long it is.
    fn sum_ways(&mut self, space: &PathSpace<'_>) {
        let (light, eye) = (&self.light, &self.eye);
        self.before.clear();
        self.after.clear();
        let mut before = Ways::none(true);
        for s in 0..=self.light_survival.len().max(1) {
            if s > TOUCHED {
                before = before.then(space.making(light, s - TOUCHED - 1));
            }
            self.before.push(before);
        }
        let mut after = WaysOn::NONE;
        for t in 0..=self.eye_survival.len() {
            if t > TOUCHED {
                after = after.after(space.making(eye, eye.len() - (t - TOUCHED)));
            }
            self.after.push(after);
        }
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
        if !self.join(space, [s, t]) {
            return;
        }
        let vertices = self.vertices([s, t]);
        let light = space.light_of(&vertices, self.joint.importance);
        let density = light.0;
        if density <= 0.0 {
            return;
        }
        let touched = s.saturating_sub(TOUCHED)..(s + TOUCHED).min(s + t);
        let ways = touched.fold(self.before[s], |ways, i| {
            ways.then(space.making(&vertices, i))
        });
        let weight = density / (ways.through(self.after[t]) * self.survival([s, t]));
        let before = *sum;
        *sum += weight;
        if !weight.is_finite() {
            self.write([s, t], light);
            space.tell(&self.joined, Role::Sampled(weight));
        } else if draws.index(&[before, weight]) == 1 {
            self.write([s, t], light);
            std::mem::swap(path, &mut self.joined);
        }
    }

    /// Joins the walks after so many vertices of each; `false` if no light passes.
    fn join(&mut self, space: &PathSpace<'_>, [s, t]: [usize; 2]) -> bool {
        let beside = s == 1 && self.is_beside(t);
        let Self {
            light, eye, joint, ..
        } = self;
        joint.resize(2);
        joint.tune(eye);
        (joint.raster, joint.importance) = (eye.raster, eye.importance);
        let first = eye.len() - t;
        if s > 0 {
            match beside {
                true => joint.copy(0, &self.beside, t..t + 1),
                false => joint.copy(0, light, s - 1..s),
            }
            joint.copy(1, eye, first..first + 1);
            return space.join(joint, 0);
        }
        joint.copy(0, eye, first..first + 2);
        let emitter = joint.at_mut(0);
        emitter.specular = false;
        if emitter.kind == VertexKind::Surface {
            emitter.kind = VertexKind::Emitter(EmitterPoint::Surface);
        }
        space.refresh(joint, 0)
    }

    /// The vertices of the path that was joined last, where they are.
    fn vertices(&self, [s, t]: [usize; 2]) -> Pieces<'_> {
        let from_light = s.saturating_sub(1);
        let from_eye = s + t - from_light - self.joint.len();
        let eye = self.eye.vertices();
        Pieces {
            vertices: [
                &self.light.vertices()[..from_light],
                self.joint.vertices(),
                &eye[eye.len() - from_eye..],
            ],
            wavelengths: &self.joint.wavelengths,
        }
    }

    /// Writes that path, with this density and colour, as `joined`.
    fn write(&mut self, [s, t]: [usize; 2], (density, colour): (f64, Xyz)) {
        let Self {
            light,
            eye,
            joint,
            joined,
            ..
        } = self;
        joined.resize(s + t);
        joined.tune(joint);
        (joined.raster, joined.importance) = (joint.raster, joint.importance);
        (joined.density, joined.colour) = (density, colour);
        let from_light = s.saturating_sub(1);
        let from_eye = from_light + joint.len();
        joined.copy(0, light, 0..from_light);
        joined.copy(from_light, joint, 0..joint.len());
        joined.copy(from_eye, eye, eye.len() - (s + t - from_eye)..eye.len());
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
    if vertices < FIRST_ROULETTE || vertex.kind != VertexKind::Surface {
        return Some(1.0);
    }
    let albedo = f64::from(vertex.bsdf.albedo(glam::DVec3::Z).max());
    let survival = albedo.clamp(*SURVIVAL.start(), *SURVIVAL.end());
    (draws.index(&[survival, 1.0 - survival]) == 0).then_some(survival)
}

#[cfg(test)]
mod tests;
