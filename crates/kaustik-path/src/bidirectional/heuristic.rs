/// How the strategies that can make a path share it, by the density `p` that each has of making it
/// (Veach 1997, 9.2). The weights of all strategies sum to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Heuristic {
    /// In proportion to the density.
    Balance,
    /// In proportion to the square of the density.
    #[default]
    Power,
    /// 1 for the largest density (of equal ones the smallest `s`), 0 for the others: saves the shadow
    /// rays of the others (Kelemen sec. 2).
    Maximum,
}

impl Heuristic {
    /// What stands in the sums for a density, a ratio of densities or a factor of one.
    #[inline]
    pub(crate) fn of(self, density: f64) -> f64 {
        match self {
            Self::Power => density * density,
            Self::Balance | Self::Maximum => density,
        }
    }

    /// Two strategies, or groups of them, together.
    #[inline]
    pub(crate) fn join(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Maximum => a.max(b),
            Self::Balance | Self::Power => a + b,
        }
    }

    /// The weight of a strategy beside its rivals, given as ratios to itself: those with fewer vertices
    /// from the light, joined, and those with more. A ratio that is no number counts nothing.
    #[inline]
    pub(crate) fn weight(self, fewer: f64, more: f64) -> f64 {
        let sound = |ratio: f64| if ratio.is_nan() { 0.0 } else { ratio };
        let (fewer, more) = (sound(fewer), sound(more));
        match self {
            Self::Maximum => f64::from(u8::from(fewer < 1.0 && more <= 1.0)),
            Self::Balance | Self::Power => 1.0 / (1.0 + fewer + more),
        }
    }
}
