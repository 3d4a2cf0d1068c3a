//! The walk through a wide tree: nearest child first, pruned by the best hit so far.
//!
//! What is called in here is `inline(always)` and takes no closures that do vector arithmetic: only then is all of it
//! compiled for the vector instructions of the one function that it ends up in. A closure is not, and its operations
//! become calls.

use glam::Affine3A;

use super::Goal;
use super::lanes::{Kernel, Lanes};
use super::node::{Block, Bvh, Child, Kind, Node};
use super::prepared::{Prepared, WIDEN};
use super::slabs::test_node;
use super::stack::{Entry, Stack};
use super::triangles::meet_block;
use crate::{Motion, Ray};

/// A tree, and the ray that goes through it.
#[derive(Clone, Copy)]
pub(crate) struct Level<'a> {
    pub(crate) bvh: &'a Bvh,
    /// In world space.
    pub(crate) ray: &'a Ray,
    /// Whose tree this is; None of the world's.
    pub(crate) place: Option<&'a PlacedTree>,
    /// What the world's tree leads to.
    pub(crate) places: &'a PlacedTrees,
    /// In [0, 1]: where what moves stands.
    pub(crate) time: f32,
}

/// Instances with trees of their own.
#[derive(Default)]
pub(crate) struct PlacedTrees {
    pub(crate) list: Vec<PlacedTree>,
    pub(crate) trees: Vec<Bvh>,
    pub(crate) motions: Vec<Motion>,
}

/// Of what does not move, in place of an index into the motions.
pub(crate) const STILL: u32 = u32::MAX;

/// An instance with a tree of its own.
#[derive(Clone, Copy)]
pub(crate) struct PlacedTree {
    pub(crate) instance: u32,
    pub(crate) tree: u32,
    pub(crate) to_object: Affine3A,
    pub(crate) to_world: Affine3A,
    /// Index into the motions, or [`STILL`].
    pub(crate) motion: u32,
}

impl PlacedTrees {
    /// Where a place is at a time; `None` where it is flat just then.
    pub(super) fn at(&self, index: u32, time: f32) -> Option<PlacedTree> {
        let place = &self.list[index as usize];
        if place.motion == STILL {
            Some(*place)
        } else {
            self.moved(place, time)
        }
    }

    /// A moving place at a time; `None` where it is flat just then, and no ray meets it.
    #[inline(never)]
    fn moved(&self, place: &PlacedTree, time: f32) -> Option<PlacedTree> {
        let to_world = self.motions[place.motion as usize].at(time);
        let to_object = to_world.inverse();
        to_object.is_finite().then_some(PlacedTree {
            to_object,
            to_world,
            ..*place
        })
    }
}

/// Walks with `K`; whether the goal asked to stop. `PLACED` is whether the tree is an instance's: two
/// functions, so that the common one knows nothing of instances.
#[inline(always)]
pub(crate) fn walk_with<K: Kernel, G: Goal, const PLACED: bool>(
    level: &Level<'_>,
    goal: &mut G,
) -> bool {
    let Some(root) = level.bvh.root else {
        return false;
    };
    let prepared = match level.place {
        Some(place) if PLACED => Prepared::in_instance(level.ray, &place.to_object),
        _ => Prepared::new(level.ray),
    };
    let Some(ray) = prepared else { return false };
    let low = goal.low() - ray.slack;
    let mut limit = widened(goal.high(), &ray);
    let mut stack = Stack::new();
    let mut current = root;
    loop {
        let next = match current.kind() {
            Kind::Node { index } => {
                let node = &level.bvh.nodes[index];
                visit_node::<K, G>(level.bvh, node, &ray, low, limit, &mut stack)
            }
            Kind::Block { index, count } => {
                let block = &level.bvh.blocks[index];
                if meet_block::<K::Block, G, PLACED>(block, count, level, &ray, goal) {
                    return true;
                }
                limit = widened(goal.high(), &ray);
                None
            }
            Kind::Instance { index } => {
                if enter::<K, G>(level, index, goal) {
                    return true;
                }
                limit = widened(goal.high(), &ray);
                None
            }
        };
        current = match next {
            Some(child) => child,
            None => match pop(&mut stack, limit) {
                Some(child) => child,
                None => return false,
            },
        };
    }
}

/// Beyond this no box is entered.
#[inline(always)]
fn widened(high: f32, ray: &Prepared) -> f32 {
    high * WIDEN + ray.slack
}

/// The next child that does not begin beyond `limit`.
#[inline(always)]
fn pop(stack: &mut Stack, limit: f32) -> Option<Child> {
    loop {
        let entry = stack.pop()?;
        if entry.near() <= limit {
            return Some(entry.child());
        }
    }
}

/// The child to go on with; the others that the ray enters go on the stack, the nearest on top.
#[inline(always)]
fn visit_node<K: Kernel, G: Goal>(
    bvh: &Bvh,
    node: &Node,
    ray: &Prepared,
    low: f32,
    high: f32,
    stack: &mut Stack,
) -> Option<Child> {
    let (mut mask, near) = test_node::<K::Node>(node, ray, low, high);
    if mask == 0 {
        return None;
    }
    let first = mask.trailing_zeros() as usize;
    mask &= mask - 1;
    if mask == 0 {
        return Some(node.children[first]);
    }
    let near = near.store();
    fetch::<K>(bvh, node.children[first]);
    let mut best = Entry::new(near[first], node.children[first]);
    let mut count = 0;
    while mask != 0 {
        let slot = mask.trailing_zeros() as usize;
        mask &= mask - 1;
        fetch::<K>(bvh, node.children[slot]);
        let other = Entry::new(near[slot], node.children[slot]);
        if G::ORDERED {
            stack.push(best.max(other));
            best = best.min(other);
            count += 1;
        } else {
            stack.push(other);
        }
    }
    if count > 1 {
        sort_descending(stack.top(count));
    }
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

/// Walks through an instance's own tree.
#[inline(always)]
fn enter<K: Kernel, G: Goal>(level: &Level<'_>, index: u32, goal: &mut G) -> bool {
    let mut place = &level.places.list[index as usize];
    let moved;
    if place.motion != STILL {
        match level.places.moved(place, level.time) {
            Some(instant) => moved = instant,
            None => return false,
        }
        place = &moved;
    }
    let bvh = &level.places.trees[place.tree as usize];
    let inner = Level {
        bvh,
        place: Some(place),
        ..*level
    };
    K::walk_placed(&inner, goal)
}

/// Asks for the memory of a child that will be visited. Measured: incoherent rays take a sixth less time. Without a
/// branch on what it is, which would be mispredicted; for an instance it asks for something of no use.
#[inline(always)]
fn fetch<K: Kernel>(bvh: &Bvh, child: Child) {
    if bvh.is_near {
        return;
    }
    let (start, size) = if child.is_node() {
        (bvh.nodes.as_ptr().cast::<u8>(), size_of::<Node>())
    } else {
        (bvh.blocks.as_ptr().cast::<u8>(), size_of::<Block>())
    };
    K::fetch(start.wrapping_add(child.index() * size));
}
