use kaustik_spectrum::Xyz;

/// Which scalar of a colour a chain follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ScalarTarget {
    /// X + Y + Z: every wavelength counts (RELT 5.1.1).
    #[default]
    Xyz,
    /// Y, with a thousandth of X + Y + Z so that no colour is out of reach.
    Luminance,
}

impl ScalarTarget {
    /// The scalar of a colour, >= 0.
    #[inline]
    pub fn of(self, xyz: Xyz) -> f64 {
        let sum = f64::from(xyz.sum());
        match self {
            Self::Xyz => sum,
            Self::Luminance => f64::from(xyz.luminance()) + 1e-3 * sum,
        }
    }
}
