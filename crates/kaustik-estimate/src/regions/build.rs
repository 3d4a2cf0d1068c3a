//! How the trees are built.

use super::node::Node;
use super::{RegionPoint, Regions};

/// How many numbers of a [`RegionPoint`] are its position.
const POSITION: usize = 3;

impl Regions {
    /// Levels of a tree below its root.
    pub const MOST_LEVELS: u32 = 15;
    /// Regions with fewer than twice as many points of a pilot are leaves.
    pub const LEAST_POINTS: usize = 16;

    /// Builds a tree that splits at the median along the longest side, or at its middle if that side
    /// belongs to the normal, which takes few values. If the median equals the lowest coordinate (a wall),
    /// the split is placed just beyond it. Leaves at the border extend to infinity.
    pub fn spatial(points: &mut [RegionPoint]) -> Self {
        Self::build(points, |points| {
            if points.len() < 2 * Self::LEAST_POINTS {
                return None;
            }
            let (axis, [low, high]) = longest_side(points);
            if axis >= POSITION {
                return Some((axis as u8, 0.5 * (low + high)));
            }
            let middle = points.len() / 2;
            let by = |a: &RegionPoint, b: &RegionPoint| a[axis].total_cmp(&b[axis]);
            points.select_nth_unstable_by(middle, by);
            let median = points[middle][axis];
            let place = match median > low {
                true => median,
                // Below the median there is nothing: without a step up, the same points would be split in
                // this way again and again.
                false => beyond(points, axis, low)?,
            };
            Some((axis as u8, place))
        })
    }

    fn build(
        points: &mut [RegionPoint],
        mut split: impl FnMut(&mut [RegionPoint]) -> Option<(u8, f32)>,
    ) -> Self {
        let mut regions = Self {
            nodes: vec![Node::default()],
            leaves: Vec::new(),
            cut: Vec::new(),
        };
        let mut open = vec![(0_u32, points, 0_u32)];
        while let Some((at, points, level)) = open.pop() {
            let found = if level < Self::MOST_LEVELS {
                split(points)
            } else {
                None
            };
            let Some((axis, place)) = found else {
                regions.nodes[at as usize].leaf = regions.leaves.len() as u32;
                regions.leaves.push(at);
                continue;
            };
            let first = regions.nodes.len() as u32;
            regions.nodes[at as usize].split = Some((axis, place, [first, first + 1]));
            for _ in 0..2 {
                regions.nodes.push(Node {
                    parent: at,
                    ..Node::default()
                });
            }
            let below = partition(points, usize::from(axis), place);
            let (low, high) = points.split_at_mut(below);
            open.push((first, low, level + 1));
            open.push((first + 1, high, level + 1));
        }
        regions.nodes[0].in_cut = true;
        regions.map_leaves();
        regions
    }

    /// Halves the image along both axes in turn (the unit square over all of it): a quad-tree with the levels between.
    pub fn image() -> Self {
        let mut regions = Self::build(&mut [], |_| None);
        regions.leaves.clear();
        regions.halve(0, [[0.0; 6], [1.0, 1.0, 0.0, 0.0, 0.0, 0.0]], 0);
        regions.map_leaves();
        regions
    }

    fn halve(&mut self, at: u32, [low, high]: [RegionPoint; 2], level: u32) {
        if level == Self::MOST_LEVELS {
            self.nodes[at as usize].leaf = self.leaves.len() as u32;
            self.leaves.push(at);
            return;
        }
        let axis = (level % 2) as usize;
        let place = 0.5 * (low[axis] + high[axis]);
        let first = self.nodes.len() as u32;
        self.nodes[at as usize].split = Some((axis as u8, place, [first, first + 1]));
        for _ in 0..2 {
            self.nodes.push(Node {
                parent: at,
                ..Node::default()
            });
        }
        let (mut upper, mut lower) = (low, high);
        upper[axis] = place;
        lower[axis] = place;
        self.halve(first, [low, lower], level + 1);
        self.halve(first + 1, [upper, high], level + 1);
    }
}

/// The axis along which points reach farthest, from where to where.
fn longest_side(points: &[RegionPoint]) -> (usize, [f32; 2]) {
    let side = |axis: usize| {
        let at = points.iter().map(|point| point[axis]);
        [
            at.clone().fold(f32::MAX, f32::min),
            at.fold(f32::MIN, f32::max),
        ]
    };
    (1..6).fold((0, side(0)), |(best, [low, high]), axis| {
        let [from, to] = side(axis);
        if to - from > high - low {
            (axis, [from, to])
        } else {
            (best, [low, high])
        }
    })
}

/// A place that parts the points at the low end of an axis from all others, halfway to the next. `None` if there are no
/// others.
fn beyond(points: &[RegionPoint], axis: usize, low: f32) -> Option<f32> {
    let above = points.iter().map(|point| point[axis]);
    let next = above.filter(|at| *at > low).min_by(f32::total_cmp)?;
    let halfway = low + 0.5 * (next - low);
    Some(if halfway > low { halfway } else { next })
}

/// Points below a place first; returns how many.
fn partition(points: &mut [RegionPoint], axis: usize, place: f32) -> usize {
    let mut below = 0;
    for at in 0..points.len() {
        if points[at][axis] < place {
            points.swap(at, below);
            below += 1;
        }
    }
    below
}
