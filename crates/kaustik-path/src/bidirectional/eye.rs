//! The subpath from the eye, and the light that it gathers.

use glam::{DVec2, DVec3};
use kaustik_bsdf::{Lobe, Mode};
use kaustik_pss::{Coordinates, Stream};
use kaustik_scene::EmissionPdf;
use kaustik_spectrum::Spectrum;

use super::join::{join, next_event};
use super::running::{Departure, End, Running};
use super::vertex::PathVertex;
use super::witness::{Joint, Seen, Witness};
use super::workspace::{Subpath, Workspace};
use super::{Form, Job};
use crate::contributions::Gathered;
use crate::walk::Walk;
use crate::{Class, camera_walk, layout};

pub(super) const BOUNCES: (Stream, u32) = (Stream::Camera, layout::CAMERA_HEAD);

/// What the vertices of the eye are joined to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum OtherEnd {
    /// Each to an emitter and to every vertex of the light (full form).
    Any,
    /// The last to an emitter: the light's walk stopped there.
    Emitter,
    /// The last to the light's last.
    Last,
    /// None: the light's walk came to nothing.
    None,
}

/// Walks from the camera; returns the raster point that the walk serves.
pub(super) fn trace(
    job: &Job<'_>,
    u: &mut dyn Coordinates,
    workspace: &mut Workspace,
    other: OtherEnd,
    gathered: &mut Gathered<'_>,
    witness: &mut impl Witness,
) -> DVec2 {
    let settings = &job.builder.settings;
    let (mut walk, raster) = camera_walk::start(settings, job.scene, job.wavelengths, u);
    follow(job, &mut walk, u, workspace, other, gathered, witness);
    gathered.count_walk(walk.edges);
    raster
}

/// The walk of [`trace`], once it has begun.
fn follow(
    job: &Job<'_>,
    walk: &mut Walk<'_>,
    u: &mut dyn Coordinates,
    workspace: &mut Workspace,
    other: OtherEnd,
    gathered: &mut Gathered<'_>,
    witness: &mut impl Witness,
) {
    let scene = job.scene;
    let (form, heuristic) = (job.builder.form, job.builder.heuristic);
    let most = job.builder.settings.max_edges;
    let mut departure = start(job, walk);
    let mut from = walk.ray.origin.as_dvec3();
    let Workspace { light, eye } = workspace;
    loop {
        let slot = eye.next();
        if walk.advance(scene, u, &mut slot.vertex).is_none() {
            let running = departure.escape(heuristic);
            escape(job, walk, &running, eye.vertices(), gathered, witness);
            return;
        }
        slot.reach(walk);
        let squared = (slot.vertex.position - from).length_squared();
        slot.running = departure.arrive(heuristic, squared, slot.cos_back());
        from = slot.vertex.position;
        eye.keep();
        emission(job, walk.specular, eye.vertices(), gathered, witness);
        if walk.edges == most {
            return;
        }
        let slot = eye.last_mut();
        scene.write_bsdf(
            &slot.vertex,
            job.wavelengths,
            &walk.interior,
            &mut slot.bsdf,
        );
        slot.connectable = slot.bsdf.is_connectable();
        slot.onward = form.at_surface(&slot.bsdf);
        let onward = slot.onward.onward;

        if form == Form::Full {
            join_all(job, u, light, eye.vertices(), gathered, witness);
        } else if onward < 1.0 {
            let stop = layout::bounce(layout::CAMERA_HEAD, walk.edges) + 3;
            if u.get(Stream::Camera, stop) >= onward {
                match other {
                    OtherEnd::Emitter => next_event(job, u, eye.vertices(), gathered, witness),
                    OtherEnd::Last => {
                        join(job, light.vertices(), eye.vertices(), gathered, witness);
                    }
                    OtherEnd::Any | OtherEnd::None => {}
                }
                return;
            }
            walk.throughput /= onward as f32;
        }
        match job.depart(walk, eye, u, BOUNCES) {
            Some(next) => departure = next,
            None => return,
        }
    }
}

/// How the walk leaves the lens.
pub(super) fn start(job: &Job<'_>, walk: &mut Walk) -> Departure {
    let onward = job.builder.form.at_lens();
    walk.throughput /= onward.onward as f32;
    walk.start = walk.throughput.mean();
    let camera = job.scene.camera();
    let origin = walk.ray.origin.as_dvec3();
    let parallel = camera.is_dirac_direction();
    let pdf = if parallel {
        camera.raster_density(origin, origin + walk.direction)
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
    Departure::from_end(job.builder.heuristic, end, onward.onward, onward.odds())
}

/// Joins the last vertex to an emitter and to all vertices of the light.
fn join_all(
    job: &Job<'_>,
    u: &mut dyn Coordinates,
    light: &Subpath,
    eye: &[PathVertex],
    gathered: &mut Gathered<'_>,
    witness: &mut impl Witness,
) {
    if !eye[eye.len() - 1].connectable {
        return;
    }
    next_event(job, u, eye, gathered, witness);
    for count in 1..=light.vertices().len() {
        join(job, &light.vertices()[..count], eye, gathered, witness);
    }
}

/// s = 0: what the surface just met emits.
pub(super) fn emission(
    job: &Job<'_>,
    specular: bool,
    eye: &[PathVertex],
    gathered: &mut Gathered<'_>,
    witness: &mut impl Witness,
) {
    let z = &eye[eye.len() - 1];
    if z.edges < job.builder.settings.min_edges {
        return;
    }
    let radiance = job.scene.emitted(&z.vertex, z.back, job.wavelengths);
    if radiance.is_zero() {
        return;
    }
    let pdf = job.scene.emission_pdf(&z.vertex, z.back);
    let weight = job.weights().implicit(z.edges, &pdf, &z.running);
    let value = z.throughput * radiance * weight as f32;
    seen(witness, z.edges, eye, (pdf, z.back), weight, value);
    gathered.add(Class::implicit(specular), value, z.dispersive);
}

/// s = 0: what a walk that left the scene sees.
pub(super) fn escape(
    job: &Job<'_>,
    walk: &Walk,
    running: &Running,
    eye: &[PathVertex],
    gathered: &mut Gathered<'_>,
    witness: &mut impl Witness,
) {
    if walk.edges < job.builder.settings.min_edges {
        return;
    }
    let radiance = job.scene.environment(walk.direction, job.wavelengths);
    if radiance.is_zero() {
        return;
    }
    let pdf = job.scene.environment_emission_pdf(walk.direction);
    let weight = job.weights().implicit(walk.edges, &pdf, running);
    let value = walk.throughput * radiance * weight as f32;
    seen(
        witness,
        walk.edges,
        eye,
        (pdf, -walk.direction),
        weight,
        value,
    );
    gathered.add(Class::implicit(walk.specular), value, walk.dispersive);
}

fn seen(
    witness: &mut impl Witness,
    edges: u32,
    eye: &[PathVertex],
    (pdf, direction): (EmissionPdf, DVec3),
    weight: f64,
    value: Spectrum,
) {
    witness.see(&Seen {
        s: 0,
        t: edges + 1,
        weight,
        value,
        light: &[],
        eye,
        joint: Joint::Emitter { pdf, direction },
    });
}

impl Job<'_> {
    /// Goes on from the last vertex of a subpath; `None` where the walk ends.
    #[inline]
    pub(super) fn depart(
        &self,
        walk: &mut Walk,
        path: &mut Subpath,
        u: &mut dyn Coordinates,
        bounces: (Stream, u32),
    ) -> Option<Departure> {
        let last = path.last_mut();
        let scatter = last.scatter();
        let sample = walk.bounce(self.scene, &scatter, u, bounces)?;
        // Where the simple form may stop, that is roulette enough.
        let roulette = self.builder.form == Form::Full || last.onward.onward >= 1.0;
        if self.roulette && roulette && !walk.survives(u, bounces) {
            return None;
        }
        let (densities, odds) = if sample.delta {
            ([1.0; 2], 0.0)
        } else {
            let reverse = match walk.mode {
                Mode::Radiance => Mode::Importance,
                Mode::Importance => Mode::Radiance,
            };
            let back = last.bsdf.pdf(sample.wi, last.wo, reverse);
            ([sample.pdf, back], last.onward.odds())
        };
        let cos = sample.wi.dot(last.ng).abs();
        last.delta = sample.delta;
        let heuristic = self.builder.heuristic;
        Some(Departure::from_surface(
            heuristic,
            &last.running,
            densities,
            cos,
            odds,
        ))
    }
}
