use crate::{Conductor, Delta, Lobe, Mode, Reflectance, Sample, fresnel, local, warp};
use glam::DVec3;
use kaustik_spectrum::Spectrum;
use std::f64::consts::FRAC_1_PI;

/// Varnish: a smooth clear coat over a diffuse base, on both sides alike.
///
/// The coat mirrors `F(wo)`. What enters is scattered by the base, thrown back in part by the
/// coat from within, and leaves: with `T = 1 - F`, `rho` the base and `F_in` the coat's mean
/// reflectance from within, the diffuse part is `T(wo) T(wi) rho / (pi n^2 (1 - rho F_in))`.
/// It is reciprocal, and since `1 - F_in = (1 - F_out) / n^2` a white base loses nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coated {
    ior: f64,
    /// The diffuse part without its two transmittances.
    body: Spectrum,
    /// The diffuse part's albedo without `T(wo)`.
    share: Spectrum,
}

impl Coated {
    /// From the base's reflectance, lanes in `[0, 1]`, and the coat's index, at least 1 (1.5 is
    /// usual).
    #[inline]
    pub fn new(reflectance: Spectrum, ior: f64) -> Self {
        let ior = if ior >= 1.0 { ior.min(10.0) } else { 1.0 };
        let out = 1.0 - fresnel::mean_dielectric(ior);
        let within = (1.0 - out / (ior * ior)) as f32;
        let base = reflectance.map(|rho| rho / (1.0 - rho * within));
        Self {
            ior,
            body: base * ((FRAC_1_PI / (ior * ior)) as f32),
            share: base * ((out / (ior * ior)) as f32),
        }
    }

    /// The coat alone: a mirror of the same reflectance.
    pub(crate) fn varnish(&self) -> Conductor {
        Conductor {
            reflectance: Reflectance::Conductor {
                eta: Spectrum::splat(self.ior as f32),
                k: Spectrum::ZERO,
            },
        }
    }

    /// Reflectance of the coat from outside.
    #[inline]
    fn coat(&self, w: DVec3) -> f64 {
        fresnel::dielectric(w.z.abs().min(1.0), self.ior).0
    }

    /// Probability of the mirror lobe, by albedo, where the coat reflects `f`.
    #[inline]
    fn mirror_probability(&self, f: f64) -> f64 {
        f / (f + (1.0 - f) * f64::from(self.share.mean())).max(f64::MIN_POSITIVE)
    }
}

impl Lobe for Coated {
    #[inline]
    fn eval(&self, wo: DVec3, wi: DVec3, _mode: Mode) -> Spectrum {
        if !local::same_side(wo, wi) {
            return Spectrum::ZERO;
        }
        self.body * (((1.0 - self.coat(wo)) * (1.0 - self.coat(wi))) as f32)
    }

    #[inline]
    fn pdf(&self, wo: DVec3, wi: DVec3, _mode: Mode) -> f64 {
        if !local::same_side(wo, wi) {
            return 0.0;
        }
        (1.0 - self.mirror_probability(self.coat(wo))) * wi.z.abs() * FRAC_1_PI
    }

    #[inline]
    fn sample(&self, wo: DVec3, uc: f64, u: [f64; 2], mode: Mode) -> Option<Sample> {
        if !local::usable(wo) {
            return None;
        }
        let f = self.coat(wo);
        let p = self.mirror_probability(f);
        if uc < p {
            return Sample::delta(wo, local::mirror(wo), Spectrum::splat(f as f32), p);
        }
        let wi = local::to_side_of(wo, warp::cosine_hemisphere(u));
        Sample::continuous(wo, wi, self.eval(wo, wi, mode), self.pdf(wo, wi, mode))
    }

    #[inline]
    fn delta(&self, wo: DVec3, transmitted: bool, _mode: Mode) -> Option<Delta> {
        if transmitted || !local::usable(wo) {
            return None;
        }
        let f = self.coat(wo);
        let p = self.mirror_probability(f);
        let sample = Sample::delta(wo, local::mirror(wo), Spectrum::splat(f as f32), p)?;
        Some(Delta::of(&sample))
    }

    #[inline]
    fn albedo(&self, wo: DVec3) -> Spectrum {
        let f = self.coat(wo) as f32;
        self.share * (1.0 - f) + Spectrum::splat(f)
    }

    #[inline]
    fn transmits(&self) -> bool {
        false
    }
}
