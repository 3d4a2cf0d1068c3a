//! The test of a block: up to eight triangles against one ray, watertight.
//!
//! After Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection" (2013): corners are seen from the origin and
//! sheared so that the ray becomes an axis; the signs of the three edge functions decide. Two triangles that share an
//! edge compute the same edge function of the same rounded corners, so that no ray passes between them. Where single
//! precision does not decide, [`super::precise`] does.

use super::lanes::Lanes;
use super::node::{BLOCK, Block};
use super::prepared::Prepared;
use super::{Goal, Level, Place, precise};
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
    let range = [goal.low(), goal.high()];
    let Some(found) = candidates::<L>(block, count, level.ray, ray, range) else {
        return false;
    };
    let place = level.place.filter(|_| PLACED);
    let mut mask = found.mask;
    while mask != 0 {
        let lane = mask.trailing_zeros() as usize;
        mask &= mask - 1;
        let Some(hit) = found.hit(lane, block, level.ray, ray, place) else {
            continue;
        };
        if goal.low() <= hit.t && hit.t <= goal.high() && goal.offer(hit) {
            return true;
        }
    }
    false
}

/// What single precision tells of the triangles of a block. Of masks and numbers only the lanes of `mask`
/// mean anything.
struct Candidates {
    /// Triangles that the ray meets, or may meet.
    mask: u32,
    /// Of them those whose `t` single precision does not decide.
    doubtful: u32,
    /// Of these those whose edge or corner the ray meets, as far as single precision sees.
    touched: u32,
    t: [f32; BLOCK],
    /// Of the second corner, over the determinant its weight.
    v: [f32; BLOCK],
    /// The same of the third.
    w: [f32; BLOCK],
    det: [f32; BLOCK],
}

/// The triangles of a block that the ray may meet within a range of `t`, its ends included; `None` if there are none.
#[inline(always)]
fn candidates<L: Lanes<BLOCK>>(
    block: &Block,
    count: u32,
    ends: &Ray,
    ray: &Prepared,
    [low, high]: [f32; 2],
) -> Option<Candidates> {
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
        return None;
    }
    let det = u.add(v).add(w);
    let height = u.mul(a[2]).add(v.mul(b[2])).add(w.mul(c[2]));
    let height = height.mul(L::splat(ray.shear.z));
    let t = height.div(det);
    // An edge function that is zero or undefined decides nothing.
    let touched = inside & !(zero.lt(least) | most.lt(zero));
    let doubtful = touched | (inside & !clear_of_ends(block, ray, ends, height, det, t));
    let range = L::splat(low).le(t) & t.le(L::splat(high));
    let mask = (inside & range) | doubtful;
    if mask == 0 {
        return None;
    }
    Some(Candidates {
        mask,
        doubtful,
        touched,
        t: t.store(),
        v: v.store(),
        w: w.store(),
        det: det.store(),
    })
}

impl Candidates {
    /// The hit of a triangle; `None` where double precision decides that there is none. `ends` is the ray in the world.
    #[inline(always)]
    fn hit(
        &self,
        lane: usize,
        block: &Block,
        ends: &Ray,
        ray: &Prepared,
        place: Option<&Place>,
    ) -> Option<Hit> {
        let mut t = self.t[lane];
        if self.doubtful >> lane & 1 == 1 {
            t = precise::plane(block, lane, ends, place)? as f32;
        }
        let (mut u, mut v) = (self.v[lane] / self.det[lane], self.w[lane] / self.det[lane]);
        if self.touched >> lane & 1 == 1 {
            let (second, third) = precise::weights(block, lane, ray)?;
            (u, v) = (second as f32, third as f32);
        }
        Some(Hit {
            t,
            u,
            v,
            instance: place.map_or(block.instances[lane], |p| p.instance),
            primitive: block.primitives[lane],
        })
    }
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
