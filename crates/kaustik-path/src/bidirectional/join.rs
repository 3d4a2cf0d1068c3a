//! Joining a vertex of the eye to an emitter, and to a vertex of the light.

use glam::DVec3;
use kaustik_bsdf::{Lobe, Mode, shading};
use kaustik_geometry::Ray;
use kaustik_pss::Coordinates;
use kaustik_scene::DirectSample;

use super::Job;
use super::joined::Joined;
use super::vertex::PathVertex;
use super::weights::{DirectEnd, Weighted};
use super::witness::{Joint, Seen, Witness};
use crate::Class;
use crate::contributions::{Gathered, colour};
use crate::next_event::{end, find_emitter};
use crate::shadow::Shadow;

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
    let mut sample = DirectSample::nothing();
    if !find_emitter(scene, job.wavelengths, &z.vertex, z.edges, u, &mut sample) {
        return;
    }
    let wi = z.vertex.frame.to_local(sample.wi);
    // To the emitter; `None` at infinity.
    let distance = end(&sample).map(|end| (end - z.vertex.position).length());
    let Some(Weighted { weight, mut value }) = weigh_direct(job, z, wi, &sample, distance) else {
        return;
    };
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
    witness.lit((1, z.edges + 1), z.survived, || {
        colour(value, dispersive, job.wavelengths)
    });
}

/// What comes from a point of an emitter, which `z` sees in local direction `wi`; `None` if that is nothing.
#[inline]
fn weigh_direct(
    job: &Job<'_>,
    z: &PathVertex,
    wi: DVec3,
    sample: &DirectSample,
    distance: Option<f64>,
) -> Option<Weighted> {
    if !shading::sides_agree(z.wo, wi, z.ng) {
        return None;
    }
    let joined = Joined::new(z, wi, Mode::Radiance);
    let value = joined.value * sample.radiance;
    if value.is_zero() {
        return None;
    }
    let direct = DirectEnd {
        pdf: (!sample.delta).then_some(sample.pdf),
        odds: sample.odds,
        emission_pdf: sample.emission_pdf,
        squared: distance.map_or(1.0, |distance| distance * distance),
    };
    let weight = job.weights().direct(&joined, &direct);
    let stops = z.onward.stop * job.builder.form.at_emitter().stop;
    Weighted::new(value, wi.z.abs() * weight / (sample.pdf * stops), weight)
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
    let Some(edge) = Edge::between(y, z) else {
        return;
    };
    let Some(Weighted { weight, mut value }) = weigh_joined(job, y, z, &edge) else {
        return;
    };
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
        interior: scene.interior_toward(&z.vertex, &z.interior, z.back, edge.direction),
        distance: edge.distance,
    };
    gathered.count_shadow();
    if !shadow.dim(scene, job.wavelengths, &mut value) {
        return;
    }
    let dispersive = y.dispersive
        || z.dispersive
        || z.bsdf.dispersive_between(z.wo, edge.wi)
        || y.bsdf.dispersive_between(y.wo, edge.wy);
    gathered.add(Class::L5, value, dispersive);
    witness.lit((y.edges + 1, z.edges + 1), y.survived * z.survived, || {
        colour(value, dispersive, job.wavelengths)
    });
}

/// The edge that joins a vertex `y` of the light and a vertex `z` of the eye.
struct Edge {
    /// From `z` to `y`, unit.
    direction: DVec3,
    /// The same in the local frame of `z`.
    wi: DVec3,
    /// From `y` to `z` in the local frame of `y`.
    wy: DVec3,
    distance: f64,
    /// Square of the distance.
    squared: f64,
    /// [`shading::connection_factor`] at `y`.
    factor: f64,
}

impl Edge {
    /// `None` if the surfaces' sides let nothing pass along it.
    #[inline]
    fn between(y: &PathVertex, z: &PathVertex) -> Option<Self> {
        let along = y.vertex.position - z.vertex.position;
        let squared = along.length_squared();
        if squared == 0.0 {
            return None;
        }
        let distance = squared.sqrt();
        let direction = along / distance;
        let wi = z.vertex.frame.to_local(direction);
        if !shading::sides_agree(z.wo, wi, z.ng) {
            return None;
        }
        let wy = y.vertex.frame.to_local(-direction);
        let factor = shading::connection_factor(wy, y.wo, y.ng);
        (factor != 0.0).then_some(Self {
            direction,
            wi,
            wy,
            distance,
            squared,
            factor,
        })
    }
}

/// What the edge from `y` to `z` carries; `None` if that is nothing.
#[inline]
fn weigh_joined(job: &Job<'_>, y: &PathVertex, z: &PathVertex, edge: &Edge) -> Option<Weighted> {
    let squared = edge.squared;
    let z = Joined::new(z, edge.wi, Mode::Radiance);
    if z.value.is_zero() {
        return None;
    }
    let y = Joined::new(y, edge.wy, Mode::Importance);
    let value = z.value * y.value;
    if value.is_zero() {
        return None;
    }
    let weight = job.weights().joined(&y, &z, squared);
    // The light's side carries geometric cosines and the factor, the eye's the shading cosine.
    let geometry = edge.factor * y.cos() * z.wi.z.abs() / squared;
    let stops = y.vertex.onward.stop * z.vertex.onward.stop;
    Weighted::new(value, geometry * weight / stops, weight)
}
