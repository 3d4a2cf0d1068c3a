//! Several `f32` at once, in two ways that give the same bits.
//!
//! Every test of a node or a block is written once, over [`Lanes`]. The operations are those whose result IEEE 754
//! fixes (no fused multiply-add, no approximate reciprocal), and minimum and maximum are defined as x86 has them, so
//! that it does not matter which implementation runs.

#[cfg(target_arch = "x86_64")]
#[expect(
    unsafe_code,
    reason = "measured: the 8-wide walk is 2 to 3 times as fast with AVX2 as compiled for any x86-64"
)]
mod avx2;
mod portable;

use super::node::{BLOCK, WIDTH};
use super::{Goal, Level};

/// `N` numbers, operated on lane by lane. Masks have one bit a lane.
pub(crate) trait Lanes<const N: usize>: Copy {
    fn splat(x: f32) -> Self;
    fn load(values: &[f32; N]) -> Self;
    fn store(self) -> [f32; N];
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    /// `if self < other { self } else { other }`.
    fn min(self, other: Self) -> Self;
    /// `if self > other { self } else { other }`.
    fn max(self, other: Self) -> Self;
    fn abs(self) -> Self;
    /// Lanes where `self < other`.
    fn lt(self, other: Self) -> u32;
    /// Lanes where `self <= other`.
    fn le(self, other: Self) -> u32;
}

/// A way to walk a tree.
pub(crate) trait Kernel {
    /// For the children of a node.
    type Node: Lanes<WIDTH>;
    /// For the triangles of a block.
    type Block: Lanes<BLOCK>;

    /// Hints that 256 bytes will be read soon. The address may be any.
    fn fetch(address: *const u8);

    /// Walks an instance's tree; whether `goal` asked to stop.
    fn walk_placed<G: Goal>(level: &Level<'_>, goal: &mut G) -> bool;
}

/// Which implementation walks. The answers are the same bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum InstructionSet {
    /// Whatever the compiler makes of plain arrays.
    Portable,
    /// 256-bit vectors. Only [`InstructionSet::detect`] makes it, where the processor has them.
    #[cfg(target_arch = "x86_64")]
    Avx2(avx2::Available),
}

impl InstructionSet {
    /// The fastest that this processor has.
    pub(crate) fn detect() -> InstructionSet {
        #[cfg(target_arch = "x86_64")]
        if let Some(available) = avx2::Available::detect() {
            return InstructionSet::Avx2(available);
        }
        InstructionSet::Portable
    }

    /// Walks the world's tree; whether `goal` asked to stop.
    #[inline(always)]
    pub(crate) fn walk<G: Goal>(self, level: &Level<'_>, goal: &mut G) -> bool {
        match self {
            InstructionSet::Portable => portable::walk(level, goal),
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2(available) => available.walk(level, goal),
        }
    }
}
