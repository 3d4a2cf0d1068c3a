//! What finished stages have counted.

use kaustik_film::Counters;
use kaustik_path::RayCounts;
use serde::{Deserialize, Serialize};

use crate::engine::{Engine, add_counters, add_rays};
use crate::state::{Reader, StateError};
use crate::{ChainStatistics, MutationStatistics, RenderStatistics, StageStatistics, StepId};

/// Sums over stages, and what each tells of itself.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Past {
    stages: Vec<StageStatistics>,
    nonfinite: u64,
    /// Ladders and steps where the first arose.
    places: Vec<(u32, u64)>,
    rays: Option<[u64; 2]>,
    counters: [u64; 3],
    /// Of each kind of mutation: proposals, and of how many of them acceptance was expected.
    moves: Vec<(u64, f64)>,
    longest_stay: u64,
    defects: u64,
}

/// Counts of an engine whose steps are those of a render after so many of each ladder.
pub(super) struct Counted<'e> {
    pub(super) engine: &'e dyn Engine,
    pub(super) start: u64,
    pub(super) width: u32,
}

impl Counted<'_> {
    /// What the stage tells of itself.
    pub(super) fn statistics(&self) -> StageStatistics {
        let chain = self.engine.chain_statistics();
        let of = |value: fn(&ChainStatistics) -> f64| chain.as_ref().map_or(0.0, value);
        StageStatistics {
            width: self.width,
            mutations: self.engine.steps(),
            normalisation: of(|chain| chain.normalisation),
            normalisation_error: of(|chain| chain.normalisation_error),
            small_acceptance: of(|chain| chain.small_acceptance),
            large_acceptance: of(|chain| chain.large_acceptance),
        }
    }

    fn nonfinite(&self) -> (u64, Vec<StepId>) {
        let (count, mut places) = self.engine.nonfinite();
        for place in &mut places {
            place.step = place.step.saturating_add(self.start);
        }
        (count, places)
    }
}

impl Past {
    /// What was measured in each stage so far.
    pub(super) fn stages(&self) -> &[StageStatistics] {
        &self.stages
    }

    /// Takes in a stage that has come to its end.
    pub(super) fn push(&mut self, stage: &Counted<'_>) {
        self.stages.push(stage.statistics());
        let (count, places) = self.nonfinite(stage);
        self.nonfinite = count;
        self.places = (places.iter().take(RenderStatistics::MOST_PLACES))
            .map(|place| (place.ladder, place.step))
            .collect();
        self.rays = self.rays(stage).map(|rays| [rays.closest, rays.any]);
        let counters = self.counters(stage);
        self.counters = [counters.non_finite, counters.too_large, counters.overflowed];
        let moves = self.mutations(stage).into_iter();
        self.moves = moves
            .map(|kind| (kind.proposed, kind.acceptance * kind.proposed as f64))
            .collect();
        if let Some(chain) = stage.engine.chain_statistics() {
            self.longest_stay = self.longest_stay.max(chain.longest_stay);
            self.defects += chain.defects;
        }
    }

    /// The chains of this stage, with what others count.
    pub(super) fn chain(&self, stage: &Counted<'_>) -> Option<ChainStatistics> {
        let chain = stage.engine.chain_statistics()?;
        Some(ChainStatistics {
            longest_stay: self.longest_stay.max(chain.longest_stay),
            defects: self.defects + chain.defects,
            ..chain
        })
    }

    /// All stages and this one.
    pub(super) fn nonfinite(&self, stage: &Counted<'_>) -> (u64, Vec<StepId>) {
        let (count, more) = stage.nonfinite();
        let places = self.places.iter();
        let mut places: Vec<StepId> = places
            .map(|&(ladder, step)| StepId { ladder, step })
            .collect();
        places.extend(more);
        (self.nonfinite + count, places)
    }

    /// All stages and this one; `None` if their method does not count rays.
    pub(super) fn rays(&self, stage: &Counted<'_>) -> Option<RayCounts> {
        let [closest, any] = self.rays.unwrap_or_default();
        let rays = stage.engine.rays()?;
        Some(add_rays([RayCounts { closest, any }, rays].into_iter()))
    }

    /// All stages and this one.
    pub(super) fn counters(&self, stage: &Counted<'_>) -> Counters {
        let [non_finite, too_large, overflowed] = self.counters;
        let before = Counters {
            non_finite,
            too_large,
            overflowed,
        };
        add_counters(before, stage.engine.film_counters())
    }

    /// All stages and this one.
    pub(super) fn mutations(&self, stage: &Counted<'_>) -> Vec<MutationStatistics> {
        let mut kinds = stage.engine.mutation_statistics();
        for (kind, &(proposed, expected)) in kinds.iter_mut().zip(&self.moves) {
            let all = kind.proposed + proposed;
            let sum = kind.acceptance * kind.proposed as f64 + expected;
            kind.proposed = all;
            kind.acceptance = sum / all.max(1) as f64;
        }
        kinds
    }

    /// Refuses what no stages can have counted.
    pub(super) fn check(&self) -> Result<(), StateError> {
        let rays = self.rays.unwrap_or_default();
        let proposed = self.moves.iter().map(|(proposed, _)| *proposed);
        let stages = self.stages.iter().map(|stage| stage.mutations);
        let places = self.places.iter().map(|(_, step)| *step);
        let others = [self.nonfinite, self.longest_stay, self.defects];
        let counts = others.into_iter().chain(rays).chain(self.counters);
        for count in counts.chain(proposed).chain(stages).chain(places) {
            Reader::count(count)?;
        }
        if self.places.len() > RenderStatistics::MOST_PLACES {
            return Err(StateError::damaged("its faults do not add up"));
        }
        Ok(())
    }
}
