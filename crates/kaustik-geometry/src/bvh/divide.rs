//! A binary tree from the top: boxes are parted by the surface area heuristic until few are left, and these are clustered.
//!
//! Clustering alone makes the better trees, but it joins only boxes that are each other's nearest: where every box is nearest to
//! the one before it (shells one within the other; all of a scene but one vertex, which is very far away), that is one pair at a
//! time, and quadratic time. Among few boxes this is bearable, and the way down to few is never longer than
//! [`LEVELS_OF_CHOICE`] and what halving takes.

use glam::Vec3;
use obvhs::aabb::Aabb as Bounds;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

/// So many boxes are clustered.
const FEW: usize = 512;
/// Slices that parts are made of, along each axis.
const BINS: usize = 16;
/// From this level on parts are equal, however small a part the heuristic would like to cut off.
const LEVELS_OF_CHOICE: usize = 40;

/// A tree whose leaves hold a box each.
pub(crate) fn divide(boxes: &[Bounds]) -> Bvh2 {
    let mut divider = Divider {
        boxes,
        tree: Bvh2::default(),
        clusters: PlocBuilder::with_capacity(FEW),
    };
    if boxes.is_empty() {
        return divider.tree;
    }
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    divider.tree.nodes.reserve(2 * boxes.len());
    divider.tree.primitive_indices.reserve(boxes.len());
    divider.tree.nodes.push(Bvh2Node::default());
    let mut open = vec![(0, order.as_mut_slice(), 0)];
    while let Some((slot, part, level)) = open.pop() {
        if part.len() <= FEW {
            divider.cluster(slot, part, level);
            continue;
        }
        let middle = if level < LEVELS_OF_CHOICE {
            divider.cheapest(part)
        } else {
            None
        };
        let middle = middle.unwrap_or_else(|| divider.halves(part));
        let first = divider.tree.nodes.len();
        divider.tree.nodes.extend([Bvh2Node::default(); 2]);
        let bounds = divider.bounds(part);
        divider.tree.nodes[slot] = Bvh2Node::new(bounds, 0, first as u32);
        let (low, high) = part.split_at_mut(middle);
        open.push((first + 1, high, level + 1));
        open.push((first, low, level + 1));
    }
    level_by_level(&mut divider.tree.nodes);
    divider.tree.children_are_ordered_after_parents = true;
    divider.tree
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
    tree: Bvh2,
    clusters: PlocBuilder,
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

    /// Parts the boxes where that costs least, and returns how many are in the first part; `None` if all centres are alike.
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
    fn cluster(&mut self, slot: usize, part: &[u32], level: usize) {
        let all = self.bounds(part);
        let centre = (all.min + all.max) * 0.5;
        let scale = inverse_power(Vec3::from(all.diagonal()).max_element());
        let scaled: Vec<Bounds> = part
            .iter()
            .map(|&i| &self.boxes[i as usize])
            .map(|b| Bounds::new((b.min - centre) * scale, (b.max - centre) * scale))
            .collect();
        let found = self.clusters.build(
            PlocSearchDistance::Medium,
            &scaled,
            (0..part.len() as u32).collect(),
            SortPrecision::U64,
            3,
        );
        let tree = &mut self.tree;
        tree.max_depth = tree.max_depth.max(level + found.max_depth);
        // The root goes where its place is kept, all others follow at the end.
        let (first, primitives) = (tree.nodes.len(), tree.primitive_indices.len() as u32);
        let place = |node: usize| if node == 0 { slot } else { first + node - 1 };
        tree.nodes
            .resize(first + found.nodes.len() - 1, Bvh2Node::default());
        for (index, node) in found.nodes.iter().enumerate().rev() {
            tree.nodes[place(index)] = if node.is_leaf() {
                let primitive = found.primitive_indices[node.first_index as usize];
                let bounds = self.boxes[part[primitive as usize] as usize];
                Bvh2Node::new(bounds, node.prim_count, primitives + node.first_index)
            } else {
                let children = place(node.first_index as usize);
                let bounds = tree.nodes[children]
                    .aabb()
                    .union(tree.nodes[children + 1].aabb());
                Bvh2Node::new(bounds, 0, children as u32)
            };
        }
        let indices = found.primitive_indices.iter();
        tree.primitive_indices
            .extend(indices.map(|&i| part[i as usize]));
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
