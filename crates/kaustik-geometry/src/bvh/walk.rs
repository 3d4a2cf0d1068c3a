//! The walk through a wide tree: nearest child first, pruned by the best hit so far.

use glam::Affine3A;

use super::Goal;
use super::lanes::{Kernel, Lanes};
use super::node::{BLOCK, Block, Bvh, Child, Kind, Node, WIDTH};
use super::precise;
use super::prepared::{Exact, Prepared, WIDEN};
use super::stack::{Entry, Stack};
use crate::{Hit, Ray};

/// A tree, a ray in its space, and what else a walk through it needs.
pub(crate) struct Level<'a> {
    pub(crate) bvh: &'a Bvh,
    pub(crate) ray: Prepared,
    pub(crate) exact: Exact,
    /// Which instance's tree this is; None of the world's, whose blocks know.
    pub(crate) instance: Option<u32>,
    /// The world, where the tree may lead to instances.
    pub(crate) places: Option<(&'a Ray, &'a [Place], &'a [Bvh])>,
}

/// An instance with a tree of its own.
#[derive(Clone, Copy)]
pub(crate) struct Place {
    pub(crate) instance: u32,
    pub(crate) tree: u32,
    pub(crate) to_object: Affine3A,
    pub(crate) to_world: Affine3A,
}

/// Walks with `K`; whether the goal asked to stop. Inlined into a function compiled for what `K` needs.
#[inline(always)]
pub(crate) fn walk_with<K: Kernel, G: Goal>(level: &Level<'_>, goal: &mut G) -> bool {
    let Some(root) = level.bvh.root else {
        return false;
    };
    let mut stack = Stack::new();
    let mut current = root;
    loop {
        let next = match current.kind() {
            Kind::Node { index } => {
                visit_node::<K, G>(&level.bvh.nodes[index], &level.ray, goal, &mut stack)
            }
            Kind::Block { index, count } => {
                if meet_block::<K, G>(&level.bvh.blocks[index], count, level, goal) {
                    return true;
                }
                None
            }
            Kind::Instance { index } => {
                if enter::<K, G>(level, index, goal) {
                    return true;
                }
                None
            }
        };
        current = match next {
            Some(child) => child,
            None => {
                let limit = widened(goal.high(), &level.ray);
                loop {
                    let Some(entry) = stack.pop() else {
                        return false;
                    };
                    if entry.near() <= limit {
                        break entry.child();
                    }
                }
            }
        };
    }
}

/// Beyond this no box is entered.
#[inline(always)]
fn widened(high: f32, ray: &Prepared) -> f32 {
    high * WIDEN + ray.slack
}

/// The nearest child; the others go on the stack, nearest on top.
#[inline(always)]
fn visit_node<K: Kernel, G: Goal>(
    node: &Node,
    ray: &Prepared,
    goal: &G,
    stack: &mut Stack,
) -> Option<Child> {
    let (mut mask, near) =
        test_node::<K::Node>(node, ray, goal.low() - ray.slack, widened(goal.high(), ray));
    if mask == 0 {
        return None;
    }
    let first = mask.trailing_zeros() as usize;
    mask &= mask - 1;
    if mask == 0 {
        return Some(node.children[first]);
    }
    let near = near.store();
    let entry = |slot: usize| Entry::new(near[slot], node.children[slot]);
    if !G::ORDERED {
        while mask != 0 {
            stack.push(entry(mask.trailing_zeros() as usize));
            mask &= mask - 1;
        }
        return Some(node.children[first]);
    }
    let (a, b) = (entry(first), entry(mask.trailing_zeros() as usize));
    let (mut best, far) = if b < a { (b, a) } else { (a, b) };
    stack.push(far);
    mask &= mask - 1;
    if mask == 0 {
        return Some(best.child());
    }
    let mut count = 1;
    while mask != 0 {
        let mut other = entry(mask.trailing_zeros() as usize);
        mask &= mask - 1;
        if other < best {
            std::mem::swap(&mut other, &mut best);
        }
        stack.push(other);
        count += 1;
    }
    sort_descending(stack.top(count));
    Some(best.child())
}

/// Insertion: there are few.
#[inline(always)]
fn sort_descending(entries: &mut [Entry]) {
    for i in 1..entries.len() {
        let moving = entries[i];
        let mut j = i;
        while j > 0 && entries[j - 1] < moving {
            entries[j] = entries[j - 1];
            j -= 1;
        }
        entries[j] = moving;
    }
}

/// Which children the ray enters between `low` and `high`, and where.
#[inline(always)]
fn test_node<L: Lanes<WIDTH>>(node: &Node, ray: &Prepared, low: f32, high: f32) -> (u32, L) {
    let enter = near::<L>(node, ray, 0)
        .max(near(node, ray, 1))
        .max(near::<L>(node, ray, 2).max(L::splat(low)));
    let leave = far::<L>(node, ray, 0)
        .min(far(node, ray, 1))
        .min(far::<L>(node, ray, 2).min(L::splat(high)));
    (enter.le(leave), enter)
}

/// Where the ray enters the slab of an axis. (No closures here and below: one is compiled without the vector
/// instructions and its operations become calls.)
#[inline(always)]
fn near<L: Lanes<WIDTH>>(node: &Node, ray: &Prepared, axis: usize) -> L {
    L::load(&node.planes[ray.near_row[axis]])
        .sub(L::splat(ray.origin[axis]))
        .mul(L::splat(ray.inverse[axis]))
}

/// Where it leaves.
#[inline(always)]
fn far<L: Lanes<WIDTH>>(node: &Node, ray: &Prepared, axis: usize) -> L {
    L::load(&node.planes[ray.far_row[axis]])
        .sub(L::splat(ray.origin[axis]))
        .mul(L::splat(ray.inverse_far[axis]))
}

/// Twice the rounding of the volume that decides on which side of a triangle a point lies, as a multiple of the sizes
/// involved: about 60 roundings of 2^-24 each, rounded up.
const DOUBT: f32 = 1.0 / 131_072.0;

/// Offers the hits in a block; whether the goal asked to stop.
#[inline(always)]
fn meet_block<K: Kernel, G: Goal>(
    block: &Block,
    count: u32,
    level: &Level<'_>,
    goal: &mut G,
) -> bool {
    let ray = &level.ray;
    let a = sheared::<K::Block>(block, ray, 0);
    let b = sheared::<K::Block>(block, ray, 1);
    let c = sheared::<K::Block>(block, ray, 2);
    let u = c[0].mul(b[1]).sub(c[1].mul(b[0]));
    let v = a[0].mul(c[1]).sub(a[1].mul(c[0]));
    let w = b[0].mul(a[1]).sub(b[1].mul(a[0]));
    let zero = K::Block::splat(0.0);
    let (least, most) = (u.min(v).min(w), u.max(v).max(w));
    let inside = !(least.lt(zero) & zero.lt(most)) & ((1 << count) - 1);
    if inside == 0 {
        return false;
    }
    let det = u.add(v).add(w);
    let height = u
        .mul(a[2])
        .add(v.mul(b[2]))
        .add(w.mul(c[2]))
        .mul(K::Block::splat(ray.shear.z));
    let t = height.div(det);
    let doubtful = inside
        & !(strictly_inside::<K>(least, most) & clear_of_ends::<K>(ray, [a, b, c], height, det));
    let range = K::Block::splat(goal.low()).le(t) & t.le(K::Block::splat(goal.high()));
    let mut mask = (inside & range) | doubtful;
    if mask == 0 {
        return false;
    }
    let (t, v, w, det) = (t.store(), v.store(), w.store(), det.store());
    while mask != 0 {
        let lane = mask.trailing_zeros() as usize;
        mask &= mask - 1;
        let (t, u, v) = if doubtful >> lane & 1 == 0 {
            (t[lane], v[lane] / det[lane], w[lane] / det[lane])
        } else {
            match precise_hit(block, lane, level) {
                Some(found) => found,
                None => continue,
            }
        };
        let instance = level.instance.unwrap_or(block.instances[lane]);
        let hit = Hit {
            t,
            u,
            v,
            instance,
            primitive: block.primitives[lane],
        };
        if goal.low() <= t && t <= goal.high() && goal.offer(hit) {
            return true;
        }
    }
    false
}

/// A corner of each triangle seen from the ray's origin, sheared so that the ray is the last axis.
#[inline(always)]
fn sheared<L: Lanes<BLOCK>>(block: &Block, ray: &Prepared, corner: usize) -> [L; 3] {
    let z = shifted::<L>(block, ray, corner, 2);
    let x = shifted::<L>(block, ray, corner, 0).sub(L::splat(ray.shear.x).mul(z));
    let y = shifted::<L>(block, ray, corner, 1).sub(L::splat(ray.shear.y).mul(z));
    [x, y, z]
}

#[inline(always)]
fn shifted<L: Lanes<BLOCK>>(block: &Block, ray: &Prepared, corner: usize, axis: usize) -> L {
    let axis = ray.axes[axis];
    L::load(&block.corners[corner][axis]).sub(L::splat(ray.origin[axis]))
}

/// Lanes whose three edge functions have one sign and none of them is zero or undefined.
#[inline(always)]
fn strictly_inside<K: Kernel>(least: K::Block, most: K::Block) -> u32 {
    let zero = K::Block::splat(0.0);
    zero.lt(least) | most.lt(zero)
}

/// Lanes whose triangle is certainly on the side of the ray's two ends where `t` in single precision puts it.
#[inline(always)]
fn clear_of_ends<K: Kernel>(
    ray: &Prepared,
    corners: [[K::Block; 3]; 3],
    height: K::Block,
    det: K::Block,
) -> u32 {
    let [a, b, c] = corners;
    let x = a[0].abs().max(b[0].abs()).max(c[0].abs());
    let y = a[1].abs().max(b[1].abs()).max(c[1].abs());
    let along = a[2].abs().max(b[2].abs()).max(c[2].abs());
    let across = x.max(y);
    let reach = across.add(along);
    let bound = across
        .mul(reach)
        .mul(reach.add(K::Block::splat(ray.blur)))
        .mul(K::Block::splat(ray.shear.z.abs() * DOUBT));
    let below = height.sub(det.mul(K::Block::splat(ray.t_min))).abs();
    let clear = bound.lt(below);
    if ray.t_max < f32::INFINITY {
        clear & bound.lt(height.sub(det.mul(K::Block::splat(ray.t_max))).abs())
    } else {
        clear
    }
}

/// A hit decided in double precision, if it lies strictly within the ray.
#[inline(always)]
fn precise_hit(block: &Block, lane: usize, level: &Level<'_>) -> Option<(f32, f32, f32)> {
    let (t, u, v) = precise::meet(block, lane, &level.ray, &level.exact)?;
    let within = f64::from(level.ray.t_min) < t && t <= f64::from(level.ray.t_max);
    within.then_some((t as f32, u as f32, v as f32))
}

/// Walks through an instance's own tree.
#[inline(always)]
fn enter<K: Kernel, G: Goal>(level: &Level<'_>, index: u32, goal: &mut G) -> bool {
    let Some((ray, places, trees)) = level.places else {
        return false;
    };
    let place = &places[index as usize];
    let Some(prepared) = Prepared::into_instance(ray, &place.to_object) else {
        return false;
    };
    let inner = Level {
        bvh: &trees[place.tree as usize],
        ray: prepared,
        exact: Exact {
            to_world: Some(place.to_world.as_daffine3()),
            ..level.exact
        },
        instance: Some(place.instance),
        places: None,
    };
    K::walk(&inner, goal)
}
