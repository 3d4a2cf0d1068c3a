//! The subpath from the light, and what it brings to the lens.

use glam::DVec3;
use kaustik_bsdf::{Lobe, Mode, shading};
use kaustik_geometry::Ray;
use kaustik_pss::{Coordinates, Stream};
use kaustik_scene::camera::LensHit;
use kaustik_scene::{EmissionSample, Interior};
use kaustik_spectrum::Spectrum;

use super::running::{Departure, End};
use super::weights::LensEnd;
use super::witness::{Joint, Seen, Witness};
use super::workspace::Subpath;
use super::{Form, Job};
use crate::contributions::colour;
use crate::light::lens_coordinates;
use crate::walk::Walk;
use crate::{Class, Contributions, layout};

pub(super) const BOUNCES: (Stream, u32) = (Stream::Light, layout::LIGHT_HEAD);

/// Walks from an emitter. In the full form every vertex is joined to the lens; in the simple form the
/// last one is, if `to_lens`, and the result tells whether there is a last one to be joined.
pub(super) fn trace(
    job: &Job<'_>,
    u: &mut dyn Coordinates,
    path: &mut Subpath,
    to_lens: bool,
    out: &mut Contributions,
    witness: &mut impl Witness,
) -> bool {
    let emission = (job.scene).sample_emission(job.wavelengths, |i| u.get(Stream::Light, i));
    let Some(emission) = emission else {
        return false;
    };
    let (mut walk, departure, from) = start(job, &emission);
    let begin = (&emission, departure, from);
    let ended = follow(job, &mut walk, begin, u, path, to_lens, out, witness);
    out.count_walk(walk.edges);
    ended
}

/// The walk of [`trace`], once it has begun.
#[expect(
    clippy::too_many_arguments,
    reason = "all that a walk reads and writes"
)]
fn follow(
    job: &Job<'_>,
    walk: &mut Walk<'_>,
    (emission, mut departure, mut from): (&EmissionSample, Departure, DVec3),
    u: &mut dyn Coordinates,
    path: &mut Subpath,
    to_lens: bool,
    out: &mut Contributions,
    witness: &mut impl Witness,
) -> bool {
    let scene = job.scene;
    let (form, heuristic) = (job.builder.form, job.builder.heuristic);
    let most = job.builder.settings.max_edges;
    let aperture = scene.camera().has_aperture();
    while !walk.throughput.is_zero() {
        // A path needs one more edge to be joined, and none to run into the lens.
        let joinable = walk.edges + 2 <= most;
        let lens = (aperture && walk.edges >= 1 && walk.edges < most)
            .then(|| job.lens_ahead(walk))
            .flatten();
        if !joinable && lens.is_none() {
            return false;
        }
        let (throughput, interior) = (walk.throughput, walk.interior);
        let distance = walk.advance(scene, u, &mut path.next().vertex);
        if let Some(hit) = lens.filter(|hit| distance.is_none_or(|d| hit.distance < d)) {
            let ray = Sent {
                throughput,
                interior,
                departure: &departure,
                walk,
            };
            meet_lens(job, &ray, &hit, path, out, witness);
        }
        let Some(distance) = distance else {
            return false;
        };
        if !joinable {
            return false;
        }
        if walk.edges == 1 {
            walk.throughput *= scene.fading(emission, distance);
        }

        let slot = path.next();
        slot.reach(walk);
        scene.write_bsdf(
            &slot.vertex,
            job.wavelengths,
            &walk.interior,
            &mut slot.bsdf,
        );
        slot.connectable = slot.bsdf.is_connectable();
        slot.onward = form.at_surface(&slot.bsdf);
        let squared = (slot.vertex.position - from).length_squared();
        slot.running = departure.arrive(heuristic, squared, slot.cos_back());
        from = slot.vertex.position;
        let onward = slot.onward.onward;
        path.keep();

        if form == Form::Full {
            join_lens(job, u, path, out, witness);
        } else if onward < 1.0 {
            let stop = layout::bounce(layout::LIGHT_HEAD, walk.edges) + 3;
            if u.get(Stream::Light, stop) >= onward {
                if to_lens {
                    join_lens(job, u, path, out, witness);
                }
                return true;
            }
            walk.throughput /= onward as f32;
        }
        if !aperture && walk.edges + 2 > most {
            return false;
        }
        match job.depart(walk, path, u, BOUNCES) {
            Some(next) => departure = next,
            None => return false,
        }
    }
    false
}

/// The walk at its emitter, how it leaves it, and from where.
pub(super) fn start<'a>(job: &Job<'a>, emission: &EmissionSample) -> (Walk<'a>, Departure, DVec3) {
    let onward = job.builder.form.at_emitter();
    let throughput = emission.weight / onward.onward as f32;
    let walk = Walk::from_emitter(emission, throughput, job.wavelengths);
    let pdf = &emission.pdf;
    let end = End {
        position: if pdf.hittable { pdf.position } else { 0.0 },
        direction: pdf.direction,
        cos: pdf.cos,
        infinite: pdf.infinite,
    };
    let departure = Departure::from_end(job.builder.heuristic, end, onward.onward, onward.odds());
    let origin = match &emission.area {
        Some(area) => area.surface.position,
        None => emission.ray.origin,
    };
    (walk, departure, origin.as_dvec3())
}

/// What an edge toward the lens carries.
pub(super) struct Sent<'a> {
    pub(super) throughput: Spectrum,
    /// The solids around its start.
    pub(super) interior: Interior,
    pub(super) departure: &'a Departure,
    pub(super) walk: &'a Walk<'a>,
}

/// t = 0: the walk runs into the lens.
pub(super) fn meet_lens(
    job: &Job<'_>,
    sent: &Sent<'_>,
    hit: &LensHit,
    path: &Subpath,
    out: &mut Contributions,
    witness: &mut impl Witness,
) {
    if sent.walk.edges < job.builder.settings.min_edges {
        return;
    }
    let camera = job.scene.camera();
    let squared = hit.distance * hit.distance;
    let running = sent
        .departure
        .arrive(job.builder.heuristic, squared, hit.cos);
    let back = camera.pdf_direction(-sent.walk.direction) * job.raster_pdf;
    let weight = job.weights().lens_hit(&running, camera.pdf_lens(), back);
    let mut value = sent.throughput * ((hit.we * job.raster_pdf * weight) as f32);
    witness.see(&Seen {
        s: sent.walk.edges + 1,
        t: 0,
        weight,
        value,
        light: path.vertices(),
        eye: &[],
        joint: Joint::LensHit(hit),
    });
    value *= (job.scene).absorption(&sent.interior, job.wavelengths, hit.distance);
    let xyz = colour(value, sent.walk.dispersive, job.wavelengths);
    out.push(hit.raster, xyz, Class::L3);
}

/// t = 1: joins the last vertex to a point of the lens.
pub(super) fn join_lens(
    job: &Job<'_>,
    u: &mut dyn Coordinates,
    path: &Subpath,
    out: &mut Contributions,
    witness: &mut impl Witness,
) {
    let Some(y) = path.vertices().last().filter(|y| y.connectable) else {
        return;
    };
    if y.edges + 1 < job.builder.settings.min_edges {
        return;
    }
    let scene = job.scene;
    let camera = scene.camera();
    let lens = lens_coordinates(scene, y.edges, u);
    let Some(lens) = camera.sample_lens(y.vertex.position, lens) else {
        return;
    };
    if !job.builder.settings.serves(lens.raster) {
        return;
    }
    let wi = y.vertex.frame.to_local(lens.direction);
    let factor = shading::connection_factor(wi, y.wo, y.ng);
    if factor == 0.0 {
        return;
    }
    let mut value = y.throughput * y.bsdf.eval(y.wo, wi, Mode::Importance);
    if value.is_zero() {
        return;
    }
    let raster = lens.importance * job.raster_pdf;
    let end = LensEnd {
        raster,
        squared: lens.distance * lens.distance,
        cos: lens.cos,
        pdf: camera.has_aperture().then_some(lens.pdf),
    };
    let weight = job.weights().lens_joined(y, wi, &end);
    let stops = y.onward.stop * job.builder.form.at_lens().stop;
    let geometry = factor * wi.dot(y.ng).abs() * raster;
    value *= (geometry * weight / stops) as f32;
    if value.is_zero() {
        return;
    }
    witness.see(&Seen {
        s: y.edges + 1,
        t: 1,
        weight,
        value,
        light: path.vertices(),
        eye: &[],
        joint: Joint::Lens(&lens),
    });
    let ray = Ray::towards(&y.vertex.surface, lens.position.as_vec3());
    let interior = scene.interior_toward(&y.vertex, &y.interior, y.back, lens.direction);
    out.count_shadow();
    let visible = scene.transmittance(&ray, &interior);
    if visible == 0.0 {
        return;
    }
    value *= visible;
    value *= scene.absorption(&interior, job.wavelengths, lens.distance);
    let dispersive = y.dispersive || y.bsdf.dispersive_between(y.wo, wi);
    let xyz = colour(value, dispersive, job.wavelengths);
    out.push(lens.raster, xyz, Class::L4);
}

impl Job<'_> {
    /// The lens on the walk's next edge, where the window shows it.
    pub(super) fn lens_ahead(&self, walk: &Walk) -> Option<LensHit> {
        let origin = walk.ray.origin.as_dvec3();
        let hit = self.scene.camera().meet_lens(origin, walk.direction)?;
        self.builder.settings.serves(hit.raster).then_some(hit)
    }
}
