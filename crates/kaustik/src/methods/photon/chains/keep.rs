//! Chains of photons written down and taken up again, between two iterations.

use std::io;

use kaustik_estimate::PhotonValue;
use kaustik_film::Counters;
use kaustik_mcmc::{AcceptanceAdaptation, Ladder, Mean, Pcg64Dxsm, Point, Power};
use serde::{Deserialize, Serialize};

use super::{Chains, PhotonChains};
use crate::engine::Nonfinite;
use crate::methods::photon::maps::Maps;
use crate::methods::photon::targets;
use crate::state::{Reader, StateError, Writer};

/// All but pictures and ladders.
#[derive(Serialize, Deserialize)]
struct Kept {
    iterations: u64,
    levels: Vec<KeptLevel>,
    visible: Option<Mean>,
    lit: u64,
    revival: Pcg64Dxsm,
    /// Of each ladder.
    nonfinite: Vec<Nonfinite>,
    counters: Counters,
    targets: targets::Kept,
}

/// How steps learn at a level, its rough normaliser, and the last one with its error.
type KeptLevel = (AcceptanceAdaptation<Power>, f64, [f64; 2]);

/// Where chains are: what is there is read anew in each iteration.
type KeptLadder<const K: usize> = (Pcg64Dxsm, Ladder<Point<Power>, (), K>);

impl<const K: usize> PhotonChains<K> {
    pub(super) fn write_down(&self, out: &mut Writer<'_>) -> io::Result<()> {
        let levels = (0..K).map(|level| {
            let adaptation = self.adaptations[level].clone();
            (adaptation, self.rough[level], self.normalisers[level])
        });
        out.value(&Kept {
            iterations: self.iterations,
            levels: levels.collect(),
            visible: self.visible,
            lit: self.lit,
            revival: self.revival.clone(),
            nonfinite: self.nonfinite.clone(),
            counters: self.counters,
            targets: self.targets.kept(self.maps.is_some()),
        })?;
        if self.visible.is_some() {
            out.film(&self.films[0])?;
        }
        out.numbers(self.sums.as_flattened().iter())?;
        if let Some(maps) = &self.maps {
            out.numbers(maps.sums().as_flattened().iter())?;
        }
        self.ladders
            .iter()
            .try_for_each(|chains| out.value(&(&chains.draws, chains.ladder.with_values([(); K]))))
    }

    pub(super) fn take_from(
        &mut self,
        from: &mut Reader<'_>,
        iterations: u64,
    ) -> Result<(), StateError> {
        let wrong = |what: &str| StateError::damaged(what);
        let kept: Kept = from.value()?;
        let levels: [KeptLevel; K] =
            (kept.levels.try_into()).map_err(|_| wrong("chains of other levels"))?;
        let known = |(_, rough, _): &KeptLevel| rough.is_finite() && *rough > 0.0;
        if kept.iterations != iterations
            || kept.visible.is_some() != self.visible.is_some()
            || kept.lit > iterations
            || kept.nonfinite.len() != self.ladders.len()
            || !levels.iter().all(known)
        {
            return Err(wrong("chains do not agree with their iterations"));
        }
        for count in [
            kept.counters.non_finite,
            kept.counters.too_large,
            kept.counters.overflowed,
        ] {
            Reader::count(count)?;
        }
        self.targets.take_up(kept.targets, self.maps.is_some())?;
        if self.visible.is_some() {
            from.film(&mut self.films[0])?;
        }
        from.numbers(self.sums.as_flattened_mut())?;
        if let Some(sums) = self.maps.as_mut().map(Maps::sums_mut) {
            from.numbers(sums.as_flattened_mut())?;
        }
        for chains in &mut self.ladders {
            chains.take_up(from.value()?, &levels)?;
        }
        self.iterations = iterations;
        self.rough = levels.each_ref().map(|level| level.1);
        self.normalisers = levels.each_ref().map(|level| level.2);
        self.adaptations = levels.map(|level| level.0);
        (self.visible, self.lit) = (kept.visible, kept.lit);
        self.revival = kept.revival;
        let nonfinite = kept.nonfinite.into_iter().map(Nonfinite::checked);
        self.nonfinite = nonfinite.collect::<Result<_, _>>()?;
        self.counters = kept.counters;
        Ok(())
    }
}

impl<const K: usize> Chains<K> {
    /// Refuses what no ladder of these chains can have left.
    fn take_up(
        &mut self,
        (draws, ladder): KeptLadder<K>,
        levels: &[KeptLevel; K],
    ) -> Result<(), StateError> {
        let before = &self.ladder;
        let learnt = (ladder.replicas().iter().zip(levels))
            .all(|(replica, level)| *replica.state().mutation() == level.0.mutation());
        let same = ladder.graph().pairs() == before.graph().pairs()
            && ladder.schedule() == before.schedule()
            && ladder.stepping_stone().below() == before.stepping_stone().below();
        if !(same && learnt) {
            return Err(StateError::damaged("a ladder does not agree with itself"));
        }
        self.draws = draws;
        self.ladder = ladder.with_values(std::array::from_fn(|_| PhotonValue::default()));
        Ok(())
    }
}
