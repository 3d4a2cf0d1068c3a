//! The GGX microsurface: slopes, shadowing, and visible normals.
//!
//! Smith's shadowing with heights correlated, `G2 = 1 / (1 + L(wo) + L(wi))`, for reflection and
//! transmission alike: symmetric, so everything built on it is reciprocal. All formulas are
//! written with `reach(w) = sqrt(z^2 + ax^2 x^2 + ay^2 y^2)`, for which `1 + 2 L = reach / z`; no
//! quotient by a cosine is left that could blow up at grazing.

use crate::albedo::{ReflectorLoss, reflector_loss};
use crate::local::within;
use crate::warp;
use glam::DVec3;
use std::f64::consts::PI;

/// GGX facets about z, as rough along x as they are along y or not. Directions are meant on the upper side
/// unless said otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ggx {
    /// Roughness along x and y.
    alpha: [f64; 2],
    /// `[ay / ax, ax / ay]`: factors of 1 where both are equal, so that nothing changes there.
    ratio: [f64; 2],
}

/// What facets do to light from one direction, or on average, as shares of what comes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FacetLoss {
    /// Lost to a second facet by single scattering. Of brushed facets an estimate: the mean of what facets would
    /// lose that are as rough all around as these are along x, and along y.
    pub(crate) loss: f32,
    /// The part of what single scattering sends back that Schlick's formula gives to F90.
    pub(crate) edge: f32,
    /// What compensation gives back of the loss: all of it, or of brushed facets what can be given back from
    /// any azimuth without making light.
    pub(crate) given_back: f32,
}

impl FacetLoss {
    /// Of a surface without facets.
    pub(crate) const NONE: Self = Self {
        loss: 0.0,
        edge: 0.0,
        given_back: 0.0,
    };

    /// Cosine of incidence that stands for all the facets that are seen: where Schlick's weight is their mean.
    pub(crate) fn mean_cosine(self) -> f64 {
        let weight = f64::from(self.edge / (1.0 - self.loss).max(1e-6));
        1.0 - libm::pow(weight.clamp(0.0, 1.0), 0.2)
    }
}

impl Ggx {
    /// Roughness `alpha`, clamped to `[1e-4, 1]`.
    #[inline]
    pub(crate) fn new(alpha: f64) -> Self {
        let alpha = within(alpha, 1e-4, 1.0);
        Self {
            alpha: [alpha; 2],
            ratio: [1.0; 2],
        }
    }

    /// Roughness along x and along y, each clamped.
    pub(crate) fn brushed(alpha: [f64; 2]) -> Self {
        let [x, y] = alpha.map(|alpha| within(alpha, 1e-4, 1.0));
        Self {
            alpha: [x, y],
            ratio: [y / x, x / y],
        }
    }

    /// Roughness; of brushed facets the geometric mean.
    #[inline]
    pub(crate) fn alpha(self) -> f64 {
        if self.is_brushed() {
            self.product().sqrt()
        } else {
            self.alpha[0]
        }
    }

    #[inline]
    fn product(self) -> f64 {
        self.alpha[0] * self.alpha[1]
    }

    #[inline]
    pub(crate) fn is_brushed(self) -> bool {
        self.alpha[0].to_bits() != self.alpha[1].to_bits()
    }

    /// What becomes of light from `w`.
    #[inline]
    pub(crate) fn loss(self, w: DVec3) -> FacetLoss {
        self.loss_by(|alpha| reflector_loss(w.z, alpha))
    }

    /// The same from one azimuth, if `at` is the [loss](Self::loss) from there: of brushed facets what those would do that are as rough
    /// all around as these are in the plane of `w`. An estimate; what a white body under them makes of light by it is held to be nearly
    /// none by a test.
    #[inline]
    pub(crate) fn in_plane(self, w: DVec3, at: FacetLoss) -> FacetLoss {
        if !self.is_brushed() {
            return at;
        }
        let [x, y] = self.alpha;
        let across = w.x * w.x + w.y * w.y;
        let alpha = if across > 0.0 {
            let [a, b] = [w.x * w.x / across, w.y * w.y / across];
            // Of all facets (by their slopes in the plane), and of those that stand upright on it.
            let all = a * x * x + b * y * y;
            let upright = 1.0 / (a / (x * x) + b / (y * y));
            (all * upright).sqrt().sqrt()
        } else {
            x.min(y)
        };
        let seen = reflector_loss(w.z, alpha);
        FacetLoss {
            loss: seen.loss,
            edge: seen.edge,
            ..at
        }
    }

    /// Facets as rough all around as these are at most.
    #[inline]
    pub(crate) fn roughest(self) -> Self {
        Self::new(self.alpha[0].max(self.alpha[1]))
    }

    /// Its cosine-weighted mean over the hemisphere; of what is given back at least that.
    #[inline]
    pub(crate) fn mean_loss(self) -> FacetLoss {
        self.loss_by(ReflectorLoss::mean)
    }

    #[inline]
    fn loss_by(self, loss: impl Fn(f64) -> ReflectorLoss) -> FacetLoss {
        let [x, y] = self.alpha;
        let along = loss(x);
        if !self.is_brushed() {
            return FacetLoss {
                loss: along.loss,
                edge: along.edge,
                given_back: along.loss,
            };
        }
        let across = loss(y);
        let [a, b] = self.ratio;
        let share = (0.5 + 0.5 * a.min(b)) as f32;
        FacetLoss {
            loss: 0.5 * (along.loss + across.loss),
            edge: 0.5 * (along.edge + across.edge),
            given_back: share * along.loss.min(across.loss),
        }
    }

    /// Density of facet normals per area and solid angle; even in z.
    #[inline]
    pub(crate) fn density(self, h: DVec3) -> f64 {
        let a2 = self.product();
        let [x, y] = self.ratio;
        let spread = h.x * h.x * x + h.y * h.y * y + a2 * h.z * h.z;
        a2 / (PI * spread * spread)
    }

    /// `|z| (1 + 2 Lambda)`; even in z.
    #[inline]
    fn reach(self, w: DVec3) -> f64 {
        let [x, y] = self.ratio;
        (w.z * w.z + self.product() * (w.x * w.x * y + w.y * w.y * x)).sqrt()
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
        self.visible_among(wo, h, self.density(h))
    }

    /// The same where the [density](Self::density) of such normals is known.
    #[inline]
    pub(crate) fn visible_among(self, wo: DVec3, h: DVec3, density: f64) -> f64 {
        2.0 * density * wo.dot(h).max(0.0) / (self.reach(wo) + wo.z.abs())
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
        let [x, y] = self.alpha;
        DVec3::new(x * wo.x, y * wo.y, wo.z).normalize()
    }

    /// The normal that mirrors stretched `wo` into `away`, taken back to the facets.
    #[inline]
    pub(crate) fn unstretch(self, stretched: DVec3, away: DVec3) -> DVec3 {
        let h = stretched + away;
        let [x, y] = self.alpha;
        DVec3::new(x * h.x, y * h.y, h.z.max(0.0)).normalize()
    }
}
