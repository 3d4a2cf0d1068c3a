//! What the visits of one iteration tell about regions, in integers that many threads add to.

use std::sync::atomic::{AtomicI64, Ordering::Relaxed};

use kaustik_mcmc::Visit;

use crate::first_meetings::{FirstMeetings, Firsts};
use crate::{LeafTally, Meeting, PhotonLevels, PhotonMap, PhotonTargetKind, PhotonValue, Sharing};

/// Steps of one: weights, in the unit of the iteration, are near one.
const STEP: f64 = (1u64 << 20) as f64;
/// What a visit adds at most, in steps: sums of 2^24 visits stay below 2^62.
const MOST_STEPS: f64 = (1u64 << 38) as f64;

/// No leaf.
const NONE: u32 = u32::MAX;

/// Of fluxes, which are given relative to a typical one: steps of squares, and the largest that counts.
const SQUARE_STEP: f64 = (1u64 << 20) as f64;
const MOST_FLUX: f64 = 256.0;

/// Which chains' visits are counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Witnesses {
    /// All chains but the one that follows what is being estimated, by the power heuristic with exponent 2.
    #[default]
    Others,
    /// The chain of visibility alone (G Eq. 6). As [`Others`](Self::Others) in ladders that have none.
    Visibility,
    /// All chains, by the same heuristic. Targets do not change within an iteration, so the chain of the
    /// full target is as good a witness as any; where light is rare it is the only one that comes often.
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
    /// For each leaf and level.
    sums: Vec<[LevelSums; K]>,
    counts: [bool; K],
    /// A typical flux that a path brings to a point, if fluxes are asked for.
    typical: Option<f64>,
    /// What a visit is about worth, > 0: all sums of weights are in it.
    unit: f64,
}

/// Sums of one level in one leaf, in steps of fixed point, so that any order of adding gives the same.
#[derive(Debug, Default)]
struct LevelSums {
    /// `psi` of both halves, in steps of 1 / [`STEP`].
    psi: [AtomicI64; 2],
    /// Paths, likewise.
    paths: AtomicI64,
    /// Flux, relative to the typical one, likewise.
    flux: AtomicI64,
    /// Its square, in steps of 1 / [`SQUARE_STEP`].
    squared_flux: AtomicI64,
}

impl<const K: usize> RegionSums<K> {
    /// For so many leaves, in a ladder of these levels, of which the last is the full target.
    pub fn new(leaves: usize, levels: &PhotonLevels<K>, witnesses: Witnesses) -> Self {
        let visibility = PhotonTargetKind::Visibility;
        let counts = std::array::from_fn(|level| match witnesses {
            Witnesses::Visibility if levels.has(visibility) => levels.0[level] == visibility,
            Witnesses::All => true,
            _ => level + 1 < K || K == 1,
        });
        let zeros = || std::array::from_fn(|_| LevelSums::default());
        Self {
            leaves: Vec::new(),
            sums: (0..leaves).map(|_| zeros()).collect(),
            counts,
            typical: None,
            unit: 1.0,
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
        for sums in self.sums.iter_mut().flatten() {
            *sums = LevelSums::default();
        }
    }

    /// Sets the unit of the fixed-point sums for the iteration that has begun. `worth` > 0 is about what a visit
    /// of the chains above the first is worth of a uniform path; it is used only if one of those is counted. The unit keeps small weights from being rounded away.
    pub fn expect(&mut self, worth: f64) {
        let looks = self.counts.iter().skip(1).any(|counts| *counts);
        self.unit = if looks { worth } else { 1.0 };
    }

    /// Takes a visit of a path that touches points, in a ladder whose chains share so. It stands for so many like it.
    pub(crate) fn take(
        &self,
        visit: &Visit<'_, PhotonValue, K>,
        stands_for: f64,
        map: &PhotonMap<'_>,
        sharing: &Sharing<K>,
        half: usize,
        room: &mut FirstMeetings,
    ) {
        let level = visit.level;
        if !self.counts[level] {
            return;
        }
        let share = self.share(visit, sharing);
        let omega = share * sharing.rough[level] / visit.densities[level];
        let weight = stands_for * visit.weight * omega / self.unit;
        let meetings = &visit.value.meetings;
        let leaf = |meeting: &Meeting| self.leaves[meeting.point as usize];
        let firsts = room.of(meetings, &self.leaves);
        // Photons meet many points of one leaf in a row: what they add is added at once.
        let (mut run, mut points) = (NONE, 0.0);
        // Where the meetings of the photon begin: it meets no point twice.
        let mut own = 0;
        for (at, meeting) in meetings.iter().enumerate() {
            if meetings[own].photon != meeting.photon {
                own = at;
            }
            // A path counts once at each point, and once in each leaf.
            if !firsts.at_point(meetings, at, own) {
                continue;
            }
            let here = leaf(meeting);
            if here != run {
                self.add_points(run, level, half, weight * points);
                (run, points) = (here, 0.0);
                // What is known rests on the paths that were looked at.
                if firsts.in_leaf(meetings, at, &self.leaves) {
                    add(&self.sums[here as usize][level].paths, visit.weight * share);
                }
            }
            let stride = stride(visit.value, &firsts, at);
            points += stride;
            if let Some(typical) = self.typical {
                let flux = flux(visit.value, &firsts, at, map) / stride;
                self.sums[here as usize][level].add_flux(flux / typical, weight * stride);
            }
        }
        self.add_points(run, level, half, weight * points);
    }

    /// The share with which a visit counts, by the heuristic over the chains that are counted.
    #[inline]
    fn share(&self, visit: &Visit<'_, PhotonValue, K>, sharing: &Sharing<K>) -> f64 {
        let of = |at: usize| {
            let q = sharing.expected(visit.densities, at);
            if self.counts[at] { q * q } else { 0.0 }
        };
        of(visit.level) / (0..K).map(of).sum::<f64>()
    }

    #[inline]
    fn add_points(&self, leaf: u32, level: usize, half: usize, weight: f64) {
        if leaf != NONE {
            add(&self.sums[leaf as usize][level].psi[half], weight);
        }
    }

    /// What was found, for each leaf. `factors` are `b_l / (b0_l N_l)`.
    pub fn tallies(&self, factors: &[f64; K]) -> Vec<LeafTally> {
        let tally = |levels: &[LevelSums; K]| {
            let mut tally = LeafTally::default();
            for (sums, factor) in levels.iter().zip(factors) {
                let factor = factor * self.unit;
                let of = |sum: &AtomicI64| sum.load(Relaxed) as f64;
                tally.flux[0] += of(&sums.flux) / STEP * factor;
                tally.flux[1] += of(&sums.squared_flux) / SQUARE_STEP * factor;
                tally.psi[0] += of(&sums.psi[0]) / STEP * factor;
                tally.psi[1] += of(&sums.psi[1]) / STEP * factor;
                tally.paths += of(&sums.paths) / STEP;
            }
            tally
        };
        self.sums.iter().map(tally).collect()
    }
}

impl LevelSums {
    /// Adds what a path brings to a point, relative to the typical flux.
    #[inline]
    fn add_flux(&self, relative: f64, weight: f64) {
        let relative = relative.clamp(0.0, MOST_FLUX);
        add(&self.flux, weight * relative);
        add_steps(
            &self.squared_flux,
            weight * relative * relative * SQUARE_STEP,
        );
    }
}

/// For how many points the point of a meeting stands: it is kept as often as by the photon that keeps most.
#[inline]
fn stride(value: &PhotonValue, firsts: &Firsts<'_>, first: usize) -> f64 {
    if value.is_whole() {
        return 1.0;
    }
    let mut least = f64::INFINITY;
    firsts.each_at_its_point(&value.meetings, first, |meeting| {
        least = least.min(value.stands_for(meeting.photon));
    });
    least
}

/// What a path brings to the point of its meeting `first`, in this meeting and in all later ones, times what each stands for.
#[inline]
fn flux(value: &PhotonValue, firsts: &Firsts<'_>, first: usize, map: &PhotonMap<'_>) -> f64 {
    let photons = value.path.photons();
    let mut flux = 0.0;
    firsts.each_at_its_point(&value.meetings, first, |meeting| {
        let photon = &photons[meeting.photon as usize];
        let response = map.points.response(meeting.point as usize, photon);
        flux += response * value.stands_for(meeting.photon);
    });
    flux
}

#[inline]
fn add(sum: &AtomicI64, value: f64) {
    add_steps(sum, value * STEP);
}

#[inline]
fn add_steps(sum: &AtomicI64, steps: f64) {
    if steps.is_nan() {
        return; // `min` would make the largest of it
    }
    let steps = steps.round_ties_even().min(MOST_STEPS);
    sum.fetch_add(steps as i64, Relaxed);
}

#[cfg(test)]
pub(crate) mod tests {
    use std::collections::BTreeSet;

    use kaustik_mcmc::{Draws, generator};
    use kaustik_path::{Lookup, MeasurementPoints};
    use kaustik_spectrum::{WavelengthSampling, Wavelengths};

    use super::*;
    use crate::Combine;

    /// A map without points: no sum of weights asks for them.
    pub(crate) struct Nowhere(MeasurementPoints, Lookup, Wavelengths);

    impl Default for Nowhere {
        fn default() -> Self {
            let wavelengths = Wavelengths::sample(0.5, WavelengthSampling::default());
            Self(MeasurementPoints::default(), Lookup::default(), wavelengths)
        }
    }

    impl Nowhere {
        pub(crate) fn map(&self) -> PhotonMap<'_> {
            let Self(points, lookup, wavelengths) = self;
            PhotonMap {
                points,
                lookup,
                wavelengths,
                max_edges: 8,
            }
        }
    }

    /// Up to three photons, each of which meets up to three of twenty points.
    fn path(mut below: impl FnMut(f64) -> u32) -> PhotonValue {
        let mut value = PhotonValue::default();
        for photon in 0..=below(3.0) {
            let first = below(17.0);
            let met = (first..=first + below(3.0)).map(|point| Meeting { photon, point });
            value.meetings.extend(met);
        }
        value
    }

    /// Paths of up to three photons that meet points of four leaves, some points again: each leaf is told of
    /// each point once, and of each path once.
    #[test]
    fn a_path_counts_once_at_a_point_and_in_a_leaf() {
        let nowhere = Nowhere::default();
        let map = nowhere.map();
        let sharing = Sharing {
            combine: Combine::Balance,
            rough: [1.0, 0.5],
            samples: [1.0, 3.0],
        };
        let leaves: Vec<u32> = (0..20).map(|point| point / 5).collect();
        let levels = PhotonLevels([PhotonTargetKind::Uniform, PhotonTargetKind::Full]);
        let mut sums = RegionSums::new(4, &levels, Witnesses::All);
        sums.begin(leaves.clone());
        sums.expect(0.5);
        let mut rng = generator(71, 0);
        let mut below = |n: f64| (rng.uniform() * n) as u32;
        let mut exact = vec![LeafTally::default(); 4];
        for number in 0..500 {
            let value = path(&mut below);
            let (level, half) = (number % 2, number / 2 % 2);
            let densities = &[1.0, 1.0];
            sums.take(
                &Visit {
                    level,
                    value: &value,
                    densities,
                    weight: 0.25,
                    independent: 0.0,
                },
                1.0,
                &map,
                &sharing,
                half,
                &mut FirstMeetings::default(),
            );
            // expected samples: 1 and 6 at any path
            let share = [1.0, 36.0][level] / 37.0;
            let met: BTreeSet<u32> = value.meetings.iter().map(|m| m.point).collect();
            let of = |point: &u32| leaves[*point as usize] as usize;
            for point in &met {
                exact[of(point)].psi[half] += 0.25 * share * sharing.rough[level];
            }
            for leaf in met.iter().map(of).collect::<BTreeSet<_>>() {
                exact[leaf].paths += 0.25 * share;
            }
        }
        for (leaf, (found, exact)) in sums.tallies(&[1.0; 2]).iter().zip(&exact).enumerate() {
            let near = |a: f64, b: f64| (a - b).abs() < 1e-4;
            assert!(
                near(found.paths, exact.paths),
                "{leaf}: {found:?}, {exact:?}"
            );
            let halves = found.psi.iter().zip(exact.psi);
            assert!(
                halves.clone().all(|(a, b)| near(*a, b)),
                "{leaf}: {found:?}, {exact:?}"
            );
            assert!(exact.psi[0] > 1.0 && exact.psi[1] > 1.0);
        }
    }

    /// Where one uniform path in a thousand million is visible, visits tell as much as anywhere.
    #[test]
    fn what_is_seldom_seen_is_not_rounded_away() {
        let nowhere = Nowhere::default();
        let map = nowhere.map();
        let share = 1e-9;
        let sharing = Sharing {
            combine: Combine::Balance,
            rough: [1.0, share, 0.2 * share],
            samples: [1.0; 3],
        };
        let kinds = [
            PhotonTargetKind::Uniform,
            PhotonTargetKind::Visibility,
            PhotonTargetKind::Full,
        ];
        let mut sums = RegionSums::new(1, &PhotonLevels(kinds), Witnesses::Others);
        sums.begin(vec![0; 2]);
        sums.expect(share);
        let mut value = PhotonValue::default();
        value
            .meetings
            .extend([0, 1].map(|point| Meeting { photon: 0, point }));
        for _ in 0..1000 {
            let visit = Visit {
                level: 1,
                value: &value,
                densities: &[1.0, 1.0, 0.2],
                weight: 1.0,
                independent: 0.0,
            };
            sums.take(
                &visit,
                1.0,
                &map,
                &sharing,
                0,
                &mut FirstMeetings::default(),
            );
        }
        let [tally] = sums.tallies(&[1.0; 3])[..] else {
            panic!("one leaf");
        };
        assert!(
            (tally.psi[0] / (2000.0 * share) - 1.0).abs() < 1e-5,
            "{tally:?}"
        );
        assert!((tally.paths / 1000.0 - 1.0).abs() < 1e-5, "{tally:?}");
    }
}
