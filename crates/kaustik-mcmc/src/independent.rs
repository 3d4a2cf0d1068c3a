use kaustik_pss::{Coordinates, Stream};

use crate::Draws;

/// Plain Monte Carlo: every ask is a fresh uniform number.
///
/// Remembers nothing, so each address may be asked for at most once an evaluation. With
/// the generator of [`sample_generator`](crate::sample_generator) any sample can be made
/// again. A builder that asks for the same coordinates in the same order sees the same
/// numbers here as in an independent step of a [`Point`](crate::Point) on the same
/// generator.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Independent<D> {
    draws: D,
}

impl<D: Draws> Independent<D> {
    /// Numbers from `draws`.
    pub fn new(draws: D) -> Self {
        Self { draws }
    }

    /// Gives the source back, as far on as it was read.
    pub fn into_inner(self) -> D {
        self.draws
    }
}

impl<D: Draws> Coordinates for Independent<D> {
    fn get(&mut self, _: Stream, _: u32) -> f64 {
        self.draws.uniform()
    }
}
