use crate::reflectance::mean_of;
use crate::{Reflectance, fresnel};
use glam::DVec3;
use kaustik_spectrum::Spectrum;

/// The boundary between two transparent media: index ratio, tints, and perhaps a finish.
///
/// What smooth and rough, solid and thin glass have in common.
///
/// # Finish
/// An interface reflects as its index says, by Fresnel's equations. A finish makes it reflect otherwise: the
/// exact curve is stretched so that it runs between the finish's own reflectances at normal incidence and at
/// grazing (`KHR_materials_specular`), or there is a film (`KHR_materials_iridescence`). What it does not
/// reflect passes. Bending remains the index's, and total reflection is total. From both sides the same share
/// is reflected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interface {
    eta: Spectrum,
    reflected: Spectrum,
    transmitted: Spectrum,
    dispersive: bool,
    finish: Option<Reflectance>,
}

impl Interface {
    /// From the index inside (z < 0) over the index outside (z > 0), each lane, and tints in
    /// `[0, 1]` which multiply reflected and transmitted light at each encounter.
    ///
    /// It is dispersive if the lanes of `eta` differ. An index that is not positive and finite
    /// is taken as 1.
    #[inline]
    pub fn new(eta: Spectrum, reflected: Spectrum, transmitted: Spectrum) -> Self {
        let eta = eta.map(|n| if n > 0.0 && n.is_finite() { n } else { 1.0 });
        // lanes come from one computation at equal wavelengths, so equal means bit-equal
        let dispersive = eta
            .lanes()
            .iter()
            .any(|n| n.to_bits() != eta.hero().to_bits());
        Self {
            eta,
            reflected,
            transmitted,
            dispersive,
            finish: None,
        }
    }

    /// The same with a finish, seen from the outside.
    pub fn with_finish(self, finish: Reflectance) -> Self {
        Self {
            finish: Some(finish),
            ..self
        }
    }

    /// Untinted, see [`new`](Self::new).
    #[inline]
    pub fn clear(eta: Spectrum) -> Self {
        Self::new(eta, Spectrum::ONE, Spectrum::ONE)
    }

    /// Index ratio inside over outside, each lane.
    #[inline]
    pub fn eta(&self) -> Spectrum {
        self.eta
    }

    /// Does the index differ between the lanes?
    #[inline]
    pub fn dispersive(&self) -> bool {
        self.dispersive
    }

    /// Does the hero bend at all? An index ratio of nearly 1 has no facets to speak of.
    #[inline]
    pub(crate) fn bends(&self) -> bool {
        (self.eta.hero() - 1.0).abs() > 1e-4
    }

    /// Tint of reflected light.
    #[inline]
    pub fn reflected(&self) -> Spectrum {
        self.reflected
    }

    /// Tint of transmitted light.
    #[inline]
    pub fn transmitted(&self) -> Spectrum {
        self.transmitted
    }

    /// The hero's index on the far side over the index on the side of `w`.
    #[inline]
    pub(crate) fn ahead(&self, w: DVec3) -> f64 {
        let eta = f64::from(self.eta.hero());
        if w.z > 0.0 { eta } else { 1.0 / eta }
    }

    /// Shares reflected, untinted, where Fresnel's are these, at a facet that is seen at the cosine `outside` from
    /// outside.
    #[inline]
    pub(crate) fn finished(&self, fresnel: Spectrum, outside: f64) -> Spectrum {
        let Some(finish) = &self.finish else {
            return fresnel;
        };
        let rise = self.eta.zip(fresnel, |eta, share| {
            let least = fresnel::normal_incidence(f64::from(eta));
            ((f64::from(share) - least) / (1.0 - least)).clamp(0.0, 1.0) as f32
        });
        let finished = finish.at_rise(outside, rise);
        finished.zip(
            fresnel,
            |finished, share| if share < 1.0 { finished } else { 1.0 },
        )
    }

    /// What a finish reflects, and Fresnel's share, at a facet met at `cosine` from the outside or the
    /// inside, with the hero's index.
    fn both_shares(&self, cosine: f64, outside: bool) -> (Spectrum, f32) {
        let eta = f64::from(self.eta.hero());
        let ahead = if outside { eta } else { 1.0 / eta };
        let (share, beyond) = fresnel::dielectric(cosine, ahead);
        let share = share as f32;
        let outside = if outside { cosine } else { beyond };
        (self.finished(Spectrum::splat(share), outside), share)
    }

    /// By how much a finish reflects otherwise than Fresnel's share at a facet met at `cosine` from the outside or the
    /// inside: the most in any lane.
    pub(crate) fn finish_changes(&self, cosine: f64, outside: bool) -> f64 {
        let (finished, share) = self.both_shares(cosine, outside);
        f64::from((finished - Spectrum::splat(share)).map(f32::abs).max())
    }

    /// Cosine-weighted means over the hemisphere of the thinner medium, with the hero's index: of what a
    /// finish reflects, over all lanes, and of what it [changes](Self::finish_changes). `None` without one.
    pub(crate) fn finished_mean(&self) -> Option<[f64; 2]> {
        self.finish?;
        let outside = self.eta.hero() >= 1.0;
        Some([
            mean_of(|mu| f64::from(self.both_shares(mu, outside).0.mean())),
            mean_of(|mu| self.finish_changes(mu, outside)),
        ])
    }

    /// What happens at a facet met at `cosine` in `[0, 1]` from the outside or the inside.
    #[inline]
    pub(crate) fn split(&self, cosine: f64, outside: bool) -> Split {
        let ahead = |eta: f32| {
            if outside {
                f64::from(eta)
            } else {
                1.0 / f64::from(eta)
            }
        };
        let (hero, beyond) = fresnel::dielectric(cosine, ahead(self.eta.hero()));
        let lanes = if self.dispersive {
            self.eta
                .map(|eta| fresnel::dielectric(cosine, ahead(eta)).0 as f32)
        } else {
            Spectrum::splat(hero as f32)
        };
        if self.finish.is_some() {
            let outside = if outside { cosine } else { beyond };
            let reflected = self.finished(lanes, outside);
            let passed = 1.0 - self.finished(Spectrum::splat(hero as f32), outside);
            let means = [reflected, passed].map(|share| f64::from(share.mean()));
            return Split::new(self, [reflected, passed], means, beyond);
        }
        let passed = Spectrum::splat((1.0 - hero) as f32);
        let mean = f64::from(lanes.mean());
        Split::new(self, [lanes, passed], [mean, 1.0 - mean], beyond)
    }
}

/// Reflection and refraction at one facet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Split {
    /// Share reflected, tinted, each lane.
    pub(crate) reflected: Spectrum,
    /// Share transmitted, tinted. Fresnel's share is the hero's in all lanes, as all go where the hero goes.
    pub(crate) transmitted: Spectrum,
    /// Cosine of the refracted hero to the facet's normal, 0 under total reflection.
    pub(crate) beyond: f64,
    /// Probability with which reflection is chosen: by the mean over lanes, 1 where the hero
    /// reflects totally. The same from both sides where the lanes agree, because Fresnel's reflectance is.
    pub(crate) reflect: f64,
}

impl Split {
    /// From the untinted shares that are reflected and passed on, and the means that the choice goes by.
    #[inline]
    fn new(
        interface: &Interface,
        [reflected, passed]: [Spectrum; 2],
        means: [f64; 2],
        beyond: f64,
    ) -> Self {
        let reflected = interface.reflected * reflected;
        let transmitted = interface.transmitted * passed;
        let r = means[0] * f64::from(interface.reflected.mean());
        let t = means[1] * f64::from(interface.transmitted.mean());
        let reflect = if beyond <= 0.0 {
            1.0
        } else if r + t > 0.0 {
            r / (r + t)
        } else {
            0.5
        };
        Self {
            reflected,
            transmitted,
            beyond,
            reflect,
        }
    }
}

/// Refracts `w` at the facet normal `h`, `ahead` = index beyond over index on `w`'s side.
///
/// `cosine = w.h > 0` and `beyond` the refracted cosine; the result points away from the surface.
#[inline]
pub(crate) fn refract(w: DVec3, h: DVec3, cosine: f64, beyond: f64, ahead: f64) -> DVec3 {
    (h * (cosine / ahead - beyond) - w / ahead).normalize()
}
