use crate::facets::Facets;
use crate::ggx::Ggx;
use crate::{Reflectance, SMOOTH_ALPHA, local};
use glam::DVec3;
use kaustik_spectrum::Spectrum;

/// A clear varnish without colour or thickness over whatever lies below (`KHR_materials_clearcoat`), of index 1.5.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Coat {
    /// Rough, or `None` for a mirror.
    facets: Option<Facets>,
    /// Share of the surface that has it.
    strength: f32,
    /// Least that it reflects from any direction, times its share.
    least: f32,
}

/// Of an index of 1.5.
const REFLECTANCE: Reflectance = Reflectance::Schlick {
    f0: Spectrum::splat(0.04),
    f90: Spectrum::ONE,
};

impl Coat {
    /// `strength` and perceptual `roughness` in `[0, 1]`.
    pub(crate) fn new(strength: f64, roughness: f64, compensation: bool) -> Self {
        let alpha = local::within(roughness, 0.0, 1.0) * local::within(roughness, 0.0, 1.0);
        let facets = (alpha >= SMOOTH_ALPHA)
            .then(|| Facets::compensated(REFLECTANCE, Ggx::new(alpha), compensation));
        let coat = Self {
            facets,
            strength: local::within(strength, 0.0, 1.0) as f32,
            least: 0.0,
        };
        Self {
            least: coat.albedo(DVec3::Z),
            ..coat
        }
    }

    /// What it reflects of light from `w` (above).
    pub(crate) fn albedo(&self, w: DVec3) -> f32 {
        let share = match &self.facets {
            Some(facets) => facets.albedo(w),
            None => REFLECTANCE.at(w.z.min(1.0)),
        };
        self.strength * share.hero()
    }

    /// What it leaves of light that comes from `wo` and goes to `wi` by what lies below (both above).
    ///
    /// Once in and once out, and what it throws back to the surface below is taken to come out again as often as
    /// at normal incidence, where it throws back least: reciprocal, and never more than came in whatever
    /// lies below.
    pub(crate) fn passed(&self, wo: DVec3, wi: DVec3) -> f32 {
        (1.0 - self.albedo(wo)).max(0.0) * (1.0 - self.albedo(wi)).max(0.0) / (1.0 - self.least)
    }

    /// Its scattering function; both directions above. A mirror has none.
    pub(crate) fn eval(&self, wo: DVec3, wi: DVec3) -> Spectrum {
        self.facets
            .map_or(Spectrum::ZERO, |facets| facets.eval(wo, wi) * self.strength)
    }

    /// Density of [`sample`](Self::sample), both directions above.
    pub(crate) fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        self.facets.map_or(0.0, |facets| facets.pdf(wo, wi))
    }

    /// Draws a direction if it is rough; one below is lost.
    pub(crate) fn sample(&self, wo: DVec3, uc: f64, u: [f64; 2]) -> Option<DVec3> {
        self.facets.map(|facets| facets.sample(wo, uc, u))
    }

    /// GGX alpha; 0 for a mirror.
    pub(crate) fn alpha(&self) -> f64 {
        self.facets.map_or(0.0, |facets| facets.alpha())
    }

    /// Is it a mirror?
    pub(crate) fn is_smooth(&self) -> bool {
        self.facets.is_none()
    }
}
