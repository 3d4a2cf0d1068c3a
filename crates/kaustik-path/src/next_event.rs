//! Next-event estimation: joining a vertex of a camera walk to an emitter.

use glam::DVec3;
use kaustik_bsdf::{Lobe, Mode, shading};
use kaustik_pss::{Coordinates, Stream};
use kaustik_scene::{DirectSample, Reach, Scene, Vertex};
use kaustik_spectrum::Wavelengths;

use crate::contributions::Gathered;
use crate::shadow::Shadow;
use crate::trace::{Event, note};
use crate::walk::{Scatter, Walk, power_heuristic};
use crate::{Class, layout};

/// How often the two techniques that find an emitter are used, as factors of their densities.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TechniqueShares {
    /// Probability that next event is used at this vertex.
    pub(crate) next_event: f64,
    /// Probability that the walk goes on.
    pub(crate) scattering: f64,
}

impl TechniqueShares {
    /// Both always.
    pub(crate) const BOTH: Self = Self {
        next_event: 1.0,
        scattering: 1.0,
    };
}

/// Adds the light that reaches the vertex from one point of an emitter, weighted against
/// the chance that scattering finds the same emitter (power heuristic).
#[inline]
pub(crate) fn next_event(
    scene: &Scene,
    walk: &Walk<'_>,
    scatter: &Scatter<'_>,
    shares: TechniqueShares,
    u: &mut dyn Coordinates,
    gathered: &mut Gathered<'_>,
) {
    if !scatter.bsdf.is_connectable() {
        return;
    }
    let vertex = scatter.vertex;
    let mut sample = DirectSample::nothing();
    if !find_emitter(scene, walk.wavelengths, vertex, walk.edges, u, &mut sample) {
        return;
    }
    let wi = vertex.frame.to_local(sample.wi);
    if !shading::sides_agree(scatter.wo, wi, scatter.ng) {
        return;
    }
    let (f, density) = scatter.bsdf.eval_pdf(scatter.wo, wi, Mode::Radiance);
    let pdf = sample.pdf * shares.next_event;
    let mut value = walk.throughput * f * sample.radiance * ((wi.z.abs() / pdf) as f32);
    if value.is_zero() {
        return;
    }
    let weight = match sample.delta {
        true => 1.0, // nothing else finds it
        false => power_heuristic(pdf, density * shares.scattering),
    };
    value *= weight;
    note(|| Event::Join {
        s: 1,
        t: walk.edges + 1,
        points: end(&sample).map(|end| [vertex.position, end]),
        weight: f64::from(weight),
        value,
    });
    let shadow = Shadow {
        ray: scene.shadow_ray(vertex, &sample),
        interior: scene.interior_toward(vertex, &walk.interior, -walk.direction, sample.wi),
        distance: end(&sample).map_or(0.0, |end| (end - vertex.position).length()),
    };
    gathered.count_shadow();
    if !shadow.dim(scene, walk.wavelengths, &mut value) {
        return;
    }
    let dispersive = walk.dispersive || scatter.bsdf.dispersive_between(scatter.wo, wi);
    gathered.add(Class::L2, value, dispersive);
}

/// Draws a point of an emitter for the vertex after `edges` edges, into `sample`; `false` if there is none.
#[inline]
pub(crate) fn find_emitter(
    scene: &Scene,
    wavelengths: &Wavelengths,
    vertex: &Vertex,
    edges: u32,
    u: &mut dyn Coordinates,
    sample: &mut DirectSample,
) -> bool {
    let first = layout::connection(edges);
    let ask = |i: u32| u.get(Stream::Connection, first + i);
    scene.write_direct(vertex.position, wavelengths, ask, sample)
}

/// The point of the emitter; `None` at infinity.
#[inline]
pub(crate) fn end(sample: &DirectSample) -> Option<DVec3> {
    match &sample.reach {
        Reach::Surface(point, _) => Some(point.as_dvec3()),
        Reach::Point(point) => Some(*point),
        Reach::Infinity => None,
    }
}
