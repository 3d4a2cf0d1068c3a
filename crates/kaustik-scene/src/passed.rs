use kaustik_spectrum::Spectrum;

/// What of the light on a segment gets past the surfaces in its way: all, nothing, or what partly transparent ones and
/// smooth panes let through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passed {
    /// Probability that a walk gets as far, in [0, 1].
    pub chance: f64,
    /// Share of light that passes, each lane in [0, 1]: without panes the chance, at each pane [`chance`](Self::chance) is the mean
    /// share over the lanes.
    pub share: Spectrum,
}

impl Passed {
    /// Nothing is in the way.
    pub const ALL: Self = Self {
        chance: 1.0,
        share: Spectrum::ONE,
    };

    /// Something is that lets nothing through.
    pub const NOTHING: Self = Self {
        chance: 0.0,
        share: Spectrum::ZERO,
    };

    /// Does no light pass?
    #[inline]
    pub fn is_nothing(&self) -> bool {
        self.chance <= 0.0
    }

    /// What a walk that gets as far carries of what it had: the share over the chance, 0 where that is 0. No lane has more
    /// than 1e30, which single precision holds: of the light behind fifty panes of the purest colours.
    #[inline]
    pub fn tint(&self) -> Spectrum {
        if self.is_nothing() {
            return Spectrum::ZERO;
        }
        (self.share).map(|share| (f64::from(share) / self.chance).min(1e30) as f32)
    }
}
