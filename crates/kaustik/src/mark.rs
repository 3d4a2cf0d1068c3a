//! What a film held before work that a stop may break off: it is taken back to there.

use kaustik_film::{Counters, Film};

/// The sums of a film as they were: 24 bytes a pixel. Its memory is used again.
#[derive(Default)]
pub(crate) struct FilmMark {
    sums: Vec<i64>,
    counters: Counters,
}

impl FilmMark {
    /// Writes down what a film holds.
    pub(crate) fn set(&mut self, film: &Film) {
        self.sums.clear();
        self.sums.extend(film.sums());
        self.counters = film.counters();
    }

    /// Takes the very film back to it.
    pub(crate) fn take_back(&self, film: &mut Film) {
        film.clear();
        // They came from this film: there are as many, and no sum is past its limit.
        let restored = film.add_sums(self.sums.iter().copied(), &self.counters);
        debug_assert!(restored.is_ok());
    }
}
