//! What an iteration adds to the picture.

use std::iter::once;

use kaustik_film::Film;
use kaustik_mcmc::{Mean, SteppingStone};

use super::PhotonChains;
use crate::engine::add_counters;

impl<const K: usize> PhotonChains<K> {
    /// Normalisers of the iteration, and what turns sums at each level into shares of the picture: `b_l / (b0_l N_l)`.
    pub(super) fn normalise(&mut self) -> [f64; K] {
        let mut stone = SteppingStone::<K>::line();
        for chains in &self.ladders {
            stone.merge_as_one(chains.ladder.stepping_stone());
        }
        self.normalisers = match &mut self.visible {
            None => chained(&stone),
            Some(visible) => {
                let ratios = stone.ratios();
                let above_visible = errors_above(&stone);
                visible.push(ratios[1]);
                let (share, error) = (visible.mean(), visible.standard_error());
                let mut above = 1.0;
                std::array::from_fn(|level| {
                    if level == 0 {
                        return [1.0, 0.0];
                    }
                    if level > 1 {
                        above *= ratios[level];
                    }
                    let value = share * above;
                    [value, (error * above).hypot(value * above_visible[level])]
                })
            }
        };
        std::array::from_fn(|level| {
            let count: f64 = self.ladders.iter().map(|chains| chains.counts[level]).sum();
            if count > 0.0 {
                self.normalisers[level][0] / (self.rough[level] * count)
            } else {
                0.0
            }
        })
    }

    /// Adds the films' light to the picture, and makes them black. What waits for visibility's normaliser is
    /// added without it; where anything does, the light of the first chain stays on its film, as its factor
    /// is always the same.
    pub(super) fn collect(&mut self, spare: &mut Film, factors: &[f64; K]) {
        let share = self.visible.as_ref().map(Mean::mean);
        let films = self.films.iter_mut().chain(once(spare));
        for (level, (film, factor)) in films.zip(factors).enumerate() {
            let mut scale = factor * film.quantum().value();
            if let Some(share) = share {
                if level == 0 {
                    continue;
                }
                scale = if share > 0.0 { scale / share } else { 0.0 };
            }
            let mut raw = film.sums();
            for sum in &mut self.sums {
                for channel in sum {
                    *channel += raw.next().unwrap_or_default() as f64 * scale;
                }
            }
            drop(raw);
            self.counters = add_counters(self.counters, film.counters());
            film.clear();
        }
    }

    /// XYZ of each pixel, summed over iterations: one after the other, as pictures are large. `first` turns
    /// what stays on the first film into shares of the picture, as [`normalise`](Self::normalise) has it.
    pub(super) fn total(&self, first: f64) -> impl Iterator<Item = [f64; 3]> + '_ {
        let scale = first * self.films[0].quantum().value();
        let share = self.visible.as_ref().map(Mean::mean);
        let mut raw = self.films[0].sums();
        self.sums.iter().map(move |sum| match share {
            None => *sum,
            Some(share) => {
                sum.map(|channel| raw.next().unwrap_or_default() as f64 * scale + share * channel)
            }
        })
    }
}

/// Relative errors of the normalisers over that of the second level, which stands for itself.
fn errors_above<const K: usize>(stone: &SteppingStone<K>) -> [f64; K] {
    let found = stone.normalisers(1.0);
    let squared = |level: usize| {
        let error = found.estimates()[level].relative_error();
        // Of a single ladder nothing is known.
        if error.is_finite() {
            error * error
        } else {
            0.0
        }
    };
    std::array::from_fn(|level| {
        let above = squared(level) - squared(1);
        if level > 1 {
            above.max(0.0).sqrt()
        } else {
            0.0
        }
    })
}

/// Each normaliser from the chain below (RELT eq. 10; G sec. 4.4), with its standard error.
fn chained<const K: usize>(stone: &SteppingStone<K>) -> [[f64; 2]; K] {
    let found = stone.normalisers(1.0);
    std::array::from_fn(|level| {
        let (value, estimate) = (found.values()[level], &found.estimates()[level]);
        let error = if value > 0.0 {
            estimate.relative_error() * value
        } else {
            0.0
        };
        [value, error]
    })
}
