use crate::ggx::Ggx;
use crate::rebound::Rebound;
use crate::{Reflectance, local};
use glam::DVec3;
use kaustik_spectrum::Spectrum;
use std::f64::consts::FRAC_1_PI;

/// Light that reflects off GGX facets: once by the facets' own lobe, more often by a diffuse
/// rebound. What rough metal and the glTF material have in common. Directions lie above.
///
/// The rebound is `rebound (1 - E(wo)) (1 - E(wi)) / (pi (1 - E_mean))`: reciprocal, and with a
/// rebound of 1 it returns exactly what single scattering loses (Kulla and Conty 2017).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Facets {
    ggx: Ggx,
    way: Rebound,
    reflectance: Reflectance,
    /// Rebound's colour over `pi (1 - E_mean)`; zero without compensation.
    rebound: Spectrum,
    /// Brightness of the rebound over the lobe's, per unit of light; for lobe choice.
    bounce: f64,
}

/// Colour of light that met two facets or more, in energy: with `F` the mean reflectance,
/// `F^2 E / (1 - F (1 - E))`.
#[inline]
pub(crate) fn rebound_colour(mean_reflectance: Spectrum, mean_loss: f32) -> Spectrum {
    mean_reflectance.map(|f| f * f * (1.0 - mean_loss) / (1.0 - f * mean_loss))
}

impl Facets {
    /// `rebound` is the colour of what scatters between facets, see [`rebound_colour`].
    #[inline]
    pub(crate) fn new(reflectance: Reflectance, ggx: Ggx, rebound: Spectrum) -> Self {
        let mean = f64::from(reflectance.mean().mean());
        let bounce = if mean > 0.0 {
            f64::from(rebound.mean()) / mean
        } else {
            0.0
        };
        let loss = ggx.mean_loss().given_back;
        let rebound = rebound * (FRAC_1_PI as f32 / loss.max(1e-9));
        Self {
            ggx,
            way: Rebound::new(ggx.alpha()),
            reflectance,
            rebound,
            bounce,
        }
    }

    /// GGX roughness.
    #[inline]
    pub(crate) fn alpha(&self) -> f64 {
        self.ggx.alpha()
    }

    /// With or without compensation by the reflectance's own mean.
    #[inline]
    pub(crate) fn compensated(reflectance: Reflectance, ggx: Ggx, compensation: bool) -> Self {
        let rebound = if compensation {
            rebound_colour(reflectance.mean(), ggx.mean_loss().loss)
        } else {
            Spectrum::ZERO
        };
        Self::new(reflectance, ggx, rebound)
    }

    #[inline]
    fn loss(&self, w: DVec3) -> f64 {
        f64::from(self.ggx.loss(w).given_back)
    }

    /// Does any light scatter between facets?
    #[inline]
    fn rebounds(&self) -> bool {
        self.bounce > 0.0
    }

    /// Probability of the rebound seen from `wo`.
    #[inline]
    fn rebound_probability(&self, wo: DVec3) -> f64 {
        if self.rebounds() {
            self.rebound_share(self.loss(wo))
        } else {
            0.0
        }
    }

    /// The same where the loss is known.
    #[inline]
    fn rebound_share(&self, loss: f64) -> f64 {
        loss * self.bounce / (1.0 - loss + loss * self.bounce)
    }

    /// The scattering function; both directions above.
    #[inline]
    pub(crate) fn eval(&self, wo: DVec3, wi: DVec3) -> Spectrum {
        self.both(wo, wi).0
    }

    /// Density of [`sample`](Self::sample); both directions above.
    #[inline]
    pub(crate) fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        let h = (wo + wi).normalize();
        self.mixed_pdf(wo, wi, h, if self.rebounds() { self.loss(wo) } else { 0.0 })
    }

    /// Value and density together, which share most of their work.
    #[inline]
    pub(crate) fn both(&self, wo: DVec3, wi: DVec3) -> (Spectrum, f64) {
        let h = (wo + wi).normalize();
        let lobe = 0.25 * self.ggx.density(h) * self.ggx.shadowing(wo, wi);
        let once = self.reflectance.at(wo.dot(h).abs().min(1.0)) * (lobe as f32);
        if !self.rebounds() {
            return (once, self.mixed_pdf(wo, wi, h, 0.0));
        }
        let loss = self.loss(wo);
        let again = self.rebound * ((loss * self.loss(wi)) as f32);
        (once + again, self.mixed_pdf(wo, wi, h, loss))
    }

    /// Density from the facet between and the loss at `wo`.
    #[inline]
    fn mixed_pdf(&self, wo: DVec3, wi: DVec3, h: DVec3, loss: f64) -> f64 {
        let lobe = 0.25 * self.ggx.visible_pdf(wo, h) / wo.dot(h);
        let p = self.rebound_share(loss);
        (1.0 - p) * lobe + p * self.way.pdf(wi.z)
    }

    /// Draws a direction; one below is lost.
    #[inline]
    pub(crate) fn sample(&self, wo: DVec3, uc: f64, u: [f64; 2]) -> DVec3 {
        if uc < self.rebound_probability(wo) {
            self.way.sample(u)
        } else {
            local::reflect(wo, self.ggx.visible(wo, u))
        }
    }

    /// Share that leaves again, to the accuracy of taking the facets' mean angle for the angle.
    #[inline]
    pub(crate) fn albedo(&self, w: DVec3) -> Spectrum {
        let at = self.ggx.loss(w);
        let mean = self.ggx.mean_loss().given_back;
        self.reflectance.once(at, w.z.min(1.0))
            + self.rebound * (std::f32::consts::PI * mean * at.given_back)
    }
}
