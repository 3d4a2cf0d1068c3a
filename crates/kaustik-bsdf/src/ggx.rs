//! The GGX microsurface: slopes, shadowing, and visible normals.
//!
//! Smith's shadowing with heights correlated, `G2 = 1 / (1 + L(wo) + L(wi))`, for reflection and
//! transmission alike: symmetric, so everything built on it is reciprocal. All formulas are
//! written with `reach(w) = sqrt(z^2 + alpha^2 (x^2 + y^2))`, for which `1 + 2 L = reach / z`; no
//! quotient by a cosine is left that could blow up at grazing.

use crate::local::within;
use crate::warp;
use glam::DVec3;
use std::f64::consts::PI;

/// Isotropic GGX facets about z. Directions are meant on the upper side unless said otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ggx {
    alpha: f64,
}

impl Ggx {
    /// Roughness `alpha`, clamped to `[1e-4, 1]`.
    #[inline]
    pub(crate) fn new(alpha: f64) -> Self {
        Self {
            alpha: within(alpha, 1e-4, 1.0),
        }
    }

    /// Roughness.
    #[inline]
    pub(crate) fn alpha(self) -> f64 {
        self.alpha
    }

    /// Density of facet normals per area and solid angle; even in z.
    #[inline]
    pub(crate) fn density(self, h: DVec3) -> f64 {
        let a2 = self.alpha * self.alpha;
        let spread = h.x * h.x + h.y * h.y + a2 * h.z * h.z;
        a2 / (PI * spread * spread)
    }

    /// `|z| (1 + 2 Lambda)`; even in z.
    #[inline]
    fn reach(self, w: DVec3) -> f64 {
        (w.z * w.z + self.alpha * self.alpha * (w.x * w.x + w.y * w.y)).sqrt()
    }

    /// `G2 / (|cos wo| |cos wi|)`; even in both z.
    #[inline]
    pub(crate) fn shadowing(self, wo: DVec3, wi: DVec3) -> f64 {
        2.0 / (self.reach(wo) * wi.z.abs() + self.reach(wi) * wo.z.abs())
    }

    /// `G2 / G1(wo)`: of what meets a visible facet, how much gets away along `wi`.
    #[cfg(test)]
    pub(crate) fn escape(self, wo: DVec3, wi: DVec3) -> f64 {
        let (ro, zo, zi) = (self.reach(wo), wo.z.abs(), wi.z.abs());
        zi * (ro + zo) / (ro * zi + self.reach(wi) * zo)
    }

    /// Density per solid angle of the normals that [`visible`](Self::visible) draws.
    #[inline]
    pub(crate) fn visible_pdf(self, wo: DVec3, h: DVec3) -> f64 {
        2.0 * self.density(h) * wo.dot(h).max(0.0) / (self.reach(wo) + wo.z.abs())
    }

    /// Draws a facet normal as `wo` (z > 0) sees them.
    ///
    /// Stretched to a hemisphere, the mirror directions of visible normals fill a spherical cap
    /// evenly (Dupuy and Benyoub 2023); the disk's equal-area map keeps that continuous.
    #[inline]
    pub(crate) fn visible(self, wo: DVec3, u: [f64; 2]) -> DVec3 {
        let stretched = self.stretch(wo);
        self.unstretch(stretched, warp::cap(u, 1.0 + stretched.z))
    }

    /// `wo` where the facets are a hemisphere.
    #[inline]
    pub(crate) fn stretch(self, wo: DVec3) -> DVec3 {
        DVec3::new(self.alpha * wo.x, self.alpha * wo.y, wo.z).normalize()
    }

    /// The normal that mirrors stretched `wo` into `away`, taken back to the facets.
    #[inline]
    pub(crate) fn unstretch(self, stretched: DVec3, away: DVec3) -> DVec3 {
        let h = stretched + away;
        DVec3::new(self.alpha * h.x, self.alpha * h.y, h.z.max(0.0)).normalize()
    }
}
