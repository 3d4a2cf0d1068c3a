//! What photons cannot carry: emitters seen directly, and in mirrors, through glass, in narrow lobes.

use kaustik_bsdf::Bsdf;
use kaustik_pss::Coordinates;
use kaustik_scene::{Scene, Vertex};

use super::narrow::{Part, take};
use crate::contributions::Gathered;
use crate::next_event::{TechniqueShares, next_event};
use crate::unidirectional::{Origin, emission, escape};
use crate::walk::{Scatter, Walk};
use crate::{BuilderSettings, Contributions, PathBuilder, camera_walk};

/// Path tracing through narrow lobes alone: with photon maps of the same threshold each light path counts once.
///
/// A walk ends where it takes the wide part of a surface, by the same law as a
/// [`MeasurementWalk`](super::MeasurementWalk): what that part scatters, photons bring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remainder {
    /// What all builders are told.
    pub settings: BuilderSettings,
    /// GGX roughness from which on a lobe is wide, in [0, 1].
    pub threshold: f64,
}

impl PathBuilder for Remainder {
    fn build(&self, scene: &Scene, u: &mut dyn Coordinates, out: &mut Contributions) {
        camera_walk::trace(&self.settings, scene, u, out, |scene, walk, u, gathered| {
            self.gather(scene, walk, u, gathered);
        });
    }
}

impl Remainder {
    fn gather(
        &self,
        scene: &Scene,
        walk: &mut Walk<'_>,
        u: &mut dyn Coordinates,
        gathered: &mut Gathered<'_>,
    ) {
        let mut origin = None;
        let (mut vertex, mut bsdf) = (Vertex::default(), Bsdf::black());
        while walk.advance(scene, u, &mut vertex).is_some() {
            emission(scene, walk, &vertex, origin, 1.0, gathered);
            if walk.edges == self.settings.max_edges {
                return;
            }
            let scatter = walk.scatter(scene, &vertex, &mut bsdf);
            let Part::Narrow(narrow) = take(walk, &scatter, self.threshold, u) else {
                return;
            };
            let scatter = Scatter {
                bsdf: &narrow,
                ..scatter
            };
            next_event(scene, walk, &scatter, TechniqueShares::BOTH, u, gathered);
            let Some(sample) = walk.bounce(scene, &scatter, u) else {
                return;
            };
            origin = (!sample.delta).then(|| Origin::new(vertex.position, sample.pdf));
            if !walk.survives(u) {
                return;
            }
        }
        escape(scene, walk, origin, 1.0, gathered);
    }
}
