//! A spectrum measured at some wavelengths.

use std::sync::Arc;

use crate::cmf::{KNOTS, NM_MAX, NM_MIN};
use crate::data::cornell;
use crate::guide::Guide;
use crate::{Spectrum, SpectrumError, Wavelengths};

/// A spectrum given by knots: linear between them, constant outside. Cheap to clone.
///
/// The unit is the caller's: a reflectance, a radiance, an absorption coefficient.
#[derive(Clone, Debug)]
pub struct Tabulated(Arc<Table>);

#[derive(Debug)]
struct Table {
    nm: Box<[f32]>,
    values: Box<[f32]>,
    guide: Guide,
    /// The values at 360, 361, ..., 830 nm, if all knots within the visible
    /// range are whole nanometres: then linear interpolation between these is the same function.
    dense: Option<Box<[f32; KNOTS]>>,
}

impl Tabulated {
    /// From pairs of a wavelength in nm and a value.
    ///
    /// # Errors
    /// No knot at all, more than 65,535, a number that is not finite, a value below 0, or wavelengths
    /// that do not ascend strictly; the error names the first offending knot.
    pub fn new(knots: Vec<(f32, f32)>) -> Result<Self, SpectrumError> {
        check(&knots)?;
        let (nm, values): (Vec<f32>, Vec<f32>) = knots.into_iter().unzip();
        Ok(Self::trusted(nm, values))
    }

    /// A table that comes with the crate: `cornell-white`, `cornell-red`, `cornell-green`
    /// (reflectances of the physical Cornell box, 400-700 nm) or `cornell-light` (its lamp, in
    /// arbitrary units). `None` for any other name.
    pub fn named(name: &str) -> Option<Self> {
        let reflectance = |values: &[f64]| {
            let nm = (0..values.len()).map(|i| 400.0 + 4.0 * i as f32).collect();
            Self::trusted(nm, values.iter().map(|&v| v as f32).collect())
        };
        match name {
            "cornell-white" => Some(reflectance(&cornell::WHITE)),
            "cornell-red" => Some(reflectance(&cornell::RED)),
            "cornell-green" => Some(reflectance(&cornell::GREEN)),
            "cornell-light" => {
                let (nm, values) = cornell::LIGHT
                    .iter()
                    .map(|k| (k[0] as f32, k[1] as f32))
                    .unzip();
                Some(Self::trusted(nm, values))
            }
            _ => None,
        }
    }

    /// The names that [`Tabulated::named`] knows.
    pub const NAMES: [&'static str; 4] = [
        "cornell-white",
        "cornell-red",
        "cornell-green",
        "cornell-light",
    ];

    /// The value at one wavelength.
    #[inline]
    pub fn at(&self, nm: f32) -> f32 {
        self.0.at(nm)
    }

    /// The values at a path's wavelengths.
    #[inline]
    pub fn eval(&self, wavelengths: &Wavelengths) -> Spectrum {
        match &self.0.dense {
            Some(dense) => wavelengths.interpolate(dense),
            None => Spectrum::new(wavelengths.nm().map(|nm| self.at(nm))),
        }
    }

    /// The knots, ascending.
    pub fn knots(&self) -> impl ExactSizeIterator<Item = (f32, f32)> + '_ {
        self.0.nm.iter().copied().zip(self.0.values.iter().copied())
    }

    /// The largest value; a reflectance must not exceed 1.
    pub fn max(&self) -> f32 {
        self.0
            .values
            .iter()
            .fold(0.0, |most, &value| value.max(most))
    }

    /// The same shape times a factor.
    ///
    /// # Errors
    /// A value that leaves the finite numbers or 0 and above.
    pub fn scaled(&self, factor: f32) -> Result<Self, SpectrumError> {
        Self::new(
            self.knots()
                .map(|(nm, value)| (nm, value * factor))
                .collect(),
        )
    }

    fn trusted(nm: Vec<f32>, values: Vec<f32>) -> Self {
        let guide = Guide::new(&nm);
        let broken = |nm: &f32| (NM_MIN..=NM_MAX).contains(nm) && nm.fract() != 0.0;
        let is_dense = !nm.iter().any(broken);
        let mut table = Table {
            nm: nm.into(),
            values: values.into(),
            guide,
            dense: None,
        };
        if is_dense {
            let at = |i: usize| table.at(NM_MIN + i as f32);
            table.dense = Some(Box::new(std::array::from_fn(at)));
        }
        Self(Arc::new(table))
    }
}

impl Table {
    fn at(&self, nm: f32) -> f32 {
        let (i, s) = self.guide.find(&self.nm, nm);
        let a = self.values[i];
        if s == 0.0 {
            a
        } else {
            a + s * (self.values[i + 1] - a)
        }
    }
}

/// Equal if the knots are.
impl PartialEq for Tabulated {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
            || (self.0.nm == other.0.nm && self.0.values == other.0.values)
    }
}

fn check(knots: &[(f32, f32)]) -> Result<(), SpectrumError> {
    if knots.is_empty() {
        return Err(SpectrumError::NoKnots);
    }
    if knots.len() > Guide::MOST {
        return Err(SpectrumError::TooManyKnots {
            given: knots.len(),
            most: Guide::MOST,
        });
    }
    for (index, &(nm, value)) in knots.iter().enumerate() {
        if !nm.is_finite() || !value.is_finite() {
            return Err(SpectrumError::NotFinite { index, nm, value });
        }
        if value < 0.0 {
            return Err(SpectrumError::Negative { index, nm, value });
        }
        if index > 0 && knots[index - 1].0 >= nm {
            return Err(SpectrumError::NotSorted {
                index,
                nm,
                before: knots[index - 1].0,
            });
        }
    }
    Ok(())
}
