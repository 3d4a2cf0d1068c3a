use crate::{Conductor, Lobe, Mode, Sample, Reflectance};
use glam::DVec3;
use kaustik_spectrum::Spectrum;

/// GGX-rough metal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughConductor {
    smooth: Conductor,
}

impl RoughConductor {
    /// See [`Bsdf`](crate::Bsdf)'s constructor.
    #[inline]
    pub fn new(reflectance: Reflectance, _alpha: f64, _compensation: bool) -> Self {
        Self { smooth: Conductor { reflectance } }
    }
}

impl Lobe for RoughConductor {
    fn eval(&self, wo: DVec3, wi: DVec3, mode: Mode) -> Spectrum {
        self.smooth.eval(wo, wi, mode)
    }

    fn pdf(&self, wo: DVec3, wi: DVec3, mode: Mode) -> f64 {
        self.smooth.pdf(wo, wi, mode)
    }

    fn sample(&self, wo: DVec3, uc: f64, u: [f64; 2], mode: Mode) -> Option<Sample> {
        self.smooth.sample(wo, uc, u, mode)
    }

    fn albedo(&self, wo: DVec3) -> Spectrum {
        self.smooth.albedo(wo)
    }
}
