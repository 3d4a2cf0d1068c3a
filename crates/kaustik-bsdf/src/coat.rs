use crate::facets::Facets;
use crate::ggx::Ggx;
use crate::{Frame, Mode, Reflectance, SMOOTH_ALPHA, fresnel, local};
use glam::DVec3;
use kaustik_spectrum::Spectrum;

/// A clear varnish without colour or thickness over whatever lies below (`KHR_materials_clearcoat`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Coat {
    /// Rough, or `None` for a mirror.
    facets: Option<Facets>,
    /// Reflectance at normal incidence.
    f0: f32,
    /// Share of the surface that has it.
    strength: f32,
    /// Least that it reflects from any direction, times its share.
    least: f32,
    /// Its own normal among directions above the surface, where that is not the surface's.
    normal: Option<DVec3>,
}

/// GGX roughness below which a varnish with a normal of its own does not go: its lobe keeps a width, so that no vertex
/// has two mirrored directions. That of a perceptual roughness of 0.05.
const LEAST_TILTED: f64 = 2.5e-3;
/// In place of a direction that its facets do not see.
const GRAZING: DVec3 = DVec3::new(1.0, 0.0, 1e-6);

fn reflectance(f0: f32) -> Reflectance {
    Reflectance::Schlick {
        f0: Spectrum::splat(f0),
        f90: Spectrum::ONE,
    }
}

impl Coat {
    /// `strength` and perceptual `roughness` in `[0, 1]`; its `index` relative to the outside; `normal`, if
    /// it has one of its own, unit with z > 0.
    pub(crate) fn new(
        strength: f64,
        roughness: f64,
        index: f64,
        normal: Option<DVec3>,
        compensation: bool,
    ) -> Self {
        let alpha = local::within(roughness, 0.0, 1.0) * local::within(roughness, 0.0, 1.0);
        let alpha = match normal {
            Some(_) => alpha.max(LEAST_TILTED),
            None => alpha,
        };
        let f0 = match index > 0.0 && index.is_finite() {
            true => fresnel::normal_incidence(index) as f32,
            false => 0.0,
        };
        let facets = (alpha >= SMOOTH_ALPHA)
            .then(|| Facets::compensated(reflectance(f0), Ggx::new(alpha), compensation));
        let coat = Self {
            facets,
            f0,
            strength: local::within(strength, 0.0, 1.0) as f32,
            least: 0.0,
            normal: None,
        };
        Self {
            least: coat.albedo(DVec3::Z),
            normal,
            ..coat
        }
    }

    /// `w` (above) as its own facets see it; `None` from behind them.
    #[inline]
    fn own(&self, w: DVec3) -> Option<DVec3> {
        let Some(normal) = self.normal else {
            return Some(w);
        };
        let own = Frame::from_z(normal).to_local(w);
        (own.z > GRAZING.z).then_some(own)
    }

    /// What it reflects of light from `w` (above).
    pub(crate) fn albedo(&self, w: DVec3) -> f32 {
        let w = self.own(w).unwrap_or(GRAZING);
        let share = match &self.facets {
            Some(facets) => facets.albedo(w),
            None => reflectance(self.f0).at(w.z.min(1.0)),
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
    ///
    /// With a normal of its own it is what makes the light that leaves be that of its own facets, as a shading normal
    /// is: `f cos` holds its own cosine. So it is not reciprocal, and in the other mode it is the adjoint.
    pub(crate) fn eval(&self, wo: DVec3, wi: DVec3, mode: Mode) -> Spectrum {
        let Some(facets) = self.facets else {
            return Spectrum::ZERO;
        };
        let (Some(own_o), Some(own_i)) = (self.own(wo), self.own(wi)) else {
            return Spectrum::ZERO;
        };
        let [o, i] = [own_o, own_i].map(|w| facets.facing(w));
        let f = facets.eval(&o, &i) * self.strength;
        if self.normal.is_none() {
            return f;
        }
        let cosines = match mode {
            Mode::Radiance => own_i.z / wi.z,
            Mode::Importance => own_o.z / wo.z,
        };
        f * cosines as f32
    }

    /// Density of [`sample`](Self::sample), both directions above.
    pub(crate) fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        match (self.facets, self.own(wo), self.own(wi)) {
            (Some(facets), Some(wo), Some(wi)) => facets.pdf(&facets.facing(wo), wi),
            _ => 0.0,
        }
    }

    /// Draws a direction if it is rough; one below is lost.
    pub(crate) fn sample(&self, wo: DVec3, uc: f64, u: [f64; 2]) -> Option<DVec3> {
        let facets = self.facets?;
        let Some(normal) = self.normal else {
            return Some(facets.sample(&facets.facing(wo), uc, u));
        };
        let Some(own) = self.own(wo) else {
            return Some(DVec3::NEG_Z);
        };
        let wi = facets.sample(&facets.facing(own), uc, u);
        if wi.z <= GRAZING.z {
            return Some(DVec3::NEG_Z);
        }
        Some(Frame::from_z(normal).to_world(wi))
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
