//! What rounds have told.

use kaustik_mcmc::Mean;
use serde::{Deserialize, Serialize};

use super::deposit::Gathered;
use crate::engine::Nonfinite;
use crate::sampling::streams;

/// What the rounds of a ladder have told.
#[derive(Clone, Debug)]
pub(super) struct Told<const K: usize> {
    pub(super) ladder: u32,
    pub(super) rounds: u64,
    pub(super) levels: [Level; K],
    /// Light of each round.
    pub(super) light: Mean,
    pub(super) nonfinite: Nonfinite,
}

/// What rounds have told of a level.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Level {
    /// `Z_k` of each round, zero where the population died before.
    pub(super) normaliser: Mean,
    /// The density of independent samples.
    pub(super) independent: Mean,
    /// Light of the level in each round.
    pub(super) share: Mean,
    pub(super) moves: u64,
    pub(super) accepted: u64,
}

impl<const K: usize> Told<K> {
    pub(super) fn of(ladder: u32) -> Self {
        Self {
            ladder,
            rounds: 0,
            levels: [Level::default(); K],
            light: Mean::new(),
            nonfinite: Nonfinite::default(),
        }
    }

    /// The number of the generators of each level of the next round.
    pub(super) fn next(&self) -> impl Fn(usize) -> u64 + use<K> {
        let (ladder, round) = (self.ladder, self.rounds);
        move |level| streams::round(ladder, round, level)
    }

    /// Adds what particles of the next round have gathered at a level.
    pub(super) fn gather(&mut self, level: usize, gathered: &Gathered<K>) {
        self.levels[level].moves += gathered.moves;
        self.levels[level].accepted += gathered.accepted;
        for (of, mean) in self.levels.iter_mut().zip(&gathered.densities) {
            of.independent.merge(mean);
        }
    }

    /// Ends the next round, with `Z_k` and the light of each level.
    pub(super) fn end_round(
        &mut self,
        normalisers: &[f64; K],
        light: &[f64; K],
        faults: Nonfinite,
    ) {
        for (k, level) in self.levels.iter_mut().enumerate() {
            level.normaliser.push(normalisers[k]);
            level.share.push(light[k]);
        }
        self.light.push(light.iter().sum());
        self.nonfinite = self.nonfinite.and(faults);
        self.rounds += 1;
    }

    pub(super) fn merge(&mut self, other: &Self) {
        self.rounds += other.rounds;
        self.light.merge(&other.light);
        for (level, other) in self.levels.iter_mut().zip(&other.levels) {
            level.normaliser.merge(&other.normaliser);
            level.independent.merge(&other.independent);
            level.share.merge(&other.share);
            level.moves += other.moves;
            level.accepted += other.accepted;
        }
    }
}
