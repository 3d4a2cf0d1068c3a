//! How the steps of rounds are counted.

use crate::methods::relt::climb::MOVES;

/// A path of a round: an independent sample at level 0, a proposal above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Step {
    /// Of its ladder.
    pub(super) round: u64,
    pub(super) level: u64,
    pub(super) particle: u64,
    /// Of the particle at the level.
    pub(super) step: u64,
}

impl Step {
    pub(super) fn new(round: u64, level: usize, particle: u64, step: u64) -> Self {
        Self {
            round,
            level: level as u64,
            particle,
            step,
        }
    }

    /// An independent sample.
    pub(super) fn sample(round: u64, particle: u64) -> Self {
        Self::new(round, 0, particle, 0)
    }

    /// Its number in rounds of so many particles that cost so many paths: samples, then level by level the
    /// steps of each particle.
    pub(super) fn number(self, particles: u64, cost: u64) -> u64 {
        let moves = MOVES as u64;
        let within = match self.level {
            0 => self.particle,
            level => particles + ((level - 1) * particles + self.particle) * moves + self.step,
        };
        self.round * cost + within
    }

    /// The step of this number.
    pub(super) fn of(number: u64, particles: u64, cost: u64) -> Self {
        let moves = MOVES as u64;
        let (round, within) = (number / cost, number % cost);
        let Some(above) = within.checked_sub(particles) else {
            return Self::sample(round, within);
        };
        Self {
            round,
            level: 1 + above / (particles * moves),
            particle: above / moves % particles,
            step: above % moves,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_path_has_a_number_of_its_own() {
        let (particles, levels) = (5, 3);
        let cost = particles * (1 + (levels - 1) * MOVES as u64);
        let mut number = 0;
        for round in 0..3 {
            for level in 0..levels {
                for particle in 0..particles {
                    let steps = if level == 0 { 1 } else { MOVES as u64 };
                    for step in 0..steps {
                        let at = Step::new(round, level as usize, particle, step);
                        assert_eq!(at.number(particles, cost), number);
                        assert_eq!(Step::of(number, particles, cost), at);
                        number += 1;
                    }
                }
            }
        }
        assert_eq!(number, 3 * cost);
    }
}
