//! The target of Chen, Wang and Yong (2011): more photons where a pilot found few.

/// What normalised densities are clamped to.
const CLAMPS: [f64; 2] = [0.05, 0.6];
/// From here on a place is bright enough.
const MIDDLE: f64 = 0.325;
/// How steeply the target rises below.
const SLOPE: f64 = 10.0;
/// Standard deviation of the blur, in pixels.
const SIGMA: f64 = 4.0;

/// A target for each pixel: 1, and `1 + SLOPE (exp(1 - v / MIDDLE) - 1)` where the density v is below the middle.
#[derive(Clone, Debug)]
pub struct DensityTarget {
    columns: usize,
    rows: usize,
    targets: Vec<f32>,
    /// What it covers of the image: the low corner, and the sides.
    window: [[f64; 2]; 2],
}

impl DensityTarget {
    /// From the density of photons in each pixel, row by row (finite, at least 0): normalised by the smallest and the
    /// largest, clamped, blurred, and turned over.
    ///
    /// # Panics
    ///
    /// If there are not `columns` times `rows` densities, or none.
    pub fn new(columns: usize, rows: usize, densities: &[f64]) -> Self {
        assert!(columns * rows == densities.len() && !densities.is_empty());
        let low = densities.iter().copied().fold(f64::INFINITY, f64::min);
        let high = densities.iter().copied().fold(0.0, f64::max);
        let range = (high - low).max(f64::MIN_POSITIVE);
        let clamped: Vec<f64> = densities
            .iter()
            .map(|d| ((d - low) / range).clamp(CLAMPS[0], CLAMPS[1]))
            .collect();
        // along rows, then along columns
        let across = blurred(&clamped, rows, |row, at| row * columns + at, columns);
        let both = blurred(&across, columns, |column, at| at * columns + column, rows);
        let target = |v: &f64| {
            if *v >= MIDDLE {
                1.0
            } else {
                (1.0 + SLOPE * (libm::exp(1.0 - v / MIDDLE) - 1.0)) as f32
            }
        };
        Self {
            columns,
            rows,
            targets: both.iter().map(target).collect(),
            window: [[0.0; 2], [1.0; 2]],
        }
    }

    /// The same for a part of the image: its low corner and its sides, in shares of the whole's.
    #[must_use]
    pub fn of_window(self, low: [f64; 2], sides: [f64; 2]) -> Self {
        Self {
            window: [low, sides],
            ..self
        }
    }

    /// The target at a point of the image (the unit square over all of it; where nothing is known, that of the nearest pixel).
    #[inline]
    pub fn at(&self, x: f64, y: f64) -> f32 {
        let [low, sides] = self.window;
        let pixel = |u: f64, axis: usize, count: usize| {
            let within = (u - low[axis]) / sides[axis];
            ((within * count as f64).max(0.0) as usize).min(count - 1)
        };
        self.targets[pixel(y, 1, self.rows) * self.columns + pixel(x, 0, self.columns)]
    }
}

/// Each of so many lines of `length` values blurred by itself; weights at the ends are renormalised.
fn blurred(
    values: &[f64],
    lines: usize,
    place: impl Fn(usize, usize) -> usize,
    length: usize,
) -> Vec<f64> {
    let reach = (3.0 * SIGMA) as i64;
    let weight = |d: i64| libm::exp(-0.5 * (d as f64 / SIGMA) * (d as f64 / SIGMA));
    let weights: Vec<f64> = (-reach..=reach).map(weight).collect();
    let mut out = vec![0.0; values.len()];
    for line in 0..lines {
        for at in 0..length {
            let (mut sum, mut total) = (0.0, 0.0);
            for (d, weight) in (-reach..=reach).zip(&weights) {
                let from = at as i64 + d;
                if (0..length as i64).contains(&from) {
                    sum += weight * values[place(line, from as usize)];
                    total += weight;
                }
            }
            out[place(line, at)] = sum / total;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_photons_ask_for_more() {
        let (columns, rows) = (64, 32);
        let density = |index: usize| if index % columns < 32 { 10.0 } else { 0.1 };
        let densities: Vec<f64> = (0..columns * rows).map(density).collect();
        let target = DensityTarget::new(columns, rows, &densities);
        assert!((target.at(0.1, 0.5) - 1.0).abs() < 1e-6);
        // 1 + 10 (exp(1 - 0.05 / 0.325) - 1)
        assert!(
            (target.at(0.9, 0.5) - 14.31).abs() < 0.01,
            "{}",
            target.at(0.9, 0.5)
        );
        let edge = target.at(0.5, 0.5);
        assert!(edge > 1.0 && edge < 14.0, "{edge}: a blur");
        assert!((target.at(5.0, -1.0) - target.at(0.999, 0.0)).abs() < 1e-6);
        let part = target.clone().of_window([0.5, 0.25], [0.25, 0.5]);
        for (u, v) in [(0.1, 0.5), (0.9, 0.2), (1.5, -0.5)] {
            assert!((part.at(0.5 + 0.25 * u, 0.25 + 0.5 * v) - target.at(u, v)).abs() < 1e-6);
        }
        let even = DensityTarget::new(columns, rows, &vec![3.0; columns * rows]);
        assert!((even.at(0.2, 0.2) - even.at(0.8, 0.9)).abs() < 1e-5);
    }
}
