use crate::finish::Grain;
use crate::ggx::{FacetLoss, Ggx};
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
    /// `1 - E_mean`.
    mean_loss: f32,
    /// Brightness of the rebound over the lobe's, per unit of light; for lobe choice.
    bounce: f64,
}

/// A direction above, with what facets do to light from there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Facing {
    pub(crate) w: DVec3,
    pub(crate) at: FacetLoss,
}

/// Colour of light that met two facets or more, in energy: with `F` the mean reflectance,
/// `F^2 E / (1 - F (1 - E))`.
#[inline]
pub(crate) fn rebound_colour(mean_reflectance: Spectrum, mean_loss: f32) -> Spectrum {
    mean_reflectance.map(|f| f * f * (1.0 - mean_loss) / (1.0 - f * mean_loss))
}

impl Facets {
    /// `rebound` is the colour of what scatters between them, see [`rebound_colour`].
    #[inline]
    pub(crate) fn new(reflectance: Reflectance, grain: &Grain, rebound: Spectrum) -> Self {
        let mean = f64::from(reflectance.mean().mean());
        let bounce = if mean > 0.0 {
            f64::from(rebound.mean()) / mean
        } else {
            0.0
        };
        let loss = grain.mean_loss.given_back;
        let rebound = rebound * (FRAC_1_PI as f32 / loss.max(1e-9));
        Self {
            ggx: grain.ggx,
            way: grain.way,
            reflectance,
            rebound,
            mean_loss: loss,
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
        let grain = Grain::new(ggx);
        let rebound = if compensation {
            rebound_colour(reflectance.mean(), grain.mean_loss.loss)
        } else {
            Spectrum::ZERO
        };
        Self::new(reflectance, &grain, rebound)
    }

    /// A direction as value, density and sampling ask for it; what they do not need is not looked up.
    #[inline]
    pub(crate) fn facing(&self, w: DVec3) -> Facing {
        let at = match self.rebounds() {
            true => self.ggx.loss(w),
            false => FacetLoss::NONE,
        };
        Facing { w, at }
    }

    /// Does any light scatter between facets?
    #[inline]
    fn rebounds(&self) -> bool {
        self.bounce > 0.0
    }

    /// Probability of the rebound where that loss is given back.
    #[inline]
    fn rebound_share(&self, loss: f64) -> f64 {
        loss * self.bounce / (1.0 - loss + loss * self.bounce)
    }

    /// The scattering function.
    #[inline]
    pub(crate) fn eval(&self, o: &Facing, i: &Facing) -> Spectrum {
        self.both(o, i).0
    }

    /// Density of [`sample`](Self::sample).
    #[inline]
    pub(crate) fn pdf(&self, o: &Facing, wi: DVec3) -> f64 {
        let h = (o.w + wi).normalize();
        self.mixed_pdf(o, wi, h, self.ggx.density(h))
    }

    /// Value and density together, which share most of their work.
    #[inline]
    pub(crate) fn both(&self, o: &Facing, i: &Facing) -> (Spectrum, f64) {
        let (f, h, facets) = self.value(o, i);
        (f, self.mixed_pdf(o, i.w, h, facets))
    }

    /// The same with the density of the way back.
    #[inline]
    pub(crate) fn both_ways(&self, o: &Facing, i: &Facing) -> (Spectrum, [f64; 2]) {
        let (f, h, facets) = self.value(o, i);
        let pdf = |o: &Facing, i: &Facing| self.mixed_pdf(o, i.w, h, facets);
        (f, [pdf(o, i), pdf(i, o)])
    }

    /// The scattering function, the facet between the directions, and the density of such facets.
    #[inline]
    fn value(&self, o: &Facing, i: &Facing) -> (Spectrum, DVec3, f64) {
        let h = (o.w + i.w).normalize();
        let facets = self.ggx.density(h);
        let lobe = 0.25 * facets * self.ggx.shadowing(o.w, i.w);
        let mut f = self.reflectance.at(o.w.dot(h).abs().min(1.0)) * (lobe as f32);
        if self.rebounds() {
            let [o, i] = [o, i].map(|facing| f64::from(facing.at.given_back));
            f += self.rebound * ((o * i) as f32);
        }
        (f, h, facets)
    }

    /// Density from the facet between, of which there are so many.
    #[inline]
    fn mixed_pdf(&self, o: &Facing, wi: DVec3, h: DVec3, facets: f64) -> f64 {
        let lobe = 0.25 * self.ggx.visible_among(o.w, h, facets) / o.w.dot(h);
        let p = self.rebound_share(f64::from(o.at.given_back));
        (1.0 - p) * lobe + p * self.way.pdf(wi.z)
    }

    /// Draws a direction; one below is lost.
    #[inline]
    pub(crate) fn sample(&self, o: &Facing, uc: f64, u: [f64; 2]) -> DVec3 {
        if self.rebounds() && uc < self.rebound_share(f64::from(o.at.given_back)) {
            self.way.sample(u)
        } else {
            local::reflect(o.w, self.ggx.visible(o.w, u))
        }
    }

    /// Share that leaves again, to the accuracy of taking the facets' mean angle for the angle.
    #[inline]
    pub(crate) fn albedo(&self, w: DVec3) -> Spectrum {
        self.albedo_facing(&Facing {
            w,
            at: self.ggx.loss(w),
        })
    }

    /// The same where the [loss](Ggx::loss) is known.
    #[inline]
    pub(crate) fn albedo_facing(&self, o: &Facing) -> Spectrum {
        self.reflectance.once(o.at, o.w.z.min(1.0))
            + self.rebound * (std::f32::consts::PI * self.mean_loss * o.at.given_back)
    }
}
