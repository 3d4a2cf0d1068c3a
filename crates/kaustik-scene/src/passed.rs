use kaustik_spectrum::Spectrum;

/// What of the light on a segment gets past the surfaces in its way: all, nothing, or what partly transparent ones and
/// smooth panes let through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passed {
    /// Probability that a walk gets as far, in [0, 1].
    pub chance: f64,
    /// Share of light over that probability, each lane: 1 without panes. [`chance`](Self::chance) is the mean share at each
    /// pane, so a lane may have up to four at each.
    pub tint: Spectrum,
}

impl Passed {
    /// Nothing is in the way.
    pub const ALL: Self = Self {
        chance: 1.0,
        tint: Spectrum::ONE,
    };

    /// Something is that lets nothing through.
    pub const NOTHING: Self = Self {
        chance: 0.0,
        tint: Spectrum::ONE,
    };

    /// Does no light pass?
    #[inline]
    pub fn is_nothing(&self) -> bool {
        self.chance <= 0.0
    }

    /// Share of light that passes, each lane in [0, 1].
    #[inline]
    pub fn share(&self) -> Spectrum {
        self.tint * self.chance as f32
    }
}
