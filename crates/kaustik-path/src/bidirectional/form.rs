use std::ops::RangeInclusive;

use glam::DVec3;
use kaustik_bsdf::{Bsdf, Lobe};

/// Which vertices of the two subpaths are joined (Kelemen sec. 2).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// Every vertex with every other.
    #[default]
    Full,
    /// Each subpath stops by chance, and only the two vertices where they stopped are joined: one
    /// shadow ray a point. A light that the eye's walk runs into, and a lens that the light's
    /// walk runs into, count as well. The probabilities of stopping and of going on are part of
    /// the weights.
    Simple,
}

/// Least and largest probability that a walk of the simple form goes on where it could be joined.
pub(crate) const ONWARD: RangeInclusive<f64> = 0.3..=0.8;
/// The same at the emitter: as often next event as a walk.
const EMITTER_ONWARD: f64 = 0.5;
/// At the lens: mostly a walk, because what a camera sees first is best found from it.
const LENS_ONWARD: f64 = 0.75;

/// The probability that a walk goes on from a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Onward {
    /// Of going on; in the full form a walk goes on and is joined.
    pub(crate) onward: f64,
    /// Of being joined.
    pub(crate) stop: f64,
}

impl Onward {
    /// Both.
    const ALWAYS: Self = Self {
        onward: 1.0,
        stop: 1.0,
    };

    /// A vertex that cannot be joined: the walk always goes on.
    pub(crate) const UNJOINED: Self = Self {
        onward: 1.0,
        stop: 0.0,
    };

    fn with(onward: f64) -> Self {
        Self {
            onward,
            stop: 1.0 - onward,
        }
    }

    /// How often the vertex is joined for each time that the walk goes on.
    #[inline]
    pub(crate) fn odds(&self) -> f64 {
        self.stop / self.onward
    }
}

impl Form {
    /// At the emitter where a light walk begins.
    #[inline]
    pub(crate) fn at_emitter(self) -> Onward {
        match self {
            Self::Full => Onward::ALWAYS,
            Self::Simple => Onward::with(EMITTER_ONWARD),
        }
    }

    /// At the lens.
    #[inline]
    pub(crate) fn at_lens(self) -> Onward {
        match self {
            Self::Full => Onward::ALWAYS,
            Self::Simple => Onward::with(LENS_ONWARD),
        }
    }

    /// At a surface. A property of the place, not of the direction in which it was reached, so that both
    /// walks go on from it with the same probability and weights need to know it for the two
    /// joined vertices alone.
    #[inline]
    pub(crate) fn at_surface(self, bsdf: &Bsdf) -> Onward {
        match self {
            Self::Full if bsdf.is_connectable() => Onward::ALWAYS,
            Self::Simple if bsdf.is_connectable() => {
                let albedo = f64::from(bsdf.albedo(DVec3::Z).mean());
                Onward::with(albedo.clamp(*ONWARD.start(), *ONWARD.end()))
            }
            _ => Onward::UNJOINED,
        }
    }
}
