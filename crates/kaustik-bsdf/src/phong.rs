use crate::{Lobe, Mode, Sample, local, warp};
use glam::DVec3;
use kaustik_spectrum::Spectrum;
use std::f64::consts::{FRAC_1_PI, TAU};

/// Diffuse plus a normalised Phong lobe about the mirror direction:
/// `k_d / pi + k_s (n + 2) / (2 pi) cos^n a`, with `a` the angle of `wi` to the mirrored `wo`.
///
/// Symmetric in `wo` and `wi`, hence reciprocal. The lobe's albedo is `k_s` at normal incidence
/// and falls towards grazing about like the cosine of `wo`: the lobe is not divided by a cosine,
/// and what points below the horizon is lost. That loss belongs to the model and is not given
/// back. Both sides alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phong {
    diffuse: Spectrum,
    specular: Spectrum,
    exponent: f64,
}

impl Phong {
    /// From `k_d`, `k_s` (lanes in `[0, 1]`) and the exponent, clamped to `[0, 1e6]`. A lane
    /// where `k_d + k_s` exceeds 1 is scaled to 1.
    #[inline]
    pub fn new(diffuse: Spectrum, specular: Spectrum, exponent: f64) -> Self {
        let scale = (diffuse + specular).map(|sum| 1.0 / sum.max(1.0));
        Self {
            diffuse: diffuse * scale,
            specular: specular * scale,
            exponent: local::within(exponent, 0.0, 1e6),
        }
    }

    /// The GGX roughness of a lobe as wide as this one.
    #[inline]
    pub fn alpha(&self) -> f64 {
        (2.0 / (self.exponent + 2.0)).sqrt()
    }

    /// `k_d` and `k_s` as they are used.
    pub(crate) fn colours(&self) -> (Spectrum, Spectrum) {
        (self.diffuse, self.specular)
    }

    /// The same lobe with other colours, which sum to at most 1.
    pub(crate) fn with_colours(self, diffuse: Spectrum, specular: Spectrum) -> Self {
        Self {
            diffuse,
            specular,
            ..self
        }
    }

    /// Albedo of the lobe for `k_s` of 1: the mean of `(n + 2) / (n + 1) cos wi` over the lobe,
    /// whose cosines spread by `sin wo / sqrt(n + 3)`, within a few per cent.
    #[inline]
    fn level(&self, wo: DVec3) -> f64 {
        let n = self.exponent;
        let sine2 = wo.x * wo.x + wo.y * wo.y;
        // half of a normal distribution has the mean 0.4 sigma
        let tail = 0.4 * (n + 2.0) / (n + 1.0);
        (wo.z * wo.z + sine2 * tail * tail / (n + 3.0)).sqrt()
    }

    /// Probability of the specular lobe.
    #[inline]
    fn specular_probability(&self, wo: DVec3) -> f64 {
        let d = f64::from(self.diffuse.mean());
        let s = f64::from(self.specular.mean()) * self.level(wo);
        if d + s > 0.0 { s / (d + s) } else { 0.0 }
    }

    /// `cos^n a` to the mirror direction, 0 behind it.
    #[inline]
    fn lobe(&self, wo: DVec3, wi: DVec3) -> f64 {
        let cosine = local::mirror(wo).dot(wi).min(1.0);
        if cosine > 0.0 {
            libm::pow(cosine, self.exponent)
        } else {
            0.0
        }
    }
}

impl Lobe for Phong {
    #[inline]
    fn eval(&self, wo: DVec3, wi: DVec3, _mode: Mode) -> Spectrum {
        if !local::same_side(wo, wi) {
            return Spectrum::ZERO;
        }
        let lobe = (self.exponent + 2.0) / TAU * self.lobe(wo, wi);
        self.diffuse * (FRAC_1_PI as f32) + self.specular * (lobe as f32)
    }

    #[inline]
    fn pdf(&self, wo: DVec3, wi: DVec3, _mode: Mode) -> f64 {
        if !local::same_side(wo, wi) {
            return 0.0;
        }
        let p = self.specular_probability(wo);
        let lobe = (self.exponent + 1.0) / TAU * self.lobe(wo, wi);
        p * lobe + (1.0 - p) * wi.z.abs() * FRAC_1_PI
    }

    #[inline]
    fn sample(&self, wo: DVec3, uc: f64, u: [f64; 2], mode: Mode) -> Option<Sample> {
        if !local::usable(wo) {
            return None;
        }
        let wi = if uc < self.specular_probability(wo) {
            about_mirror(wo, self.exponent, u)
        } else {
            local::to_side_of(wo, warp::cosine_hemisphere(u))
        };
        if !local::same_side(wo, wi) {
            return None; // below the horizon
        }
        Sample::continuous(wo, wi, self.eval(wo, wi, mode), self.pdf(wo, wi, mode))
    }

    #[inline]
    fn albedo(&self, wo: DVec3) -> Spectrum {
        self.diffuse + self.specular * (self.level(wo).min(1.0) as f32)
    }

    #[inline]
    fn transmits(&self) -> bool {
        false
    }
}

/// A direction with density `(n + 1) / (2 pi) cos^n` about the mirror direction of `wo`.
#[inline]
fn about_mirror(wo: DVec3, exponent: f64, u: [f64; 2]) -> DVec3 {
    let axis = crate::Frame::from_z(local::mirror(wo));
    let [x, y] = warp::concentric_disk(u);
    // the disk's squared radius is the uniform number: 1 - r^2 = cos^(n+1)
    let squared = x * x + y * y;
    let cosine = libm::pow((1.0 - squared).max(0.0), 1.0 / (exponent + 1.0));
    let scale = ((1.0 - cosine * cosine).max(0.0) / squared.max(f64::MIN_POSITIVE)).sqrt();
    axis.to_world(DVec3::new(x * scale, y * scale, cosine))
}
