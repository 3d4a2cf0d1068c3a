use glam::DVec3;
use kaustik_spectrum::Spectrum;

/// A direction drawn by [`Lobe::sample`](crate::Lobe::sample) and what it is worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// The drawn direction: local frame, unit, away from the surface.
    pub wi: DVec3,
    /// `f |cos wi| / pdf` in the mode asked for; of a delta lobe its share over its probability.
    /// Where [`dispersive`](Self::dispersive) is set only the hero lane means anything; the other
    /// lanes are then of the hero's order, so that a mean over lanes stays a fair measure of size.
    pub weight: Spectrum,
    /// Density per solid angle over all continuous lobes, lobe choice included. Of a delta lobe:
    /// the probability of that lobe.
    pub pdf: f64,
    /// Drawn from a delta lobe (mirror, smooth interface): nothing can be connected here.
    pub delta: bool,
    /// Refracted where the index depends on the wavelength: from here on the hero counts alone.
    pub dispersive: bool,
    /// `wi` lies on the other side of the surface than `wo`.
    pub transmitted: bool,
}

impl Sample {
    /// A sample of a continuous lobe from `f` and `pdf`; `None` unless the density is positive
    /// and finite.
    #[inline]
    pub(crate) fn continuous(wo: DVec3, wi: DVec3, f: Spectrum, pdf: f64) -> Option<Self> {
        let usable = pdf > 0.0 && pdf.is_finite();
        usable.then(|| Self {
            wi,
            weight: f * ((wi.z.abs() / pdf) as f32),
            pdf,
            delta: false,
            dispersive: false,
            transmitted: wo.z * wi.z < 0.0,
        })
    }

    /// A sample of a delta lobe of the given share (`f |cos wi|` over the delta) and probability.
    #[inline]
    pub(crate) fn delta(wo: DVec3, wi: DVec3, share: Spectrum, probability: f64) -> Option<Self> {
        (probability > 0.0).then(|| Self {
            wi,
            weight: share / (probability as f32),
            pdf: probability,
            delta: true,
            dispersive: false,
            transmitted: wo.z * wi.z < 0.0,
        })
    }
}
