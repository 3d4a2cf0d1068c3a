use super::{PrincipledParameters, Wall};
use crate::lobe::lobe_of_variants;
use crate::{
    Bsdf, Delta, Dielectric, Interface, Lobe, Mode, Passing, RoughDielectric, RoughThinDielectric,
    Sample, ThinDielectric,
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
            (Wall::Thin, false) => Self::Pane(ThinDielectric {
                interface,
                passable: false,
            }),
            (Wall::Thin, true) => {
                Self::FrostedPane(RoughThinDielectric::new(interface, alpha, compensation))
            }
            (Wall::Solid, false) => Self::Solid(Dielectric { interface }),
            (Wall::Solid, true) => {
                Self::RoughSolid(RoughDielectric::new(interface, alpha, compensation))
            }
        }
    }

    /// The same, [passable](ThinDielectric::passable) if it is a smooth pane.
    pub(super) fn passable(self) -> Self {
        match self {
            Self::Pane(pane) => Self::Pane(ThinDielectric {
                passable: true,
                ..pane
            }),
            other => other,
        }
    }

    /// What [passes](ThinDielectric::passing).
    #[inline]
    pub(super) fn passing(&self, wo: DVec3) -> Passing {
        match self {
            Self::Pane(pane) => pane.passing(wo),
            _ => Passing::NOTHING,
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

lobe_of_variants!(Clear: Pane, FrostedPane, Solid, RoughSolid);
