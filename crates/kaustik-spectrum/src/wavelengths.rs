//! The wavelengths of a path.
//!
//! Four of them, from one random number u: lane i stands at the inverse CDF of frac(u + i/4), so
//! any hero takes three companions along that are spread over the whole range (hero wavelength
//! sampling, rotated in u and not in nm, so that every lane has the same law).
//!
//! **The pdf** is proportional to |rbar| + |gbar| + |bbar|, the matching functions of linear Rec.709, and a
//! small floor. Two noises count: that of X + Y + Z, the chain's target, since a target that
//! depends on the wavelength rejects changes of it; and that of the image's RGB. Standard deviation
//! over mean, of the estimate from four lanes, for whole D65 / D65 seen in a saturated red, green,
//! blue reflectance:
//!
//! | pdf proportional to | X + Y + Z | linear RGB |
//! |---|---|---|
//! | 1 | 0.35 / 0.67, 0.93, 0.78 | 0.70 / 0.76, 1.11, 0.88 |
//! | ybar | 0.97 / 0.34, 0.12, 2.45 | 1.60 / 0.45, 0.19, 2.63 |
//! | xbar + ybar + zbar | 0.01 / 0.28, 0.46, 0.22 | 0.25 / 0.37, 0.71, 0.27 |
//! | root of the squares of rbar, gbar, bbar | 0.07 / 0.18, 0.25, 0.18 | 0.20 / 0.22, 0.41, 0.21 |
//! | abs(rbar) + abs(gbar) + abs(bbar) | 0.03 / 0.15, 0.20, 0.13 | 0.19 / 0.20, 0.26, 0.18 |
//!
//! The sum of xbar, ybar, zbar makes a grey path's target exactly flat, but crowds the blue, where
//! zbar is large, and starves the green. The last row leaves a white path's target 3 % and is best or
//! near it everywhere else. XYZ is linear in RGB, so the weights are bounded by a matrix norm. The
//! floor keeps the pdf above 0 to the ends of the range, so that the map from u to nm is
//! continuous and invertible.

mod sampler;

pub use sampler::WavelengthSampling;

use sampler::Drawn;

use crate::cmf::{CMF, KNOTS, Y_INTEGRAL, cell};
use crate::{NM_MIN, Spectrum, Xyz};

/// A path's four wavelengths with what their use needs, worked out once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wavelengths {
    nm: Spectrum,
    t: Spectrum,
    pdf: Spectrum,
    /// Where tables of whole nanometres are read: see [`Wavelengths::interpolate`].
    cells: [u32; Spectrum::LANES],
    fractions: Spectrum,
    /// For each lane, matching functions over pdf, over the integral of ybar, over the number of
    /// lanes: X, Y, Z and nothing.
    weights: [Spectrum; Spectrum::LANES],
}

impl Wavelengths {
    /// The wavelengths of a random number in [0, 1).
    ///
    /// With [`WavelengthSampling::Hero`] lane i has the inverse CDF of frac(u + i/4); with
    /// [`WavelengthSampling::Single`] all lanes have 400 + 300 u nm.
    #[inline]
    pub fn sample(u: f64, sampling: WavelengthSampling) -> Self {
        let shares = match sampling {
            WavelengthSampling::Hero => [0.0, 0.25, 0.5, 0.75].map(|lane| {
                let shifted = u + lane;
                if shifted >= 1.0 {
                    shifted - 1.0
                } else {
                    shifted
                }
            }),
            WavelengthSampling::Single => [u; Spectrum::LANES],
        };
        Self::build(sampling.inverse(shares))
    }

    /// One wavelength in all lanes, with pdf 1: `to_xyz` gives the matching functions over the
    /// integral of ybar. For plots, tests and laser light; nm within 360-830 (clamped).
    pub fn monochromatic(nm: f32) -> Self {
        let nm = nm.clamp(NM_MIN, crate::NM_MAX);
        Self::build(Drawn {
            nm: Spectrum::splat(nm),
            pdf: Spectrum::ONE,
            cells: [cell(nm).0 as u32; Spectrum::LANES],
        })
    }

    /// Wavelength of each lane, in nm, within 360-830.
    #[inline]
    pub const fn nm(&self) -> [f32; Spectrum::LANES] {
        self.nm.lanes()
    }

    /// (nm - 360) / 470 of each lane, in [0, 1]: the variable of [`Sigmoid`](crate::Sigmoid).
    #[inline]
    pub const fn t(&self) -> Spectrum {
        self.t
    }

    /// Density of a lane's wavelength, per nm; the same law for all lanes. `lane` below 4.
    #[inline]
    pub const fn pdf(&self, lane: usize) -> f32 {
        self.pdf.lanes()[lane]
    }

    /// Mean over the lanes of value x matching functions / (pdf x integral of ybar): an unbiased
    /// estimate of the XYZ of the spectrum that has these values.
    ///
    /// With [`WavelengthSampling::Single`], of the part of it within 400-700 nm, under the same normalisation:
    /// the rest is simply not seen, as in RELT, and no factor makes up for it. White
    /// then has Y = 0.9996 and xy (0.3127, 0.3295): brightness is comparable with
    /// [`WavelengthSampling::Hero`] without a switch anywhere.
    #[inline]
    pub fn to_xyz(&self, values: Spectrum) -> Xyz {
        let [a, b, c, d] = values.lanes();
        let [first, second, third, fourth] = self.weights;
        let [x, y, z, _] = ((first * a + second * b) + (third * c + fourth * d)).lanes();
        Xyz([x, y, z])
    }

    /// The same from lane 0 alone, with weight 1: for paths on which only the hero survived
    /// refraction. Unbiased, with a single wavelength's noise.
    #[inline]
    pub fn hero_to_xyz(&self, values: Spectrum) -> Xyz {
        let value = values.hero() * Spectrum::LANES as f32;
        let [x, y, z, _] = (self.weights[0] * value).lanes();
        Xyz([x, y, z])
    }

    /// A function that is linear between whole nanometres, given by its values at 360, 361, ..., 830 nm:
    /// its values here.
    #[inline]
    pub(crate) fn interpolate(&self, knots: &[f32; KNOTS]) -> Spectrum {
        // Never more, but only then can the compiler see that it is within the table.
        let cells = self.cells.map(|cell| (cell as usize).min(KNOTS - 2));
        let left = Spectrum::new(cells.map(|cell| knots[cell]));
        let right = Spectrum::new(cells.map(|cell| knots[cell + 1]));
        left + self.fractions * (right - left)
    }

    #[inline]
    fn build(drawn: Drawn) -> Self {
        let Drawn { nm, pdf, cells } = drawn;
        let offset = nm - NM_MIN;
        let fractions = offset - Spectrum::new(cells.map(|cell| cell as f32));
        let scale = const { (1.0 / (Y_INTEGRAL * Spectrum::LANES as f64)) as f32 } / pdf;
        let weights = std::array::from_fn(|lane| {
            let cell = (cells[lane] as usize).min(KNOTS - 2);
            let (a, b) = (Spectrum::new(CMF[cell]), Spectrum::new(CMF[cell + 1]));
            (a + fractions[lane] * (b - a)) * scale[lane]
        });
        Self {
            nm,
            t: offset * const { 1.0 / 470.0 },
            pdf,
            cells,
            fractions,
            weights,
        }
    }
}
