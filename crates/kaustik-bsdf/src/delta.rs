use glam::DVec3;
use kaustik_spectrum::Spectrum;

use crate::Sample;

/// Scattering into a Dirac direction: [`Lobe::delta`](crate::Lobe::delta).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Delta {
    /// The direction: local frame, unit, away from the surface.
    pub wi: DVec3,
    /// `f |cos wi|` over the delta, of all lobes that scatter there.
    pub share: Spectrum,
    /// Probability with which [`Lobe::sample`](crate::Lobe::sample) takes this direction, by any lobe.
    pub probability: f64,
    /// Refracted where the index depends on the wavelength: only the hero lane means anything.
    pub dispersive: bool,
}

impl Delta {
    /// Of a sample of the one lobe that scatters there.
    #[inline]
    pub(crate) fn of(sample: &Sample) -> Self {
        Self {
            wi: sample.wi,
            share: sample.weight * (sample.pdf as f32),
            probability: sample.pdf,
            dispersive: sample.dispersive,
        }
    }

    /// With the same direction reached by another lobe as well.
    #[inline]
    pub(crate) fn and(self, other: Option<Self>) -> Self {
        match other {
            None => self,
            Some(other) => Self {
                share: self.share + other.share,
                probability: self.probability + other.probability,
                dispersive: self.dispersive || other.dispersive,
                ..self
            },
        }
    }
}
