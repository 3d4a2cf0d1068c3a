//! Regions that gather how likely photons are: the hierarchy of the spatial target function (Gruson et al. 2016, "G").
//!
//! A tree is built once, from a pilot's measurement points; every node keeps its statistics, and a cut through the tree
//! says which regions the target goes by (G sec. 4.2). The cut begins at the root and is refined where the statistics
//! suffice.

mod build;
mod node;
mod refinement;

pub use node::LeafTally;
use node::Node;
pub use refinement::Refinement;

/// A position in the world or in the image (the unit square), then the normal times a length:
/// a tree tells orientations apart where regions are smaller than that length. With length zero
/// orientations do not count.
pub type RegionPoint = [f32; 6];

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

impl Regions {
    /// No render has so many iterations.
    const MOST_ITERATIONS: u64 = 1 << 60;

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

    /// Restores what regions with the same tree have learnt. `None` if the tree differs, or if the marked
    /// nodes are not a cut, that is, exactly one on the way from the root to each leaf.
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

/// A factor of the target, of a value relative to the largest: G Eq. 11, in [EPSILON / (1 + EPSILON), 1].
#[inline]
pub fn inverse(relative: f64) -> f64 {
    EPSILON / (relative + EPSILON)
}

#[cfg(test)]
mod tests;
