use crate::{Dielectric, Lobe, Mode, Sample, Interface};
use glam::DVec3;
use kaustik_spectrum::Spectrum;

/// GGX-rough boundary of a transparent solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughDielectric {
    smooth: Dielectric,
}

impl RoughDielectric {
    /// See [`Bsdf`](crate::Bsdf)'s constructor.
    #[inline]
    pub fn new(interface: Interface, _alpha: f64, _compensation: bool) -> Self {
        Self { smooth: Dielectric { interface } }
    }
}

impl Lobe for RoughDielectric {
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
