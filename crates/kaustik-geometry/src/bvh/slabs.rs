//! The test of a node: eight boxes against one ray.

use super::lanes::Lanes;
use super::node::{Node, WIDTH};
use super::prepared::Prepared;

/// Which children the ray enters between `low` and `high`, and where.
///
/// Never misses one for rounding: boxes have room (see [`super::build::Leaf::bounds`]), and the far planes' distances
/// are widened by more than three roundings.
#[inline(always)]
pub(crate) fn test_node<L: Lanes<WIDTH>>(
    node: &Node,
    ray: &Prepared,
    low: f32,
    high: f32,
) -> (u32, L) {
    let enter = near::<L>(node, ray, 0)
        .max(near(node, ray, 1))
        .max(near::<L>(node, ray, 2).max(L::splat(low)));
    let leave = far::<L>(node, ray, 0)
        .min(far(node, ray, 1))
        .min(far::<L>(node, ray, 2).min(L::splat(high)));
    (enter.le(leave), enter)
}

/// Where the ray enters the slab of an axis.
#[inline(always)]
fn near<L: Lanes<WIDTH>>(node: &Node, ray: &Prepared, axis: usize) -> L {
    L::load(&node.planes[axis][ray.negative[axis]])
        .sub(L::splat(ray.origin[axis]))
        .mul(L::splat(ray.inverse[axis]))
}

/// Where it leaves.
#[inline(always)]
fn far<L: Lanes<WIDTH>>(node: &Node, ray: &Prepared, axis: usize) -> L {
    L::load(&node.planes[axis][ray.negative[axis] ^ 1])
        .sub(L::splat(ray.origin[axis]))
        .mul(L::splat(ray.inverse_far[axis]))
}
