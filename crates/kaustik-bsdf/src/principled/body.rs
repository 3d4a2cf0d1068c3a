use super::PrincipledParameters;
use crate::facets::rebound_colour;
use crate::finish::Grain;
use crate::ggx::{FacetLoss, Ggx};
use crate::{Finish, Reflectance, warp};
use glam::DVec3;
use kaustik_spectrum::Spectrum;
use std::f64::consts::FRAC_1_PI;

/// Diffuse light under the glossy cover, sent back or, as by a leaf or a lampshade, let through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Body {
    cover: Reflectance,
    /// Colour of light rebounding between the cover's facets.
    rebound: Spectrum,
    /// Facets of the cover; `None` where it is smooth.
    ggx: Option<Ggx>,
    /// Base colour times its share of the material.
    colour: Spectrum,
    /// The same of what leaves on the other side, from under as much of a cover.
    through: Spectrum,
    /// `1 - A_mean`, positive.
    passed: Spectrum,
}

impl Body {
    /// `share` is the part of the material that is opaque dielectric.
    pub(super) fn new(p: &PrincipledParameters, finish: &Finish, share: f32) -> Self {
        let (f0, f90) = p.dielectric_ends();
        let cover = p.reflectance(f0, f90);
        let mut mean = cover.mean();
        let mut rebound = Spectrum::ZERO;
        if let Some(Grain {
            ggx, mean_loss: at, ..
        }) = finish.grain
        {
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
        let through = p.diffuse_transmission as f32;
        let passed = mean.map(|a| (1.0 - a).max(1e-6));
        Self {
            cover,
            rebound,
            ggx: finish.grain.map(|grain| grain.ggx),
            colour: p.base_color * (share * (1.0 - through)),
            through: p.diffuse_transmission_color * (share * through),
            passed,
        }
    }

    /// The same without diffuse light.
    pub(super) fn blackened(&self) -> Self {
        self.coloured(Spectrum::ZERO, Spectrum::ZERO)
    }

    /// The same with other colours of what is sent back and let through.
    #[inline]
    pub(super) fn coloured(&self, colour: Spectrum, through: Spectrum) -> Self {
        Self {
            colour,
            through,
            ..*self
        }
    }

    /// What is sent back: base colour times its share of the material.
    pub(super) fn colour(&self) -> Spectrum {
        self.colour
    }

    /// What is let through.
    pub(super) fn through(&self) -> Spectrum {
        self.through
    }

    /// What is sent back and let through, of the light that is let in.
    #[inline]
    pub(super) fn scattered(&self) -> Spectrum {
        self.colour + self.through
    }

    /// Does light come through?
    #[inline]
    pub(super) fn lets_through(&self) -> bool {
        !self.through.is_zero()
    }

    /// Probability that a sample goes through, if one of diffuse light is drawn.
    #[inline]
    pub(super) fn chance_through(&self) -> f64 {
        if !self.lets_through() {
            return 0.0;
        }
        let [back, through] = [self.colour, self.through].map(|c| f64::from(c.mean()));
        through / (back + through)
    }

    /// Colour of light rebounding between the cover's facets.
    pub(super) fn rebound(&self) -> Spectrum {
        self.rebound
    }

    /// No diffuse light at all?
    #[inline]
    pub(super) fn is_black(&self) -> bool {
        self.colour.is_zero() && self.through.is_zero()
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

    /// The scattering function, of two directions from which so much is let in, on one side or with the surface in between.
    #[inline]
    pub(super) fn eval(&self, (o, i): (Spectrum, Spectrum), across: bool) -> Spectrum {
        let colour = if across { self.through } else { self.colour };
        colour * (o * i) / self.passed * (FRAC_1_PI as f32)
    }

    /// Density of a direction at this cosine, if one of diffuse light is drawn.
    #[inline]
    pub(super) fn pdf(&self, cos: f64, across: bool) -> f64 {
        let through = self.chance_through();
        let share = if across { through } else { 1.0 - through };
        share * warp::cosine_hemisphere_pdf(cos.abs())
    }
}
