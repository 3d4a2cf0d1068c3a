use kaustik_spectrum::Spectrum;

/// Light that goes through a smooth pane without being scattered: [`Bsdf::passing`](crate::Bsdf::passing).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passing {
    /// Share of light, each lane in `[0, 1]`. The same from both ends of the way.
    pub share: Spectrum,
}

impl Passing {
    /// Of all surfaces that are no panes.
    pub const NOTHING: Self = Self {
        share: Spectrum::ZERO,
    };

    /// Probability, in `[0, 1]`, with which a walk is to meet the surface and not to pass it: what passes in the mean
    /// over the lanes is the chance to. What is scattered and what is swallowed have the rest together, so
    /// that divided by it they are no more than what came.
    #[inline]
    pub fn meeting(&self) -> f64 {
        (1.0 - f64::from(self.share.mean())).clamp(0.0, 1.0)
    }
}
