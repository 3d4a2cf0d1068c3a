//! Linear Rec.709, and the transfer function of sRGB.
//!
//! The matrices are derived here, at compile time, from the chromaticities of Rec.709's primaries and
//! from this crate's own integral of D65, rather than copied: rounded published matrices would
//! turn D65 into (0.9999, 1.0000, 1.0002) and a furnace test into a search for that error.

use std::iter::Sum;
use std::ops::{Add, AddAssign, Mul};

use crate::Xyz;
use crate::cmf::integrate;
use crate::illuminant::D65_KNOTS;

/// Linear Rec.709 (the linear light of sRGB). D65 with Y = 1 is `Rgb([1.0; 3])`; colours outside
/// the gamut have components below 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rgb(pub [f32; 3]);

impl Rgb {
    /// No light.
    pub const ZERO: Self = Self([0.0; 3]);
    /// D65 with Y = 1.
    pub const WHITE: Self = Self([1.0; 3]);

    /// The largest component.
    #[inline]
    pub fn max(self) -> f32 {
        let [r, g, b] = self.0;
        r.max(g).max(b)
    }

    /// Are all three finite?
    #[inline]
    pub fn is_finite(self) -> bool {
        self.0.iter().all(|c| c.is_finite())
    }
}

impl From<Xyz> for Rgb {
    #[inline]
    fn from(xyz: Xyz) -> Self {
        Self(matrix(&XYZ_TO_RGB, xyz.0))
    }
}

impl Add for Rgb {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|c| self.0[c] + other.0[c]))
    }
}

impl AddAssign for Rgb {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Mul<f32> for Rgb {
    type Output = Self;
    #[inline]
    fn mul(self, factor: f32) -> Self {
        Self(self.0.map(|c| c * factor))
    }
}

impl Sum for Rgb {
    fn sum<I: Iterator<Item = Self>>(items: I) -> Self {
        items.fold(Self::ZERO, Add::add)
    }
}

/// The value in [0, 1] (an 8-bit code divided by 255) that sRGB stores, to linear light. IEC
/// 61966-2-1; values above 1 follow the same curve, negative ones are mirrored.
pub fn srgb_to_linear(encoded: f32) -> f32 {
    let x = f64::from(encoded).abs();
    let linear = if x <= 0.04045 {
        x / 12.92
    } else {
        libm::pow((x + 0.055) / 1.055, 2.4)
    };
    (linear as f32).copysign(encoded)
}

/// Linear light to the value that sRGB stores, the inverse of [`srgb_to_linear`].
pub fn linear_to_srgb(linear: f32) -> f32 {
    let x = f64::from(linear).abs();
    let encoded = if x <= 0.0031308 {
        12.92 * x
    } else {
        1.055 * libm::pow(x, 1.0 / 2.4) - 0.055
    };
    (encoded as f32).copysign(linear)
}

/// Rows give X, Y, Z.
pub(crate) const RGB_TO_XYZ: [[f64; 3]; 3] = rgb_to_xyz();
/// Rows give R, G, B.
pub(crate) const XYZ_TO_RGB: [[f64; 3]; 3] = inverse(&RGB_TO_XYZ);
/// XYZ of D65 with Y = 1.
pub(crate) const WHITE_XYZ: [f64; 3] = integrate(&D65_KNOTS);

#[inline]
pub(crate) fn matrix(m: &[[f64; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    let v = v.map(f64::from);
    std::array::from_fn(|r| (m[r][0] * v[0] + m[r][1] * v[1] + m[r][2] * v[2]) as f32)
}

/// Primaries at Rec.709's chromaticities, scaled so that their sum is D65.
const fn rgb_to_xyz() -> [[f64; 3]; 3] {
    const XY: [[f64; 2]; 3] = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]];
    let mut unscaled = [[0.0; 3]; 3];
    let mut p = 0;
    while p < 3 {
        let [x, y] = XY[p];
        unscaled[0][p] = x / y;
        unscaled[1][p] = 1.0;
        unscaled[2][p] = (1.0 - x - y) / y;
        p += 1;
    }
    let inverse = inverse(&unscaled);
    let mut out = unscaled;
    let mut p = 0;
    while p < 3 {
        let [a, b, c] = inverse[p];
        let scale = a * WHITE_XYZ[0] + b * WHITE_XYZ[1] + c * WHITE_XYZ[2];
        out[0][p] *= scale;
        out[1][p] *= scale;
        out[2][p] *= scale;
        p += 1;
    }
    out
}

const fn inverse(m: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let mut out = [[0.0; 3]; 3];
    let mut r = 0;
    while r < 3 {
        let (r1, r2) = ((r + 1) % 3, (r + 2) % 3);
        let mut c = 0;
        while c < 3 {
            let (c1, c2) = ((c + 1) % 3, (c + 2) % 3);
            out[c][r] = m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1]; // cofactors, transposed
            c += 1;
        }
        r += 1;
    }
    let det = m[0][0] * out[0][0] + m[0][1] * out[1][0] + m[0][2] * out[2][0];
    let mut i = 0;
    while i < 9 {
        out[i / 3][i % 3] /= det;
        i += 1;
    }
    out
}
