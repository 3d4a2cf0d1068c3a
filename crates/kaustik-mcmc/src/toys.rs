//! The small programs that exact tests of several drivers run.

use kaustik_pss::{Coordinates, Stream};

use crate::testing::GridStep;
use crate::{Draws, Kernel, Move, Target, target};

/// States of a [`Ring`].
pub(crate) const STATES: usize = 3;

/// Values are states of a ring; a step goes up with probability `up`, else down.
#[derive(Clone, Copy)]
pub(crate) struct Ring {
    pub(crate) up: f64,
}

impl Kernel<()> for Ring {
    type Value = usize;

    fn propose<D: Draws + ?Sized>(
        &self,
        (): &mut (),
        current: &usize,
        proposed: &mut usize,
        draws: &mut D,
    ) -> Move {
        let up = draws.index(&[1.0 - self.up, self.up]) == 1;
        *proposed = (current + if up { 1 } else { STATES - 1 }) % STATES;
        let odds = (1.0 - self.up) / self.up;
        Move::new(2, if up { odds } else { 1.0 / odds })
    }
}

/// Cells of a coordinate of [`lazy`].
pub(crate) const CELLS: usize = 3;

/// Where a point of [`lazy`] lies: two coordinates, or one.
pub(crate) type Cells = (usize, Option<usize>);

/// The cell of a coordinate.
pub(crate) fn cell(x: f64) -> usize {
    (x * CELLS as f64) as usize
}

/// The first coordinate decides whether another is read.
pub(crate) fn lazy() -> impl Target<Value = Cells> + Clone {
    target(|u: &mut dyn Coordinates| -> Cells {
        let first = cell(u.get(Stream::Camera, 0));
        let second = (first != 2).then(|| cell(u.get(Stream::Light, 0)));
        (first, second)
    })
}

/// Small steps far apart from level to level.
pub(crate) fn mutations() -> [GridStep; 2] {
    [
        GridStep::symmetric(CELLS, 1),
        GridStep::new(CELLS, &[(0, 0.8), (1, 0.1), (-1, 0.1)]),
    ]
}
