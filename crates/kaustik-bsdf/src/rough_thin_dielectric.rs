use crate::albedo::{ReflectorLoss, reflector_loss};
use crate::ggx::Ggx;
use crate::rebound::Rebound;
use crate::reflectance::mean_of_lanes;
use crate::thin_dielectric::{pane, reflect_probability};
use crate::{Interface, Lobe, Mode, Sample, fresnel, local};
use glam::DVec3;
use kaustik_spectrum::Spectrum;
use std::f64::consts::FRAC_1_PI;

/// Frosted pane: light that passes is blurred by the same lobe as light that is thrown back,
/// mirrored to the other side. Nothing bends as a whole, so no wavelength parts from the others.
///
/// Symmetric, since the facet's angle is the same from `wo` and from `wi`, mirrored or not. The
/// compensation splits what scatters between facets by the pane's mean reflectance; a clear pane
/// loses nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughThinDielectric {
    interface: Interface,
    ggx: Ggx,
    way: Rebound,
    /// Colours reflected and transmitted after many facets, over `pi (1 - E_mean)`; or zero.
    again: [Spectrum; 2],
    /// Probability of reflecting once it scatters between facets.
    reflect: f64,
}

impl RoughThinDielectric {
    /// GGX roughness.
    #[inline]
    pub fn alpha(&self) -> f64 {
        self.ggx.alpha()
    }

    /// From the media and `alpha` in `[SMOOTH_ALPHA, 1]` (clamped).
    #[inline]
    pub fn new(interface: Interface, alpha: f64, compensation: bool) -> Self {
        let ggx = Ggx::new(alpha);
        let loss = ReflectorLoss::mean(ggx.alpha()).loss.max(1e-9);
        let scale = if compensation {
            FRAC_1_PI as f32 / loss
        } else {
            0.0
        };
        let mean = mean_pane(&interface);
        Self {
            interface,
            ggx,
            way: Rebound::new(ggx.alpha()),
            again: [
                interface.reflected() * mean * scale,
                interface.transmitted() * (1.0 - mean) * scale,
            ],
            reflect: f64::from(mean.mean()),
        }
    }

    #[inline]
    fn loss(&self, w: DVec3) -> f64 {
        f64::from(reflector_loss(w.z.abs(), self.ggx.alpha()).loss)
    }

    #[inline]
    fn rebound_probability(&self, wo: DVec3) -> f64 {
        let [r, t] = self.again;
        if r.is_zero() && t.is_zero() {
            0.0
        } else {
            self.loss(wo)
        }
    }

    /// Value and density; the pane has no modes.
    #[inline]
    fn both(&self, wo: DVec3, wi: DVec3) -> (Spectrum, f64) {
        let transmits = wo.z * wi.z < 0.0;
        let (wo, wi) = (local::lift(wo), local::lift(wi));
        let h = (wo + wi).normalize();
        let cosine = wo.dot(h).min(1.0);
        let (reflected, transmitted) = pane(&self.interface, cosine);
        let p = reflect_probability(reflected, transmitted);
        let (colour, p, again, side) = if transmits {
            (transmitted, 1.0 - p, self.again[1], 1.0 - self.reflect)
        } else {
            (reflected, p, self.again[0], self.reflect)
        };
        let lobe = 0.25 * self.ggx.density(h) * self.ggx.shadowing(wo, wi);
        let lost = self.rebound_probability(wo);
        let f = colour * (lobe as f32) + again * ((lost * self.loss(wi)) as f32);
        let visible = 0.25 * self.ggx.visible_pdf(wo, h) / cosine;
        (
            f,
            (1.0 - lost) * p * visible + lost * side * self.way.pdf(wi.z),
        )
    }
}

/// Cosine-weighted mean reflectance of a pane, with the hero's index in all lanes, by the rule that metals use too.
#[inline]
fn mean_pane(interface: &Interface) -> Spectrum {
    let eta = f64::from(interface.eta().hero());
    mean_of_lanes(|mu| {
        let one = Spectrum::splat(fresnel::dielectric(mu, eta).0 as f32);
        let one = interface.finished(one, mu);
        one.map(|r| 2.0 * r / (1.0 + r))
    })
}

impl Lobe for RoughThinDielectric {
    #[inline]
    fn eval(&self, wo: DVec3, wi: DVec3, _mode: Mode) -> Spectrum {
        if !local::usable(wo) || !local::usable(wi) {
            return Spectrum::ZERO;
        }
        self.both(wo, wi).0
    }

    #[inline]
    fn pdf(&self, wo: DVec3, wi: DVec3, _mode: Mode) -> f64 {
        if !local::usable(wo) || !local::usable(wi) {
            return 0.0;
        }
        self.both(wo, wi).1
    }

    #[inline]
    fn sample(&self, wo: DVec3, uc: f64, u: [f64; 2], _mode: Mode) -> Option<Sample> {
        if !local::usable(wo) {
            return None;
        }
        let up = local::lift(wo);
        let (again, uc) = local::choose(uc, self.rebound_probability(wo));
        let (wi, reflect) = if again {
            (self.way.sample(u), self.reflect)
        } else {
            let h = self.ggx.visible(up, u);
            let (reflected, transmitted) = pane(&self.interface, up.dot(h).clamp(0.0, 1.0));
            (
                local::reflect(up, h),
                reflect_probability(reflected, transmitted),
            )
        };
        let wi = local::to_side_of(wo, wi);
        if !local::same_side(wo, wi) {
            return None; // met a second facet, which single scattering leaves out
        }
        let wi = if uc < reflect { wi } else { local::flip(wi) };
        let (f, pdf) = self.both(wo, wi);
        Sample::continuous(wo, wi, f, pdf)
    }

    #[inline]
    fn albedo(&self, wo: DVec3) -> Spectrum {
        let (reflected, transmitted) = pane(&self.interface, wo.z.abs().min(1.0));
        reflected + transmitted
    }
}
