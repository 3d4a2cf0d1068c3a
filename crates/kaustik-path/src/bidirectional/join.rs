//! Joining a vertex of the eye to an emitter, and to a vertex of the light.

use kaustik_bsdf::{Lobe, Mode, shading};
use kaustik_geometry::Ray;
use kaustik_pss::{Coordinates, Stream};
use kaustik_scene::DirectSample;

use super::Job;
use super::vertex::PathVertex;
use super::weights::DirectEnd;
use super::witness::{Joint, Seen, Witness};
use crate::contributions::Gathered;
use crate::next_event::end;
use crate::shadow::Shadow;
use crate::{Class, layout};

/// s = 1: joins the last vertex to a fresh point of an emitter.
pub(super) fn next_event(
    job: &Job<'_>,
    u: &mut dyn Coordinates,
    eye: &[PathVertex],
    gathered: &mut Gathered<'_>,
    witness: &mut impl Witness,
) {
    let scene = job.scene;
    let z = &eye[eye.len() - 1];
    if z.edges + 1 < job.builder.settings.min_edges {
        return;
    }
    let first = layout::connection(z.edges);
    let mut sample = DirectSample::nothing();
    let ask = |i: u32| u.get(Stream::Connection, first + i);
    if !scene.write_direct(z.vertex.position, job.wavelengths, ask, &mut sample) {
        return;
    }
    let wi = z.vertex.frame.to_local(sample.wi);
    if !shading::sides_agree(z.wo, wi, z.ng) {
        return;
    }
    let f = z.bsdf.eval(z.wo, wi, Mode::Radiance);
    let mut value = z.throughput * f * sample.radiance;
    if value.is_zero() {
        return;
    }
    let distance = distance(z, &sample);
    let direct = DirectEnd {
        pdf: (!sample.delta).then_some(sample.pdf),
        emission_pdf: sample.emission_pdf,
        squared: distance.map_or(1.0, |distance| distance * distance),
    };
    let weight = job.weights().direct(z, wi, &direct);
    let stops = z.onward.stop * job.builder.form.at_emitter().stop;
    value *= (wi.z.abs() * weight / (sample.pdf * stops)) as f32;
    if value.is_zero() {
        return;
    }
    witness.see(&Seen {
        s: 1,
        t: z.edges + 1,
        weight,
        value,
        light: &[],
        eye,
        joint: Joint::Direct(&sample),
    });
    let shadow = Shadow {
        ray: scene.shadow_ray(&z.vertex, &sample),
        interior: scene.interior_toward(&z.vertex, &z.interior, z.back, sample.wi),
        distance: distance.unwrap_or(0.0),
    };
    gathered.count_shadow();
    if !shadow.dim(scene, job.wavelengths, &mut value) {
        return;
    }
    let dispersive = z.dispersive || z.bsdf.dispersive_between(z.wo, wi);
    gathered.add(Class::L2, value, dispersive);
}

/// To the emitter; `None` at infinity.
fn distance(z: &PathVertex, sample: &DirectSample) -> Option<f64> {
    end(sample).map(|end| (end - z.vertex.position).length())
}

/// s >= 2, t >= 2: joins the last vertices of both subpaths.
pub(super) fn join(
    job: &Job<'_>,
    light: &[PathVertex],
    eye: &[PathVertex],
    gathered: &mut Gathered<'_>,
    witness: &mut impl Witness,
) {
    let scene = job.scene;
    let (y, z) = (&light[light.len() - 1], &eye[eye.len() - 1]);
    let settings = &job.builder.settings;
    let edges = y.edges + z.edges + 1;
    if !y.connectable || edges > settings.max_edges || edges < settings.min_edges {
        return;
    }
    let along = y.vertex.position - z.vertex.position;
    let squared = along.length_squared();
    if squared == 0.0 {
        return;
    }
    let distance = squared.sqrt();
    let direction = along / distance;
    // z's direction to y, and y's to z
    let wi = z.vertex.frame.to_local(direction);
    if !shading::sides_agree(z.wo, wi, z.ng) {
        return;
    }
    let wy = y.vertex.frame.to_local(-direction);
    let factor = shading::connection_factor(wy, y.wo, y.ng);
    if factor == 0.0 {
        return;
    }
    let f = z.bsdf.eval(z.wo, wi, Mode::Radiance);
    let g = y.bsdf.eval(y.wo, wy, Mode::Importance);
    let mut value = (z.throughput * f) * (y.throughput * g);
    if value.is_zero() {
        return;
    }
    let weight = job.weights().joined((y, wy), (z, wi), squared);
    // The light's side carries geometric cosines and `factor`, the eye's the shading cosine.
    let geometry = factor * wy.dot(y.ng).abs() * wi.z.abs() / squared;
    value *= (geometry * weight / (y.onward.stop * z.onward.stop)) as f32;
    if value.is_zero() {
        return;
    }
    witness.see(&Seen {
        s: y.edges + 1,
        t: z.edges + 1,
        weight,
        value,
        light,
        eye,
        joint: Joint::Surfaces,
    });
    let shadow = Shadow {
        ray: Ray::between(&z.vertex.surface, &y.vertex.surface),
        interior: scene.interior_toward(&z.vertex, &z.interior, z.back, direction),
        distance,
    };
    gathered.count_shadow();
    if !shadow.dim(scene, job.wavelengths, &mut value) {
        return;
    }
    let dispersive = y.dispersive
        || z.dispersive
        || z.bsdf.dispersive_between(z.wo, wi)
        || y.bsdf.dispersive_between(y.wo, wy);
    gathered.add(Class::L5, value, dispersive);
}
