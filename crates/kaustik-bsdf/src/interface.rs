use crate::fresnel;
use glam::DVec3;
use kaustik_spectrum::Spectrum;

/// The boundary between two transparent media: index ratio and tints.
///
/// What smooth and rough, solid and thin glass have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interface {
    eta: Spectrum,
    reflected: Spectrum,
    transmitted: Spectrum,
    dispersive: bool,
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
        Split::new(self, lanes, hero, beyond)
    }
}

/// Reflection and refraction at one facet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Split {
    /// Share reflected, tinted, each lane.
    pub(crate) reflected: Spectrum,
    /// Share transmitted, tinted. Fresnel's share is the hero's in all lanes.
    pub(crate) transmitted: Spectrum,
    /// Cosine of the refracted hero to the facet's normal, 0 under total reflection.
    pub(crate) beyond: f64,
    /// Probability with which reflection is chosen: by the mean over lanes, 1 where the hero
    /// reflects totally. The same from both sides, because Fresnel's reflectance is.
    pub(crate) reflect: f64,
}

impl Split {
    #[inline]
    fn new(interface: &Interface, lanes: Spectrum, hero: f64, beyond: f64) -> Self {
        let reflected = interface.reflected * lanes;
        let transmitted = interface.transmitted * ((1.0 - hero) as f32);
        let mean = f64::from(lanes.mean());
        let r = mean * f64::from(interface.reflected.mean());
        let t = (1.0 - mean) * f64::from(interface.transmitted.mean());
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
