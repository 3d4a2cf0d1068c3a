//! The test of a block: up to eight triangles against one ray, watertight.
//!
//! After Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection" (2013): corners are seen from the origin and
//! sheared so that the ray becomes an axis; the signs of the three edge functions decide. Two triangles that share an
//! edge compute the same edge function of the same rounded corners, so that no ray passes between them. Where single
//! precision does not decide, [`super::precise`] does.

use super::lanes::Lanes;
use super::node::{BLOCK, Block};
use super::prepared::Prepared;
use super::{Goal, Level, precise};
use crate::{Hit, Ray};

/// Bound on the rounding of the volume that tells on which side of a triangle a point lies, as a multiple of the sizes
/// involved. About 60 roundings of 2^-24 for the volume, as many for the determinant times `t`.
const DOUBT: f32 = 1.0 / 131_072.0;

/// Offers the hits in a block; whether the goal asked to stop.
#[inline(always)]
pub(crate) fn meet_block<L: Lanes<BLOCK>, G: Goal, const PLACED: bool>(
    block: &Block,
    count: u32,
    level: &Level<'_>,
    ray: &Prepared,
    goal: &mut G,
) -> bool {
    let place = level.place.filter(|_| PLACED);
    let zero = L::splat(0.0);
    let a = sheared::<L>(block, ray, 0);
    let b = sheared::<L>(block, ray, 1);
    let c = sheared::<L>(block, ray, 2);
    let u = c[0].mul(b[1]).sub(c[1].mul(b[0]));
    let v = a[0].mul(c[1]).sub(a[1].mul(c[0]));
    let w = b[0].mul(a[1]).sub(b[1].mul(a[0]));
    let (least, most) = (u.min(v).min(w), u.max(v).max(w));
    let inside = !(least.lt(zero) & zero.lt(most)) & ((1 << count) - 1);
    if inside == 0 {
        return false;
    }
    let det = u.add(v).add(w);
    let height = u.mul(a[2]).add(v.mul(b[2])).add(w.mul(c[2]));
    let height = height.mul(L::splat(ray.shear.z));
    let t = height.div(det);
    // An edge function that is zero or undefined decides nothing.
    let touched = inside & !(zero.lt(least) | most.lt(zero));
    let doubtful = touched | (inside & !clear_of_ends(block, ray, level.ray, height, det, t));
    let range = L::splat(goal.low()).le(t) & t.le(L::splat(goal.high()));
    let mut mask = (inside & range) | doubtful;
    if mask == 0 {
        return false;
    }
    let (t, v, w, det) = (t.store(), v.store(), w.store(), det.store());
    while mask != 0 {
        let lane = mask.trailing_zeros() as usize;
        mask &= mask - 1;
        let mut t = t[lane];
        if doubtful >> lane & 1 == 1 {
            match precise::plane(block, lane, level.ray, place) {
                Some(precise) => t = precise as f32,
                None => continue,
            }
        }
        let (mut u, mut v) = (v[lane] / det[lane], w[lane] / det[lane]);
        if touched >> lane & 1 == 1 {
            match precise::weights(block, lane, ray) {
                Some(precise) => (u, v) = (precise.0 as f32, precise.1 as f32),
                None => continue,
            }
        }
        let hit = Hit {
            t,
            u,
            v,
            instance: place.map_or(block.instances[lane], |p| p.instance),
            primitive: block.primitives[lane],
        };
        if goal.low() <= t && t <= goal.high() && goal.offer(hit) {
            return true;
        }
    }
    false
}

/// A corner of each triangle, seen from the ray's origin along the ray.
#[inline(always)]
fn sheared<L: Lanes<BLOCK>>(block: &Block, ray: &Prepared, corner: usize) -> [L; 3] {
    let z = shifted::<L>(block, ray, corner, 2);
    let x = shifted::<L>(block, ray, corner, 0).sub(L::splat(ray.shear.x).mul(z));
    let y = shifted::<L>(block, ray, corner, 1).sub(L::splat(ray.shear.y).mul(z));
    [x, y, z]
}

#[inline(always)]
fn shifted<L: Lanes<BLOCK>>(block: &Block, ray: &Prepared, corner: usize, axis: usize) -> L {
    L::load(&block.corners[corner][ray.axes[axis]]).sub(L::splat(ray.turned_origin[axis]))
}

/// Lanes whose plane is certainly on the side of the ray's two ends where single precision puts it. Only asked of
/// triangles that the ray passes through, so that none of their corners is further from it than their size.
#[inline(always)]
fn clear_of_ends<L: Lanes<BLOCK>>(
    block: &Block,
    ray: &Prepared,
    ends: &Ray,
    height: L,
    det: L,
    t: L,
) -> u32 {
    // Sheared, a corner is off the ray by at most twice the size; along it by the size besides the hit's distance.
    let size = L::load(&block.sizes);
    let across = size.add(size);
    let reach = t.abs().mul(L::splat(ray.stride)).add(across.add(size));
    let bound = across
        .mul(reach)
        .mul(reach.add(L::splat(ray.blur)))
        .mul(L::splat(ray.shear.z.abs() * DOUBT));
    let clear = bound.lt(height.sub(det.mul(L::splat(ends.t_min))).abs());
    if ends.t_max < f32::INFINITY {
        clear & bound.lt(height.sub(det.mul(L::splat(ends.t_max))).abs())
    } else {
        clear
    }
}
