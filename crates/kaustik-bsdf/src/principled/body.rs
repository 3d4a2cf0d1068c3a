use super::PrincipledParameters;
use crate::Reflectance;
use crate::facets::rebound_colour;
use crate::ggx::{FacetLoss, Ggx};
use glam::DVec3;
use kaustik_spectrum::Spectrum;
use std::f64::consts::FRAC_1_PI;

/// Diffuse light under the glossy cover.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Body {
    cover: Reflectance,
    /// Colour of light rebounding between the cover's facets.
    rebound: Spectrum,
    /// Facets of the cover; `None` where it is smooth.
    ggx: Option<Ggx>,
    /// Base colour times its share of the material.
    colour: Spectrum,
    /// `1 - A_mean`, positive.
    passed: Spectrum,
}

impl Body {
    /// `share` is the part of the material that is opaque dielectric; `facets` are its facets with their mean loss.
    pub(super) fn new(
        p: &PrincipledParameters,
        facets: Option<(Ggx, FacetLoss)>,
        share: f32,
    ) -> Self {
        let (f0, f90) = p.dielectric_ends();
        let cover = p.reflectance(f0, f90);
        let mut mean = cover.mean();
        let mut rebound = Spectrum::ZERO;
        if let Some((ggx, at)) = facets {
            if p.compensation {
                rebound = rebound_colour(mean, at.loss);
            }
            // Brushed facets send back less in the mean over azimuths than in the mean of their two planes: with the least of it
            // for all, what is below is dimmed rather than brightened.
            let mut once = cover.mean_once(ggx, at);
            if ggx.is_brushed() {
                let roughest = ggx.roughest();
                once = once.zip(cover.mean_once(roughest, roughest.mean_loss()), f32::min);
            }
            mean = once + rebound * at.given_back;
        }
        let passed = mean.map(|a| (1.0 - a).max(1e-6));
        Self {
            cover,
            rebound,
            ggx: facets.map(|(ggx, _)| ggx),
            colour: p.base_color * share,
            passed,
        }
    }

    /// The same without diffuse light.
    pub(super) fn blackened(&self) -> Self {
        self.coloured(Spectrum::ZERO)
    }

    /// The same of another colour.
    #[inline]
    pub(super) fn coloured(&self, colour: Spectrum) -> Self {
        Self { colour, ..*self }
    }

    /// Base colour times its share of the material.
    pub(super) fn colour(&self) -> Spectrum {
        self.colour
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

    /// Facets of the cover; `None` where it is smooth.
    #[inline]
    pub(super) fn ggx(&self) -> Option<Ggx> {
        self.ggx
    }

    /// `1 - A`: what the cover lets in from a direction above, where its facets have that loss.
    #[inline]
    pub(super) fn admitted(&self, w: DVec3, at: FacetLoss) -> Spectrum {
        let cover = match self.ggx {
            None => self.cover.at(w.z),
            Some(ggx) => {
                let at = ggx.in_plane(w, at);
                self.cover.once_at_most(at, w.z) + self.rebound * at.given_back
            }
        };
        cover.map(|a| (1.0 - a).max(0.0))
    }

    /// The scattering function, of two directions on one side from which so much is let in.
    #[inline]
    pub(super) fn eval(&self, admitted_o: Spectrum, admitted_i: Spectrum) -> Spectrum {
        let through = admitted_o * admitted_i;
        self.colour * through / self.passed * (FRAC_1_PI as f32)
    }
}
