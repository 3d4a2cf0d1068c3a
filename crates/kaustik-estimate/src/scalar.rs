//! The scalar contribution `I*`: what a chain's density is proportional to.

use kaustik_mcmc::Family;
use kaustik_path::Contributions;
use kaustik_spectrum::Xyz;

/// Which scalar of a colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ScalarTarget {
    /// X + Y + Z: every wavelength counts (RELT 5.1.1).
    #[default]
    Xyz,
    /// Y, with a thousandth of X + Y + Z so that no colour is out of reach (spec:
    /// pss-and-pssmlt.md 9).
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

/// How the splats of one point add up to one scalar.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Contribution {
    /// Their sum.
    #[default]
    Sum,
    /// The largest (Kelemen sec. 2: the sum favours long bundles of paths).
    Maximum,
}

/// The family of one density that PSSMLT samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ScalarContribution {
    /// Which scalar of a colour.
    pub target: ScalarTarget,
    /// How splats combine.
    pub contribution: Contribution,
}

impl ScalarContribution {
    /// `I*` of a value.
    #[inline]
    pub fn of(&self, value: &Contributions) -> f64 {
        let scalars = value.splats().iter().map(|splat| self.target.of(splat.xyz));
        match self.contribution {
            Contribution::Sum => scalars.sum(),
            Contribution::Maximum => scalars.fold(0.0, f64::max),
        }
    }
}

impl Family<Contributions, 1> for ScalarContribution {
    #[inline]
    fn densities(&self, value: &Contributions) -> [f64; 1] {
        [self.of(value)]
    }
}
