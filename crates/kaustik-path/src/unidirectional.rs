//! Path tracing: walks from the camera, with or without next-event estimation.

use glam::DVec3;
use kaustik_bsdf::{Bsdf, Lobe};
use kaustik_pss::Coordinates;
use kaustik_scene::{Scene, Vertex};
use kaustik_spectrum::Spectrum;

use crate::contributions::Gathered;
use crate::next_event::{TechniqueShares, next_event};
use crate::trace::{Event, note};
use crate::walk::{Walk, power_heuristic};
use crate::{BuilderSettings, Contributions, PathBuilder, PureSpecular, camera_walk};

/// Walks from the camera; emitters are found by next-event estimation at every vertex and by
/// running into them, weighted by the power heuristic (Veach 1997, 9.2), or by
/// running into them alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unidirectional {
    /// What all builders are told.
    pub settings: BuilderSettings,
    /// Join every vertex to an emitter.
    pub next_event: bool,
}

/// The last scattering, for weighing an emitter that it found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Origin {
    position: DVec3,
    /// Density per solid angle of the direction taken.
    pdf: f64,
}

impl Origin {
    pub(crate) fn new(position: DVec3, pdf: f64) -> Self {
        Self { position, pdf }
    }
}

impl PathBuilder for Unidirectional {
    fn build(&self, scene: &Scene, u: &mut dyn Coordinates, out: &mut Contributions) {
        camera_walk::trace(&self.settings, scene, u, out, |scene, walk, u, gathered| {
            self.gather(scene, walk, u, gathered);
        });
    }
}

impl Unidirectional {
    fn gather(
        &self,
        scene: &Scene,
        walk: &mut Walk<'_>,
        u: &mut dyn Coordinates,
        gathered: &mut Gathered<'_>,
    ) {
        // `None`: next event could not have found what the walk runs into.
        let mut origin = None;
        let (mut vertex, mut bsdf) = (Vertex::default(), Bsdf::black());
        while walk.advance(scene, u, &mut vertex).is_some() {
            let Self { settings, .. } = self;
            let shown = walk.edges > 1 || settings.emitters_seen;
            if shown && settings.makes(walk.edges, walk.pure) {
                emission(scene, walk, &vertex, origin, 1.0, gathered);
            }
            if walk.edges == settings.max_edges {
                return;
            }
            let scatter = walk.scatter(scene, &vertex, &mut bsdf);
            let alone = settings.pure_specular == PureSpecular::Alone;
            if alone && !scatter.bsdf.has_choice() && !scatter.bsdf.is_delta() {
                return;
            }
            if self.next_event && walk.edges + 1 >= settings.min_edges {
                next_event(scene, walk, &scatter, TechniqueShares::BOTH, u, gathered);
            }
            let Some(sample) = walk.bounce(scene, &scatter, u) else {
                return;
            };
            let rivalled = self.next_event && !sample.delta;
            if alone && !sample.delta {
                return;
            }
            origin = rivalled.then(|| Origin::new(scatter.vertex.position, sample.pdf));
            if !walk.survives(u) {
                return;
            }
        }
        if self.settings.makes(walk.edges, walk.pure) {
            escape(scene, walk, origin, 1.0, gathered);
        }
    }
}

/// Adds what the surface just met emits toward the walk. `share` is the factor of next event's
/// density at the last vertex.
#[inline]
pub(crate) fn emission(
    scene: &Scene,
    walk: &Walk<'_>,
    vertex: &Vertex,
    origin: Option<Origin>,
    share: f64,
    gathered: &mut Gathered<'_>,
) {
    let radiance = scene.emitted(vertex, -walk.direction, walk.wavelengths);
    if radiance.is_zero() {
        return;
    }
    let weight = origin.map_or(1.0, |origin| {
        power_heuristic(
            origin.pdf,
            scene.direct_pdf(origin.position, vertex) * share,
        )
    });
    let value = walk.throughput * radiance * weight;
    tell(walk, weight, value);
    gathered.add(walk.implicit(), value, walk.dispersive);
}

/// Adds what a walk that left the scene sees.
#[inline]
pub(crate) fn escape(
    scene: &Scene,
    walk: &Walk<'_>,
    origin: Option<Origin>,
    share: f64,
    gathered: &mut Gathered<'_>,
) {
    let radiance = scene.environment(walk.direction, walk.wavelengths);
    if radiance.is_zero() {
        return;
    }
    let weight = origin.map_or(1.0, |origin| {
        power_heuristic(origin.pdf, scene.environment_pdf(walk.direction) * share)
    });
    let value = walk.throughput * radiance * weight;
    tell(walk, weight, value);
    gathered.add(walk.implicit(), value, walk.dispersive);
}

/// Strategy (0, t), for whoever looks at the path.
#[inline]
fn tell(walk: &Walk<'_>, weight: f32, value: Spectrum) {
    note(|| Event::Join {
        s: 0,
        t: walk.edges + 1,
        points: None,
        weight: f64::from(weight),
        value,
    });
}
