//! A coarse grid over the image.

use crate::{Method, RenderSettings};

/// Cells of about the same width and height; as many as a `pilot` can afford, or the start of `relt` in its place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    columns: usize,
    rows: usize,
}

impl Grid {
    /// The most cells.
    const MOST: u64 = 1024;
    /// Samples of a pilot for each cell.
    const PILOT: u64 = 100;
    /// Samples that a particle of `relt` stands for: its annealing takes nearly as many.
    const PARTICLE: u64 = 10;

    pub(super) fn new(settings: &RenderSettings) -> Self {
        let bounds = settings.layout().extended_bounds();
        let [width, height] = [0, 1].map(|axis| bounds.max[axis] - bounds.min[axis]);
        let pilot = match settings.method {
            Method::Relt => settings.particles().saturating_mul(Self::PARTICLE),
            _ => settings.pilot(),
        };
        let wanted = (pilot / Self::PILOT).clamp(1, Self::MOST) as f64;
        let columns = (wanted * width / height).sqrt().clamp(1.0, wanted);
        Self {
            columns: columns as usize,
            rows: (wanted / columns.floor()) as usize,
        }
    }

    pub(super) fn count(self) -> usize {
        self.columns * self.rows
    }

    /// Corner of a cell in cells, and the size of a cell as a share of the window.
    pub(super) fn place(self, cell: usize) -> ([f64; 2], [f64; 2]) {
        let corner = [cell % self.columns, cell / self.columns];
        let size = [self.columns, self.rows];
        (
            corner.map(|at| at as f64),
            size.map(|side| 1.0 / side as f64),
        )
    }

    /// For each cell the mean of what it and its neighbours have.
    pub(super) fn blurred(self, cells: &[f64]) -> Vec<f64> {
        let near = |at: usize, side: usize| at.saturating_sub(1)..(at + 2).min(side);
        let blur = |cell: usize| {
            let (x, y) = (cell % self.columns, cell / self.columns);
            let rows = near(y, self.rows).map(|row| row * self.columns);
            let (sum, count) = rows
                .flat_map(|row| near(x, self.columns).map(move |column| cells[row + column]))
                .fold((0.0, 0.0), |(sum, count), one| (sum + one, count + 1.0));
            sum / count
        };
        (0..self.count()).map(blur).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(width: u32, height: u32, pilot: u64) -> Grid {
        let mut settings = RenderSettings {
            method: Method::Pssmlt,
            width,
            height,
            ..RenderSettings::default()
        };
        settings.options.pilot = pilot;
        Grid::new(&settings)
    }

    /// `relt` has particles in the place of a pilot, and does not ask for one.
    #[test]
    fn relt_goes_by_its_particles() {
        let mut settings = RenderSettings {
            method: Method::Relt,
            width: 64,
            height: 64,
            ..RenderSettings::default()
        };
        let usual = Grid::new(&settings);
        assert_eq!([usual.columns, usual.rows], [31, 32]);
        settings.options.pilot = 1;
        assert_eq!(Grid::new(&settings).count(), usual.count());
        settings.options.particles = 10;
        assert_eq!(Grid::new(&settings).count(), 1);
    }

    #[test]
    fn cells_are_about_square_and_cover_the_window() {
        for (width, height, pilot, wanted) in [
            (1920, 1080, 100_000, [42, 23]),
            (64, 64, 100_000, [31, 32]),
            (1, 5_000, 100_000, [1, 1_000]),
            (5_000, 1, 100_000, [1_000, 1]),
            (64, 64, 1, [1, 1]),
            (64, 64, 10_000_000, [32, 32]),
        ] {
            let grid = grid(width, height, pilot);
            assert_eq!([grid.columns, grid.rows], wanted, "{width}x{height}");
            let (corner, size) = grid.place(grid.count() - 1);
            for axis in 0..2 {
                assert!(((corner[axis] + 1.0) * size[axis] - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn cells_are_blurred_over_their_neighbours() {
        let grid = grid(300, 200, 600); // three columns, two rows
        assert_eq!([grid.columns, grid.rows], [3, 2]);
        let blurred = grid.blurred(&[12.0, 0.0, 0.0, 0.0, 0.0, 6.0]);
        assert_eq!(blurred, [3.0, 3.0, 1.5, 3.0, 3.0, 1.5]);
    }
}
