use std::ops::{Add, AddAssign, Div, DivAssign, Index, Mul, MulAssign, Neg, Sub, SubAssign};

/// Values at the four wavelengths that a path carries; lane 0 is the hero.
///
/// The unit is the caller's: a reflectance, a throughput, a radiance. Arithmetic is lane by
/// lane. The alignment lets a lane-wise operation become one vector instruction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(16))]
pub struct Spectrum([f32; Spectrum::LANES]);

impl Spectrum {
    /// Wavelengths a path.
    pub const LANES: usize = 4;
    /// Zero everywhere.
    pub const ZERO: Self = Self([0.0; Self::LANES]);
    /// One everywhere.
    pub const ONE: Self = Self([1.0; Self::LANES]);

    /// From the four lanes.
    #[inline]
    pub const fn new(lanes: [f32; Self::LANES]) -> Self {
        Self(lanes)
    }

    /// The same value in every lane.
    #[inline]
    pub const fn splat(value: f32) -> Self {
        Self([value; Self::LANES])
    }

    /// Lane `i` is `f(i)`.
    #[inline]
    pub fn from_fn(f: impl FnMut(usize) -> f32) -> Self {
        Self(std::array::from_fn(f))
    }

    /// The four lanes.
    #[inline]
    pub const fn lanes(self) -> [f32; Self::LANES] {
        self.0
    }

    /// The value at the hero wavelength.
    #[inline]
    pub const fn hero(self) -> f32 {
        self.0[0]
    }

    /// Mean over the lanes: what lobe choice and roulette go by.
    #[inline]
    pub fn mean(self) -> f32 {
        let [a, b, c, d] = self.0;
        ((a + b) + (c + d)) * 0.25
    }

    /// Largest lane; a NaN lane is passed over.
    #[inline]
    pub fn max(self) -> f32 {
        let [a, b, c, d] = self.0;
        a.max(b).max(c.max(d))
    }

    /// Smallest lane; a NaN lane is passed over.
    #[inline]
    pub fn min(self) -> f32 {
        let [a, b, c, d] = self.0;
        a.min(b).min(c.min(d))
    }

    /// Is every lane exactly zero?
    #[inline]
    pub fn is_zero(self) -> bool {
        let [a, b, c, d] = self.0;
        a == 0.0 && b == 0.0 && c == 0.0 && d == 0.0
    }

    /// Is every lane finite?
    #[inline]
    pub fn is_finite(self) -> bool {
        self.0.iter().all(|lane| lane.is_finite())
    }

    /// `f` of each lane.
    #[inline]
    pub fn map(self, mut f: impl FnMut(f32) -> f32) -> Self {
        // Spelled out: the standard library's `map` of arrays is not always inlined.
        let [a, b, c, d] = self.0;
        Self([f(a), f(b), f(c), f(d)])
    }

    /// `f` of each pair of lanes.
    #[inline]
    pub fn zip(self, other: Self, mut f: impl FnMut(f32, f32) -> f32) -> Self {
        let ([a, b, c, d], [e, g, h, i]) = (self.0, other.0);
        Self([f(a, e), f(b, g), f(c, h), f(d, i)])
    }

    /// Square root of each lane.
    #[inline]
    pub fn sqrt(self) -> Self {
        self.map(f32::sqrt)
    }

    /// Each lane clamped to `[low, high]`.
    #[inline]
    pub fn clamp(self, low: f32, high: f32) -> Self {
        self.map(|lane| lane.clamp(low, high))
    }

    /// `self + (other - self) t`.
    #[inline]
    pub fn lerp(self, other: Self, t: f32) -> Self {
        self + (other - self) * t
    }
}

impl Index<usize> for Spectrum {
    type Output = f32;
    #[inline]
    fn index(&self, lane: usize) -> &f32 {
        &self.0[lane]
    }
}

impl Neg for Spectrum {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.map(|lane| -lane)
    }
}

macro_rules! lane_wise {
    ($($op:ident $f:ident $assign:ident $g:ident $sign:tt;)*) => {$(
        impl $op for Spectrum {
            type Output = Self;
            #[inline]
            fn $f(self, other: Self) -> Self {
                self.zip(other, |a, b| a $sign b)
            }
        }
        impl $op<f32> for Spectrum {
            type Output = Self;
            #[inline]
            fn $f(self, other: f32) -> Self {
                self.map(|a| a $sign other)
            }
        }
        impl $op<Spectrum> for f32 {
            type Output = Spectrum;
            #[inline]
            fn $f(self, other: Spectrum) -> Spectrum {
                other.map(|b| self $sign b)
            }
        }
        impl $assign for Spectrum {
            #[inline]
            fn $g(&mut self, other: Self) {
                *self = *self $sign other;
            }
        }
        impl $assign<f32> for Spectrum {
            #[inline]
            fn $g(&mut self, other: f32) {
                *self = *self $sign other;
            }
        }
    )*};
}

lane_wise! {
    Add add AddAssign add_assign +;
    Sub sub SubAssign sub_assign -;
    Mul mul MulAssign mul_assign *;
    Div div DivAssign div_assign /;
}

impl std::iter::Sum for Spectrum {
    fn sum<I: Iterator<Item = Self>>(items: I) -> Self {
        items.fold(Self::ZERO, Add::add)
    }
}
