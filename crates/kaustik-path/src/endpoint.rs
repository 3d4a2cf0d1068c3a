//! A walk from the camera that is joined to an emitter at its end only (Kelemen sec. 2).

use kaustik_bsdf::{Bsdf, Lobe};
use kaustik_pss::Coordinates;
use kaustik_scene::{Scene, Vertex};

use crate::bidirectional::ONWARD;
use crate::contributions::Gathered;
use crate::next_event::{TechniqueShares, next_event};
use crate::unidirectional::{Origin, emission, escape};
use crate::walk::{Scatter, Walk};
use crate::{BuilderSettings, Contributions, PathBuilder, camera_walk};

/// One path a point: the walk stops by roulette, and where it stops it is joined to an emitter. An
/// emitter that the walk runs into counts as well; the two techniques are weighted with their
/// densities, the probabilities of stopping and of going on included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Endpoint {
    /// What all builders are told.
    pub settings: BuilderSettings,
}

impl PathBuilder for Endpoint {
    fn build(&self, scene: &Scene, u: &mut dyn Coordinates, out: &mut Contributions) {
        camera_walk::trace(&self.settings, scene, u, out, |scene, walk, u, gathered| {
            self.gather(scene, walk, u, gathered);
        });
    }
}

impl Endpoint {
    fn gather(
        &self,
        scene: &Scene,
        walk: &mut Walk<'_>,
        u: &mut dyn Coordinates,
        gathered: &mut Gathered<'_>,
    ) {
        let mut origin = None;
        let mut share = 0.0;
        let (mut vertex, mut bsdf) = (Vertex::default(), Bsdf::black());
        while walk.advance(scene, u, &mut vertex).is_some() {
            let settings = &self.settings;
            if settings.makes(walk.edges, walk.pure) {
                emission(scene, walk, &vertex, origin, share, gathered);
            }
            if walk.edges == settings.max_edges {
                return;
            }
            let scatter = walk.scatter(scene, &vertex, &mut bsdf);
            let onward = onward(&scatter);
            if onward < 1.0 {
                if walk.stops(onward, u) {
                    let shares = TechniqueShares {
                        next_event: 1.0 - onward,
                        scattering: onward,
                    };
                    if walk.edges + 1 >= settings.min_edges {
                        next_event(scene, walk, &scatter, shares, u, gathered);
                    }
                    return;
                }
                walk.throughput /= onward as f32;
            }
            let Some(sample) = walk.bounce(scene, &scatter, u) else {
                return;
            };
            share = 1.0 - onward;
            let rivalled = onward < 1.0 && !sample.delta;
            origin = rivalled.then(|| Origin::new(scatter.vertex.position, sample.pdf * onward));
            if onward >= 1.0 && !walk.survives(u) {
                return;
            }
        }
        if self.settings.makes(walk.edges, walk.pure) {
            escape(scene, walk, origin, share, gathered);
        }
    }
}

/// Probability of going on: the albedo within limits where the walk could be joined, else 1.
fn onward(scatter: &Scatter<'_>) -> f64 {
    if !scatter.bsdf.is_connectable() {
        return 1.0;
    }
    f64::from(scatter.bsdf.albedo(scatter.wo).mean()).clamp(*ONWARD.start(), *ONWARD.end())
}
