//! Emission spectra of RGB colours.

use crate::{Illuminant, Sigmoid, Spectrum, Wavelengths, uplift_reflectance};

/// D65 seen in a smooth reflectance, times a factor: an emission of a wanted colour, any
/// brightness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissionSpectrum {
    /// Factor; at least 0.
    pub scale: f32,
    /// Shape, relative to D65.
    pub shape: Sigmoid,
}

impl EmissionSpectrum {
    /// No light.
    pub const BLACK: Self = Self {
        scale: 0.0,
        shape: Sigmoid::BLACK,
    };

    /// Emission at a path's wavelengths, in the unit of the RGB values.
    #[inline]
    pub fn eval(&self, wavelengths: &Wavelengths) -> Spectrum {
        Illuminant::D65.eval(wavelengths) * self.shape.eval(wavelengths) * self.scale
    }

    /// Emission at one wavelength.
    #[inline]
    pub fn at(&self, nm: f32) -> f32 {
        Illuminant::D65.at(nm) * self.shape.at(nm) * self.scale
    }
}

/// A spectrum whose XYZ is that of a linear Rec.709 colour; components at least 0, any size (below
/// 0 or not finite counts as 0). (1, 1, 1) gives D65 with Y = 1.
///
/// The colour is halved below its largest component before it becomes a reflectance, so that
/// even a pure primary keeps clear of the saturated, bright corner where smooth reflectances
/// turn into steps (after Jakob and Hanika 2019). Looked up ([`uplift_reflectance`]): components are within
/// 0.8 % of the largest one, at worst (a trace of red in blue), and within 0.03 % on average.
pub fn uplift_emission(rgb: [f32; 3]) -> EmissionSpectrum {
    let rgb = rgb.map(|c| if c.is_finite() { c.max(0.0) } else { 0.0 });
    let most = rgb[0].max(rgb[1]).max(rgb[2]);
    if most <= 0.0 {
        return EmissionSpectrum::BLACK;
    }
    let shape = uplift_reflectance(rgb.map(|c| c / most * 0.5));
    EmissionSpectrum {
        scale: most * 2.0,
        shape,
    }
}
