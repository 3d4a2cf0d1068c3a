use crate::{Delta, Lobe, Mode, Reflectance, Sample, local};
use glam::DVec3;
use kaustik_spectrum::Spectrum;

/// Smooth metal: a mirror whose reflectance depends on the angle. Both sides alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    /// How it reflects.
    pub reflectance: Reflectance,
}

impl Lobe for Conductor {
    #[inline]
    fn eval(&self, _wo: DVec3, _wi: DVec3, _mode: Mode) -> Spectrum {
        Spectrum::ZERO
    }

    #[inline]
    fn pdf(&self, _wo: DVec3, _wi: DVec3, _mode: Mode) -> f64 {
        0.0
    }

    #[inline]
    fn sample(&self, wo: DVec3, _uc: f64, _u: [f64; 2], _mode: Mode) -> Option<Sample> {
        if !local::usable(wo) {
            return None;
        }
        Sample::delta(wo, local::mirror(wo), self.albedo(wo), 1.0)
    }

    #[inline]
    fn delta(&self, wo: DVec3, transmitted: bool, mode: Mode) -> Option<Delta> {
        if transmitted {
            return None;
        }
        Some(Delta::of(&self.sample(wo, 0.0, [0.0; 2], mode)?))
    }

    #[inline]
    fn albedo(&self, wo: DVec3) -> Spectrum {
        self.reflectance.at(wo.z.abs())
    }

    fn is_delta(&self) -> bool {
        true
    }

    #[inline]
    fn transmits(&self) -> bool {
        false
    }
}
