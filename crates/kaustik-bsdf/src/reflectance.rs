use crate::ggx::{FacetLoss, Ggx};
use crate::{ThinFilm, fresnel};
use glam::DVec3;
use kaustik_spectrum::Spectrum;

/// How an opaque interface reflects at each angle: measured metal, or two colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reflectance {
    /// Index `eta - i k` relative to the medium outside, each lane; both at least 0.
    Conductor {
        /// Real part of the index.
        eta: Spectrum,
        /// Extinction, the imaginary part's size.
        k: Spectrum,
    },
    /// Schlick's formula from the colours at normal incidence and at grazing.
    Schlick {
        /// Reflectance at normal incidence, each lane in `[0, 1]`.
        f0: Spectrum,
        /// Reflectance at grazing, each lane in `[0, 1]`.
        f90: Spectrum,
    },
    /// A thin film over what Schlick's colours describe.
    Filmed(ThinFilm),
}

impl Reflectance {
    /// Share reflected at an angle of incidence of the given cosine in `[0, 1]`.
    #[inline]
    pub fn at(&self, cosine: f64) -> Spectrum {
        match *self {
            Self::Conductor { eta, k } => fresnel::conductor(cosine, eta, k),
            Self::Schlick { f0, f90 } => f0.lerp(f90, fresnel::schlick_weight(cosine) as f32),
            Self::Filmed(ref film) => film.at(cosine),
        }
    }

    /// The same where what Schlick's formula describes rises by `rise`, each lane, in place of Schlick's weight: from
    /// normal incidence, 0, to grazing, 1.
    pub(crate) fn at_rise(&self, cosine: f64, rise: Spectrum) -> Spectrum {
        match *self {
            Self::Conductor { .. } => self.at(cosine),
            Self::Schlick { f0, f90 } => f0 + (f90 - f0) * rise,
            Self::Filmed(ref film) => film.at_rise(cosine, rise),
        }
    }

    /// Cosine-weighted mean over the hemisphere, `2` times the integral of `F(mu) mu dmu`.
    #[inline]
    pub fn mean(&self) -> Spectrum {
        match *self {
            // 2 * integral of (1 - mu)^5 mu = 1/21
            Self::Schlick { f0, f90 } => f0.lerp(f90, 1.0 / 21.0),
            Self::Conductor { .. } | Self::Filmed(_) => mean_of_lanes(|mu| self.at(mu)),
        }
    }

    /// Share that facets send back at once of light from a direction of this cosine.
    #[inline]
    pub(crate) fn once(&self, at: FacetLoss, cosine: f64) -> Spectrum {
        match *self {
            Self::Schlick { f0, f90 } => f0 * (1.0 - at.loss - at.edge) + f90 * at.edge,
            Self::Conductor { .. } => self.at(cosine) * (1.0 - at.loss),
            Self::Filmed(ref film) => film.at(at.mean_cosine()) * (1.0 - at.loss),
        }
    }

    /// The same for who hands on the rest: of a film the larger of two guesses, at the direction and at the facets'
    /// mean, so that what lies below gets too little and never too much.
    #[inline]
    pub(crate) fn once_at_most(&self, at: FacetLoss, cosine: f64) -> Spectrum {
        let once = self.once(at, cosine);
        match self {
            Self::Filmed(film) => once.zip(film.at(cosine) * (1.0 - at.loss), f32::max),
            _ => once,
        }
    }

    /// Its cosine-weighted mean over the hemisphere; `mean` is the facets' [mean loss](Ggx::mean_loss).
    #[inline]
    pub(crate) fn mean_once(&self, ggx: Ggx, mean: FacetLoss) -> Spectrum {
        if let Self::Schlick { .. } = self {
            return self.once(mean, 1.0); // linear in both colours
        }
        mean_of_lanes(|mu| self.once(ggx.loss(DVec3::new(0.0, 0.0, mu)), mu))
    }
}

/// Cosine-weighted mean of `f` over the hemisphere, `2` times the integral of `f(mu) mu dmu`.
pub(crate) fn mean_of(f: impl Fn(f64) -> f64) -> f64 {
    GAUSS.iter().map(|&(mu, weight)| weight * f(mu)).sum()
}

/// The same, each lane.
pub(crate) fn mean_of_lanes(f: impl Fn(f64) -> Spectrum) -> Spectrum {
    GAUSS
        .iter()
        .map(|&(mu, weight)| f(mu) * (weight as f32))
        .sum()
}

/// Five-point Gauss rule for the weight `2 mu` on `[0, 1]`: points and weights.
const GAUSS: [(f64, f64); 5] = [
    (0.098_535_085_798_826_42, 0.031_495_829_043_384_55),
    (0.304_535_726_646_363_9, 0.147_817_740_145_233_34),
    (0.562_025_189_752_613_8, 0.292_773_974_169_339_6),
    (0.801_986_582_126_391_8, 0.334_349_276_188_739_1),
    (0.960_190_142_948_531_3, 0.193_563_180_453_303_36),
];
