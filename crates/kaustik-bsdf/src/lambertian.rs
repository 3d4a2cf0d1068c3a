use crate::{Lobe, Mode, Sample, local, warp};
use glam::DVec3;
use kaustik_spectrum::Spectrum;
use std::f64::consts::FRAC_1_PI;

/// Ideal diffuse reflection on the side of `wo`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lambertian {
    /// Share reflected, each lane in `[0, 1]`.
    pub reflectance: Spectrum,
}

impl Lobe for Lambertian {
    #[inline]
    fn eval(&self, wo: DVec3, wi: DVec3, _mode: Mode) -> Spectrum {
        if local::same_side(wo, wi) {
            self.reflectance * (FRAC_1_PI as f32)
        } else {
            Spectrum::ZERO
        }
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
    fn sample(&self, wo: DVec3, _uc: f64, u: [f64; 2], _mode: Mode) -> Option<Sample> {
        if !local::usable(wo) {
            return None;
        }
        let wi = local::to_side_of(wo, warp::cosine_hemisphere(u));
        let pdf = wi.z.abs() * FRAC_1_PI;
        (pdf > 0.0).then_some(Sample {
            wi,
            weight: self.reflectance,
            pdf,
            delta: false,
            dispersive: false,
            transmitted: false,
        })
    }

    #[inline]
    fn albedo(&self, _wo: DVec3) -> Spectrum {
        self.reflectance
    }

    #[inline]
    fn transmits(&self) -> bool {
        false
    }
}
