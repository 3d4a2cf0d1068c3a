//! Looking for implicit specular paths by a walk from the camera alone.

use kaustik_bsdf::Bsdf;
use kaustik_pss::{Coordinates, Stream};
use kaustik_scene::{Scene, Vertex};
use kaustik_spectrum::Wavelengths;

use crate::instant::at_its_time;
use crate::walk::Walk;
use crate::{BuilderSettings, camera_walk};

/// Which walks a look follows beyond their first surface: by how they scatter there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beginning {
    /// All.
    Any,
    /// Those that scatter into a Dirac direction: light seen by way of glass, mirrors or water. What begins otherwise
    /// walks from the light find as well, so that heuristics leave most of its light to these.
    Dirac,
    /// The others: at diffuse and glossy surfaces.
    Other,
}

impl Beginning {
    #[inline]
    fn admits(self, specular: bool) -> bool {
        match self {
            Self::Any => true,
            Self::Dirac => specular,
            Self::Other => !specular,
        }
    }
}

/// How far a walk from the camera came on the way to an implicit specular path ([`Class::L0`](crate::Class::L0)).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sighting {
    /// It never scattered into a Dirac direction, or it turned round before.
    Plain,
    /// It did, and met no light after, or it turned round before.
    Specular,
    /// It did, and ran into light after.
    Light,
}

/// The camera walk of [`Bidirectional`](crate::Bidirectional) paths in their full form, without anything that
/// is joined to it, up to the first light that it meets after a specular scattering, or to its first surface
/// if it does not begin as it should. It reads the same coordinates and comes to the same places; so where
/// this does not see light, the value of the point has nothing in [`Class::L0`](crate::Class::L0) of such a
/// beginning. It takes a tenth of the time, and much less where few walks begin so.
pub fn sight(
    settings: &BuilderSettings,
    scene: &Scene,
    beginning: Beginning,
    u: &mut dyn Coordinates,
) -> Sighting {
    at_its_time(scene, u, |scene, u| sight_at(settings, scene, beginning, u))
}

/// In a scene that stands at the path's time.
fn sight_at(
    settings: &BuilderSettings,
    scene: &Scene,
    beginning: Beginning,
    u: &mut dyn Coordinates,
) -> Sighting {
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
        let first = walk.edges == 1;
        if walk.bounce(scene, &scatter, u).is_none()
            || first && !beginning.admits(walk.specular)
            || !walk.survives(u)
        {
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
    let counts = walk.specular && settings.makes(walk.edges, walk.pure);
    counts && !(scene.emitted(vertex, -walk.direction, walk.wavelengths)).is_zero()
}

/// The same of a walk that has left the scene.
#[inline]
pub(crate) fn sees_environment(settings: &BuilderSettings, scene: &Scene, walk: &Walk<'_>) -> bool {
    let counts = walk.specular && settings.makes(walk.edges, walk.pure);
    counts && !(scene.environment(walk.direction, walk.wavelengths)).is_zero()
}
