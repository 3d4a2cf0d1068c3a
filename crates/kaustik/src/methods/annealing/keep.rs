//! Rounds of populations written down and taken up again.

use std::io;

use kaustik_mcmc::{Estimate, Mean};
use serde::{Deserialize, Serialize};

use super::{AnnealingEngine, Level, Told};
use crate::engine::Nonfinite;
use crate::state::{Keep, Reader, StateError, Writer};

/// A [`Told`] as it is kept.
#[derive(Serialize, Deserialize)]
struct Kept {
    ladder: u32,
    rounds: u64,
    levels: Vec<Level>,
    light: Mean,
    nonfinite: Nonfinite,
}

/// Film and what rounds have told: no population lives on. The first annealing is done again, and compared.
impl<const K: usize> Keep for AnnealingEngine<'_, K> {
    /// On the account of the first ladder.
    fn taken(&self) -> Vec<u64> {
        let mut taken = vec![0; self.told.len()];
        if let Some(first) = taken.first_mut() {
            *first = self.rounds() * self.cost();
        }
        taken
    }

    fn write(&self, out: &mut Writer<'_>) -> io::Result<()> {
        out.value(&self.rough.to_vec())?;
        out.film(&self.film)?;
        self.besides.write(out)?;
        let kept = self.told.iter().map(|told| Kept {
            ladder: told.ladder,
            rounds: told.rounds,
            levels: told.levels.to_vec(),
            light: told.light,
            nonfinite: told.nonfinite,
        });
        out.value(&kept.collect::<Vec<_>>())
    }

    fn take_up(&mut self, from: &mut Reader<'_>) -> Result<(), StateError> {
        let rough: Vec<Estimate> = from.value()?;
        if rough != self.rough {
            let value = |rough: &[Estimate]| rough.last().map_or(0.0, |b| b.value);
            return Err(StateError::pilot(value(&rough), value(&self.rough)));
        }
        from.film(&mut self.film)?;
        let passes = self.besides.take_up(from)?;
        let kept: Vec<Kept> = from.value()?;
        let (ladders, cost) = (from.ladders(), self.cost());
        let told = (self.told.iter_mut()).filter(|told| ladders.contains(&told.ladder));
        let mut rounds = 0;
        if kept.len() != ladders.len() {
            return Err(StateError::damaged("a ladder's rounds are missing"));
        }
        for (told, kept) in told.zip(kept) {
            *told = kept.checked(told.ladder, cost)?;
            rounds += told.rounds;
        }
        self.besides.check(passes, rounds * cost)?;
        let steps = self.rounds() * cost;
        self.besides.keep_up(steps);
        Ok(())
    }
}

impl Kept {
    /// Refuses what no rounds of this ladder can have told.
    fn checked<const K: usize>(self, ladder: u32, cost: u64) -> Result<Told<K>, StateError> {
        let wrong = || StateError::damaged("rounds do not agree with each other");
        let levels: [Level; K] = self.levels.try_into().map_err(|_| wrong())?;
        Reader::count(self.rounds.saturating_mul(cost))?;
        let sound = |level: &Level| {
            let means = [&level.normaliser, &level.share];
            let counts = [level.moves, level.independent.count()];
            means.iter().all(|mean| mean.count() == self.rounds)
                && counts.iter().all(|&count| Reader::count(count).is_ok())
                && level.accepted <= level.moves
        };
        if self.ladder != ladder || self.light.count() != self.rounds || !levels.iter().all(sound) {
            return Err(wrong());
        }
        Ok(Told {
            ladder,
            rounds: self.rounds,
            levels,
            light: self.light,
            nonfinite: self.nonfinite.checked()?,
        })
    }
}
