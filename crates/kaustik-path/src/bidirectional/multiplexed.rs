//! One strategy at a time (Hachisuka, Kaplanyan and Dachsbacher 2014).

use glam::DVec3;
use kaustik_pss::{Coordinates, Stream};
use kaustik_scene::{EmissionSample, Scene};
use kaustik_spectrum::Wavelengths;

use super::eye;
use super::join::{join, next_event};
use super::light;
use super::running::Departure;
use super::techniques::{Technique, Techniques};
use super::witness::Witness;
use super::workspace::{Subpath, Workspace};
use super::{Bidirectional, Form, Job};
use crate::contributions::Gathered;
use crate::instant::at_its_time;
use crate::walk::Walk;
use crate::{Contributions, PathBuilder, camera_walk};

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
            raster_pdf: 1.0 / self.paths.settings.window_area(),
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

/// A subpath on its way.
struct Going<'a> {
    walk: Walk<'a>,
    departure: Departure,
    /// Where the next edge begins.
    from: DVec3,
}

/// How far a walk from an emitter is to go.
struct Way<'a> {
    emission: &'a EmissionSample,
    /// Vertices on surfaces.
    vertices: u32,
    /// Vertices of the eye.
    t: u32,
}

impl Going<'_> {
    /// The next edge, to a vertex that is kept; `None` if it leaves the scene. The vertex cannot be joined
    /// yet.
    #[inline]
    fn arrive(
        &mut self,
        job: &Job<'_>,
        u: &mut dyn Coordinates,
        path: &mut Subpath,
    ) -> Option<f64> {
        let slot = path.next();
        let distance = self.walk.advance(job.scene, u, &mut slot.vertex)?;
        slot.reach(&self.walk);
        let squared = (slot.vertex.position - self.from).length_squared();
        let heuristic = job.builder.heuristic;
        slot.running = self.departure.arrive(heuristic, squared, slot.cos_back());
        self.from = slot.vertex.position;
        path.keep();
        Some(distance)
    }

    /// Makes the last vertex one that scatters.
    #[inline]
    fn open(&self, job: &Job<'_>, path: &mut Subpath) {
        let slot = path.last_mut();
        let interior = &self.walk.interior;
        (job.scene).write_bsdf(&slot.vertex, job.wavelengths, interior, &mut slot.bsdf);
        let onward = Form::Full.at_surface(&slot.bsdf);
        slot.connectable = onward.stop > 0.0;
        slot.onward = onward;
    }

    /// Scatters at the last vertex; `false` where the walk ends.
    #[inline]
    fn depart(
        &mut self,
        job: &Job<'_>,
        u: &mut dyn Coordinates,
        path: &mut Subpath,
        bounces: (Stream, u32),
    ) -> bool {
        match job.depart(&mut self.walk, path, u, bounces) {
            Some(departure) => {
                self.departure = departure;
                true
            }
            None => false,
        }
    }
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
        // Vertices on surfaces; a light walk to the lens has one edge more than those.
        let of_light = (s.saturating_sub(1)) - u32::from(t == 0);
        if s >= 2 {
            let scale = if t <= 1 { share } else { 1.0 };
            if !self.walk_from_light(of_light, t, scale, u, &mut workspace.light, out, witness) {
                return;
            }
        }
        if t >= 2 {
            let mut gathered = Gathered::new(self.wavelengths, false);
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
        let (mut walk, departure, from) = light::start(self, &emission);
        walk.throughput *= scale as f32;
        if walk.throughput.is_zero() {
            return false;
        }
        let mut going = Going {
            walk,
            departure,
            from,
        };
        let way = Way {
            emission: &emission,
            vertices,
            t,
        };
        let joins = self.follow_from_light(&mut going, &way, u, path, out, witness);
        out.count_walk(going.walk.edges);
        joins
    }

    /// The walk of [`Self::walk_from_light`], once it has begun.
    fn follow_from_light(
        &self,
        going: &mut Going<'_>,
        way: &Way<'_>,
        u: &mut dyn Coordinates,
        path: &mut Subpath,
        out: &mut Contributions,
        witness: &mut impl Witness,
    ) -> bool {
        let Way {
            emission,
            vertices,
            t,
        } = *way;
        for vertex in 1..=vertices {
            let Some(distance) = going.arrive(self, u, path) else {
                return false;
            };
            if vertex == 1 {
                let fading = self.scene.fading(emission, distance);
                going.walk.throughput *= fading;
                path.last_mut().throughput *= fading;
            }
            going.open(self, path);
            let last = vertex == vertices && t > 0;
            if !last && !going.depart(self, u, path, light::BOUNCES) {
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
        going: &mut Going<'_>,
        u: &mut dyn Coordinates,
        path: &mut Subpath,
        out: &mut Contributions,
        witness: &mut impl Witness,
    ) {
        let Some(hit) = self.lens_ahead(&going.walk) else {
            return;
        };
        let (throughput, interior) = (going.walk.throughput, going.walk.interior);
        let scene = self.scene;
        let distance = going.walk.advance(scene, u, &mut path.next().vertex);
        if distance.is_none_or(|distance| hit.distance < distance) {
            let sent = light::Sent {
                throughput,
                interior,
                departure: &going.departure,
                walk: &going.walk,
            };
            light::meet_lens(self, &sent, &hit, path, out, witness);
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
    ) -> glam::DVec2 {
        let settings = &self.builder.settings;
        let (mut walk, raster) = camera_walk::start(settings, self.scene, self.wavelengths, u);
        let departure = eye::start(self, &mut walk);
        walk.throughput *= scale as f32;
        let from = walk.ray.origin.as_dvec3();
        let mut going = Going {
            walk,
            departure,
            from,
        };
        self.follow_from_eye(&mut going, technique, u, workspace, gathered, witness);
        gathered.count_walk(going.walk.edges);
        raster
    }

    /// The walk of [`Self::walk_from_eye`], once it has begun.
    fn follow_from_eye(
        &self,
        going: &mut Going<'_>,
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
            if going.arrive(self, u, eye).is_none() {
                if s == 0 && last {
                    let running = going.departure.escape(self.builder.heuristic);
                    let vertices = eye.vertices();
                    eye::escape(self, &going.walk, &running, vertices, gathered, witness);
                }
                return;
            }
            if s == 0 && last {
                let specular = going.walk.specular;
                eye::emission(self, specular, eye.vertices(), gathered, witness);
                return;
            }
            going.open(self, eye);
            if !last && !going.depart(self, u, eye, eye::BOUNCES) {
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
