use crate::interface::Split;
use crate::{Delta, Interface, Lobe, Mode, Sample, interface, local};
use glam::DVec3;
use kaustik_spectrum::Spectrum;

/// Smooth boundary of a transparent solid: reflects and refracts, z > 0 is outside.
///
/// Refraction carries the squared index ratio in radiance mode and nothing in importance mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric {
    /// The two media.
    pub interface: Interface,
}

impl Dielectric {
    /// Through the surface; `None` under total reflection.
    #[inline]
    fn refracted(&self, wo: DVec3, split: &Split, mode: Mode) -> Option<Sample> {
        let ahead = self.interface.ahead(wo);
        let normal = DVec3::new(0.0, 0.0, wo.z.signum());
        let wi = interface::refract(wo, normal, wo.z.abs(), split.beyond, ahead);
        let share = split.transmitted * (radiance_scale(ahead, mode) as f32);
        let sample = Sample::delta(wo, wi, share, 1.0 - split.reflect)?;
        Some(Sample {
            dispersive: self.interface.dispersive(),
            ..sample
        })
    }
}

impl Lobe for Dielectric {
    #[inline]
    fn eval(&self, _wo: DVec3, _wi: DVec3, _mode: Mode) -> Spectrum {
        Spectrum::ZERO
    }

    #[inline]
    fn pdf(&self, _wo: DVec3, _wi: DVec3, _mode: Mode) -> f64 {
        0.0
    }

    #[inline]
    fn sample(&self, wo: DVec3, uc: f64, _u: [f64; 2], mode: Mode) -> Option<Sample> {
        if !local::usable(wo) {
            return None;
        }
        let split = self.interface.split(wo.z.abs(), wo.z > 0.0);
        if uc < split.reflect {
            return Sample::delta(wo, local::mirror(wo), split.reflected, split.reflect);
        }
        self.refracted(wo, &split, mode)
    }

    #[inline]
    fn delta(&self, wo: DVec3, transmitted: bool, mode: Mode) -> Option<Delta> {
        if !local::usable(wo) {
            return None;
        }
        let split = self.interface.split(wo.z.abs(), wo.z > 0.0);
        let sample = if transmitted {
            self.refracted(wo, &split, mode)
        } else {
            Sample::delta(wo, local::mirror(wo), split.reflected, split.reflect)
        };
        sample.as_ref().map(Delta::of)
    }

    #[inline]
    fn albedo(&self, wo: DVec3) -> Spectrum {
        let split = self.interface.split(wo.z.abs(), wo.z > 0.0);
        split.reflected + split.transmitted
    }

    fn is_delta(&self) -> bool {
        true
    }

    fn dispersive_between(&self, wo: DVec3, wi: DVec3) -> bool {
        self.interface.dispersive() && wo.z * wi.z < 0.0
    }
}

/// Radiance grows with the square of the index: going from `wo` against the light into a medium
/// `ahead` times as dense divides by `ahead^2` (Veach 1997 ch. 5). Particles know nothing of it.
#[inline]
pub(crate) fn radiance_scale(ahead: f64, mode: Mode) -> f64 {
    match mode {
        Mode::Radiance => 1.0 / (ahead * ahead),
        Mode::Importance => 1.0,
    }
}
