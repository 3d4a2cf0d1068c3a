//! Looking for implicit specular paths by a walk from the camera alone.

use kaustik_bsdf::Bsdf;
use kaustik_pss::{Coordinates, Stream};
use kaustik_scene::{Scene, Vertex};
use kaustik_spectrum::Wavelengths;

use crate::instant::at_its_time;
use crate::walk::Walk;
use crate::{BuilderSettings, Class, camera_walk};

/// How far a walk from the camera came on the way to an implicit specular path of those that nothing else makes
/// ([`Class::L0`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sighting {
    /// The first surface did not scatter it into a Dirac direction.
    Plain,
    /// That one did, and the walk met no light before it could have been joined.
    Specular,
    /// It did, and the walk ran into light.
    Light,
}

/// The camera walk of [`Bidirectional`](crate::Bidirectional) paths in their full form, without anything that
/// is joined to it, up to the first light that it meets as paths of [`Class::L0`] do, or to where it could be
/// joined: of most walks this is the first surface. It reads the same coordinates and comes to the same places; so where
/// this does not see light, the value of the point has nothing in that class. It takes a tenth of the time, and much
/// less where few walks begin at a Dirac surface.
pub fn sight(settings: &BuilderSettings, scene: &Scene, u: &mut dyn Coordinates) -> Sighting {
    at_its_time(scene, u, |scene, u| sight_at(settings, scene, u))
}

/// In a scene that stands at the path's time.
fn sight_at(settings: &BuilderSettings, scene: &Scene, u: &mut dyn Coordinates) -> Sighting {
    let wavelengths = Wavelengths::sample(u.get(Stream::Wavelength, 0), settings.wavelengths);
    let (mut walk, _) = camera_walk::start(settings, scene, &wavelengths, u);
    let (mut vertex, mut bsdf) = (Vertex::default(), Bsdf::black());
    let so_far = |walk: &Walk<'_>| {
        if walk.specular {
            Sighting::Specular
        } else {
            Sighting::Plain
        }
    };
    while walk.advance(scene, u, &mut vertex).is_some() {
        if sees_light(settings, scene, &walk, &vertex) {
            return Sighting::Light;
        }
        if walk.edges == settings.max_edges {
            return so_far(&walk);
        }
        let scatter = walk.scatter(scene, &vertex, &mut bsdf);
        if walk.bounce(scene, &scatter, u).is_none() || walk.joined || !walk.survives(u) {
            return so_far(&walk);
        }
    }
    if sees_environment(settings, scene, &walk) {
        return Sighting::Light;
    }
    so_far(&walk)
}

/// Does a walk that has come to a vertex see light of an implicit specular path there?
#[inline]
pub(crate) fn sees_light(
    settings: &BuilderSettings,
    scene: &Scene,
    walk: &Walk<'_>,
    vertex: &Vertex,
) -> bool {
    let counts = walk.implicit() == Class::L0 && settings.makes(walk.edges, walk.pure);
    counts && !(scene.emitted(vertex, -walk.direction, walk.wavelengths)).is_zero()
}

/// The same of a walk that has left the scene.
#[inline]
pub(crate) fn sees_environment(settings: &BuilderSettings, scene: &Scene, walk: &Walk<'_>) -> bool {
    let counts = walk.implicit() == Class::L0 && settings.makes(walk.edges, walk.pure);
    counts && !(scene.environment(walk.direction, walk.wavelengths)).is_zero()
}
