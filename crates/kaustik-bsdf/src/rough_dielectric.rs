use crate::albedo::{InterfaceLoss, interface_loss, reflector_loss};
use crate::ggx::Ggx;
use crate::interface::refract;
use crate::rebound::Rebound;
use crate::{Interface, Lobe, Mode, Sample, fresnel, local};
use glam::DVec3;
use kaustik_spectrum::Spectrum;
use std::f64::consts::PI;

/// GGX-rough boundary of a transparent solid; z > 0 is outside (Walter et al. 2007).
///
/// # Energy
/// Write `n(w)` for the index on the side of `w` and `f` for the function in radiance mode. A
/// closed space of uniform light holds radiance `L n^2` in a medium of index `n`. A surface that
/// absorbs nothing cannot be seen in it: for every `wo`,
/// `integral f(wo, wi) |cos wi| n(wi)^2 dwi = n(wo)^2`. With generalised reciprocity,
/// `f(wo, wi) / n(wo)^2` symmetric, this is the same as: in importance mode
/// `integral f(wo, wi) |cos wi| dwi = 1`, no particle is lost.
///
/// # Compensation
/// Single scattering misses `l(wo)`. Given back is `n(wo)^2 c l(wo) l(wi)` in radiance mode, with
/// a constant `c` for each pair of sides, the same in both directions. With
/// `m = pi n^2 (mean of l)` on each side, no loss means `c_tt m_t + c_td m_d = 1` and
/// `c_td m_t + c_dd m_d = 1` for the thinner and the denser side; what is left free is the share
/// that changes sides, taken from the mean Fresnel transmittances.
///
/// # Dispersion
/// Facets bend by the hero's index, and the compensation's shares are the hero's; reflection by a
/// facet has each lane's own Fresnel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughDielectric {
    interface: Interface,
    ggx: Ggx,
    compensation: Option<Compensation>,
}

impl RoughDielectric {
    /// GGX roughness.
    #[inline]
    pub fn alpha(&self) -> f64 {
        self.ggx.alpha()
    }

    /// From the media and `alpha` in `[SMOOTH_ALPHA, 1]` (clamped). The hero's index ratio must
    /// not be 1, where facets have no effect (the [`Bsdf`](crate::Bsdf) constructor sees to it).
    #[inline]
    pub fn new(interface: Interface, alpha: f64, compensation: bool) -> Self {
        let ggx = Ggx::new(alpha);
        let compensation = compensation.then(|| Compensation::new(&interface, ggx.alpha()));
        Self {
            interface,
            ggx,
            compensation,
        }
    }

    /// Probability of scattering between facets, which is the share lost by one facet.
    #[inline]
    fn rebound_probability(&self, wo: DVec3) -> f64 {
        self.compensation.map_or(0.0, |c| c.loss(wo))
    }

    /// Reflection by one facet, the same in both modes, and its density.
    #[inline]
    fn reflect_once(&self, wo: DVec3, wi: DVec3) -> (Spectrum, f64) {
        let h = (wo + wi).normalize();
        let cosine = wo.dot(h).min(1.0);
        let split = self.interface.split(cosine, wo.z > 0.0);
        let lobe = 0.25 * self.ggx.density(h) * self.ggx.shadowing(wo, wi);
        let pdf = 0.25 * split.reflect * self.ggx.visible_pdf(wo, h) / cosine;
        (split.reflected * (lobe as f32), pdf)
    }

    /// Refraction by one facet in radiance mode, and its density; zero where no facet can do it.
    #[inline]
    fn refract_once(&self, wo: DVec3, wi: DVec3) -> (Spectrum, f64) {
        let ahead = self.interface.ahead(wo);
        let Some(h) = refracting_normal(wo, wi, ahead) else {
            return (Spectrum::ZERO, 0.0);
        };
        let (co, ci) = (wo.dot(h), -wi.dot(h));
        if co <= 0.0 || ci <= 0.0 {
            return (Spectrum::ZERO, 0.0);
        }
        let split = self.interface.split(co.min(1.0), wo.z > 0.0);
        if split.beyond <= 0.0 {
            return (Spectrum::ZERO, 0.0);
        }
        let stretch = co - ahead * ci; // sqrt of the half vector's Jacobian, Walter (17)
        let jacobian = ci / (stretch * stretch);
        let lobe = jacobian * co * self.ggx.density(h) * self.ggx.shadowing(wo, wi);
        let visible = self.ggx.visible_pdf(wo, h);
        let pdf = (1.0 - split.reflect) * visible * ahead * ahead * jacobian;
        (split.transmitted * (lobe as f32), pdf)
    }

    /// The share of a loss that is given back from a direction. Where a finish reflects otherwise than
    /// Fresnel's share the loss is another (at most by that of as much reflected light), which the tables do
    /// not know; and no light must be made.
    #[inline]
    fn given_back(&self, c: &Compensation, w: DVec3, loss: f64) -> f64 {
        if c.known >= 1.0 {
            return loss;
        }
        let mu = w.z.abs().min(1.0);
        let other = self.interface.finish_changes(mu, w.z > 0.0);
        let reflected = f64::from(reflector_loss(mu, self.ggx.alpha()).loss);
        f64::from(c.known) * (loss - other * reflected).max(0.0)
    }

    /// Value in radiance mode and density.
    #[inline]
    fn both(&self, wo: DVec3, wi: DVec3) -> (Spectrum, f64) {
        let transmits = wo.z * wi.z < 0.0;
        let once = if transmits {
            self.refract_once(wo, wi)
        } else {
            self.reflect_once(wo, wi)
        };
        let Some(c) = self.compensation else {
            return once;
        };
        let tint = if transmits {
            self.interface.transmitted()
        } else {
            self.interface.reflected()
        };
        let (lo, li) = (c.loss(wo), c.loss(wi));
        let [given, got] = [(wo, lo), (wi, li)].map(|(w, loss)| self.given_back(&c, w, loss));
        let again = c.pair(wo, wi) * c.squared_index(wo) * given * got;
        let pdf = c.way.pdf(wi.z.abs()) * c.share(wo, wi);
        (
            once.0 + tint * (again as f32),
            (1.0 - lo) * once.1 + lo * pdf,
        )
    }

    /// From radiance mode, which carries `n(wo)^2`, to either mode (Veach 1997 ch. 5).
    #[inline]
    fn in_mode(&self, wo: DVec3, wi: DVec3, radiance: Spectrum, mode: Mode) -> Spectrum {
        if wo.z * wi.z > 0.0 || mode == Mode::Radiance {
            return radiance;
        }
        let ahead = self.interface.ahead(wo);
        radiance * ((ahead * ahead) as f32)
    }

    /// Draws a direction by one facet.
    #[inline]
    fn sample_once(&self, wo: DVec3, uc: f64, u: [f64; 2]) -> DVec3 {
        let up = local::lift(wo);
        let h = self.ggx.visible(up, u);
        let cosine = up.dot(h).clamp(0.0, 1.0);
        let split = self.interface.split(cosine, wo.z > 0.0);
        let wi = if uc < split.reflect {
            let wi = local::reflect(up, h);
            // lost if it points down: a second facet is met
            if wi.z > 0.0 { wi } else { DVec3::ZERO }
        } else {
            let wi = refract(up, h, cosine, split.beyond, self.interface.ahead(wo));
            if wi.z < 0.0 { wi } else { DVec3::ZERO }
        };
        local::to_side_of(wo, wi)
    }
}

/// The facet normal, on `wo`'s side, that refracts `wo` into `wi`.
#[inline]
fn refracting_normal(wo: DVec3, wi: DVec3, ahead: f64) -> Option<DVec3> {
    let sum = wo + wi * ahead;
    let length = sum.length();
    if length < 1e-9 {
        return None; // no bend at all
    }
    let h = sum / length;
    Some(if h.z * wo.z < 0.0 { -h } else { h })
}

impl Lobe for RoughDielectric {
    #[inline]
    fn eval(&self, wo: DVec3, wi: DVec3, mode: Mode) -> Spectrum {
        if !local::usable(wo) || !local::usable(wi) {
            return Spectrum::ZERO;
        }
        self.in_mode(wo, wi, self.both(wo, wi).0, mode)
    }

    #[inline]
    fn pdf(&self, wo: DVec3, wi: DVec3, _mode: Mode) -> f64 {
        if !local::usable(wo) || !local::usable(wi) {
            return 0.0;
        }
        self.both(wo, wi).1
    }

    #[inline]
    fn sample(&self, wo: DVec3, uc: f64, u: [f64; 2], mode: Mode) -> Option<Sample> {
        if !local::usable(wo) {
            return None;
        }
        let (again, uc) = local::choose(uc, self.rebound_probability(wo));
        let wi = match self.compensation {
            Some(c) if again => c.sample(wo, uc, u),
            _ => self.sample_once(wo, uc, u),
        };
        if !local::usable(wi) {
            return None;
        }
        let dispersive = self.dispersive_between(wo, wi);
        let (radiance, pdf) = self.both(wo, wi);
        let f = self.in_mode(wo, wi, radiance, mode);
        Some(Sample {
            dispersive,
            ..Sample::continuous(wo, wi, f, pdf)?
        })
    }

    #[inline]
    fn albedo(&self, wo: DVec3) -> Spectrum {
        // exact where untinted and compensated
        let split = self.interface.split(wo.z.abs().min(1.0), wo.z > 0.0);
        split.reflected + split.transmitted
    }

    #[inline]
    fn dispersive_between(&self, wo: DVec3, wi: DVec3) -> bool {
        self.interface.dispersive() && wo.z * wi.z < 0.0
    }
}

/// What scatters between facets, see [`RoughDielectric`].
#[derive(Clone, Copy, Debug, PartialEq)]
struct Compensation {
    place: InterfaceLoss,
    way: Rebound,
    /// Is the outside, z > 0, the thinner medium?
    thin_outside: bool,
    /// Squared index of the denser medium over the thinner's.
    squared: f64,
    /// `c` of thin-thin, across, dense-dense.
    pairs: [f64; 3],
    /// Probability of changing sides from the thinner and from the denser.
    cross: [f64; 2],
    /// How far the tables hold, in `[0, 1]`, for each end of a scattering: 1 without a finish.
    known: f32,
}

/// How fast trust in the tables falls with the mean change that a finish makes. With 3 some finishes made up
/// to 0.8 % more light than there was (the test of energy); with this none makes half a percent.
const DISTRUST: f64 = 8.0;

impl Compensation {
    fn new(interface: &Interface, alpha: f64) -> Self {
        let eta = f64::from(interface.eta().hero());
        let n = eta.max(1.0 / eta);
        let squared = n * n;
        let place = InterfaceLoss::new(n, alpha);
        let [thin, dense] = place.means().map(f64::from);
        let (mt, md) = ((PI * thin).max(1e-12), (PI * squared * dense).max(1e-12));
        // Transmittances wanted from either side; their sum is met, each nearly, as the two
        // conditions of the shares leave one number free.
        let [reflected, otherwise] = interface
            .finished_mean()
            .unwrap_or_else(|| [fresnel::mean_dielectric(n), 0.0]);
        let out = 1.0 - reflected;
        let within = out / squared;
        let across = ((out + within) / (mt + md)).min(1.0 / mt).min(1.0 / md);
        Self {
            place,
            way: Rebound::new(alpha),
            thin_outside: eta >= 1.0,
            squared,
            pairs: [(1.0 - across * md) / mt, across, (1.0 - across * mt) / md],
            cross: [across * md, across * mt],
            known: (1.0 - DISTRUST * otherwise).max(0.0) as f32,
        }
    }

    /// 0 on the thinner side, 1 on the denser.
    #[inline]
    fn side(&self, w: DVec3) -> usize {
        usize::from((w.z > 0.0) != self.thin_outside)
    }

    #[inline]
    fn squared_index(&self, w: DVec3) -> f64 {
        if self.side(w) == 0 { 1.0 } else { self.squared }
    }

    /// Share of light from `w` that single scattering loses.
    #[inline]
    fn loss(&self, w: DVec3) -> f64 {
        f64::from(interface_loss(self.place, w.z.abs(), self.side(w)))
    }

    #[inline]
    fn pair(&self, wo: DVec3, wi: DVec3) -> f64 {
        self.pairs[self.side(wo) + self.side(wi)]
    }

    /// Probability of the side of `wi` once light from `wo` scatters between facets.
    #[inline]
    fn share(&self, wo: DVec3, wi: DVec3) -> f64 {
        let cross = self.cross[self.side(wo)];
        if wo.z * wi.z < 0.0 {
            cross
        } else {
            1.0 - cross
        }
    }

    #[inline]
    fn sample(&self, wo: DVec3, uc: f64, u: [f64; 2]) -> DVec3 {
        let wi = local::to_side_of(wo, self.way.sample(u));
        if uc < self.cross[self.side(wo)] {
            local::flip(wi)
        } else {
            wi
        }
    }
}
