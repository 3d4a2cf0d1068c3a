//! What the render loop asks of a method.

use std::sync::atomic::AtomicBool;

use kaustik_film::{Counters, Image, Layer};
use kaustik_path::Rays;
use serde::{Deserialize, Serialize};

use crate::state::{Keep, Reader, StateError};
use crate::{
    ChainStatistics, DirectStatistics, EnergyStatistics, MutationStatistics, PhotonStatistics,
    Place, RenderError, RenderSettings, ReplicaStatistics,
};

/// A method at work: ladders that can be driven on, films that can be developed, and a state that can be kept.
///
/// Ladders are independent of each other and of how their steps are cut into rounds, so that
/// the picture depends on the number of steps alone.
pub(crate) trait Engine: Keep {
    /// Drives the ladders of this process on by as many steps as `plan` says for each, on the threads
    /// of the current pool; returns early when `stop` is raised. Returns the number of steps taken.
    fn advance(&mut self, plan: &[u64], stop: Option<&AtomicBool>) -> u64;

    /// Steps that a ladder is to take in all.
    fn planned(&self, ladder: u32, settings: &RenderSettings) -> u64 {
        settings.planned(ladder)
    }

    /// The smallest number of steps of a ladder that leaves the picture even.
    fn grain(&self, _ladder: u32) -> u64 {
        1
    }

    /// The picture of all steps taken. For the end: what chains hold back is added first.
    fn develop(&mut self) -> Result<Image, RenderError>;

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

    /// Parts of the picture, each weighted as it is in the whole. After [`develop`](Self::develop).
    fn layers(&self) -> Result<Vec<Layer>, RenderError> {
        Ok(Vec::new())
    }

    /// Contributions left out because they were not finite, and where the first arose.
    fn nonfinite(&self) -> (u64, Option<Place>);

    /// The rays of all steps taken; `None` of a method that does not count them.
    fn rays(&self) -> Option<Rays> {
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

/// Counts contributions of one ladder that were not finite.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Nonfinite {
    count: u64,
    first_step: u64,
}

impl Nonfinite {
    /// Takes what a step left out.
    #[inline]
    pub(crate) fn count(&mut self, found: u64, step: u64) {
        if found > 0 {
            if self.count == 0 {
                self.first_step = step;
            }
            self.count += found;
        }
    }

    /// As it was read from a state.
    pub(crate) fn checked(self) -> Result<Self, StateError> {
        Reader::count(self.count)?;
        Reader::count(self.first_step)?;
        Ok(self)
    }

    /// Both, with the first step of either.
    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            first_step: match (self.count, other.count) {
                (0, _) => other.first_step,
                (_, 0) => self.first_step,
                _ => self.first_step.min(other.first_step),
            },
        }
    }

    /// All of several ladders, and the place of the first.
    pub(crate) fn all(ladders: impl Iterator<Item = (u32, Self)>) -> (u64, Option<Place>) {
        ladders.fold((0, None), |(sum, first), (ladder, nonfinite)| {
            let step = nonfinite.first_step;
            let here = (nonfinite.count > 0).then_some(Place { ladder, step });
            (sum + nonfinite.count, first.or(here))
        })
    }
}

/// What two parts left out, and the first place of either.
pub(crate) fn add_nonfinite(
    (count, place): (u64, Option<Place>),
    other: Option<(u64, Option<Place>)>,
) -> (u64, Option<Place>) {
    let (more, there) = other.unwrap_or_default();
    (count + more, place.or(there))
}

/// Rays of several parts, in their order.
pub(crate) fn add_rays(parts: impl Iterator<Item = Rays>) -> Rays {
    parts.fold(Rays::default(), |mut sum, part| {
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
