use glam::DVec2;
use kaustik_pss::Coordinates;
use kaustik_scene::Scene;
use kaustik_spectrum::WavelengthSampling;

use crate::{Contributions, PureSpecular};

/// Makes paths from a point of the primary sample space: `S(u)` and `F*(u)` of Kelemen sec. 2.
///
/// A builder owns no random generator: every choice is a coordinate, so that the same point gives the
/// same paths. Which coordinate means what is fixed by the builder ([`layout`](crate::layout)).
pub trait PathBuilder: Send + Sync {
    /// Evaluates `u` into `out`, which is cleared first.
    fn build(&self, scene: &Scene, u: &mut dyn Coordinates, out: &mut Contributions);
}

/// What all builders are told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuilderSettings {
    /// Shortest path that is kept, in edges (at least 1). Shorter ones contribute nothing, and longer ones do not depend on it.
    pub min_edges: u32,
    /// Longest path in edges, at least 1 (1: emitters seen directly).
    pub max_edges: u32,
    /// What becomes of purely specular paths. [`Alone`](PureSpecular::Alone) is for
    /// [`Unidirectional`](crate::Unidirectional) without next event: others do not keep to them.
    pub pure_specular: PureSpecular,
    /// Whether directly visible emitting surfaces contribute. `false` is supported only by
    /// [`Unidirectional`](crate::Unidirectional), for use beside separate samples of these emitters; other
    /// builders ignore it.
    pub emitters_seen: bool,
    /// Keep the largest single `C_{s,t}` ([`Contributions::largest`]), for Kelemen's maximum: it costs
    /// a colour for each.
    pub track_largest: bool,
    /// Law of the wavelengths.
    pub wavelengths: WavelengthSampling,
    /// Lower corner of the part of the raster that is drawn from.
    pub window_min: DVec2,
    /// Upper corner; a filter that reaches over the image's edge wants a window larger than
    /// the unit square.
    pub window_max: DVec2,
}

impl Default for BuilderSettings {
    fn default() -> Self {
        Self {
            min_edges: 1,
            max_edges: 64,
            pure_specular: PureSpecular::Kept,
            emitters_seen: true,
            track_largest: false,
            wavelengths: WavelengthSampling::Hero,
            window_min: DVec2::ZERO,
            window_max: DVec2::ONE,
        }
    }
}

impl BuilderSettings {
    /// Is a path made of so many edges that ends in an emitter which it has run into, `pure` if it scattered into
    /// Dirac directions alone?
    #[inline]
    pub(crate) fn makes(&self, edges: u32, pure: bool) -> bool {
        edges >= self.min_edges && self.pure_specular.admits(pure)
    }

    /// The raster point of two coordinates in [0, 1): uniform over the window.
    #[inline]
    pub fn raster(&self, u: DVec2) -> DVec2 {
        self.window_min + u * (self.window_max - self.window_min)
    }

    /// Where in the window a raster point lies, the unit square over all of it: inverse of [`raster`](Self::raster).
    #[inline]
    pub fn window(&self, raster: DVec2) -> DVec2 {
        (raster - self.window_min) / (self.window_max - self.window_min)
    }

    /// Does the window hold this raster point?
    #[inline]
    pub fn serves(&self, raster: DVec2) -> bool {
        raster.cmpge(self.window_min).all() && raster.cmplt(self.window_max).all()
    }

    /// Density of a raster point that is uniform over the window.
    #[inline]
    pub fn raster_pdf(&self) -> f64 {
        1.0 / self.window_area()
    }

    /// Area of the window; the whole image has 1.
    pub fn window_area(&self) -> f64 {
        (self.window_max - self.window_min).element_product()
    }
}
