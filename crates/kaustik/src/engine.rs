//! What the render loop asks of a method.

use std::sync::atomic::AtomicBool;

use kaustik_film::{Counters, Image, Layer};
use kaustik_path::{Event, RayCounts};
use serde::{Deserialize, Serialize};

use crate::state::{Keep, Reader, StateError};
use crate::{
    ChainStatistics, DirectStatistics, EnergyStatistics, MutationStatistics, PhotonStatistics,
    RenderError, RenderSettings, ReplicaStatistics, StageStatistics, StepId,
};

/// A method at work: ladders that can be driven on, films that can be developed, and a state that can be kept.
///
/// The picture depends on the number of steps alone, never on how they are cut into rounds. Ladders are
/// independent of each other, but for those of photon methods and of stages: these learn from each other at
/// the end of an iteration or a stage, and move on only when all have come there.
pub(crate) trait Engine: Keep {
    /// Drives the ladders of this process on by as many steps as `plan` says for each, on the threads
    /// of the current pool; returns early when `stop` is raised. Returns the number of steps taken.
    fn advance(&mut self, plan: &[u64], stop: Option<&AtomicBool>) -> u64;

    /// Steps that a ladder is to take in all.
    fn planned(&self, ladder: u32, settings: &RenderSettings) -> u64 {
        settings.planned(ladder)
    }

    /// Steps that leave one in each cell of the raster, where samples visit these in turn: with a filter wider than a pixel there are
    /// some beyond the picture.
    fn pass(&self) -> Option<u64> {
        None
    }

    /// The smallest number of steps of a ladder that leaves the picture even.
    fn grain(&self, _ladder: u32) -> u64 {
        1
    }

    /// The picture of all steps taken. For the end: what chains hold back is added first.
    fn develop(&mut self) -> Result<Image, RenderError>;

    /// Does [`develop`](Self::develop) change what goes on from there?
    fn holds_back(&self) -> bool {
        true
    }

    /// The chains so far.
    fn chain_statistics(&self) -> Option<ChainStatistics> {
        None
    }

    /// The replicas so far.
    fn replica_statistics(&self) -> Option<ReplicaStatistics> {
        None
    }

    /// Direct light that is rendered apart, so far.
    fn direct_statistics(&self) -> Option<DirectStatistics> {
        None
    }

    /// The kinds of mutations of paths so far.
    fn mutation_statistics(&self) -> Vec<MutationStatistics> {
        Vec::new()
    }

    /// Light that chains redistribute so far. After [`develop`](Self::develop).
    fn energy_statistics(&self) -> Option<EnergyStatistics> {
        None
    }

    /// The chains of photons so far.
    fn photon_statistics(&self) -> Option<PhotonStatistics> {
        None
    }

    /// The stages of a multi-stage method so far, that at work last.
    fn stage_statistics(&self) -> Vec<StageStatistics> {
        Vec::new()
    }

    /// Parts of the picture, each weighted as it is in the whole. After [`develop`](Self::develop).
    fn layers(&self) -> Result<Vec<Layer>, RenderError> {
        Ok(Vec::new())
    }

    /// Contributions left out because they were not finite, and where the first of each ladder arose.
    fn nonfinite(&self) -> (u64, Vec<StepId>);

    /// Takes the step at this place, and those before it where they follow on each other, and tells
    /// what happened in it.
    ///
    /// The engine must not be [past it](Self::ahead), and must be dropped afterwards; if the method
    /// [has shares](crate::Method::has_shares), it must drive that ladder alone. Refuses a step that does not exist.
    fn replay(&mut self, place: StepId) -> Result<Vec<Event>, RenderError>;

    /// Iterations or stages of the whole render that [`replay`](Self::replay) has to run before it comes to
    /// the one of this place; `None` if the engine is past it.
    fn ahead(&self, _place: StepId) -> Option<u64> {
        Some(0)
    }

    /// The rays of all steps taken; `None` of a method that does not count them.
    fn rays(&self) -> Option<RayCounts> {
        None
    }

    /// What the films left out.
    fn film_counters(&self) -> Counters;

    /// Does anything bring light to the camera? `false` lets the render end at once.
    fn is_lit(&self) -> bool {
        true
    }
}

/// Steps between two looks at the stop flag.
pub(crate) const STRIDE: u64 = 1024;

/// Steps of a ladder whose places are kept: enough to look at, and no more memory the more there are.
const KEPT: usize = 4;

/// Counts contributions of one ladder that were not finite, and knows the first steps where that was so.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Nonfinite {
    count: u64,
    /// Of `steps`.
    kept: u8,
    /// Rising.
    steps: [u64; KEPT],
}

impl Nonfinite {
    /// Takes what a step left out.
    #[inline]
    pub(crate) fn count(&mut self, found: u64, step: u64) {
        if found > 0 {
            self.count += found;
            self.keep(step);
        }
    }

    fn keep(&mut self, step: u64) {
        let kept = usize::from(self.kept);
        if kept < KEPT && !self.steps().contains(&step) {
            self.steps[kept] = step;
            self.kept += 1;
        }
    }

    fn steps(&self) -> &[u64] {
        &self.steps[..usize::from(self.kept)]
    }

    /// As it was read from a state.
    pub(crate) fn checked(self) -> Result<Self, StateError> {
        Reader::count(self.count)?;
        let kept = usize::from(self.kept);
        if kept > KEPT || (kept == 0) != (self.count == 0) || kept as u64 > self.count {
            return Err(StateError::damaged("its faults do not add up"));
        }
        // Numbers of steps are places and no counts: samples beside chains have some from far up.
        if self.steps.iter().any(|&step| step > u64::MAX / 2) {
            return Err(StateError::damaged("a step is beyond all that are"));
        }
        Ok(self)
    }

    /// Both, with the first steps of either.
    pub(crate) fn and(self, other: Self) -> Self {
        if other.count == 0 {
            return self;
        }
        let mut both = Self {
            count: self.count + other.count,
            ..Self::default()
        };
        let mut steps = [self.steps(), other.steps()].concat();
        steps.sort_unstable();
        steps.into_iter().for_each(|step| both.keep(step));
        both
    }

    /// All of several ladders, and the first places of each.
    pub(crate) fn all(ladders: impl Iterator<Item = (u32, Self)>) -> (u64, Vec<StepId>) {
        ladders.fold((0, Vec::new()), |(sum, mut places), (ladder, nonfinite)| {
            let steps = nonfinite.steps().iter();
            places.extend(steps.map(|&step| StepId { ladder, step }));
            (sum + nonfinite.count, places)
        })
    }
}

/// What two parts left out, and the places of both.
pub(crate) fn add_nonfinite(
    (count, mut places): (u64, Vec<StepId>),
    other: Option<(u64, Vec<StepId>)>,
) -> (u64, Vec<StepId>) {
    let (more, there) = other.unwrap_or_default();
    places.extend(there);
    (count + more, places)
}

/// Rays of several parts, in their order.
pub(crate) fn add_rays(parts: impl Iterator<Item = RayCounts>) -> RayCounts {
    parts.fold(RayCounts::default(), |mut sum, part| {
        sum += part;
        sum
    })
}

/// Sum of two films' counters.
pub(crate) fn add_counters(a: Counters, b: Counters) -> Counters {
    Counters {
        non_finite: a.non_finite + b.non_finite,
        too_large: a.too_large + b.too_large,
        overflowed: a.overflowed + b.overflowed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples beside chains have numbers that no count may have.
    #[test]
    fn faults_of_samples_from_far_up_are_read_again() {
        let at = |step| {
            let mut faults = Nonfinite::default();
            faults.count(1, step);
            faults.checked()
        };
        assert!(at(u64::MAX / 4 + 7).is_ok());
        assert!(at(u64::MAX).is_err());
    }

    #[test]
    fn the_first_faults_are_kept_and_all_are_counted() {
        let mut faults = Nonfinite::default();
        for step in [3, 3, 5, 8, 13, 21, 34] {
            faults.count(0, step - 1);
            faults.count(2, step);
        }
        assert_eq!((faults.count, faults.steps()), (14, &[3, 5, 8, 13][..]));
        let mut others = Nonfinite::default();
        others.count(1, 4);
        assert_eq!(
            (faults.and(others).count, faults.and(others).steps()),
            (15, &[3, 4, 5, 8][..])
        );
        assert_eq!(Nonfinite::default().and(others), others);
        let (sum, places) = Nonfinite::all([(7, faults), (9, others)].into_iter());
        assert_eq!(
            (sum, places.len(), places[4]),
            (15, 5, StepId { ladder: 9, step: 4 })
        );
        assert!(faults.checked().is_ok() && Nonfinite::default().checked().is_ok());
        for wrong in [
            Nonfinite { kept: 5, ..faults },
            Nonfinite { kept: 0, ..faults },
            Nonfinite { count: 0, ..faults },
            Nonfinite { count: 3, ..faults },
        ] {
            assert!(wrong.checked().is_err());
        }
    }
}
