//! The grid over the image whose cells samples visit in turn.

use glam::DVec2;
use kaustik_pss::Coordinates;

use crate::sampling::stratified::Stratified;
use crate::{Budget, RenderSettings};

/// A grid over the window, one cell a pixel (nearly so where a filter reaches over the edge).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cells {
    columns: u64,
    rows: u64,
    ladders: u64,
}

impl Cells {
    pub(crate) fn new(settings: &RenderSettings) -> Self {
        let bounds = settings.layout().extended_bounds();
        let side = |axis: usize| ((bounds.max[axis] - bounds.min[axis]).round() as u64).max(1);
        Self {
            columns: side(0),
            rows: side(1),
            ladders: u64::from(settings.options.ladders),
        }
    }

    pub(crate) fn count(&self) -> u64 {
        self.columns.saturating_mul(self.rows)
    }

    pub(crate) fn columns(&self) -> u64 {
        self.columns
    }

    pub(crate) fn rows(&self) -> u64 {
        self.rows
    }

    /// The cell at a point of the window, which is the unit square.
    pub(crate) fn at(&self, point: DVec2) -> u64 {
        let along = |at: f64, side: u64| ((at * side as f64) as u64).min(side - 1);
        along(point.y, self.rows) * self.columns + along(point.x, self.columns)
    }

    /// First cell of a ladder and the one after its last: ladders own bands of the image.
    pub(crate) fn of_ladder(&self, ladder: u32) -> [u64; 2] {
        [u64::from(ladder), u64::from(ladder) + 1].map(|l| self.count() * l / self.ladders)
    }

    /// Steps of a ladder within a budget of whole passes over the image, at least one.
    pub(crate) fn whole_passes(&self, ladder: u32, budget: Budget) -> u64 {
        let [first, end] = self.of_ladder(ladder);
        match budget {
            Budget::PerPixel(n) => n.saturating_mul(end - first),
            Budget::Total(n) => (n / self.count()).max(1) * (end - first),
            Budget::Time(_) => u64::MAX.saturating_mul(end - first),
        }
    }

    /// The part of `n` samples (fewer than there are cells) that falls to a ladder's cells.
    pub(crate) fn share(&self, n: u64, [first, end]: [u64; 2]) -> u64 {
        let up_to =
            |cell: u64| (u128::from(n) * u128::from(cell) / u128::from(self.count())) as u64;
        up_to(end) - up_to(first)
    }

    /// Coordinates whose raster point lies in a cell: those of its sample of this index. All samples of a cell with one
    /// `seed` share it evenly.
    #[inline]
    pub(crate) fn confine<C: Coordinates>(
        &self,
        (cell, index): (u64, u64),
        seed: u64,
        inner: C,
    ) -> Stratified<C> {
        let corner = [cell % self.columns(), cell / self.columns()].map(|at| at as f64);
        let size = [self.columns(), self.rows()].map(|side| 1.0 / side as f64);
        Stratified::new(inner, corner, size, index, seed ^ cell)
    }
}

/// The way of a ladder's steps through its cells, again and again.
pub(crate) struct Tour {
    /// First cell of the ladder and the one after its last.
    bounds: [u64; 2],
    columns: u64,
    /// Size of a cell as a share of the window.
    size: [f64; 2],
    pass: u64,
    cell: u64,
    /// Column and row of the cell.
    corner: [u64; 2],
}

impl Tour {
    /// As it stands before a step of a ladder that has cells.
    pub(crate) fn new(cells: &Cells, ladder: u32, step: u64) -> Self {
        let [first, end] = cells.of_ladder(ladder);
        let count = (end - first).max(1);
        let mut tour = Self {
            bounds: [first, end],
            columns: cells.columns,
            size: [1.0 / cells.columns as f64, 1.0 / cells.rows as f64],
            pass: step / count,
            cell: 0,
            corner: [0; 2],
        };
        tour.go_to(first + step % count);
        tour
    }

    fn go_to(&mut self, cell: u64) {
        self.cell = cell;
        self.corner = [cell % self.columns, cell / self.columns];
    }

    /// Is this the first step of a pass?
    #[inline]
    pub(crate) fn begins(&self) -> bool {
        self.cell == self.bounds[0]
    }

    /// To the next step's cell.
    #[inline]
    pub(crate) fn go_on(&mut self) {
        let [first, end] = self.bounds;
        self.cell += 1;
        self.corner[0] += 1;
        if self.cell == end {
            self.pass += 1;
            self.go_to(first);
        } else if self.corner[0] == self.columns {
            self.corner = [0, self.corner[1] + 1];
        }
    }

    /// The coordinates of a step, whose raster point lies in the step's cell.
    #[inline]
    pub(crate) fn confine<C: Coordinates>(&self, seed: u64, inner: C) -> Stratified<C> {
        let corner = self.corner.map(|at| at as f64);
        Stratified::new(inner, corner, self.size, self.pass, seed ^ self.cell)
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::RenderSettings;

    /// Or a render by time would wait for a ladder that has nothing to do.
    #[test]
    fn a_ladder_without_cells_plans_no_steps() {
        let mut settings = RenderSettings {
            width: 3,
            height: 3,
            ..RenderSettings::default()
        };
        settings.options.ladders = 64;
        let cells = Cells::new(&settings);
        let hour = Budget::Time(Duration::from_secs(3600));
        let planned: Vec<u64> = (0..64).map(|l| cells.whole_passes(l, hour)).collect();
        assert_eq!(
            planned.iter().filter(|steps| **steps == u64::MAX).count(),
            9
        );
        assert_eq!(planned.iter().filter(|steps| **steps == 0).count(), 55);
    }
}
