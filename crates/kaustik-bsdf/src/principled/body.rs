use super::PrincipledParameters;
use crate::albedo::{ReflectorLoss, reflector_loss};
use crate::facets::rebound_colour;
use crate::{Reflectance, fresnel};
use glam::DVec3;
use kaustik_spectrum::Spectrum;
use std::f64::consts::FRAC_1_PI;

/// Diffuse light under the glossy cover.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Body {
    f0: Spectrum,
    f90: Spectrum,
    /// Colour of light rebounding between the cover's facets.
    rebound: Spectrum,
    /// Roughness of the cover; 0 where it is smooth.
    alpha: f64,
    /// Base colour times its share of the material.
    colour: Spectrum,
    /// `1 - A_mean`, positive.
    passed: Spectrum,
}

impl Body {
    /// `share` is the part of the material that is opaque dielectric.
    pub(super) fn new(p: &PrincipledParameters, share: f32) -> Self {
        let (f0, f90) = p.dielectric_ends();
        let alpha = p.alpha();
        let mut mean = Reflectance::Schlick { f0, f90 }.mean();
        let mut rebound = Spectrum::ZERO;
        if alpha > 0.0 {
            let at = ReflectorLoss::mean(alpha);
            if p.compensation {
                rebound = rebound_colour(mean, at.loss);
            }
            mean = f0 * (1.0 - at.loss - at.edge) + f90 * at.edge + rebound * at.loss;
        }
        let passed = mean.map(|a| (1.0 - a).max(1e-6));
        Self {
            f0,
            f90,
            rebound,
            alpha,
            colour: p.base_color * share,
            passed,
        }
    }

    /// The same without diffuse light.
    pub(super) fn blackened(&self) -> Self {
        Self {
            colour: Spectrum::ZERO,
            ..*self
        }
    }

    /// Colour of light rebounding between the cover's facets.
    pub(super) fn rebound(&self) -> Spectrum {
        self.rebound
    }

    /// No diffuse light at all?
    #[inline]
    pub(super) fn is_black(&self) -> bool {
        self.colour.is_zero()
    }

    /// `1 - A`: what the cover lets in from `w`.
    #[inline]
    fn admitted(&self, w: DVec3) -> Spectrum {
        let mu = w.z.abs().min(1.0);
        let cover = if self.alpha > 0.0 {
            let at = reflector_loss(mu, self.alpha);
            self.f0 * (1.0 - at.loss - at.edge) + self.f90 * at.edge + self.rebound * at.loss
        } else {
            self.f0.lerp(self.f90, fresnel::schlick_weight(mu) as f32)
        };
        cover.map(|a| (1.0 - a).max(0.0))
    }

    /// The scattering function; both directions on one side.
    #[inline]
    pub(super) fn eval(&self, wo: DVec3, wi: DVec3) -> Spectrum {
        if self.is_black() {
            return Spectrum::ZERO;
        }
        let through = self.admitted(wo) * self.admitted(wi);
        self.colour * through / self.passed * (FRAC_1_PI as f32)
    }

    /// Directional albedo.
    #[inline]
    pub(super) fn albedo(&self, wo: DVec3) -> Spectrum {
        if self.is_black() {
            Spectrum::ZERO
        } else {
            self.colour * self.admitted(wo)
        }
    }
}
