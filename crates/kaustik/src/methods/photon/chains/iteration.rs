//! The sweeps of an iteration.

use std::sync::atomic::{AtomicBool, AtomicU64};

use kaustik_estimate::{
    PhotonDeposit, PhotonLevels, PhotonTarget, PhotonValue, RegionSums, RegionWitnesses, Scale,
    Sharing,
};
use kaustik_film::Film;
use kaustik_mcmc::{Ignore, PointKernel, Recorder};

use super::periods::Periods;
use super::{Chains, kernels};
use crate::control::is_stopped;
use crate::engine::Nonfinite;

/// Sweeps between two looks at the stop flag.
const SWEEPS_TO_A_LOOK: u64 = 32;

/// Sweeps that ladders of K chains take in every iteration, and how the steps of all iterations are counted:
/// a ladder's sweeps one after the other, those that burn in included, and in each sweep one for every chain,
/// whether it takes a step there or rests.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course<const K: usize> {
    /// Sweeps of each ladder that tell nothing.
    pub(super) burn_in: u64,
    /// Those of all ladders that follow.
    pub(super) sweeps: u64,
    pub(super) ladders: u64,
    /// Which chains take a step in these.
    pub(super) periods: Periods<K>,
}

/// Where a step of a ladder lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Step {
    pub(super) iteration: u64,
    /// In the iteration.
    pub(super) sweep: u64,
    pub(super) level: usize,
}

impl<const K: usize> Course<K> {
    /// Sweeps of a ladder that are told.
    fn told(&self, ladder: u64) -> u64 {
        self.sweeps / self.ladders + u64::from(ladder < self.sweeps % self.ladders)
    }

    /// Does the chain take a step in the sweep of this number? All do in those that burn in.
    #[inline]
    pub(super) fn steps(&self, level: usize, sweep: u64) -> bool {
        (sweep.checked_sub(self.burn_in)).is_none_or(|told| self.periods.steps(level, told))
    }

    /// Are exchanges tried after it?
    #[inline]
    pub(super) fn exchanges(&self, sweep: u64) -> bool {
        (sweep.checked_sub(self.burn_in)).is_none_or(|told| self.periods.exchanges(told))
    }

    /// Light paths of the chain of all ladders that are told.
    pub(super) fn count(&self, level: usize) -> u64 {
        let of = |ladder| self.periods.count(level, self.told(ladder));
        (0..self.ladders).map(of).sum()
    }

    /// All sweeps of a ladder.
    fn all(&self, ladder: u64) -> u64 {
        (self.burn_in + self.told(ladder)).max(1)
    }

    fn number(&self, ladder: u64, at: Step) -> u64 {
        (at.iteration * self.all(ladder) + at.sweep) * K as u64 + at.level as u64
    }

    /// The step of this number; `None` of a ladder that there is not.
    pub(super) fn step(&self, ladder: u64, number: u64) -> Option<Step> {
        let sweep = number / K as u64;
        (ladder < self.ladders).then(|| Step {
            iteration: sweep / self.all(ladder),
            sweep: sweep % self.all(ladder),
            level: (number % K as u64) as usize,
        })
    }
}

/// What all ladders have in common in an iteration.
pub(super) struct Iteration<'a, const K: usize> {
    pub(super) target: PhotonTarget<'a>,
    pub(super) levels: &'a PhotonLevels<K>,
    /// Counted from 0.
    pub(super) number: u64,
    pub(super) course: Course<K>,
    pub(super) scale: Scale,
    pub(super) films: [&'a Film; K],
    pub(super) sharing: Sharing<K>,
    pub(super) regions: Option<&'a RegionSums<K>>,
    /// Of so many of the first chain one tells regions.
    pub(super) visits_to_a_witness: u64,
    pub(super) touches: Option<&'a [AtomicU64]>,
}

/// The kernels of a ladder.
pub(super) type Kernels<'t, const K: usize> = [PointKernel<&'t PhotonTarget<'t>>; K];

/// Who goes through the sweeps of an iteration: a render, or somebody who looks at one of them.
pub(super) trait Sweeps<const K: usize> {
    /// Does it end before this sweep?
    fn end(&mut self, sweep: u64) -> bool;

    /// Takes the sweep of this number.
    fn sweep<R: Recorder<PhotonValue, K>>(
        &mut self,
        number: u64,
        chains: &mut Chains<K>,
        of: (&Iteration<'_, K>, &Kernels<'_, K>),
        recorder: &mut R,
    );

    /// Reports what states have gathered, after the sweep of this number.
    fn flush<R: Recorder<PhotonValue, K>>(
        &mut self,
        number: u64,
        chains: &mut Chains<K>,
        recorder: &mut R,
    );
}

/// A render.
pub(super) struct Unheard<'a> {
    pub(super) stop: Option<&'a AtomicBool>,
}

impl<const K: usize> Sweeps<K> for Unheard<'_> {
    #[inline]
    fn end(&mut self, sweep: u64) -> bool {
        sweep.is_multiple_of(SWEEPS_TO_A_LOOK) && is_stopped(self.stop)
    }

    #[inline]
    fn sweep<R: Recorder<PhotonValue, K>>(
        &mut self,
        number: u64,
        chains: &mut Chains<K>,
        (iteration, kernels): (&Iteration<'_, K>, &Kernels<'_, K>),
        recorder: &mut R,
    ) {
        let Chains { ladder, draws, .. } = chains;
        for (level, kernel) in kernels.iter().enumerate() {
            if iteration.course.steps(level, number) {
                ladder.step_at(level, kernel, iteration.levels, draws, recorder);
            }
        }
        if iteration.course.exchanges(number) {
            ladder.exchange(kernels, draws, recorder);
        }
    }

    fn flush<R: Recorder<PhotonValue, K>>(
        &mut self,
        _: u64,
        chains: &mut Chains<K>,
        recorder: &mut R,
    ) {
        chains.ladder.flush(recorder);
    }
}

impl<const K: usize> Iteration<'_, K> {
    /// The sweeps of the ladder of this number, or the first of them.
    pub(super) fn run(&self, index: usize, chains: &mut Chains<K>, sweeps: &mut impl Sweeps<K>) {
        let kernels = kernels::<K>(&self.target);
        let of = (self, &kernels);
        for number in 0..self.course.burn_in {
            if sweeps.end(number) {
                return;
            }
            sweeps.sweep(number, chains, of, &mut Ignore);
        }
        chains.ladder.flush(&mut Ignore);
        chains.ladder.reset_statistics();
        chains.counts = [0.0; K];
        chains.found = Nonfinite::default();
        // Both halves have a block of every ladder.
        let told = self.course.told(index as u64);
        let first = told / 2;
        let mut number = self.course.burn_in;
        for (half, count) in [(0, first), (1, told - first)] {
            let mut recorder = self.deposit((half + index) % 2);
            for left in (0..count).rev() {
                if sweeps.end(number) {
                    return;
                }
                sweeps.sweep(number, chains, of, &mut recorder);
                if left == 0 {
                    sweeps.flush(number, chains, &mut recorder);
                }
                if recorder.faults != [0; K] {
                    let faults = std::mem::replace(&mut recorder.faults, [0; K]);
                    self.count(index, number, faults, &mut chains.found);
                }
                number += 1;
            }
            for level in 0..K {
                chains.counts[level] += recorder.counts[level];
            }
        }
    }

    /// What was left out of what each chain reported in a sweep.
    #[cold]
    fn count(&self, ladder: usize, sweep: u64, faults: [u64; K], found: &mut Nonfinite) {
        for (level, faults) in faults.into_iter().enumerate() {
            let at = Step {
                iteration: self.number,
                sweep,
                level,
            };
            found.count(faults, self.course.number(ladder as u64, at));
        }
    }

    fn deposit(&self, half: usize) -> PhotonDeposit<'_, K> {
        PhotonDeposit {
            map: self.target.map,
            scale: self.scale,
            films: self.films,
            sharing: self.sharing,
            regions: (self.regions)
                .map(|sums| RegionWitnesses::new(sums, half, self.visits_to_a_witness)),
            touches: self.touches,
            counts: [0.0; K],
            faults: [0; K],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_step_has_a_number_of_its_own() {
        let course = Course::<3> {
            burn_in: 4,
            sweeps: 11,
            ladders: 2,
            periods: Periods::of([1, 2, 3]),
        };
        for (ladder, sweeps) in [(0, 10), (1, 9)] {
            let all = (0..3).flat_map(|iteration| {
                let levels = move |sweep| (0..3).map(move |level| (iteration, sweep, level));
                (0..sweeps).flat_map(levels)
            });
            for (number, (iteration, sweep, level)) in (0..).zip(all) {
                let at = Step {
                    iteration,
                    sweep,
                    level,
                };
                assert_eq!(course.number(ladder, at), number);
                assert_eq!(course.step(ladder, number), Some(at));
            }
        }
        assert_eq!(course.step(2, 0), None);
        // six sweeps and five: the second chain takes 3 + 3 steps, the last 2 + 2
        assert_eq!([0, 1, 2].map(|level| course.count(level)), [11, 6, 4]);
    }
}
