use crate::albedo::{sheen_albedo, sheen_peak};
use crate::{local, warp};
use glam::DVec3;
use kaustik_spectrum::Spectrum;
use std::f64::consts::FRAC_1_PI;

/// Fibres that stand on a surface and catch light at grazing angles: cloth, velvet (`KHR_materials_sheen`).
///
/// Charlie's distribution of fibre normals and the fit of its shadowing (Estevez and Kulla 2017, as the
/// extension has them). At perceptual roughness below 0.25 that would send back more light than comes in; it is
/// dimmed there to send back all at most. Sampled evenly over the hemisphere, which its light fills.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sheen {
    /// Dimmed where need be.
    colour: Spectrum,
    /// What is taken at least from what lies below, at every wavelength; dimmed alike.
    shade: f32,
    alpha: f64,
}

/// Roughness below which the distribution's exponents mean nothing.
pub(crate) const LEAST_ALPHA: f64 = 1e-2;

impl Sheen {
    /// `colour` with lanes in `[0, 1]`, and `shade` too; `roughness` perceptual in `[0, 1]`.
    pub(crate) fn new(colour: Spectrum, shade: f32, roughness: f64) -> Self {
        let alpha = local::within(roughness * roughness, LEAST_ALPHA, 1.0);
        let peak = sheen_peak(alpha).max(1.0);
        Self {
            colour: colour / peak,
            shade: shade / peak,
            alpha,
        }
    }

    /// Both directions above.
    pub(crate) fn eval(&self, wo: DVec3, wi: DVec3) -> Spectrum {
        self.colour * (white(wo, wi, self.alpha) as f32)
    }

    /// Of the density that [`sample`](Self::sample) draws with, above.
    pub(crate) const PDF: f64 = 0.5 * FRAC_1_PI;

    /// A direction above.
    pub(crate) fn sample(u: [f64; 2]) -> DVec3 {
        warp::cap(u, 1.0)
    }

    /// What the fibres send back of light from `w`.
    pub(crate) fn albedo(&self, w: DVec3) -> Spectrum {
        self.colour * sheen_albedo(w.z.abs().min(1.0), self.alpha)
    }

    /// What they leave of it for the surface below: as the extension has it, by the largest channel of the
    /// colour, so that no colour is made, and nowhere more than they do not send back. Of each lane by
    /// itself: a wavelength knows nothing of the others on its path.
    pub(crate) fn passed(&self, w: DVec3) -> Spectrum {
        let taken = self.colour.map(|lane| lane.max(self.shade));
        (1.0 - taken * sheen_albedo(w.z.abs().min(1.0), self.alpha)).map(|lane| lane.max(0.0))
    }
}

/// Sheen of colour 1; both directions above, `alpha` in `[LEAST_ALPHA, 1]`.
pub(crate) fn white(wo: DVec3, wi: DVec3, alpha: f64) -> f64 {
    let Some(h) = (wo + wi).try_normalize() else {
        return 0.0;
    };
    let sine2 = (h.x * h.x + h.y * h.y).min(1.0);
    let inverse = 1.0 / alpha;
    let density = (2.0 + inverse) * libm::pow(sine2, 0.5 * inverse) * (0.5 * FRAC_1_PI);
    let (mo, mi) = (wo.z.min(1.0), wi.z.min(1.0));
    let value = density / ((1.0 + shadow(mo, alpha) + shadow(mi, alpha)) * 4.0 * mo * mi);
    if value.is_finite() { value } else { 0.0 }
}

/// Smith's Lambda, fitted: exponentials of a rational curve, mirrored about the cosine 1/2.
fn shadow(mu: f64, alpha: f64) -> f64 {
    let curve = |x: f64| {
        let t = (1.0 - alpha) * (1.0 - alpha);
        let mix = |rough: f64, smooth: f64| rough + t * (smooth - rough);
        let a = mix(21.5473, 25.3245);
        let b = mix(3.82987, 3.32435);
        let c = mix(0.19823, 0.16801);
        let d = mix(-1.97760, -1.27393);
        let e = mix(-4.32054, -4.85967);
        a / (1.0 + b * libm::pow(x, c)) + d * x + e
    };
    if mu < 0.5 {
        libm::exp(curve(mu))
    } else {
        libm::exp(2.0 * curve(0.5) - curve(1.0 - mu))
    }
}
