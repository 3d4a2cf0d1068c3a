//! The wide and the narrow lobes of a glTF material.

use super::clear::Clear;
use super::{Glossy, Principled};

impl Principled {
    /// The lobes that are wide under a threshold of `alpha`, and the others; `None` where there are none.
    pub(crate) fn parts(&self, threshold: f64) -> [Option<Self>; 2] {
        let (glossy, clear) = (self.glossy.is_wide(threshold), self.clear.map(Clear::alpha));
        let clear = clear.is_some_and(|alpha| alpha.is_some_and(|alpha| alpha >= threshold));
        let part = |wide: bool| Self {
            glossy: if glossy == wide {
                self.glossy
            } else {
                Glossy::None
            },
            body: if wide {
                self.body
            } else {
                self.body.blackened()
            },
            clear: self.clear.filter(|_| clear == wide),
        };
        [true, false].map(|wide| Some(part(wide)).filter(|part| !part.is_empty()))
    }

    fn is_empty(&self) -> bool {
        matches!(self.glossy, Glossy::None) && self.body.is_black() && self.clear.is_none()
    }
}

impl Glossy {
    fn is_wide(&self, threshold: f64) -> bool {
        match self {
            Self::Rough(facets) => facets.alpha() >= threshold,
            Self::None | Self::Smooth(_) => false,
        }
    }
}

impl Clear {
    /// Roughness; `None` where it is smooth.
    fn alpha(self) -> Option<f64> {
        match self {
            Self::Pane(_) | Self::Solid(_) => None,
            Self::FrostedPane(lobe) => Some(lobe.alpha()),
            Self::RoughSolid(lobe) => Some(lobe.alpha()),
        }
    }
}
