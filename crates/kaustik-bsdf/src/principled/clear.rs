use super::{PrincipledParameters, Wall};
use crate::{
    Bsdf, Delta, Dielectric, Interface, Lobe, Mode, RoughDielectric, RoughThinDielectric, Sample,
    ThinDielectric,
};
use glam::DVec3;
use kaustik_spectrum::Spectrum;

/// The clear share of a glTF material; its weight stands in the interface's tints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Clear {
    Pane(ThinDielectric),
    FrostedPane(RoughThinDielectric),
    Solid(Dielectric),
    RoughSolid(RoughDielectric),
}

impl Clear {
    pub(super) fn new(p: &PrincipledParameters, share: f32) -> Self {
        let mut interface = Interface::new(p.ior, Spectrum::splat(share), p.base_color * share);
        let plain = p.specular >= 1.0 && p.specular_color == Spectrum::ONE && p.film.is_none();
        if !plain {
            let (f0, f90) = p.dielectric_ends();
            interface = interface.with_finish(p.reflectance(f0, f90));
        }
        let rough = p.alpha() > 0.0 && interface.bends();
        let (alpha, compensation) = (p.alpha(), p.compensation);
        match (p.wall, rough) {
            (Wall::Thin, false) => Self::Pane(ThinDielectric { interface }),
            (Wall::Thin, true) => {
                Self::FrostedPane(RoughThinDielectric::new(interface, alpha, compensation))
            }
            (Wall::Solid, false) => Self::Solid(Dielectric { interface }),
            (Wall::Solid, true) => {
                Self::RoughSolid(RoughDielectric::new(interface, alpha, compensation))
            }
        }
    }

    /// By itself.
    pub(super) fn bsdf(self) -> Bsdf {
        match self {
            Self::Pane(lobe) => Bsdf::ThinDielectric(lobe),
            Self::FrostedPane(lobe) => Bsdf::RoughThinDielectric(lobe),
            Self::Solid(lobe) => Bsdf::Dielectric(lobe),
            Self::RoughSolid(lobe) => Bsdf::RoughDielectric(lobe),
        }
    }
}

/// The same expression for whatever it is.
macro_rules! each {
    ($clear:expr, $lobe:ident => $body:expr) => {
        match $clear {
            Clear::Pane($lobe) => $body,
            Clear::FrostedPane($lobe) => $body,
            Clear::Solid($lobe) => $body,
            Clear::RoughSolid($lobe) => $body,
        }
    };
}

impl Lobe for Clear {
    #[inline]
    fn eval(&self, wo: DVec3, wi: DVec3, mode: Mode) -> Spectrum {
        each!(self, lobe => lobe.eval(wo, wi, mode))
    }

    #[inline]
    fn pdf(&self, wo: DVec3, wi: DVec3, mode: Mode) -> f64 {
        each!(self, lobe => lobe.pdf(wo, wi, mode))
    }

    #[inline]
    fn sample(&self, wo: DVec3, uc: f64, u: [f64; 2], mode: Mode) -> Option<Sample> {
        each!(self, lobe => lobe.sample(wo, uc, u, mode))
    }

    #[inline]
    fn delta(&self, wo: DVec3, transmitted: bool, mode: Mode) -> Option<Delta> {
        each!(self, lobe => lobe.delta(wo, transmitted, mode))
    }

    #[inline]
    fn albedo(&self, wo: DVec3) -> Spectrum {
        each!(self, lobe => lobe.albedo(wo))
    }

    #[inline]
    fn is_delta(&self) -> bool {
        each!(self, lobe => lobe.is_delta())
    }

    #[inline]
    fn dispersive_between(&self, wo: DVec3, wi: DVec3) -> bool {
        each!(self, lobe => lobe.dispersive_between(wo, wi))
    }
}
