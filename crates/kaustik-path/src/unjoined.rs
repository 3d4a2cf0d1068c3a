//! Implicit specular paths that nothing else makes, alone.

use kaustik_bsdf::Bsdf;
use kaustik_pss::Coordinates;
use kaustik_scene::{Scene, Vertex};

use crate::contributions::Gathered;
use crate::walk::Walk;
use crate::{BuilderSettings, Class, Contributions, PathBuilder, camera_walk};

/// What [`Bidirectional`](crate::Bidirectional) paths in their full form contribute in [`Class::L0`], by the camera
/// walk alone.
///
/// It reads the same coordinates and comes to the same light, up to rounding: a walk that runs into an emitter by way of
/// Dirac surfaces and that could not have been joined anywhere has weight 1 whatever the heuristic. (Through a lens with area it
/// has not: there a walk from the light may run into the lens, and the full form brings less in this class.) No light
/// subpath is walked, nothing is joined, and a walk ends where it could be joined: where much of the
/// picture is such light it takes a fifth of the time, elsewhere less. So a chain can take many steps by it for each full evaluation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unjoined {
    /// What all builders are told.
    pub settings: BuilderSettings,
}

impl PathBuilder for Unjoined {
    fn build(&self, scene: &Scene, u: &mut dyn Coordinates, out: &mut Contributions) {
        let settings = &self.settings;
        camera_walk::trace(settings, scene, u, out, |scene, walk, u, gathered| {
            gather(settings, scene, walk, u, gathered);
        });
    }
}

/// Follows the walk to where it ends or could be joined.
fn gather(
    settings: &BuilderSettings,
    scene: &Scene,
    walk: &mut Walk<'_>,
    u: &mut dyn Coordinates,
    gathered: &mut Gathered<'_>,
) {
    let counts =
        |walk: &Walk<'_>| walk.implicit() == Class::L0 && settings.makes(walk.edges, walk.pure);
    let (mut vertex, mut bsdf) = (Vertex::default(), Bsdf::black());
    while walk.advance(scene, u, &mut vertex).is_some() {
        if counts(walk) {
            let radiance = scene.emitted(&vertex, -walk.direction, walk.wavelengths);
            if !radiance.is_zero() {
                gathered.add(Class::L0, walk.throughput * radiance, walk.dispersive);
            }
        }
        if walk.edges == settings.max_edges {
            return;
        }
        let scatter = walk.scatter(scene, &vertex, &mut bsdf);
        if walk.bounce(scene, &scatter, u).is_none() || walk.joined || !walk.survives(u) {
            return;
        }
    }
    if counts(walk) {
        let radiance = scene.environment(walk.direction, walk.wavelengths);
        if !radiance.is_zero() {
            gathered.add(Class::L0, walk.throughput * radiance, walk.dispersive);
        }
    }
}
