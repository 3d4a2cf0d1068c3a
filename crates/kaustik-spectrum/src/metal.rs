//! Metals as measured.

use crate::data::metals;
use crate::guide::Guide;
use crate::{Spectrum, Wavelengths};

/// A metal with measured complex index of refraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Metal {
    /// Silver, Johnson and Christy 1972.
    Ag,
    /// Gold, Johnson and Christy 1972.
    Au,
    /// Copper, Johnson and Christy 1972.
    Cu,
    /// Aluminium, Rakic 1995.
    Al,
}

impl Metal {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Ag, Self::Au, Self::Cu, Self::Al];

    /// By its name in scene files, in any case: `ag`, `au`, `cu`, `al`.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|metal| metal.name().eq_ignore_ascii_case(name))
    }

    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ag => "ag",
            Self::Au => "au",
            Self::Cu => "cu",
            Self::Al => "al",
        }
    }

    /// n and k at one wavelength; absorption means k > 0. Linear between the measured knots, which
    /// span the visible range.
    #[inline]
    pub fn at(self, nm: f32) -> [f32; 2] {
        match self {
            Self::Ag => AG.at(nm),
            Self::Au => AU.at(nm),
            Self::Cu => CU.at(nm),
            Self::Al => AL.at(nm),
        }
    }

    /// n and k at a path's wavelengths.
    #[inline]
    pub fn eta_k(self, wavelengths: &Wavelengths) -> (Spectrum, Spectrum) {
        let nk = wavelengths.nm().map(|nm| self.at(nm));
        (
            Spectrum::new(nk.map(|v| v[0])),
            Spectrum::new(nk.map(|v| v[1])),
        )
    }
}

static AG: Measured<18> = Measured::new(&metals::AG);
static AU: Measured<18> = Measured::new(&metals::AU);
static CU: Measured<18> = Measured::new(&metals::CU);
static AL: Measured<15> = Measured::new(&metals::AL);

struct Measured<const N: usize> {
    nm: [f32; N],
    nk: [[f32; 2]; N],
    guide: Guide,
}

impl<const N: usize> Measured<N> {
    const fn new(table: &[[f64; 3]; N]) -> Self {
        let (mut nm, mut nk) = ([0.0; N], [[0.0; 2]; N]);
        let mut i = 0;
        while i < N {
            nm[i] = table[i][0] as f32;
            nk[i] = [table[i][1] as f32, table[i][2] as f32];
            i += 1;
        }
        Self {
            nm,
            nk,
            guide: Guide::new(&nm),
        }
    }

    #[inline]
    fn at(&self, nm: f32) -> [f32; 2] {
        let (i, s) = self.guide.find(&self.nm, nm);
        let (a, b) = (self.nk[i], self.nk[(i + 1).min(N - 1)]);
        [a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])]
    }
}
