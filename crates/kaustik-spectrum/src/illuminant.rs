//! Standard illuminants of the CIE.

use crate::cmf::{KNOTS, NM_MIN, integrate};
use crate::data::illuminants;
use crate::{Spectrum, Wavelengths};

/// A standard light, scaled to Y = 1: as a radiance it has the luminance of the constant 1.
///
/// Linear between the tabulated 5 nm steps. D50 is tabulated to 780 nm, FL2 and FL11 from
/// 380 to 780 nm; beyond, the end values hold, where the eye sees less than a thousandth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Illuminant {
    /// A tungsten lamp of 2856 K, xy (0.4476, 0.4074).
    A,
    /// Daylight of the printing trade.
    D50,
    /// Noon daylight, the white of Rec.709 and sRGB, xy (0.3127, 0.3290).
    D65,
    /// Equal energy: the constant 1.
    E,
    /// A cool white fluorescent lamp: broad, with mercury lines.
    Fl2,
    /// A three-band fluorescent lamp: spikes, the hard case for sampled wavelengths.
    Fl11,
}

impl Illuminant {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::A,
        Self::D50,
        Self::D65,
        Self::E,
        Self::Fl2,
        Self::Fl11,
    ];

    /// By its name in scene files, in any case: `a`, `d50`, `d65`, `e`, `fl2`, `fl11`.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|light| light.name().eq_ignore_ascii_case(name))
    }

    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::A => "a",
            Self::D50 => "d50",
            Self::D65 => "d65",
            Self::E => "e",
            Self::Fl2 => "fl2",
            Self::Fl11 => "fl11",
        }
    }

    /// The value at one wavelength.
    #[inline]
    pub fn at(self, nm: f32) -> f32 {
        match self {
            Self::A => A.at(nm),
            Self::D50 => D50.at(nm),
            Self::D65 => D65.at(nm),
            Self::E => 1.0,
            Self::Fl2 => FL2.at(nm),
            Self::Fl11 => FL11.at(nm),
        }
    }

    /// The values at a path's wavelengths.
    #[inline]
    pub fn eval(self, wavelengths: &Wavelengths) -> Spectrum {
        match self {
            // The light of every emitter that is given as a colour.
            Self::D65 => wavelengths.interpolate(&D65_DENSE),
            _ => Spectrum::new(wavelengths.nm().map(|nm| self.at(nm))),
        }
    }
}

static A: Steps<95> = Steps::new(&illuminants::A, 360.0);
static D50: Steps<85> = Steps::new(&illuminants::D50, 360.0);
static D65: Steps<95> = Steps::new(&illuminants::D65, 360.0);
static FL2: Steps<81> = Steps::new(&illuminants::FL2, 380.0);
static FL11: Steps<81> = Steps::new(&illuminants::FL11, 380.0);

/// D65 at the 1 nm knots, scaled to Y = 1, in double precision: what matrices and uplift stand on.
pub(crate) const D65_KNOTS: [f64; KNOTS] = normalised(&illuminants::D65, 360.0);

/// The same in single precision.
static D65_DENSE: [f32; KNOTS] = {
    let mut out = [0.0; KNOTS];
    let mut i = 0;
    while i < KNOTS {
        out[i] = D65_KNOTS[i] as f32;
        i += 1;
    }
    out
};

/// Values in steps of 5 nm, scaled to Y = 1.
struct Steps<const N: usize> {
    first_nm: f32,
    values: [f32; N],
}

impl<const N: usize> Steps<N> {
    const fn new(table: &[f64; N], first_nm: f32) -> Self {
        let scale = luminance_scale(table, first_nm);
        let mut values = [0.0; N];
        let mut i = 0;
        while i < N {
            values[i] = (table[i] * scale) as f32;
            i += 1;
        }
        Self { first_nm, values }
    }

    #[inline]
    fn at(&self, nm: f32) -> f32 {
        let x = ((nm - self.first_nm) * 0.2).clamp(0.0, (N - 1) as f32);
        let i = (x as usize).min(N - 2);
        let (a, b) = (self.values[i], self.values[i + 1]);
        a + (x - i as f32) * (b - a)
    }
}

const fn luminance_scale<const N: usize>(table: &[f64; N], first_nm: f32) -> f64 {
    1.0 / integrate(&at_knots(table, first_nm))[1]
}

const fn normalised<const N: usize>(table: &[f64; N], first_nm: f32) -> [f64; KNOTS] {
    let scale = luminance_scale(table, first_nm);
    let mut out = at_knots(table, first_nm);
    let mut i = 0;
    while i < KNOTS {
        out[i] *= scale;
        i += 1;
    }
    out
}

/// A table in steps of 5 nm at the 1 nm knots.
const fn at_knots<const N: usize>(table: &[f64; N], first_nm: f32) -> [f64; KNOTS] {
    let skipped = (first_nm - NM_MIN) as usize;
    let mut out = [0.0; KNOTS];
    let mut k = 0;
    while k < KNOTS {
        let steps = k.saturating_sub(skipped);
        let i = steps / 5;
        out[k] = if i + 1 < N {
            let s = (steps % 5) as f64 / 5.0;
            table[i] + s * (table[i + 1] - table[i])
        } else {
            table[N - 1]
        };
        k += 1;
    }
    out
}
