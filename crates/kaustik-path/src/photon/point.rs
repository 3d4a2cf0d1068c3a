//! Where photons are counted.

use std::f64::consts::PI;

use glam::{DVec2, Vec3};
use kaustik_spectrum::Spectrum;

use super::manner::Manner;
use super::{Photon, Sheet};

/// Normals that differ by more (about 84 degrees) belong to different surfaces.
const LEAST_AGREEMENT: f32 = 0.1;

/// Do two geometric normals belong to one surface?
#[inline]
pub(super) fn agree(a: Vec3, b: Vec3) -> bool {
    a.dot(b) >= LEAST_AGREEMENT
}

/// Where photons count: around a point that the camera sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// World position of the point.
    pub center: Vec3,
    /// In scene units, > 0.
    pub radius: f32,
}

/// A point seen by the camera, without its [`Disc`].
///
/// There is about one per pixel, so it is kept to 64 bytes: one cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct MeasurementPoint {
    /// Point of the image: the unit square over the whole image.
    pub raster: DVec2,
    /// What the camera walk carries; times the scattering function where that is constant.
    pub(super) throughput: Spectrum,
    /// Unit geometric normal of the surface's front.
    pub normal: Vec3,
    /// The shading normal.
    pub(super) shading: Vec3,
    /// Edges of the walk from the camera.
    pub edges: u16,
    /// Where it lies.
    pub(super) sheet: Sheet,
    pub(super) manner: Manner,
}

impl Disc {
    /// Area of the full disc in square scene units, ignoring outlines. Photons are counted on
    /// [`MeasurementPoints::area`](super::MeasurementPoints::area).
    #[inline]
    pub fn whole_area(&self) -> f64 {
        PI * f64::from(self.radius) * f64::from(self.radius)
    }
}

impl MeasurementPoint {
    /// By all but the place.
    #[inline]
    pub(super) fn accepts(&self, photon: &Photon, max_edges: u32) -> bool {
        let opaque = self.manner.is(Manner::OPAQUE);
        self.sheet.is_shared_with(photon.sheet)
            && u32::from(self.edges) + photon.edges <= max_edges
            && if opaque {
                self.lands_on_seen_side(photon) && agree(self.seen_normal(), photon.met_normal())
            } else {
                agree(self.normal, photon.normal)
            }
    }

    /// The geometric normal on the side that the camera sees.
    #[inline]
    fn seen_normal(&self) -> Vec3 {
        match self.manner.is(Manner::FRONT) {
            true => self.normal,
            false => -self.normal,
        }
    }

    /// By both normals.
    #[inline]
    fn lands_on_seen_side(&self, photon: &Photon) -> bool {
        let front = self.manner.is(Manner::FRONT);
        [self.shading, self.normal].iter().all(|normal| {
            let cosine = normal.as_dvec3().dot(photon.wi);
            if front { cosine > 0.0 } else { cosine < 0.0 }
        })
    }

    /// The value but for the colour: 0 for light that lands on the other side.
    #[inline]
    pub(super) fn diffuse(&self, photon: &Photon) -> Spectrum {
        if !self.lands_on_seen_side(photon) {
            return Spectrum::ZERO;
        }
        let shading = self.shading.as_dvec3().dot(photon.wi);
        Spectrum::splat(photon.per_cosine(shading))
    }
}
