//! A node of the tree, and what it learns.

#[derive(Clone, Debug, Default)]
pub(super) struct Node {
    pub(super) parent: u32,
    /// Axis, place, children: lower side first.
    pub(super) split: Option<(u8, f32, [u32; 2])>,
    pub(super) in_cut: bool,
    /// Number of the leaf, if it is one.
    pub(super) leaf: u32,
    /// Sums over iterations of psi / s, in two halves: kappa / s of G Eq. 8, defined without points as well.
    pub(super) delta: [f64; 2],
    /// The same of the flux that each of these paths brings, and of its square.
    pub(super) flux: [f64; 2],
    /// Iterations in which it had points.
    pub(super) iterations: u64,
    /// Light paths that touched it, each counted with its share; of a node above leaves the sum of theirs, so that a path which touched
    /// several of them counts for each.
    pub(super) paths: f64,
    /// Sum of the areas of this iteration's points (G Eq. 9).
    pub(super) area: f64,
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

impl Node {
    pub(super) fn learn(&mut self, tally: &LeafTally) {
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
    pub(super) fn density(&self) -> Option<f64> {
        let [flux, square] = self.flux;
        let delta = if square > 0.0 {
            flux * flux / square
        } else {
            self.delta[0] + self.delta[1]
        };
        (self.iterations > 0 && delta > 0.0).then(|| delta / self.iterations as f64)
    }

    /// By how much the halves disagree: err of G sec. 4.2, each half doubled to stand for the whole.
    pub(super) fn error(&self) -> f64 {
        let sum = self.delta[0] + self.delta[1];
        if sum > 0.0 {
            2.0 * (self.delta[0] - self.delta[1]).abs() / sum
        } else {
            f64::INFINITY
        }
    }
}
