//! One strategy at a time (Hachisuka, Kaplanyan and Dachsbacher 2014).

use glam::DVec2;
use kaustik_pss::{Coordinates, Stream};
use kaustik_scene::{EmissionSample, Scene};
use kaustik_spectrum::Wavelengths;

use super::eye;
use super::join::{join, next_event};
use super::light::{self, Carried};
use super::subpath_walk::SubpathWalk;
use super::techniques::{Technique, Techniques};
use super::witness::Witness;
use super::workspace::{Subpath, Workspace};
use super::{Bidirectional, Form, Job};
use crate::contributions::Gathered;
use crate::instant::at_its_time;
use crate::{Contributions, PathBuilder};

/// Bidirectional paths of which each point makes one alone: coordinates choose its length and its strategy, both
/// subpaths are walked just as far as that takes, and one connection is made, with its weight
/// among all strategies, over the probability of the choice. The mean over the choice is the value of
/// [`Bidirectional`] in its full form.
///
/// Length and strategy are coordinates like any other, so that a chain moves from one to another by
/// ordinary steps. The walks know how long they are to be and play no roulette.
#[derive(Clone, Debug, PartialEq)]
pub struct Multiplexed {
    /// The strategies; of the form this one must be full.
    paths: Bidirectional,
    techniques: Techniques,
}

impl Multiplexed {
    /// Over bidirectional paths with these settings and this heuristic, taken in their full form.
    pub fn new(paths: Bidirectional, techniques: Techniques) -> Self {
        let form = Form::Full;
        Self {
            paths: Bidirectional { form, ..paths },
            techniques,
        }
    }

    /// What is tried how often.
    pub fn techniques(&self) -> &Techniques {
        &self.techniques
    }

    /// The value of a technique that was drawn, over its probability. `u` is not asked for what the draw
    /// read.
    pub fn build_one(
        &self,
        scene: &Scene,
        technique: Technique,
        u: &mut dyn Coordinates,
        out: &mut Contributions,
    ) {
        at_its_time(scene, u, |scene, u| {
            Workspace::with(|workspace| self.one(scene, technique, u, out, workspace, &mut ()));
        });
    }

    pub(super) fn one(
        &self,
        scene: &Scene,
        technique: Technique,
        u: &mut dyn Coordinates,
        out: &mut Contributions,
        workspace: &mut Workspace,
        witness: &mut impl Witness,
    ) {
        out.clear();
        let settings = &self.paths.settings;
        let edges = technique.s + technique.t - 1;
        if edges < settings.min_edges || edges > settings.max_edges {
            return;
        }
        let sampling = settings.wavelengths;
        let wavelengths = Wavelengths::sample(u.get(Stream::Wavelength, 0), sampling);
        let job = Job {
            builder: &self.paths,
            scene,
            wavelengths: &wavelengths,
            raster_pdf: self.paths.settings.raster_pdf(),
            roulette: false,
        };
        job.one(&technique, u, out, workspace, witness);
    }
}

impl PathBuilder for Multiplexed {
    fn build(&self, scene: &Scene, u: &mut dyn Coordinates, out: &mut Contributions) {
        match self.techniques.draw(u) {
            Some(technique) => self.build_one(scene, technique, u, out),
            None => out.clear(),
        }
    }
}

/// How far a walk from an emitter is to go.
struct LightSubpath<'a> {
    emission: &'a EmissionSample,
    /// Vertices on surfaces.
    vertices: u32,
    /// Vertices of the eye.
    t: u32,
}

impl Job<'_> {
    fn one(
        &self,
        technique: &Technique,
        u: &mut dyn Coordinates,
        out: &mut Contributions,
        workspace: &mut Workspace,
        witness: &mut impl Witness,
    ) {
        let Technique { s, t, probability } = *technique;
        let share = 1.0 / probability;
        if s >= 2 {
            // Vertices on surfaces; a light walk to the lens, which has three vertices at least, has one edge more than those.
            let of_light = s - 1 - u32::from(t == 0);
            let scale = if t <= 1 { share } else { 1.0 };
            if !self.walk_from_light(of_light, t, scale, u, &mut workspace.light, out, witness) {
                return;
            }
        }
        if t >= 2 {
            let mut gathered = Gathered::new(self.wavelengths, self.builder.settings.track_largest);
            let raster = self.walk_from_eye(technique, share, u, workspace, &mut gathered, witness);
            out.merge(raster, &gathered);
        }
    }

    /// Walks from an emitter to as many vertices; for t = 1 and t = 0 the path is finished here. `true` if
    /// there is a vertex to be joined to one of the eye.
    #[expect(
        clippy::too_many_arguments,
        reason = "all that a walk reads and writes"
    )]
    fn walk_from_light(
        &self,
        vertices: u32,
        t: u32,
        scale: f64,
        u: &mut dyn Coordinates,
        path: &mut Subpath,
        out: &mut Contributions,
        witness: &mut impl Witness,
    ) -> bool {
        let scene = self.scene;
        let emission = scene.sample_emission(self.wavelengths, |i| u.get(Stream::Light, i));
        let Some(emission) = emission else {
            return false;
        };
        let mut going = SubpathWalk::from_emitter(self, &emission);
        going.walk.throughput *= scale as f32;
        if going.walk.throughput.is_zero() {
            return false;
        }
        let subpath = LightSubpath {
            emission: &emission,
            vertices,
            t,
        };
        let joins = self.follow_from_light(&mut going, &subpath, u, path, out, witness);
        out.count_walk(going.walk.edges);
        joins
    }

    /// The walk of [`Self::walk_from_light`], once it has begun.
    fn follow_from_light(
        &self,
        going: &mut SubpathWalk<'_>,
        subpath: &LightSubpath<'_>,
        u: &mut dyn Coordinates,
        path: &mut Subpath,
        out: &mut Contributions,
        witness: &mut impl Witness,
    ) -> bool {
        let LightSubpath {
            emission,
            vertices,
            t,
        } = *subpath;
        for vertex in 1..=vertices {
            let Some(distance) = going.advance(self, u, path) else {
                return false;
            };
            if vertex == 1 {
                going.walk.throughput *= self.scene.fading(emission, distance);
            }
            going.keep(self, path);
            going.open(self, path);
            let last = vertex == vertices && t > 0;
            if !last && !going.depart(self, u, path) {
                return false;
            }
        }
        match t {
            0 => self.run_into_lens(going, u, path, out, witness),
            1 => light::join_lens(self, u, path, out, witness),
            _ => return path.last_mut().connectable,
        }
        false
    }

    /// t = 0: the next edge, if the lens is on it.
    fn run_into_lens(
        &self,
        going: &mut SubpathWalk<'_>,
        u: &mut dyn Coordinates,
        path: &mut Subpath,
        out: &mut Contributions,
        witness: &mut impl Witness,
    ) {
        let Some(hit) = self.lens_ahead(&going.walk) else {
            return;
        };
        let carried = Carried::by(&going.walk);
        let distance = going.advance(self, u, path);
        if distance.is_none_or(|distance| hit.distance < distance) {
            light::meet_lens(self, going, &carried, &hit, path, out, witness);
        }
    }

    /// Walks from the lens as far as `t` says and finishes the path; returns the raster point.
    fn walk_from_eye(
        &self,
        technique: &Technique,
        scale: f64,
        u: &mut dyn Coordinates,
        workspace: &mut Workspace,
        gathered: &mut Gathered<'_>,
        witness: &mut impl Witness,
    ) -> DVec2 {
        let (mut going, raster) = SubpathWalk::from_lens(self, u);
        going.walk.throughput *= scale as f32;
        self.follow_from_eye(&mut going, technique, u, workspace, gathered, witness);
        gathered.count_walk(going.walk.edges);
        raster
    }

    /// The walk of [`Self::walk_from_eye`], once it has begun.
    fn follow_from_eye(
        &self,
        going: &mut SubpathWalk<'_>,
        technique: &Technique,
        u: &mut dyn Coordinates,
        workspace: &mut Workspace,
        gathered: &mut Gathered<'_>,
        witness: &mut impl Witness,
    ) {
        let Technique { s, t, .. } = *technique;
        let Workspace { light, eye } = workspace;
        for vertex in 1..t {
            let last = vertex + 1 == t;
            if going.advance(self, u, eye).is_none() {
                if s == 0 && last {
                    eye::escape(self, going, eye.vertices(), gathered, witness);
                }
                return;
            }
            going.keep(self, eye);
            if s == 0 && last {
                eye::emission(self, &going.walk, eye.vertices(), gathered, witness);
                return;
            }
            going.open(self, eye);
            if !last && !going.depart(self, u, eye) {
                return;
            }
        }
        if eye.last_mut().connectable {
            match s {
                1 => next_event(self, u, eye.vertices(), gathered, witness),
                _ => join(self, light.vertices(), eye.vertices(), gathered, witness),
            }
        }
    }
}
