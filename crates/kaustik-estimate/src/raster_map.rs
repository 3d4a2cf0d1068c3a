//! Weights over the image that a chain's target is multiplied by (Hoberock and Hart 2010).

use kaustik_film::Layout;

/// Standard deviation of the Gaussian, in samples of the coarser of the two grids.
const SIGMA: f64 = 0.5;
/// How far it reaches, in standard deviations.
const REACH: f64 = 3.0;

/// A weight for each pixel of a window of the image, finite and above 0.
#[derive(Clone, Debug, PartialEq)]
pub struct RasterMap {
    /// Pixels of the whole image.
    size: [f64; 2],
    /// First pixel of the window.
    corner: [f64; 2],
    columns: usize,
    rows: usize,
    weights: Vec<f64>,
}

impl RasterMap {
    /// 1 everywhere.
    pub fn even() -> Self {
        Self {
            size: [1.0; 2],
            corner: [0.0; 2],
            columns: 1,
            rows: 1,
            weights: vec![1.0],
        }
    }

    /// Weights under which the relative error of a picture becomes even: inverse to what its pixels hold.
    /// `scalars`, one for each pixel of the layout's window, row by row, are brought down by a Gaussian to a
    /// grid of `width` cells along the longer side, and up again; what is below `floor` times their mean
    /// counts as that much. Of a black picture: 1 everywhere.
    ///
    /// # Panics
    ///
    /// If there is not a scalar for each pixel, or none, or if `width` is 0.
    pub fn evening(layout: &Layout, scalars: &[f64], width: u32, floor: f64) -> Self {
        let crop = layout.crop;
        let [columns, rows] = [crop.width(), crop.height()].map(|side| side as usize);
        assert!(columns * rows == scalars.len() && !scalars.is_empty() && width > 0);
        let least = scalars.iter().sum::<f64>() / scalars.len() as f64 * floor;
        if !(least > 0.0 && (1.0 / least).is_finite() && least.is_finite()) {
            return Self::even();
        }
        let longer = columns.max(rows) as f64;
        let cells = |side: usize| {
            let cells = side as f64 * f64::from(width) / longer;
            (cells.round() as usize).clamp(1, side)
        };
        let (across, down) = (
            Resampling::new(columns, cells(columns)),
            Resampling::new(rows, cells(rows)),
        );
        let coarse = down.columns(&across.rows(scalars), cells(columns));
        let (across, down) = (across.back(), down.back());
        let smooth = down.columns(&across.rows(&coarse), columns);
        Self {
            size: [layout.width, layout.height].map(f64::from),
            corner: [crop.x0, crop.y0].map(f64::from),
            columns,
            rows,
            weights: smooth.into_iter().map(|y| 1.0 / y.max(least)).collect(),
        }
    }

    /// The weight at a point of the image (the unit square over all of it); beyond the window that of the
    /// nearest pixel.
    #[inline]
    pub fn at(&self, [x, y]: [f64; 2]) -> f64 {
        // A float that is negative becomes 0.
        let column = (x * self.size[0] - self.corner[0]) as usize;
        let row = (y * self.size[1] - self.corner[1]) as usize;
        self.weights[row.min(self.rows - 1) * self.columns + column.min(self.columns - 1)]
    }

    /// The mean of pixels, each times its weight.
    pub fn mean(&self, scalars: &[f64]) -> f64 {
        let weights = self
            .weights
            .iter()
            .chain(std::iter::repeat(&self.weights[0]));
        let sum: f64 = scalars.iter().zip(weights).map(|(s, w)| s * w).sum();
        sum / scalars.len().max(1) as f64
    }

    /// The weights, row by row.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }
}

/// Samples of a line, each a weighted mean of some of those of another line over the same length.
struct Resampling {
    from: usize,
    /// Of each new sample: the first old one that it sees, and the weights from there on, which sum to 1.
    taps: Vec<(usize, Vec<f64>)>,
}

impl Resampling {
    fn new(from: usize, to: usize) -> Self {
        let ratio = from as f64 / to as f64;
        let sigma = SIGMA * ratio.max(1.0);
        let reach = REACH * sigma;
        let taps = |index: usize| {
            let centre = (index as f64 + 0.5) * ratio;
            let first = (centre - reach).max(0.0) as usize;
            let end = ((centre + reach).ceil() as usize).min(from);
            let weight = |at: usize| {
                let distance = (at as f64 + 0.5 - centre) / sigma;
                libm::exp(-0.5 * distance * distance)
            };
            let weights: Vec<f64> = (first..end).map(weight).collect();
            let sum: f64 = weights.iter().sum();
            (first, weights.into_iter().map(|w| w / sum).collect())
        };
        Self {
            from,
            taps: (0..to).map(taps).collect(),
        }
    }

    /// From its samples to those that it came from.
    fn back(&self) -> Self {
        Self::new(self.taps.len(), self.from)
    }

    /// Every row of a grid.
    fn rows(&self, grid: &[f64]) -> Vec<f64> {
        let row = |row: &[f64]| -> Vec<f64> {
            let sample = |(first, weights): &(usize, Vec<f64>)| -> f64 {
                row[*first..].iter().zip(weights).map(|(v, w)| v * w).sum()
            };
            self.taps.iter().map(sample).collect()
        };
        grid.chunks_exact(self.from).flat_map(row).collect()
    }

    /// Every column of a grid that has so many of them.
    fn columns(&self, grid: &[f64], columns: usize) -> Vec<f64> {
        let mut out = vec![0.0; columns * self.taps.len()];
        for (to, (first, weights)) in out.chunks_exact_mut(columns).zip(&self.taps) {
            let rows = grid.chunks_exact(columns).skip(*first);
            for (from, weight) in rows.zip(weights) {
                for (to, from) in to.iter_mut().zip(from) {
                    *to += weight * from;
                }
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kaustik_film::Window;

    #[test]
    fn a_constant_picture_has_a_constant_map() {
        for (columns, rows) in [(1, 1), (1, 9), (7, 1), (2, 2), (13, 8), (8, 13)] {
            let layout = Layout::new(columns, rows);
            let scalars = vec![0.25; (columns * rows) as usize];
            for width in 1..=columns.max(rows) {
                let map = RasterMap::evening(&layout, &scalars, width, 0.01);
                for weight in map.weights() {
                    assert!((weight - 4.0).abs() < 1e-12, "{columns} {rows} {width}");
                }
                assert!((map.mean(&scalars) - 1.0).abs() < 1e-12);
            }
        }
    }

    /// Values of the map along a row that is 1 on the left and 9 on the right.
    fn step(width: u32) -> Vec<f64> {
        let layout = Layout::new(16, 4);
        let value = |i: usize| if i % 16 < 8 { 1.0 } else { 9.0 };
        let scalars: Vec<f64> = (0..64).map(value).collect();
        let map = RasterMap::evening(&layout, &scalars, width, 1e-3);
        map.weights()[16..32].iter().map(|w| 1.0 / w).collect()
    }

    #[test]
    fn a_step_is_blurred_to_the_width() {
        let mut before = 0.0;
        for width in [1, 2, 4, 8, 16] {
            let row = step(width);
            let contrast = row[15] - row[0];
            assert!(contrast >= before - 1e-12, "{width}: {row:?}");
            assert!(row.is_sorted_by(|a, b| *a <= b + 1e-12), "{width}: {row:?}");
            // symmetric about the edge
            for (a, b) in row.iter().zip(row.iter().rev()) {
                assert!((a + b - 10.0).abs() < 1e-9, "{width}: {row:?}");
            }
            before = contrast;
        }
        // One cell knows the mean alone; as many as pixels keep all but the edge.
        assert!(step(1).iter().all(|v| (v - 5.0).abs() < 1e-9));
        let fine = step(16);
        assert!((fine[0] - 1.0).abs() < 1e-9 && (fine[15] - 9.0).abs() < 1e-9);
        assert!(fine[7] > 1.5 && fine[7] < 3.5, "{fine:?}");
        // Half of the grid's width apart, values do not leak.
        let coarse = step(4);
        assert!(coarse[0] < 2.0 && coarse[6] > 2.0, "{coarse:?}");
    }

    #[test]
    fn the_floor_holds() {
        let layout = Layout::new(4, 1);
        let map = RasterMap::evening(&layout, &[0.0, 0.0, 0.0, 4.0], 4, 0.1);
        assert!((map.weights()[0] - 10.0).abs() < 1e-12);
        assert!(map.weights()[3] < 0.5);
        // What stands below 0 by rounding is dark as well.
        let map = RasterMap::evening(&layout, &[-1e-9, 0.0, 0.0, 4.0], 4, 0.1);
        assert!(map.weights()[0] <= 10.0 + 1e-6);
        for scalars in [
            [0.0; 4],
            [-1.0; 4],
            [f64::NAN; 4],
            [1e-310; 4],
            [f64::INFINITY; 4],
        ] {
            let map = RasterMap::evening(&layout, &scalars, 4, 0.1);
            assert_eq!(map, RasterMap::even());
        }
    }

    #[test]
    fn weights_lie_where_pixels_do() {
        let crop = Window {
            x0: 2,
            y0: 1,
            x1: 5,
            y1: 3,
        };
        let layout = Layout::new(8, 4).with_crop(crop);
        let scalars: Vec<f64> = (0..6).map(|i| 10.0_f64.powi(i)).collect();
        let map = RasterMap::evening(&layout, &scalars, 3, 1e-9);
        for (row, y) in (1..3).enumerate() {
            for (column, x) in (2..5).enumerate() {
                let raster = [(f64::from(x) + 0.3) / 8.0, (f64::from(y) + 0.7) / 4.0];
                let expected = map.weights()[row * 3 + column];
                assert_eq!(map.at(raster).to_bits(), expected.to_bits());
            }
        }
        assert_eq!(map.at([0.0, 0.0]).to_bits(), map.weights()[0].to_bits());
        assert_eq!(map.at([0.99, 0.99]).to_bits(), map.weights()[5].to_bits());
        assert_eq!(map.at([-3.0, 7.0]).to_bits(), map.weights()[3].to_bits());
    }
}
