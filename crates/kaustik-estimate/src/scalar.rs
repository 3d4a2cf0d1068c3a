//! The scalar contribution `I*`: what a chain's density is proportional to.

use kaustik_mcmc::Family;
use kaustik_path::{Contributions, ScalarTarget};

use crate::RasterMap;

/// How what one point contributes makes one scalar.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Contribution {
    /// The sum of all.
    #[default]
    Sum,
    /// The largest single weighted `C_{s,t}` (Kelemen sec. 2: the sum favours long bundles of paths).
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
        match self.contribution {
            Contribution::Sum => {
                let splats = value.splats().iter();
                splats.map(|splat| self.target.of(splat.xyz)).sum()
            }
            Contribution::Maximum => value.largest(self.target),
        }
    }
}

impl Family<Contributions, 1> for ScalarContribution {
    #[inline]
    fn densities(&self, value: &Contributions) -> [f64; 1] {
        [self.of(value)]
    }
}

/// The same times a weight where each splat falls: the target of a stage of PSSMLT in stages (Hoberock and Hart 2010).
///
/// The sum alone: a largest path has no place in the image of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct MappedContribution {
    /// Which scalar of a colour.
    pub target: ScalarTarget,
    /// The weights.
    pub map: RasterMap,
}

impl Family<Contributions, 1> for MappedContribution {
    #[inline]
    fn densities(&self, value: &Contributions) -> [f64; 1] {
        let splats = value.splats().iter();
        let weighted = splats.map(|splat| {
            let raster = [splat.raster.x, splat.raster.y];
            self.target.of(splat.xyz) * self.map.at(raster)
        });
        [weighted.sum()]
    }
}
