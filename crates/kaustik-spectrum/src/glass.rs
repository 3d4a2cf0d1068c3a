//! Clear solids and liquids whose index of refraction depends on wavelength.

use crate::data::glasses::GLASSES;
use crate::{NM_MAX, NM_MIN, Spectrum, SpectrumError, Wavelengths};

/// How the index of refraction depends on wavelength. L below is the wavelength in micrometres.
///
/// Build one with [`Glass::named`], [`Glass::sellmeier`], [`Glass::abbe`] or [`Glass::constant`], which
/// check their input; the variants are open for matching.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Glass {
    /// The same at all wavelengths; paths keep their four wavelengths.
    Constant(f32),
    /// n^2 = 1 + sum of B L^2 / (L^2 - C), C in square micrometres; unused terms have B = 0.
    Sellmeier {
        /// Strengths.
        b: [f32; 4],
        /// Resonances, in square micrometres.
        c: [f32; 4],
    },
    /// n = A + B / L^2.
    Cauchy {
        /// The index at long wavelengths.
        a: f32,
        /// In square micrometres.
        b: f32,
    },
    /// n^2 = a0 L^4 + a1 L^2 + a2 + a3 L^-2 + a4 L^-4 + a5 L^-6 + a6 L^-8.
    Polynomial {
        /// Coefficients, of L^4 first.
        a: [f32; 7],
    },
}

impl Glass {
    /// Pairs that a Sellmeier formula may have.
    pub const SELLMEIER_TERMS: usize = 4;

    /// A measured material by name, in any case; [`Glass::names`] lists them. `None` if unknown.
    ///
    /// Where a measured fit does not reach 360 or 830 nm, its formula is extrapolated.
    pub fn named(name: &str) -> Option<Self> {
        let known = |entry: &&(&str, Self)| entry.0.eq_ignore_ascii_case(name);
        GLASSES.iter().find(known).map(|&(_, glass)| glass)
    }

    /// The names that [`Glass::named`] knows.
    pub fn names() -> impl ExactSizeIterator<Item = &'static str> {
        GLASSES.iter().map(|&(name, _)| name)
    }

    /// The same index at all wavelengths.
    ///
    /// # Errors
    /// An index that is not finite or below 0.1.
    pub fn constant(ior: f32) -> Result<Self, SpectrumError> {
        Self::Constant(ior).checked()
    }

    /// A Sellmeier formula, C in square micrometres.
    ///
    /// # Errors
    /// Unequal numbers of B and C, none or more than four, an index that is not finite or
    /// below 0.1 somewhere in 360-830 nm, or a resonance there (a C of which the root lies within, whose B is not 0).
    pub fn sellmeier(b: &[f32], c: &[f32]) -> Result<Self, SpectrumError> {
        if b.len() != c.len() || b.is_empty() || b.len() > Self::SELLMEIER_TERMS {
            let most = Self::SELLMEIER_TERMS;
            return Err(SpectrumError::SellmeierTerms {
                b: b.len(),
                c: c.len(),
                most,
            });
        }
        let padded = |terms: &[f32]| std::array::from_fn(|i| terms.get(i).copied().unwrap_or(0.0));
        let micrometres = |nm: f32| nm * 1e-3;
        let (least, most) = (micrometres(NM_MIN), micrometres(NM_MAX));
        let resonant =
            |(&b, &c): (&f32, &f32)| b != 0.0 && (least * least..=most * most).contains(&c);
        if let Some((_, &c)) = b.iter().zip(c).find(|term| resonant(*term)) {
            let nm = 1e3 * c.sqrt();
            return Err(SpectrumError::Ior {
                ior: f32::INFINITY,
                nm,
            });
        }
        Self::Sellmeier {
            b: padded(b),
            c: padded(c),
        }
        .checked()
    }

    /// Cauchy's formula through the index `nd` at 587.5618 nm with the Abbe number
    /// Vd = (nd - 1) / (nF - nC). glTF's `KHR_materials_dispersion` stores 20 / Vd; its 0 is
    /// [`Glass::constant`].
    ///
    /// # Errors
    /// An Abbe number that is not positive, or an index that is not finite or below 0.1.
    pub fn abbe(nd: f32, abbe_number: f32) -> Result<Self, SpectrumError> {
        if abbe_number.is_nan() || abbe_number <= 0.0 {
            return Err(SpectrumError::Abbe(abbe_number));
        }
        const D2: f64 = 0.587_561_8 * 0.587_561_8;
        const F2: f64 = 0.486_132_7 * 0.486_132_7;
        const C2: f64 = 0.656_272_5 * 0.656_272_5;
        let (nd, abbe_number) = (f64::from(nd), f64::from(abbe_number));
        let b = (nd - 1.0) / (abbe_number * (1.0 / F2 - 1.0 / C2));
        Self::Cauchy {
            a: (nd - b / D2) as f32,
            b: b as f32,
        }
        .checked()
    }

    /// The index at one wavelength.
    #[inline]
    pub fn at(&self, nm: f32) -> f32 {
        let um = nm * 1e-3;
        let l2 = um * um;
        match self {
            Self::Constant(ior) => *ior,
            Self::Sellmeier { b, c } => sellmeier(b, c, l2),
            Self::Cauchy { a, b } => a + b / l2,
            Self::Polynomial { a } => {
                let r = 1.0 / l2;
                let negative = a[2] + r * (a[3] + r * (a[4] + r * (a[5] + r * a[6])));
                (l2 * (l2 * a[0] + a[1]) + negative).sqrt()
            }
        }
    }

    /// The index at a path's wavelengths.
    #[inline]
    pub fn ior(&self, wavelengths: &Wavelengths) -> Spectrum {
        match self {
            Self::Constant(ior) => Spectrum::splat(*ior),
            _ => Spectrum::new(wavelengths.nm().map(|nm| self.at(nm))),
        }
    }

    /// Does the index depend on wavelength? Then refraction leaves the hero alone.
    #[inline]
    pub fn is_dispersive(&self) -> bool {
        match self {
            Self::Constant(_) => false,
            Self::Cauchy { b, .. } => *b != 0.0,
            Self::Sellmeier { .. } | Self::Polynomial { .. } => true,
        }
    }

    /// Refuse formulas that leave the physical numbers anywhere in the visible range.
    fn checked(self) -> Result<Self, SpectrumError> {
        let steps = (NM_MAX - NM_MIN) as u16;
        for step in 0..=steps {
            let nm = NM_MIN + f32::from(step);
            let ior = self.at(nm);
            if !ior.is_finite() || ior < 0.1 {
                return Err(SpectrumError::Ior { ior, nm });
            }
        }
        Ok(self)
    }
}

#[inline]
fn sellmeier(b: &[f32; 4], c: &[f32; 4], l2: f32) -> f32 {
    let term = |i: usize| b[i] * l2 / (l2 - c[i]);
    (1.0 + ((term(0) + term(1)) + (term(2) + term(3)))).sqrt()
}
