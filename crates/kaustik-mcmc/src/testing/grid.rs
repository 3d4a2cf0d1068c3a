use crate::mutation::wrap;
use crate::{Draws, Mutation};

/// A mutation whose steps are whole cells of a grid on the circle: the discrete stand-in
/// of a continuous one, for enumeration.
#[derive(Clone, Debug, PartialEq)]
pub struct GridStep {
    cells: usize,
    /// (cells to move, relative probability)
    steps: Vec<(i32, f64)>,
}

impl GridStep {
    /// Moves by `reach` cells of a grid of `cells`, up or down with equal probability:
    /// symmetric. `reach` is below `cells`.
    pub fn symmetric(cells: usize, reach: i32) -> Self {
        Self::new(cells, &[(reach, 0.5), (-reach, 0.5)])
    }

    /// Moves by given numbers of cells with given relative probabilities: symmetric only
    /// if these are. Moves are smaller than the grid.
    pub fn new(cells: usize, steps: &[(i32, f64)]) -> Self {
        Self {
            cells,
            steps: steps.to_vec(),
        }
    }
}

impl Mutation for GridStep {
    fn mutate<D: Draws + ?Sized>(&self, x: f64, draws: &mut D) -> f64 {
        let weights: Vec<f64> = self.steps.iter().map(|step| step.1).collect();
        let (cells, n) = (self.steps[draws.index(&weights)].0, self.cells as f64);
        // back to the middle of a cell, so that equal positions have equal bits
        let cell = (wrap(x + f64::from(cells) / n) * n).floor();
        (cell + 0.5) / n
    }
}
