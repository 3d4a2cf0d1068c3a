use crate::PrincipledParameters;
use crate::ggx::{FacetLoss, Ggx};
use crate::rebound::Rebound;

/// How rough a glTF material reflects, with all that follows from that alone: what is equally rough all over makes it once, not at
/// each hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finish {
    /// `None` where the surface counts as smooth.
    pub(crate) grain: Option<Grain>,
}

/// Facets, and what they do to light on average.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grain {
    pub(crate) ggx: Ggx,
    /// [`Ggx::mean_loss`].
    pub(crate) mean_loss: FacetLoss,
    pub(crate) way: Rebound,
}

impl Finish {
    /// Perceptual roughness and strength of anisotropy, both brought into `[0, 1]`.
    pub fn new(roughness: f64, anisotropy: f64) -> Self {
        let parameters = PrincipledParameters {
            roughness,
            anisotropy,
            ..PrincipledParameters::default()
        };
        Self::of(&parameters.in_range())
    }

    /// Of numbers that are in range.
    #[inline]
    pub(crate) fn of(parameters: &PrincipledParameters) -> Self {
        Self {
            grain: parameters.facets().map(Grain::new),
        }
    }
}

impl Grain {
    #[inline]
    pub(crate) fn new(ggx: Ggx) -> Self {
        Self {
            ggx,
            mean_loss: ggx.mean_loss(),
            way: Rebound::new(ggx.alpha()),
        }
    }
}
