//! What a film held before work that a stop may break off: it is taken back to there.

use std::convert::Infallible;

use kaustik_film::{Counters, Film};

use crate::state::packed::{Packed, pack};

/// The sums of a film as they were, packed as in states: of a bright film some 15 bytes a pixel, of a dark
/// one next to nothing. Its memory is used again.
#[derive(Default)]
pub(crate) struct FilmMark {
    packed: Vec<u8>,
    /// Sums that were packed.
    count: usize,
    counters: Counters,
}

impl FilmMark {
    /// Writes down what a film holds.
    pub(crate) fn set(&mut self, film: &Film) {
        self.packed.clear();
        let sums = film.sums();
        self.count = sums.len();
        let Ok(()) = pack::<Infallible>(sums, |piece| {
            self.packed.extend_from_slice(piece);
            Ok(())
        });
        self.counters = film.counters();
    }

    /// Takes the very film back to it.
    pub(crate) fn take_back(&self, film: &mut Film) {
        film.clear();
        let Some((sums, _)) = Packed::split(&self.packed, self.count) else {
            unreachable!("a film was packed");
        };
        // They came from this film: there are as many, and no sum is past its limit.
        let restored = film.add_sums(sums, &self.counters);
        debug_assert!(restored.is_ok());
    }
}
