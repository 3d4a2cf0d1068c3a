//! Smooth reflectances of three numbers (Jakob and Hanika 2019).

use crate::{NM_MIN, Spectrum, Wavelengths};

/// A reflectance S(t) = s(c0 t^2 + c1 t + c2) with s(x) = 1/2 + x / (2 sqrt(1 + x^2)) and
/// t = (nm - 360) / 470: smooth, and inside [0, 1] whatever the numbers are.
///
/// The paper's polynomial in nm loses digits to cancellation in single precision; the one in t
/// does not, and [`Wavelengths::t`] is at hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sigmoid([f32; 3]);

impl Sigmoid {
    /// Absorbs everything: exactly 0.
    pub const BLACK: Self = Self([0.0, 0.0, -f32::MAX]);
    /// Reflects everything: exactly 1.
    pub const WHITE: Self = Self([0.0, 0.0, f32::MAX]);

    /// From the coefficients of t^2, t and 1; finite.
    #[inline]
    pub const fn new(coefficients: [f32; 3]) -> Self {
        Self(coefficients)
    }

    /// The same reflectance at all wavelengths, 0 to 1 (clamped; not a number counts as 0). 0 and 1 are
    /// exact.
    pub fn constant(reflectance: f32) -> Self {
        if reflectance >= 1.0 {
            Self::WHITE
        } else if reflectance > 0.0 {
            let g = f64::from(reflectance);
            Self([0.0, 0.0, ((g - 0.5) / (g * (1.0 - g)).sqrt()) as f32])
        } else {
            Self::BLACK
        }
    }

    /// Coefficients of t^2, t and 1.
    #[inline]
    pub const fn coefficients(self) -> [f32; 3] {
        self.0
    }

    /// Reflectance at one wavelength.
    #[inline]
    pub fn at(self, nm: f32) -> f32 {
        self.at_t((nm - NM_MIN) / 470.0)
    }

    /// Reflectances at a path's wavelengths.
    #[inline]
    pub fn eval(self, wavelengths: &Wavelengths) -> Spectrum {
        wavelengths.t().map(|t| self.at_t(t))
    }

    #[inline]
    fn at_t(self, t: f32) -> f32 {
        let [c0, c1, c2] = self.0;
        sigmoid((c0 * t + c1) * t + c2)
    }
}

/// s(x) by way of the smaller of s(x) and s(-x) = 1 / (2 r (r + |x|)), r = sqrt(1 + x^2), which
/// keeps the relative precision of dark reflectances. Where x^2 overflows, that is 0, so the limits come
/// out exactly and no infinity is divided by another.
#[inline]
fn sigmoid(x: f32) -> f32 {
    let r = (1.0 + x * x).sqrt();
    let small = 0.5 / (r * (r + x.abs()));
    if x < 0.0 { small } else { 1.0 - small }
}
