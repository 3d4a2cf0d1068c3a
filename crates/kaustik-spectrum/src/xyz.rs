//! Tristimulus values of the CIE 1931 observer.

use std::iter::Sum;
use std::ops::{Add, AddAssign, Mul};

use crate::Rgb;
use crate::rgb::{RGB_TO_XYZ, matrix};

/// CIE XYZ, normalised so that the spectrum that is 1 everywhere has Y = 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Xyz(pub [f32; 3]);

impl Xyz {
    /// No light.
    pub const ZERO: Self = Self([0.0; 3]);

    /// X + Y + Z: the chain's target in RELT 5.1.1, which sees every visible wavelength.
    #[inline]
    pub fn sum(self) -> f32 {
        let [x, y, z] = self.0;
        x + y + z
    }

    /// Y.
    #[inline]
    pub fn luminance(self) -> f32 {
        self.0[1]
    }

    /// Are all three finite?
    #[inline]
    pub fn is_finite(self) -> bool {
        self.0.iter().all(|c| c.is_finite())
    }

    /// Chromaticity (x, y); not a number for no light.
    pub fn xy(self) -> [f32; 2] {
        let sum = self.sum();
        [self.0[0] / sum, self.0[1] / sum]
    }
}

impl From<Rgb> for Xyz {
    #[inline]
    fn from(rgb: Rgb) -> Self {
        Self(matrix(&RGB_TO_XYZ, rgb.0))
    }
}

impl Add for Xyz {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|c| self.0[c] + other.0[c]))
    }
}

impl AddAssign for Xyz {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Mul<f32> for Xyz {
    type Output = Self;
    #[inline]
    fn mul(self, factor: f32) -> Self {
        Self(self.0.map(|c| c * factor))
    }
}

impl Sum for Xyz {
    fn sum<I: Iterator<Item = Self>>(items: I) -> Self {
        items.fold(Self::ZERO, Add::add)
    }
}
