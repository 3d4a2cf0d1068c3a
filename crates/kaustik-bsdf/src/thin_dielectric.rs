use crate::{Delta, Interface, Lobe, Mode, Passing, Sample, local};
use glam::DVec3;
use kaustik_spectrum::Spectrum;

/// Smooth pane: two parallel interfaces so close that refraction cancels out.
///
/// With `R` of one interface, all inter-reflections sum to `2R/(1+R)` reflected and the rest
/// straight through. Nothing bends, so no wavelength parts from the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinDielectric {
    /// The pane against its surroundings.
    pub interface: Interface,
    /// Is light that goes straight through not scattered at all, but [passing](Self::passing)? Then the pane reflects,
    /// and no more.
    pub passable: bool,
}

impl ThinDielectric {
    /// What of light from `wo` passes without being scattered: nothing unless [`passable`](Self::passable).
    #[inline]
    pub fn passing(&self, wo: DVec3) -> Passing {
        if self.passable && local::usable(wo) {
            let (_, share) = pane(&self.interface, wo.z.abs());
            Passing { share }
        } else {
            Passing::NOTHING
        }
    }

    /// Reflected and transmitted share, and the probability of reflecting.
    #[inline]
    fn shares(&self, wo: DVec3) -> (Spectrum, Spectrum, f64) {
        let (reflected, transmitted) = pane(&self.interface, wo.z.abs());
        if self.passable {
            return (reflected, Spectrum::ZERO, 1.0);
        }
        let p = reflect_probability(reflected, transmitted);
        (reflected, transmitted, p)
    }
}

/// Reflected and transmitted share of a pane, tinted, of a facet met at `cosine`.
#[inline]
pub(crate) fn pane(interface: &Interface, cosine: f64) -> (Spectrum, Spectrum) {
    let one = crate::fresnel::dielectric_lanes(cosine, interface.eta());
    let one = interface.finished(one, cosine);
    let both = one.map(|r| 2.0 * r / (1.0 + r));
    (
        both * interface.reflected(),
        (1.0 - both) * interface.transmitted(),
    )
}

/// Probability of reflecting, by the means over lanes.
#[inline]
pub(crate) fn reflect_probability(reflected: Spectrum, transmitted: Spectrum) -> f64 {
    let (r, t) = (f64::from(reflected.mean()), f64::from(transmitted.mean()));
    if r + t > 0.0 { r / (r + t) } else { 0.5 }
}

impl Lobe for ThinDielectric {
    #[inline]
    fn eval(&self, _wo: DVec3, _wi: DVec3, _mode: Mode) -> Spectrum {
        Spectrum::ZERO
    }

    #[inline]
    fn pdf(&self, _wo: DVec3, _wi: DVec3, _mode: Mode) -> f64 {
        0.0
    }

    #[inline]
    fn sample(&self, wo: DVec3, uc: f64, _u: [f64; 2], _mode: Mode) -> Option<Sample> {
        if !local::usable(wo) {
            return None;
        }
        let (reflected, transmitted, p) = self.shares(wo);
        if uc < p {
            Sample::delta(wo, local::mirror(wo), reflected, p)
        } else {
            Sample::delta(wo, -wo, transmitted, 1.0 - p)
        }
    }

    #[inline]
    fn delta(&self, wo: DVec3, transmitted: bool, _mode: Mode) -> Option<Delta> {
        if !local::usable(wo) {
            return None;
        }
        let (reflected, through, p) = self.shares(wo);
        let sample = if transmitted {
            Sample::delta(wo, -wo, through, 1.0 - p)
        } else {
            Sample::delta(wo, local::mirror(wo), reflected, p)
        };
        sample.as_ref().map(Delta::of)
    }

    #[inline]
    fn albedo(&self, wo: DVec3) -> Spectrum {
        let (reflected, transmitted, _) = self.shares(wo);
        reflected + transmitted
    }

    fn transmits(&self) -> bool {
        !self.passable
    }

    fn is_delta(&self) -> bool {
        true
    }
}
