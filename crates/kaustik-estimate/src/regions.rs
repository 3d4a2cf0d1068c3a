//! Regions that gather how likely photons are: the hierarchy of the spatial target function (Gruson et al. 2016, "G").
//!
//! A tree is built once, from a pilot's measurement points; every node keeps its statistics, and a cut through the tree
//! says which regions the target goes by (G sec. 4.2). The cut begins at the root and is refined where the statistics
//! suffice.

mod refinement;

pub use refinement::Refinement;

/// A position in the world or in the image (the unit square), then the normal times a length:
/// a tree tells orientations apart where regions are smaller than that length. With length zero
/// orientations do not count.
pub type RegionPoint = [f32; 6];
/// How many of them are the position.
const POSITION: usize = 3;

/// The compression of both factors of the target (G Eq. 11).
const EPSILON: f64 = 1e-4;

/// A tree of regions with a cut.
#[derive(Clone, Debug)]
pub struct Regions {
    /// Parents before their children.
    nodes: Vec<Node>,
    /// The node of each leaf.
    leaves: Vec<u32>,
    /// For each leaf its node in the cut.
    cut: Vec<u32>,
}

/// What a node of the tree has learnt: all that [`Regions`] have beyond how they were built.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Learnt {
    in_cut: bool,
    delta: [f64; 2],
    flux: [f64; 2],
    iterations: u64,
    paths: f64,
}

#[derive(Clone, Debug, Default)]
struct Node {
    parent: u32,
    /// Axis, place, children: lower side first.
    split: Option<(u8, f32, [u32; 2])>,
    in_cut: bool,
    /// Number of the leaf, if it is one.
    leaf: u32,
    /// Sums over iterations of psi / s, in two halves: kappa / s of G Eq. 8, defined without points as well.
    delta: [f64; 2],
    /// The same of the flux that each of these paths brings, and of its square.
    flux: [f64; 2],
    /// Iterations in which it had points.
    iterations: u64,
    /// Light paths that touched it, each counted with its share.
    paths: f64,
    /// Sum of the areas of this iteration's points (G Eq. 9).
    area: f64,
}

/// What an iteration has found out about a leaf.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LeafTally {
    /// psi (G Eqs. 6 and 7) in two halves, which sum to it.
    pub psi: [f64; 2],
    /// The same sum with the flux that a path brings to the point in the place of 1, and with its square;
    /// zero where nobody asks.
    pub flux: [f64; 2],
    /// Light paths, each with its share.
    pub paths: f64,
}

impl Regions {
    /// Levels of a tree below its root.
    pub const MOST_LEVELS: u32 = 15;
    /// No render has so many iterations.
    const MOST_ITERATIONS: u64 = 1 << 60;
    /// Points of a pilot that a leaf holds at least.
    pub const LEAST_POINTS: usize = 16;

    /// Splits at medians along the longest side; at the middle of it where that is the normal's, whose values
    /// are few. A wall that holds the median at the low end is parted from what is beyond it. Leaves at the
    /// border reach to infinity.
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

    /// The number of leaves.
    pub fn leaves(&self) -> usize {
        self.leaves.len()
    }

    /// The number of regions in the cut.
    pub fn cut(&self) -> usize {
        self.nodes.iter().filter(|node| node.in_cut).count()
    }

    /// For each leaf the number of its region in the cut.
    pub fn regions(&self) -> &[u32] {
        &self.cut
    }

    /// The leaf that holds a point: exactly one does.
    #[inline]
    pub fn leaf(&self, point: RegionPoint) -> u32 {
        let mut node = &self.nodes[0];
        while let Some((axis, place, children)) = node.split {
            let side = usize::from(point[usize::from(axis)] >= place);
            node = &self.nodes[children[side] as usize];
        }
        node.leaf
    }

    /// Begins an iteration with the areas of its points, summed for each leaf.
    pub fn set_areas(&mut self, of_leaves: &[f64]) {
        for node in &mut self.nodes {
            node.area = 0.0;
        }
        for (&at, &area) in self.leaves.iter().zip(of_leaves) {
            self.nodes[at as usize].area = area;
        }
        self.sum_up(|node| node.area, |node, area| node.area += area);
    }

    /// Area of all points of the iteration, in the unit of [`set_areas`](Self::set_areas).
    pub fn area(&self) -> f64 {
        self.nodes[0].area
    }

    /// What all nodes have learnt, to be kept.
    pub fn learnt(&self) -> Vec<Learnt> {
        let of = |node: &Node| Learnt {
            in_cut: node.in_cut,
            delta: node.delta,
            flux: node.flux,
            iterations: node.iterations,
            paths: node.paths,
        };
        self.nodes.iter().map(of).collect()
    }

    /// Takes up what regions that were built alike have learnt. `None` if they were built otherwise, or if it is
    /// no cut, which has exactly one node on the way from the root to each leaf.
    pub fn with_learnt(mut self, learnt: &[Learnt]) -> Option<Self> {
        if learnt.len() != self.nodes.len() {
            return None;
        }
        for (node, learnt) in self.nodes.iter_mut().zip(learnt) {
            node.in_cut = learnt.in_cut;
            node.delta = learnt.delta;
            node.flux = learnt.flux;
            node.iterations = learnt.iterations.min(Self::MOST_ITERATIONS);
            node.paths = learnt.paths;
        }
        // parents come before their children
        let mut above = vec![0_u32; self.nodes.len()];
        for at in 0..self.nodes.len() {
            let parent = self.nodes[at].parent as usize;
            let before = if at == 0 { 0 } else { above[parent] };
            above[at] = before + u32::from(self.nodes[at].in_cut);
        }
        let is_cut = self.leaves.iter().all(|&leaf| above[leaf as usize] == 1);
        self.map_leaves();
        is_cut.then_some(self)
    }

    /// Adds what children have to their parents, from below.
    fn sum_up(&mut self, of: impl Fn(&Node) -> f64, add: impl Fn(&mut Node, f64)) {
        for at in (1..self.nodes.len()).rev() {
            let value = of(&self.nodes[at]);
            let parent = self.nodes[at].parent as usize;
            add(&mut self.nodes[parent], value);
        }
    }

    /// For each leaf the density of photons in its region of the cut, D of G Eq. 10, over the largest of all that have
    /// points. A region without statistics takes the density of its nearest ancestor that has some;
    /// 1 where there is none.
    pub fn densities(&self) -> Vec<f64> {
        let densities = self.cut.iter().map(|&node| self.known_density(node));
        self.relative(densities.collect(), &self.cut)
    }

    /// As [`densities`](Self::densities), without a cut: the estimate of each leaf is shrunk towards that
    /// of the region it is half of, which is shrunk likewise, up to the root.
    ///
    /// The mean of a Poisson variable that was seen `n` times where `e` were expected, with a gamma prior
    /// that counts for `paths` looks at the region around it: `D = D_parent (paths + n) / (paths + e)`. Where
    /// nothing was seen, `e` goes by area.
    pub fn shrunk_densities(&self, paths: u32) -> Vec<f64> {
        let prior = f64::from(paths);
        // parents come before their children
        let mut known: Vec<f64> = Vec::with_capacity(self.nodes.len());
        for (at, node) in self.nodes.iter().enumerate() {
            let parent = &self.nodes[node.parent as usize];
            known.push(match (node.density(), known.get(node.parent as usize)) {
                _ if at == 0 => node.density().unwrap_or(0.0),
                (Some(density), Some(above)) if node.paths > 0.0 && *above > 0.0 => {
                    let expected = node.paths * above / density;
                    above * (prior + node.paths) / (prior + expected)
                }
                (None, Some(above)) if parent.area > 0.0 => {
                    let expected = parent.paths * node.area / parent.area;
                    above * prior / (prior + expected)
                }
                (_, above) => above.copied().unwrap_or(0.0),
            });
        }
        let of_leaves = self.leaves.iter().map(|&leaf| known[leaf as usize]);
        self.relative(of_leaves.collect(), &self.leaves)
    }

    /// Densities of nodes over the largest of those that have points; 1 where nothing is known.
    fn relative(&self, densities: Vec<f64>, nodes: &[u32]) -> Vec<f64> {
        let here = densities.iter().zip(nodes);
        let most = here
            .filter(|(_, node)| self.nodes[**node as usize].area > 0.0)
            .map(|(density, _)| *density)
            .fold(0.0, f64::max);
        let relative = |density: f64| {
            if most > 0.0 && density > 0.0 {
                (density / most).min(1.0)
            } else {
                1.0
            }
        };
        densities.into_iter().map(relative).collect()
    }

    fn known_density(&self, mut at: u32) -> f64 {
        loop {
            let node = &self.nodes[at as usize];
            if let Some(density) = node.density() {
                return density;
            }
            if at == 0 {
                return 0.0;
            }
            at = node.parent;
        }
    }

    /// Ends an iteration: all nodes take what their leaves have found, then the cut is refined.
    pub fn learn(&mut self, tallies: &[LeafTally], refinement: Refinement) {
        let mut sums = vec![LeafTally::default(); self.nodes.len()];
        for (&at, tally) in self.leaves.iter().zip(tallies) {
            sums[at as usize] = *tally;
        }
        for at in (1..self.nodes.len()).rev() {
            let tally = sums[at];
            let parent = &mut sums[self.nodes[at].parent as usize];
            parent.psi = [0, 1].map(|half| parent.psi[half] + tally.psi[half]);
            parent.flux = [0, 1].map(|power| parent.flux[power] + tally.flux[power]);
            parent.paths += tally.paths;
        }
        for (node, tally) in self.nodes.iter_mut().zip(&sums) {
            node.learn(tally);
        }
        match refinement {
            Refinement::Adaptive { least, percent } => {
                let (least, error) = (f64::from(least), 0.01 * f64::from(percent));
                self.refine(|regions, children| regions.suffices(children, least, error));
            }
            Refinement::Shrunk { .. } => self.refine(|_, _| true),
            Refinement::Iterations => {
                let before: Vec<bool> = self.nodes.iter().map(|node| node.in_cut).collect();
                self.refine(|regions, [child, _]| {
                    before[regions.nodes[child as usize].parent as usize]
                });
            }
            Refinement::Off => {}
        }
    }

    /// Are both children known well enough? One that never had a point does not stand in the way.
    fn suffices(&self, children: [u32; 2], least: f64, error: f64) -> bool {
        let seen = children.map(|child| &self.nodes[child as usize]);
        let fine =
            |node: &&Node| node.iterations == 0 || (node.error() < error && node.paths >= least);
        seen.iter().all(fine) && seen.iter().any(|node| node.iterations > 0)
    }

    /// Puts children in the place of their parents in the cut as long as `wanted` says so.
    fn refine(&mut self, wanted: impl Fn(&Self, [u32; 2]) -> bool) {
        // Children come after their parents: one pass descends as far as it may.
        for at in 0..self.nodes.len() {
            let node = &self.nodes[at];
            let Some((_, _, children)) = node.split.filter(|_| node.in_cut) else {
                continue;
            };
            if wanted(self, children) {
                self.nodes[at].in_cut = false;
                for child in children {
                    self.nodes[child as usize].in_cut = true;
                }
            }
        }
        self.map_leaves();
    }

    fn map_leaves(&mut self) {
        let cut = self.leaves.iter().map(|&leaf| {
            let mut at = leaf;
            while !self.nodes[at as usize].in_cut && at != 0 {
                at = self.nodes[at as usize].parent;
            }
            at
        });
        self.cut = cut.collect();
    }
}

impl Node {
    fn learn(&mut self, tally: &LeafTally) {
        self.paths += tally.paths;
        if self.area > 0.0 {
            self.iterations += 1;
            self.delta = [0, 1].map(|half| self.delta[half] + tally.psi[half] / self.area);
            self.flux = [0, 1].map(|power| self.flux[power] + tally.flux[power] / self.area);
        }
    }

    /// Photons an area and light path, under uniform sampling; `None` if nothing is known. Where fluxes are
    /// known, so many photons of one flux as have the same relative variance: the inverse of G Eq. 3, which
    /// is that of Eq. 5 times the mean square of the flux over the square of its mean.
    fn density(&self) -> Option<f64> {
        let [flux, square] = self.flux;
        let delta = if square > 0.0 {
            flux * flux / square
        } else {
            self.delta[0] + self.delta[1]
        };
        (self.iterations > 0 && delta > 0.0).then(|| delta / self.iterations as f64)
    }

    /// By how much the halves disagree: err of G sec. 4.2, each half doubled to stand for the whole.
    fn error(&self) -> f64 {
        let sum = self.delta[0] + self.delta[1];
        if sum > 0.0 {
            2.0 * (self.delta[0] - self.delta[1]).abs() / sum
        } else {
            f64::INFINITY
        }
    }
}

/// A factor of the target, of a value relative to the largest: G Eq. 11, in [EPSILON / (1 + EPSILON), 1].
#[inline]
pub fn inverse(relative: f64) -> f64 {
    EPSILON / (relative + EPSILON)
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

#[cfg(test)]
mod tests;
