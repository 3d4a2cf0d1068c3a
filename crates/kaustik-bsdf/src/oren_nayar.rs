use crate::{Lobe, Mode, Sample, local, warp};
use glam::DVec3;
use kaustik_spectrum::Spectrum;
use std::f64::consts::{FRAC_1_PI, PI};

/// Rough diffuse reflection that loses no energy: Fujii's form of Oren and Nayar's model, with what it loses by
/// light that meets the surface's facets more than once given back (Portsmouth, Kutz and Hill 2024).
///
/// Clay, plaster, sand, the full moon: flatter than [`Lambertian`](crate::Lambertian), which roughness 0 is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrenNayar {
    reflectance: Spectrum,
    roughness: f64,
    /// Fujii's A: `1 / (1 + (1/2 - 2/(3 pi)) roughness)`.
    level: f64,
    /// Colour of light that was scattered more than once, over `pi (1 - mean)`.
    again: Spectrum,
}

/// `1/2 - 2/(3 pi)`.
const FIRST: f64 = 0.5 - 2.0 / (3.0 * PI);
/// `2/3 - 28/(15 pi)`.
const SECOND: f64 = 2.0 / 3.0 - 28.0 / (15.0 * PI);

impl OrenNayar {
    /// `reflectance`: of a surface that scatters once, each lane in `[0, 1]`; `roughness` in `[0, 1]` (clamped).
    pub fn new(reflectance: Spectrum, roughness: f64) -> Self {
        let roughness = local::within(roughness, 0.0, 1.0);
        let reflectance = reflectance.map(|rho| local::within(f64::from(rho), 0.0, 1.0) as f32);
        let level = 1.0 / (1.0 + FIRST * roughness);
        let mean = level * (1.0 + SECOND * roughness);
        let lost = 1.0 - mean;
        let again = reflectance.map(|rho| {
            let rho = f64::from(rho);
            let colour = rho * rho * mean / (1.0 - rho * lost);
            if lost > 1e-12 {
                (colour * FRAC_1_PI / lost) as f32
            } else {
                0.0
            }
        });
        Self {
            reflectance,
            roughness,
            level,
            again,
        }
    }

    /// Share that leaves after one scattering, of a white surface seen at the cosine `mu`.
    #[inline]
    fn once(&self, mu: f64) -> f64 {
        let mu = mu.clamp(1e-6, 1.0);
        let sine = (1.0 - mu * mu).max(0.0).sqrt();
        let turn = sine * (libm::acos(mu) - sine * mu)
            + (2.0 / 3.0) * (sine / mu * (1.0 - sine * sine * sine) - sine);
        self.level * (1.0 + self.roughness * FRAC_1_PI * turn)
    }

    #[inline]
    fn lost(&self, mu: f64) -> f64 {
        (1.0 - self.once(mu)).max(0.0)
    }
}

impl Lobe for OrenNayar {
    #[inline]
    fn eval(&self, wo: DVec3, wi: DVec3, _mode: Mode) -> Spectrum {
        if !local::same_side(wo, wi) {
            return Spectrum::ZERO;
        }
        let (mo, mi) = (wo.z.abs(), wi.z.abs());
        let s = wo.dot(wi) - mo * mi;
        let bend = if s > 0.0 { s / mo.max(mi) } else { s };
        let single = self.level * (1.0 + self.roughness * bend) * FRAC_1_PI;
        self.reflectance * (single.max(0.0) as f32)
            + self.again * ((self.lost(mo) * self.lost(mi)) as f32)
    }

    #[inline]
    fn pdf(&self, wo: DVec3, wi: DVec3, _mode: Mode) -> f64 {
        if local::same_side(wo, wi) {
            wi.z.abs() * FRAC_1_PI
        } else {
            0.0
        }
    }

    #[inline]
    fn sample(&self, wo: DVec3, _uc: f64, u: [f64; 2], mode: Mode) -> Option<Sample> {
        if !local::usable(wo) {
            return None;
        }
        let wi = local::to_side_of(wo, warp::cosine_hemisphere(u));
        Sample::continuous(wo, wi, self.eval(wo, wi, mode), self.pdf(wo, wi, mode))
    }

    #[inline]
    fn albedo(&self, wo: DVec3) -> Spectrum {
        let mu = wo.z.abs().min(1.0);
        let mean = (self.level * (1.0 + SECOND * self.roughness)) as f32;
        self.reflectance * (self.once(mu) as f32)
            + self.again * ((PI * self.lost(mu)) as f32 * (1.0 - mean))
    }

    #[inline]
    fn transmits(&self) -> bool {
        false
    }
}
