//! What the visits of one iteration tell about regions, in integers that many threads add to.

use std::sync::atomic::{AtomicI64, Ordering::Relaxed};

use kaustik_mcmc::Visit;

use crate::{LeafTally, PhotonMap, PhotonValue};

/// Steps of one: weights are near one, and sums stay below 2^62.
const STEP: f64 = (1u64 << 24) as f64;

/// Of fluxes, which are given relative to a typical one: steps of squares, and the largest that counts.
const SQUARE_STEP: f64 = (1u64 << 20) as f64;
const MOST_FLUX: f64 = 256.0;

/// Which chains' visits are counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Witnesses {
    /// All chains but the one that follows what is being estimated, by the power heuristic with exponent 2.
    #[default]
    Others,
    /// The chain of visibility alone (G Eq. 6).
    Visibility,
    /// All chains, by the same heuristic. Within an iteration targets stand, so that the chain of the full one is as good a
    /// witness as any; where light is seldom it is the only one that comes often.
    All,
}

/// Sums for each leaf, of each level and half.
///
/// The number of points that a path touches there, weighted by `share b0_l / T_l` (times `b_l / (b0_l N_l)` a term of
/// G Eq. 6), and the share with which the path counts.
#[derive(Debug)]
pub struct RegionSums<const K: usize> {
    /// The leaf of each measurement point.
    leaves: Vec<u32>,
    /// For each leaf and level: psi of both halves, paths, flux, its square.
    sums: Vec<[[AtomicI64; 5]; K]>,
    counts: [bool; K],
    /// A typical flux that a path brings to a point, if fluxes are asked for.
    typical: Option<f64>,
}

impl<const K: usize> RegionSums<K> {
    /// For so many leaves. `levels` are the targets of the ladder (see [`PhotonLevels`](crate::PhotonLevels)); the last is
    /// the full one.
    pub fn new(leaves: usize, levels: [usize; K], witnesses: Witnesses) -> Self {
        let counts = std::array::from_fn(|level| match witnesses {
            Witnesses::Visibility if levels.contains(&1) => levels[level] == 1,
            Witnesses::All => true,
            _ => level + 1 < K || K == 1,
        });
        let zeros = || std::array::from_fn(|_| std::array::from_fn(|_| AtomicI64::new(0)));
        Self {
            leaves: Vec::new(),
            sums: (0..leaves).map(|_| zeros()).collect(),
            counts,
            typical: None,
        }
    }

    /// With the sums that the second-moment target needs. `typical` is about what a path brings to a point, > 0.
    #[must_use]
    pub fn with_fluxes(mut self, typical: f64) -> Self {
        self.typical = Some(typical);
        self
    }

    /// The leaves of the iteration that has ended, for whoever wants their memory for the next.
    #[must_use]
    pub fn take_leaves(&mut self) -> Vec<u32> {
        std::mem::take(&mut self.leaves)
    }

    /// Begins an iteration: all is zero.
    pub fn begin(&mut self, leaves: Vec<u32>) {
        self.leaves = leaves;
        for sum in self.sums.iter_mut().flatten().flatten() {
            *sum.get_mut() = 0;
        }
    }

    /// Takes a visit of a path that touches points.
    pub(crate) fn take(
        &self,
        visit: &Visit<'_, PhotonValue, K>,
        map: &PhotonMap<'_>,
        rough: &[f64; K],
        half: usize,
    ) {
        let level = visit.level;
        if !self.counts[level] {
            return;
        }
        let of = |at: usize| {
            let q = visit.densities[at] / rough[at];
            if self.counts[at] { q * q } else { 0.0 }
        };
        let share = of(level) / (0..K).map(of).sum::<f64>();
        let omega = share * rough[level] / visit.densities[level];
        let meetings = &visit.value.meetings;
        let leaf = |at: usize| self.leaves[meetings[at].point as usize];
        for at in 0..meetings.len() {
            // A path counts once at each point, and once in each leaf.
            let before = &meetings[..at];
            if before.iter().any(|other| other.point == meetings[at].point) {
                continue;
            }
            let sums = &self.sums[leaf(at) as usize][level];
            add(&sums[half], visit.weight * omega);
            if let Some(typical) = self.typical {
                let point = meetings[at].point;
                let here = meetings[at..].iter().filter(|other| other.point == point);
                let photons = visit.value.path.photons();
                let flux = here
                    .map(|m| {
                        map.points
                            .response(point as usize, &photons[m.photon as usize])
                    })
                    .sum::<f64>();
                let relative = (flux / typical).clamp(0.0, MOST_FLUX);
                add(&sums[3], visit.weight * omega * relative);
                let square = visit.weight * omega * relative * relative;
                let steps = (square * SQUARE_STEP).round_ties_even() as i64;
                sums[4].fetch_add(steps, Relaxed);
            }
            if !(0..at).any(|other| leaf(other) == leaf(at)) {
                add(&sums[2], visit.weight * share);
            }
        }
    }

    /// What was found, for each leaf. `factors` are `b_l / (b0_l N_l)`.
    pub fn tallies(&self, factors: &[f64; K]) -> Vec<LeafTally> {
        let tally = |levels: &[[AtomicI64; 5]; K]| {
            let mut tally = LeafTally::default();
            for (sums, factor) in levels.iter().zip(factors) {
                let of = |at: usize| sums[at].load(Relaxed) as f64;
                let [first, second, paths] = [0, 1, 2].map(|at| of(at) / STEP);
                tally.flux[0] += of(3) / STEP * factor;
                tally.flux[1] += of(4) / SQUARE_STEP * factor;
                tally.psi[0] += first * factor;
                tally.psi[1] += second * factor;
                tally.paths += paths;
            }
            tally
        };
        self.sums.iter().map(tally).collect()
    }
}

#[inline]
fn add(sum: &AtomicI64, value: f64) {
    sum.fetch_add((value * STEP).round_ties_even() as i64, Relaxed);
}
