use crate::facets::Facets;
use crate::ggx::Ggx;
use crate::{Lobe, Mode, Reflectance, Sample, local};
use glam::DVec3;
use kaustik_spectrum::Spectrum;

/// GGX-rough metal, both sides alike. Visible normals are sampled; what scatters between facets
/// is given back as a reciprocal, nearly diffuse lobe unless that is switched off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughConductor {
    facets: Facets,
}

impl RoughConductor {
    /// From the facets' reflectance and `alpha` in `[SMOOTH_ALPHA, 1]` (clamped).
    #[inline]
    pub fn new(reflectance: Reflectance, alpha: f64, compensation: bool) -> Self {
        Self {
            facets: Facets::compensated(reflectance, Ggx::new(alpha), compensation),
        }
    }

    /// GGX roughness.
    #[inline]
    pub fn alpha(&self) -> f64 {
        self.facets.alpha()
    }
}

impl Lobe for RoughConductor {
    #[inline]
    fn eval(&self, wo: DVec3, wi: DVec3, _mode: Mode) -> Spectrum {
        if !local::same_side(wo, wi) {
            return Spectrum::ZERO;
        }
        let [o, i] = [wo, wi].map(|w| self.facets.facing(local::lift(w)));
        self.facets.eval(&o, &i)
    }

    #[inline]
    fn pdf(&self, wo: DVec3, wi: DVec3, _mode: Mode) -> f64 {
        if !local::same_side(wo, wi) {
            return 0.0;
        }
        let o = self.facets.facing(local::lift(wo));
        self.facets.pdf(&o, local::lift(wi))
    }

    #[inline]
    fn eval_pdf(&self, wo: DVec3, wi: DVec3, _mode: Mode) -> (Spectrum, f64) {
        if !local::same_side(wo, wi) {
            return (Spectrum::ZERO, 0.0);
        }
        let [o, i] = [wo, wi].map(|w| self.facets.facing(local::lift(w)));
        self.facets.both(&o, &i)
    }

    #[inline]
    fn eval_pdfs(&self, wo: DVec3, wi: DVec3, _mode: Mode) -> (Spectrum, [f64; 2]) {
        if !local::same_side(wo, wi) {
            return (Spectrum::ZERO, [0.0; 2]);
        }
        let [o, i] = [wo, wi].map(|w| self.facets.facing(local::lift(w)));
        self.facets.both_ways(&o, &i)
    }

    #[inline]
    fn sample(&self, wo: DVec3, uc: f64, u: [f64; 2], _mode: Mode) -> Option<Sample> {
        if !local::usable(wo) {
            return None;
        }
        let o = self.facets.facing(local::lift(wo));
        let wi = local::to_side_of(wo, self.facets.sample(&o, uc, u));
        if !local::same_side(wo, wi) {
            return None; // met a second facet, which single scattering leaves out
        }
        let (f, pdf) = self.facets.both(&o, &self.facets.facing(local::lift(wi)));
        Sample::continuous(wo, wi, f, pdf)
    }

    #[inline]
    fn albedo(&self, wo: DVec3) -> Spectrum {
        self.facets.albedo(local::lift(wo))
    }

    #[inline]
    fn transmits(&self) -> bool {
        false
    }
}
