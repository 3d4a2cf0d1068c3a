//! [`Lanes`] of any number, in plain Rust.

use crate::bvh::walk::walk_with;

use super::{BLOCK, Goal, Kernel, Lanes, Level, WIDTH};

#[derive(Clone, Copy)]
pub(crate) struct Portable<const N: usize>([f32; N]);

impl<const N: usize> Portable<N> {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Portable(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    #[inline(always)]
    fn mask(self, other: Self, f: impl Fn(f32, f32) -> bool) -> u32 {
        let mut mask = 0;
        for i in 0..N {
            mask |= u32::from(f(self.0[i], other.0[i])) << i;
        }
        mask
    }
}

impl<const N: usize> Lanes<N> for Portable<N> {
    #[inline(always)]
    fn splat(x: f32) -> Self {
        Portable([x; N])
    }

    #[inline(always)]
    fn load(values: &[f32; N]) -> Self {
        Portable(*values)
    }

    #[inline(always)]
    fn store(self) -> [f32; N] {
        self.0
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Portable(self.0.map(f32::abs))
    }

    #[inline(always)]
    fn lt(self, other: Self) -> u32 {
        self.mask(other, |a, b| a < b)
    }

    #[inline(always)]
    fn le(self, other: Self) -> u32 {
        self.mask(other, |a, b| a <= b)
    }
}

impl Kernel for Portable<WIDTH> {
    type Node = Portable<WIDTH>;
    type Block = Portable<BLOCK>;

    #[inline(always)]
    fn fetch(_: *const u8) {}

    #[inline(never)]
    fn walk_placed<G: Goal>(level: &Level<'_>, goal: &mut G) -> bool {
        walk_with::<Self, G, true>(level, goal)
    }
}

/// Walks the world's tree; whether `goal` asked to stop.
pub(crate) fn walk<G: Goal>(level: &Level<'_>, goal: &mut G) -> bool {
    walk_with::<Portable<WIDTH>, G, false>(level, goal)
}
