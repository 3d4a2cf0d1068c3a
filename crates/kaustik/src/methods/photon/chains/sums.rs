//! What an iteration adds to the picture.

use std::iter::once;

use kaustik_film::Film;
use kaustik_mcmc::SteppingStone;

use super::PhotonChains;
use crate::engine::add_counters;

/// So many ladders make their spread a better measure of errors than the spread of batches within each.
const LADDERS_FOR_ERRORS: usize = 4;

/// What turns sums at each level into shares of the picture.
pub(super) struct Factors<const K: usize> {
    /// `b_l / (b0_l N_l)`.
    pub(super) of_all: [f64; K],
    /// The same of what is on films: over visibility's normaliser where that is still to come.
    pub(super) of_films: [f64; K],
}

impl<const K: usize> PhotonChains<K> {
    /// Normalisers of the iteration.
    pub(super) fn normalise(&mut self) -> Factors<K> {
        let mut stone = SteppingStone::<K>::line();
        for chains in &self.ladders {
            let found = chains.ladder.stepping_stone();
            if self.ladders.len() < LADDERS_FOR_ERRORS {
                stone.merge(found);
            } else {
                stone.merge_as_one(found);
            }
        }
        let count =
            |level: usize| -> f64 { self.ladders.iter().map(|chains| chains.counts[level]).sum() };
        let counts: [f64; K] = std::array::from_fn(count);
        let of = |normalisers: [f64; K]| {
            std::array::from_fn(|level| match counts[level] {
                count if count > 0.0 => normalisers[level] / (self.rough[level] * count),
                _ => 0.0,
            })
        };
        match &mut self.visible {
            None => {
                self.normalisers = chained(&stone);
                let of_all = of(self.normalisers.map(|[value, _]| value));
                Factors {
                    of_all,
                    of_films: of_all,
                }
            }
            Some(visible) => {
                let ratios = stone.ratios();
                visible.push(ratios[1]);
                let (share, error) = (visible.mean(), visible.standard_error());
                let above_visible = errors_above(&stone);
                let mut above = [1.0; K];
                for level in 2..K {
                    above[level] = above[level - 1] * ratios[level];
                }
                self.normalisers = std::array::from_fn(|level| match level {
                    0 => [1.0, 0.0],
                    _ => {
                        let (above, value) = (above[level], share * above[level]);
                        [value, (error * above).hypot(value * above_visible[level])]
                    }
                });
                self.lit += u64::from(counts[1..].iter().any(|&count| count > 0.0));
                Factors {
                    of_all: of(self.normalisers.map(|[value, _]| value)),
                    of_films: of(above),
                }
            }
        }
    }

    /// Adds the films' light to the picture, and makes them black. What waits for visibility's normaliser is
    /// added without it; where anything does, the light of the first chain stays on its film, as its factor
    /// is always the same.
    pub(super) fn collect(&mut self, spare: &mut Film, factors: &[f64; K]) {
        let films = self.films.iter_mut().chain(once(spare));
        for (level, (film, factor)) in films.zip(factors).enumerate() {
            if level == 0 && self.visible.is_some() {
                continue;
            }
            let scale = factor * film.quantum().value();
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
        // Where all chains were in the dark nothing is known of what they would have brought.
        let known = self.iterations as f64 / self.lit.max(1) as f64;
        let share = (self.visible.as_ref()).map(|visible| visible.mean() * known);
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
        // Of a single batch nothing is known.
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
