//! [`Lanes`] of eight in one 256-bit register.
//!
//! # Safety
//! Every operation here needs a processor with AVX2. They are methods of a private type that only the two
//! walks use; these are reached through an [`Available`] alone, which is made only where the processor has
//! been asked. The operations are `inline(always)` so that they become part of a walk, which is compiled for
//! AVX2.

use std::arch::x86_64::*;

use crate::bvh::walk::walk_with;

use super::{Goal, Kernel, Lanes, Level};

/// Evidence that the processor has AVX2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Available(());

impl Available {
    pub(crate) fn detect() -> Option<Available> {
        std::arch::is_x86_feature_detected!("avx2").then_some(Available(()))
    }

    #[inline(always)]
    pub(crate) fn walk<G: Goal>(self, level: &Level<'_>, goal: &mut G) -> bool {
        // SAFETY: `self` is evidence that the processor has AVX2.
        unsafe { walk(level, goal) }
    }
}

#[target_feature(enable = "avx2")]
fn walk<G: Goal>(level: &Level<'_>, goal: &mut G) -> bool {
    walk_with::<Avx2, G, false>(level, goal)
}

#[target_feature(enable = "avx2")]
fn walk_placed<G: Goal>(level: &Level<'_>, goal: &mut G) -> bool {
    walk_with::<Avx2, G, true>(level, goal)
}

struct Avx2;

impl Kernel for Avx2 {
    type Node = Eight;
    type Block = Eight;

    #[inline(always)]
    fn fetch(address: *const u8) {
        for line in 0..4 {
            // SAFETY: a hint; it reads nothing, whatever the address.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(address.wrapping_add(line * 64).cast()) };
        }
    }

    #[inline(always)]
    fn walk_placed<G: Goal>(level: &Level<'_>, goal: &mut G) -> bool {
        // SAFETY: called only from within a walk with AVX2.
        unsafe { walk_placed(level, goal) }
    }
}

#[derive(Clone, Copy)]
struct Eight(__m256);

/// A method that is one intrinsic.
macro_rules! forward {
    ($name:ident, $intrinsic:ident) => {
        #[inline(always)]
        fn $name(self, other: Self) -> Self {
            // SAFETY: see the module.
            Eight(unsafe { $intrinsic(self.0, other.0) })
        }
    };
}

impl Lanes<8> for Eight {
    #[inline(always)]
    fn splat(x: f32) -> Self {
        // SAFETY: see the module.
        Eight(unsafe { _mm256_set1_ps(x) })
    }

    #[inline(always)]
    fn load(values: &[f32; 8]) -> Self {
        // SAFETY: see the module; the reference is to 32 readable bytes.
        Eight(unsafe { _mm256_loadu_ps(values.as_ptr()) })
    }

    #[inline(always)]
    fn store(self) -> [f32; 8] {
        let mut values = [0.0; 8];
        // SAFETY: see the module; the reference is to 32 writable bytes.
        unsafe { _mm256_storeu_ps(values.as_mut_ptr(), self.0) };
        values
    }

    forward!(add, _mm256_add_ps);
    forward!(sub, _mm256_sub_ps);
    forward!(mul, _mm256_mul_ps);
    forward!(div, _mm256_div_ps);
    forward!(min, _mm256_min_ps);
    forward!(max, _mm256_max_ps);

    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see the module.
        Eight(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }

    #[inline(always)]
    fn lt(self, other: Self) -> u32 {
        // SAFETY: see the module.
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0)) as u32 }
    }

    #[inline(always)]
    fn le(self, other: Self) -> u32 {
        // SAFETY: see the module.
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0)) as u32 }
    }
}
