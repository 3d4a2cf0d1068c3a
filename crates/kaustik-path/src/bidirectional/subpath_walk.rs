//! A walk whose vertices are kept, with what weights must know of them.

use glam::{DVec2, DVec3};
use kaustik_bsdf::Lobe;
use kaustik_pss::Coordinates;
use kaustik_scene::{EmissionPdf, EmissionSample};

use super::running::{Departure, End};
use super::workspace::Subpath;
use super::{Form, Job};
use crate::camera_walk;
use crate::walk::Walk;

/// A subpath on its way from one of the path's ends.
///
/// Each edge is walked ([`Self::advance`]), its vertex kept ([`Self::keep`]) and made one that scatters
/// ([`Self::open`]), and then left ([`Self::depart`]).
#[derive(Clone, Debug)]
pub(super) struct SubpathWalk<'a> {
    pub(super) walk: Walk<'a>,
    /// How the last vertex, or the end, was left.
    pub(super) departure: Departure,
    /// Where the next edge begins.
    from: DVec3,
    /// The emitter that it began at.
    emitter: Option<EmissionPdf>,
}

impl<'a> SubpathWalk<'a> {
    /// At an emitter.
    #[inline]
    pub(super) fn from_emitter(job: &Job<'a>, emission: &EmissionSample) -> Self {
        let onward = job.builder.form.at_emitter();
        let throughput = emission.weight / onward.onward as f32;
        let pdf = &emission.pdf;
        let end = End {
            position: if pdf.hittable { pdf.position } else { 0.0 },
            direction: pdf.direction,
            cos: pdf.cos,
            infinite: pdf.infinite,
        };
        let heuristic = job.builder.heuristic;
        let origin = match &emission.area {
            Some(area) => area.surface.position,
            None => emission.ray.origin,
        };
        Self {
            walk: Walk::from_emitter(emission, throughput, job.wavelengths),
            departure: Departure::from_end(heuristic, end, onward.onward, onward.odds()),
            from: origin.as_dvec3(),
            emitter: Some(*pdf),
        }
    }

    /// At the lens, with the raster point that the walk serves.
    #[inline]
    pub(super) fn from_lens(job: &Job<'a>, u: &mut dyn Coordinates) -> (Self, DVec2) {
        let settings = &job.builder.settings;
        let (mut walk, raster) = camera_walk::start(settings, job.scene, job.wavelengths, u);
        let onward = job.builder.form.at_lens();
        walk.throughput /= onward.onward as f32;
        walk.start = walk.throughput.mean();
        let camera = job.scene.camera();
        let from = walk.ray.origin.as_dvec3();
        let parallel = camera.is_dirac_direction();
        let pdf = if parallel {
            camera.raster_density(from, from + walk.direction)
        } else {
            camera.pdf_direction(walk.direction)
        };
        let end = End {
            position: if camera.has_aperture() {
                camera.pdf_lens()
            } else {
                0.0
            },
            direction: pdf * job.raster_pdf,
            cos: camera.forward().dot(walk.direction),
            infinite: parallel,
        };
        let heuristic = job.builder.heuristic;
        let departure = Departure::from_end(heuristic, end, onward.onward, onward.odds());
        let begun = Self {
            walk,
            departure,
            from,
            emitter: None,
        };
        (begun, raster)
    }

    /// Takes the next edge, to a vertex that is not kept yet. Returns its length; `None`: the walk left the scene.
    #[inline]
    pub(super) fn advance(
        &mut self,
        job: &Job<'_>,
        u: &mut dyn Coordinates,
        path: &mut Subpath,
    ) -> Option<f64> {
        self.walk.advance(job.scene, u, &mut path.next().vertex)
    }

    /// Keeps the vertex just reached. It cannot be joined yet.
    #[inline]
    pub(super) fn keep(&mut self, job: &Job<'_>, path: &mut Subpath) {
        let slot = path.next();
        slot.reach(&self.walk);
        let squared = (slot.vertex.position - self.from).length_squared();
        let heuristic = job.builder.heuristic;
        let cos = slot.cos_back();
        slot.running = match &self.emitter {
            Some(emitter) if self.walk.edges == 1 => {
                let choice = (job.scene).next_event_odds(emitter, slot.vertex.position);
                (self.departure).arrive_first(heuristic, (squared, cos), choice)
            }
            _ => self.departure.arrive(heuristic, squared, cos),
        };
        self.from = slot.vertex.position;
        path.keep();
    }

    /// Makes the last vertex one that scatters; returns the probability of going on from it.
    #[inline]
    pub(super) fn open(&self, job: &Job<'_>, path: &mut Subpath) -> f64 {
        let slot = path.last_mut();
        let interior = &self.walk.interior;
        (job.scene).write_bsdf(&slot.vertex, job.wavelengths, interior, &mut slot.bsdf);
        slot.onward = job.builder.form.at_surface(&slot.bsdf);
        slot.connectable = slot.onward.stop > 0.0;
        slot.onward.onward
    }

    /// Goes on from the last vertex; `false` where the walk ends.
    #[inline]
    pub(super) fn depart(
        &mut self,
        job: &Job<'_>,
        u: &mut dyn Coordinates,
        path: &mut Subpath,
    ) -> bool {
        let last = path.last_mut();
        let Some(sample) = self.walk.bounce(job.scene, &last.scatter(), u) else {
            return false;
        };
        // Where the simple form may stop, that is roulette enough.
        let roulette = job.builder.form == Form::Full || last.onward.onward >= 1.0;
        if job.roulette && roulette && !self.walk.survives(u) {
            return false;
        }
        let (densities, odds) = if sample.delta {
            ([1.0; 2], 0.0)
        } else {
            let back = (last.bsdf).pdf(sample.wi, last.wo, self.walk.mode.reversed());
            ([sample.pdf, back], last.onward.odds())
        };
        let cos = sample.wi.dot(last.ng).abs();
        last.delta = sample.delta;
        let heuristic = job.builder.heuristic;
        self.departure = Departure::from_surface(heuristic, &last.running, densities, cos, odds);
        true
    }
}
