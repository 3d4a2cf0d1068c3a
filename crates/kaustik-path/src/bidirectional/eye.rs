//! The subpath from the eye, and the light that it gathers.

use glam::{DVec2, DVec3};
use kaustik_pss::Coordinates;
use kaustik_scene::EmissionPdf;
use kaustik_spectrum::Spectrum;

use super::join::{join, next_event};
use super::subpath_walk::SubpathWalk;
use super::vertex::PathVertex;
use super::witness::{Joint, Seen, Witness};
use super::workspace::{Subpath, Workspace};
use super::{Form, Job};
use crate::contributions::{Gathered, colour};
use crate::walk::Walk;

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
    let (mut going, raster) = SubpathWalk::from_lens(job, u);
    follow(job, &mut going, u, workspace, other, gathered, witness);
    gathered.count_walk(going.walk.edges);
    raster
}

/// The walk of [`trace`], once it has begun.
fn follow(
    job: &Job<'_>,
    going: &mut SubpathWalk<'_>,
    u: &mut dyn Coordinates,
    workspace: &mut Workspace,
    other: OtherEnd,
    gathered: &mut Gathered<'_>,
    witness: &mut impl Witness,
) {
    let Workspace { light, eye } = workspace;
    loop {
        if going.advance(job, u, eye).is_none() {
            escape(job, going, eye.vertices(), gathered, witness);
            return;
        }
        going.keep(job, eye);
        emission(job, &going.walk, eye.vertices(), gathered, witness);
        if going.walk.edges == job.builder.settings.max_edges {
            return;
        }
        let onward = going.open(job, eye);
        if job.builder.form == Form::Full {
            join_all(job, u, light, eye.vertices(), gathered, witness);
        } else if onward < 1.0 {
            if going.walk.stops(onward, u) {
                match other {
                    OtherEnd::Emitter => next_event(job, u, eye.vertices(), gathered, witness),
                    OtherEnd::Last => {
                        join(job, light.vertices(), eye.vertices(), gathered, witness);
                    }
                    OtherEnd::Any | OtherEnd::None => {}
                }
                return;
            }
            going.walk.throughput /= onward as f32;
        }
        if !going.depart(job, u, eye) {
            return;
        }
    }
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
    walk: &Walk<'_>,
    eye: &[PathVertex],
    gathered: &mut Gathered<'_>,
    witness: &mut impl Witness,
) {
    let z = &eye[eye.len() - 1];
    if !job.builder.settings.makes(z.edges, walk.pure) {
        return;
    }
    let radiance = job.scene.emitted(&z.vertex, z.back, job.wavelengths);
    if radiance.is_zero() {
        return;
    }
    let pdf = job.scene.emission_pdf(&z.vertex, z.back);
    // From the lens there is no next event.
    let choice = || match eye {
        [.., before, _] => (job.scene).next_event_odds(&pdf, before.vertex.position),
        _ => 1.0,
    };
    let weight = (job.weights()).implicit(z.edges, &pdf, choice, &z.running);
    let value = z.throughput * radiance * weight as f32;
    seen(witness, z.edges, eye, (pdf, z.back), weight, value);
    gathered.add(walk.implicit(), value, z.dispersive);
    witness.lit((0, z.edges + 1), z.survived, || {
        colour(value, z.dispersive, job.wavelengths)
    });
}

/// s = 0: what a walk that left the scene sees.
pub(super) fn escape(
    job: &Job<'_>,
    going: &SubpathWalk<'_>,
    eye: &[PathVertex],
    gathered: &mut Gathered<'_>,
    witness: &mut impl Witness,
) {
    let walk = &going.walk;
    if !job.builder.settings.makes(walk.edges, walk.pure) {
        return;
    }
    let radiance = job.scene.environment(walk.direction, job.wavelengths);
    if radiance.is_zero() {
        return;
    }
    let pdf = job.scene.environment_emission_pdf(walk.direction);
    let running = going.departure.escape(job.builder.heuristic);
    let weight = (job.weights()).implicit(walk.edges, &pdf, || 1.0, &running);
    let value = walk.throughput * radiance * weight as f32;
    seen(
        witness,
        walk.edges,
        eye,
        (pdf, -walk.direction),
        weight,
        value,
    );
    gathered.add(walk.implicit(), value, walk.dispersive);
    witness.lit((0, walk.edges + 1), walk.survived, || {
        colour(value, walk.dispersive, job.wavelengths)
    });
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
