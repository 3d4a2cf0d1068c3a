//! A binary tree from the top: boxes are parted by the surface area heuristic until few are left, and these
//! are clustered.
//!
//! Clustering alone makes the better trees, but it joins only boxes that are each other's nearest. Where
//! every box is nearest to the one before it (shells one within the other; a scene of which one vertex is
//! very far away), it joins one pair at a time, which takes quadratic time. Among few boxes this is bearable,
//! and the way down to few is never longer than [`LEVELS_OF_CHOICE`] and what halving takes.

use glam::Vec3;
use obvhs::aabb::Aabb as Bounds;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
#[cfg(feature = "parallel")]
use rayon::join;

/// So many boxes are clustered.
const FEW: usize = 512;
/// Slices that parts are made of, along each axis.
const BINS: usize = 16;
/// From this level on parts are equal, however small a part the heuristic would like to cut off.
const LEVELS_OF_CHOICE: usize = 40;

/// Parts of so many boxes are parted by one thread.
const MANY: usize = 1 << 13;

/// A tree whose leaves hold a box each. The same bits on any number of threads.
pub(crate) fn divide(boxes: &[Bounds]) -> Bvh2 {
    let mut tree = Bvh2::default();
    if boxes.is_empty() {
        return tree;
    }
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    tree.nodes = vec![Bvh2Node::default(); 2 * boxes.len() - 1];
    tree.primitive_indices = vec![0; boxes.len()];
    let below = Below {
        nodes: &mut tree.nodes[1..],
        first_node: 1,
        primitives: &mut tree.primitive_indices,
        first_primitive: 0,
        level: 0,
    };
    let mut clusters = PlocBuilder::with_capacity(FEW);
    let (root, depth) = Divider { boxes }.part(&mut order, below, &mut clusters);
    tree.nodes[0] = root;
    tree.max_depth = depth;
    level_by_level(&mut tree.nodes);
    tree.children_are_ordered_after_parents = true;
    tree
}

/// Does both, one after the other.
#[cfg(not(feature = "parallel"))]
fn join<A, B>(first: impl FnOnce() -> A, second: impl FnOnce() -> B) -> (A, B) {
    (first(), second())
}

/// Orders nodes from the top, as whoever improves the tree takes the first ones to be the large ones.
fn level_by_level(nodes: &mut Vec<Bvh2Node>) {
    let mut ordered: Vec<Bvh2Node> = Vec::with_capacity(nodes.len());
    ordered.push(nodes[0]);
    let mut at = 0;
    while at < ordered.len() {
        if !ordered[at].is_leaf() {
            let children = ordered[at].first_index as usize;
            ordered[at].first_index = ordered.len() as u32;
            ordered.extend_from_slice(&nodes[children..children + 2]);
        }
        at += 1;
    }
    *nodes = ordered;
}

struct Divider<'a> {
    boxes: &'a [Bounds],
}

/// Where what is below a node goes: n boxes have 2 n - 2 nodes below their root.
struct Below<'a> {
    nodes: &'a mut [Bvh2Node],
    /// Place of the first of these in the tree.
    first_node: usize,
    primitives: &'a mut [u32],
    first_primitive: usize,
    /// Of the node itself.
    level: usize,
}

impl<'a> Below<'a> {
    /// The two children, and what is below each if the first has so many boxes.
    fn split(self, boxes: usize) -> (&'a mut [Bvh2Node], [Below<'a>; 2]) {
        let (children, nodes) = self.nodes.split_at_mut(2);
        let below_low = 2 * boxes - 2;
        let (low, high) = nodes.split_at_mut(below_low);
        let (low_primitives, high_primitives) = self.primitives.split_at_mut(boxes);
        let (first_node, level) = (self.first_node + 2, self.level + 1);
        let low = Below {
            nodes: low,
            first_node,
            primitives: low_primitives,
            first_primitive: self.first_primitive,
            level,
        };
        let high = Below {
            nodes: high,
            first_node: first_node + below_low,
            primitives: high_primitives,
            first_primitive: self.first_primitive + boxes,
            level,
        };
        (children, [low, high])
    }
}

/// Boxes in a slice.
#[derive(Clone, Copy)]
struct Bin {
    count: usize,
    bounds: Bounds,
}

impl Bin {
    const EMPTY: Self = Self {
        count: 0,
        bounds: Bounds::INVALID,
    };

    fn and(&self, other: &Self) -> Self {
        Self {
            count: self.count + other.count,
            bounds: self.bounds.union(&other.bounds),
        }
    }

    /// Number of boxes times half the surface that holds them.
    fn cost(&self) -> f64 {
        if self.count == 0 {
            return 0.0;
        }
        let [x, y, z] = self.bounds.diagonal().to_array().map(f64::from);
        (x * y + y * z + z * x) * self.count as f64
    }
}

impl Divider<'_> {
    /// Makes the tree of a part; returns its root and the greatest depth.
    fn part(
        &self,
        part: &mut [u32],
        below: Below<'_>,
        clusters: &mut PlocBuilder,
    ) -> (Bvh2Node, usize) {
        if part.len() <= FEW {
            return self.cluster(part, below, clusters);
        }
        let middle = if below.level < LEVELS_OF_CHOICE {
            self.cheapest(part)
        } else {
            None
        };
        let middle = middle.unwrap_or_else(|| self.halves(part));
        let first = below.first_node as u32;
        let many = part.len() > MANY;
        let (low, high) = part.split_at_mut(middle);
        let (children, [below_low, below_high]) = below.split(middle);
        let ((low, low_depth), (high, high_depth)) = if many {
            join(
                || self.part(low, below_low, clusters),
                || self.part(high, below_high, &mut PlocBuilder::with_capacity(FEW)),
            )
        } else {
            let low = self.part(low, below_low, clusters);
            (low, self.part(high, below_high, clusters))
        };
        let root = Bvh2Node::new(low.aabb().union(high.aabb()), 0, first);
        children.copy_from_slice(&[low, high]);
        (root, low_depth.max(high_depth))
    }

    fn bounds(&self, part: &[u32]) -> Bounds {
        let boxes = part.iter().map(|&i| &self.boxes[i as usize]);
        boxes.fold(Bounds::INVALID, |all, b| all.union(b))
    }

    /// Twice the centre of a box.
    fn centre(&self, index: u32) -> [f64; 3] {
        let b = &self.boxes[index as usize];
        std::array::from_fn(|axis| f64::from(b.min[axis]) + f64::from(b.max[axis]))
    }

    /// Smallest and largest centres.
    fn spread(&self, part: &[u32]) -> [[f64; 3]; 2] {
        let start = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        part.iter().fold(start, |[low, high], &i| {
            let centre = self.centre(i);
            [
                std::array::from_fn(|axis| low[axis].min(centre[axis])),
                std::array::from_fn(|axis| high[axis].max(centre[axis])),
            ]
        })
    }

    /// Parts the boxes where that costs least, and returns how many are in the first part; `None` if all
    /// centres are alike.
    fn cheapest(&self, part: &mut [u32]) -> Option<usize> {
        let [low, high] = self.spread(part);
        let slices = |axis: usize| Slices {
            low: low[axis],
            scale: BINS as f64 / (high[axis] - low[axis]),
        };
        let mut best: Option<(f64, usize, usize)> = None;
        for axis in (0..3).filter(|&axis| high[axis] > low[axis]) {
            let slices = slices(axis);
            let mut bins = [Bin::EMPTY; BINS];
            for &i in &*part {
                let bin = &mut bins[slices.of(self.centre(i)[axis])];
                bin.count += 1;
                bin.bounds = bin.bounds.union(&self.boxes[i as usize]);
            }
            let (cost, cut) = cheapest_cut(&bins);
            if best.is_none_or(|best| cost < best.0) {
                best = Some((cost, axis, cut));
            }
        }
        let (_, axis, cut) = best?;
        let slices = slices(axis);
        let middle = partition(part, |i| slices.of(self.centre(i)[axis]) < cut);
        (middle > 0 && middle < part.len()).then_some(middle)
    }

    /// Two halves along the longest side of the centres.
    fn halves(&self, part: &mut [u32]) -> usize {
        let [low, high] = self.spread(part);
        let side = |axis: usize| high[axis] - low[axis];
        let longest = (1..3).fold(
            0,
            |best, axis| {
                if side(axis) > side(best) { axis } else { best }
            },
        );
        let middle = part.len() / 2;
        part.select_nth_unstable_by(middle, |&a, &b| {
            let [a_at, b_at] = [a, b].map(|i| self.centre(i)[longest]);
            a_at.total_cmp(&b_at).then(a.cmp(&b))
        });
        middle
    }

    /// Locally ordered clustering of a few boxes, scaled to sizes whose products `f32` can hold.
    fn cluster(
        &self,
        part: &[u32],
        below: Below<'_>,
        clusters: &mut PlocBuilder,
    ) -> (Bvh2Node, usize) {
        let Below {
            nodes,
            first_node,
            primitives,
            first_primitive,
            level,
        } = below;
        let scaled = self.scaled(part);
        let found = clusters.build(
            PlocSearchDistance::Medium,
            &scaled,
            (0..part.len() as u32).collect(),
            SortPrecision::U64,
            3,
        );
        let mut root = Bvh2Node::default();
        for (index, node) in found.nodes.iter().enumerate().rev() {
            let first = node.first_index as usize;
            let node = if node.is_leaf() {
                let primitive = part[found.primitive_indices[first] as usize];
                let bounds = self.boxes[primitive as usize];
                let at = first_primitive + first;
                Bvh2Node::new(bounds, node.prim_count, at as u32)
            } else {
                // children come after their parents, and the root is not below itself
                let [low, high] = [first - 1, first].map(|child| nodes[child].aabb());
                let at = first_node + first - 1;
                Bvh2Node::new(low.union(high), 0, at as u32)
            };
            match index.checked_sub(1) {
                Some(place) => nodes[place] = node,
                None => root = node,
            }
        }
        for (place, &i) in primitives.iter_mut().zip(&found.primitive_indices) {
            *place = part[i as usize];
        }
        (root, level + found.max_depth)
    }

    /// The boxes of a part, around the origin and of a size whose products `f32` can hold.
    fn scaled(&self, part: &[u32]) -> Vec<Bounds> {
        let all = self.bounds(part);
        let centre = (all.min + all.max) * 0.5;
        let scale = inverse_power(Vec3::from(all.diagonal()).max_element());
        part.iter()
            .map(|&i| &self.boxes[i as usize])
            .map(|b| Bounds::new((b.min - centre) * scale, (b.max - centre) * scale))
            .collect()
    }
}

/// Which slice of an axis a centre is in.
struct Slices {
    low: f64,
    scale: f64,
}

impl Slices {
    fn of(&self, centre: f64) -> usize {
        (((centre - self.low) * self.scale) as usize).min(BINS - 1)
    }
}

/// The cost of the cheapest cut, and the first slice after it.
fn cheapest_cut(bins: &[Bin; BINS]) -> (f64, usize) {
    let mut above = [0.0; BINS];
    let mut sum = Bin::EMPTY;
    for cut in (1..BINS).rev() {
        sum = sum.and(&bins[cut]);
        above[cut] = sum.cost();
    }
    let mut best = (f64::INFINITY, 1);
    let mut below = Bin::EMPTY;
    for cut in 1..BINS {
        below = below.and(&bins[cut - 1]);
        let cost = below.cost() + above[cut];
        if cost < best.0 {
            best = (cost, cut);
        }
    }
    best
}

/// Brings what is `low` to the front, and counts it.
fn partition(part: &mut [u32], low: impl Fn(u32) -> bool) -> usize {
    let mut count = 0;
    for at in 0..part.len() {
        if low(part[at]) {
            part.swap(count, at);
            count += 1;
        }
    }
    count
}

/// The power of two that brings a size to between one and two; one for a size of nothing.
fn inverse_power(size: f32) -> f32 {
    if !(size.is_normal() && size.is_finite()) {
        return 1.0;
    }
    let exponent = (size.to_bits() >> 23) as i32 - 127;
    f32::from_bits(((127 - exponent).clamp(1, 254) as u32) << 23)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every box is in a leaf of its own, within all nodes above.
    fn check(boxes: &[Bounds], tree: &Bvh2) {
        let mut seen = vec![0; boxes.len()];
        let mut open = vec![0];
        while let Some(at) = open.pop() {
            let node = &tree.nodes[at];
            if node.is_leaf() {
                assert_eq!(node.prim_count, 1);
                let primitive = tree.primitive_indices[node.first_index as usize] as usize;
                seen[primitive] += 1;
                assert_eq!(*node.aabb(), boxes[primitive]);
                continue;
            }
            for child in [node.first_index as usize, node.first_index as usize + 1] {
                let bounds = tree.nodes[child].aabb();
                assert_eq!(node.aabb().union(bounds), *node.aabb());
                open.push(child);
            }
        }
        assert!(seen.iter().all(|&count| count == 1));
        assert_eq!(tree.nodes.len(), (2 * boxes.len()).saturating_sub(1));
    }

    fn around(centre: Vec3, half: f32) -> Bounds {
        Bounds::new((centre - half).into(), (centre + half).into())
    }

    /// Boxes whose clusters would be made one at a time, and others.
    fn crowds(n: usize) -> [(&'static str, Vec<Bounds>); 5] {
        let make = |of: &dyn Fn(f32) -> Bounds| (0..n).map(|i| of(i as f32)).collect();
        let mut far: Vec<Bounds> = make(&|i| around(Vec3::new(i % 61.0, i % 67.0, i), 0.7));
        far[0] = around(Vec3::X * 1e30, 1.0);
        [
            ("shells", make(&|i| around(Vec3::ZERO, 1.0 + i))),
            ("far", far),
            ("row", make(&|i| around(Vec3::X * i * i, 0.5))),
            (
                "even",
                make(&|i| around(Vec3::new(i % 7.0, i, i % 5.0), 0.1)),
            ),
            ("cubes", make(&|i| around(Vec3::X * i * i * i, 1e-3))),
        ]
    }

    #[test]
    fn every_box_is_a_leaf() {
        for n in [0, 1, 2, FEW, FEW + 1, 5000] {
            if n == 0 {
                assert!(divide(&[]).nodes.is_empty());
                continue;
            }
            for (_, boxes) in crowds(n) {
                check(&boxes, &divide(&boxes));
            }
        }
    }

    /// Clustering all of these at once takes minutes.
    #[test]
    fn no_crowd_takes_quadratic_time() {
        for (name, boxes) in crowds(100_000) {
            let start = std::time::Instant::now();
            check(&boxes, &divide(&boxes));
            let taken = start.elapsed().as_secs_f64();
            assert!(taken < 30.0, "{name}: {taken} s");
        }
    }
}
