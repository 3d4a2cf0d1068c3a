//! The subpath from the light, and what it brings to the lens.

use glam::DVec3;
use kaustik_bsdf::{Lobe, Mode, shading};
use kaustik_geometry::Ray;
use kaustik_pss::{Coordinates, Stream};
use kaustik_scene::camera::{LensHit, LensSample};
use kaustik_scene::{EmissionSample, Interior};
use kaustik_spectrum::Spectrum;

use super::joined::Joined;
use super::subpath_walk::SubpathWalk;
use super::vertex::PathVertex;
use super::weights::{LensEnd, Weighted};
use super::witness::{Joint, Seen, Witness};
use super::workspace::Subpath;
use super::{Form, Job};
use crate::contributions::colour;
use crate::light::find_lens;
use crate::shadow::Shadow;
use crate::walk::Walk;
use crate::{Class, Contributions};

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
    let mut going = SubpathWalk::from_emitter(job, &emission);
    let ended = follow(job, &mut going, &emission, u, path, to_lens, out, witness);
    out.count_walk(going.walk.edges);
    ended
}

/// The walk of [`trace`], once it has begun.
#[expect(
    clippy::too_many_arguments,
    reason = "all that a walk reads and writes"
)]
fn follow(
    job: &Job<'_>,
    going: &mut SubpathWalk<'_>,
    emission: &EmissionSample,
    u: &mut dyn Coordinates,
    path: &mut Subpath,
    to_lens: bool,
    out: &mut Contributions,
    witness: &mut impl Witness,
) -> bool {
    let aperture = job.scene.camera().has_aperture();
    while !going.walk.throughput.is_zero() {
        let Some(distance) = take_edge(job, going, u, path, out, witness) else {
            return false;
        };
        if going.walk.edges == 1 {
            going.walk.throughput *= job.scene.fading(emission, distance);
        }
        going.keep(job, path);
        let onward = going.open(job, path);
        if job.builder.form == Form::Full {
            join_lens(job, u, path, out, witness);
        } else if onward < 1.0 {
            if going.walk.stops(onward, u) {
                if to_lens {
                    join_lens(job, u, path, out, witness);
                }
                return true;
            }
            going.walk.throughput /= onward as f32;
        }
        let ends = !aperture && !next_is_joined(job, &going.walk);
        if ends || !going.depart(job, u, path) {
            return false;
        }
    }
    false
}

/// Takes the next edge, and if it runs into the lens, tells what it brings there. Returns its length; `None`
/// if it leads to no vertex that a path can be joined at.
fn take_edge(
    job: &Job<'_>,
    going: &mut SubpathWalk<'_>,
    u: &mut dyn Coordinates,
    path: &mut Subpath,
    out: &mut Contributions,
    witness: &mut impl Witness,
) -> Option<f64> {
    let edges = going.walk.edges;
    let joined = next_is_joined(job, &going.walk);
    let aperture = job.scene.camera().has_aperture();
    let lens = (aperture && edges >= 1 && edges < job.builder.settings.max_edges)
        .then(|| job.lens_ahead(&going.walk))
        .flatten();
    if !joined && lens.is_none() {
        return None;
    }
    let carried = Carried::by(&going.walk);
    let distance = going.advance(job, u, path);
    if let Some(hit) = lens.filter(|hit| distance.is_none_or(|d| hit.distance < d)) {
        meet_lens(job, going, &carried, &hit, path, out, witness);
    }
    distance.filter(|_| joined)
}

/// May the vertex that the next edge leads to be joined? That takes one edge more; to run into the lens takes none.
#[inline]
fn next_is_joined(job: &Job<'_>, walk: &Walk<'_>) -> bool {
    walk.edges + 2 <= job.builder.settings.max_edges
}

/// What an edge toward the lens carries, whatever lies behind the lens.
#[derive(Clone, Copy, Debug)]
pub(super) struct Carried {
    throughput: Spectrum,
    /// The solids around its start.
    interior: Interior,
    ray: Ray,
}

impl Carried {
    /// What the panes before the lens make of it: what the walk took with it is of those behind as well.
    fn tint(&self, job: &Job<'_>, distance: f64) -> Spectrum {
        let unit = self.ray.direction.as_dvec3().length();
        let up_to_lens = Ray {
            t_max: (distance / unit) as f32,
            ..self.ray
        };
        let passed = (job.scene).visibility(&up_to_lens, &self.interior, job.wavelengths);
        passed.tint()
    }

    /// By a walk that is about to take the edge.
    #[inline]
    pub(super) fn by(walk: &Walk<'_>) -> Self {
        Self {
            throughput: walk.throughput,
            interior: walk.interior,
            ray: walk.ray,
        }
    }
}

/// t = 0: the edge just walked runs into the lens.
pub(super) fn meet_lens(
    job: &Job<'_>,
    going: &SubpathWalk<'_>,
    carried: &Carried,
    hit: &LensHit,
    path: &Subpath,
    out: &mut Contributions,
    witness: &mut impl Witness,
) {
    let walk = &going.walk;
    if !job.builder.settings.makes(walk.edges, walk.pure) {
        return;
    }
    let camera = job.scene.camera();
    let squared = hit.distance * hit.distance;
    let running = (going.departure).arrive(job.builder.heuristic, squared, hit.cos);
    let back = camera.pdf_direction(-walk.direction) * job.raster_pdf;
    let weight = job.weights().lens_hit(&running, camera.pdf_lens(), back);
    let mut value = carried.throughput * ((hit.we * job.raster_pdf * weight) as f32);
    witness.see(&Seen {
        s: walk.edges + 1,
        t: 0,
        weight,
        value,
        light: path.vertices(),
        eye: &[],
        joint: Joint::LensHit(hit),
    });
    value *= (job.scene).transmittance(&carried.interior, job.wavelengths, hit.distance);
    if job.scene.has_panes() {
        value *= carried.tint(job, hit.distance);
    }
    let xyz = colour(value, walk.dispersive, job.wavelengths);
    out.push(hit.raster, xyz, Class::L3);
    witness.lit((walk.edges + 1, 0), walk.survived, || xyz);
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
    let settings = &job.builder.settings;
    let Some(lens) = find_lens(settings, scene, y.vertex.position, y.edges, u) else {
        return;
    };
    let wi = y.vertex.frame.to_local(lens.direction);
    let Some(Weighted { weight, mut value }) = weigh_lens(job, y, wi, &lens) else {
        return;
    };
    witness.see(&Seen {
        s: y.edges + 1,
        t: 1,
        weight,
        value,
        light: path.vertices(),
        eye: &[],
        joint: Joint::Lens(&lens),
    });
    let shadow = Shadow {
        ray: Ray::towards(&y.vertex.surface, lens.position.as_vec3()),
        interior: scene.interior_toward(&y.vertex, &y.interior, y.back, lens.direction),
        distance: lens.distance,
    };
    out.count_shadow();
    if !shadow.dim(scene, job.wavelengths, &mut value) {
        return;
    }
    let dispersive = y.dispersive || y.bsdf.dispersive_between(y.wo, wi);
    let xyz = colour(value, dispersive, job.wavelengths);
    out.push(lens.raster, xyz, Class::L4);
    witness.lit((y.edges + 1, 1), y.survived, || xyz);
}

/// What a point of the lens, which `y` sees in local direction `wi`, gets; `None` if that is nothing.
#[inline]
fn weigh_lens(job: &Job<'_>, y: &PathVertex, wi: DVec3, lens: &LensSample) -> Option<Weighted> {
    let factor = shading::connection_factor(wi, y.wo, y.ng);
    if factor == 0.0 {
        return None;
    }
    let joined = Joined::new(y, wi, Mode::Importance);
    if joined.value.is_zero() {
        return None;
    }
    let raster = lens.importance * job.raster_pdf;
    let end = LensEnd {
        raster,
        squared: lens.distance * lens.distance,
        cos: lens.cos,
        pdf: job.scene.camera().has_aperture().then_some(lens.pdf),
    };
    let weight = job.weights().lens_joined(&joined, &end);
    let stops = y.onward.stop * job.builder.form.at_lens().stop;
    let geometry = factor * joined.cos() * raster;
    Weighted::new(joined.value, geometry * weight / stops, weight)
}

impl Job<'_> {
    /// The lens on the walk's next edge, where the window shows it.
    pub(super) fn lens_ahead(&self, walk: &Walk) -> Option<LensHit> {
        let origin = walk.ray.origin.as_dvec3();
        let hit = self.scene.camera().meet_lens(origin, walk.direction)?;
        self.builder.settings.serves(hit.raster).then_some(hit)
    }
}
