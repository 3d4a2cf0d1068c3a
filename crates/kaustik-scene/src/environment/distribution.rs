use std::f64::consts::{FRAC_1_PI, PI};

use super::cumulative::{accumulate, cell, find, invert_linear, linear};

/// The distribution of points on a picture read bilinearly, over the sphere.
///
/// Between two rows of texel centres lies a strip; the first and the last strip, half as high, reach to the
/// poles. A strip is chosen by its integral, the height in it by the linear change of the rows' sums,
/// the position along it from the blend of the two rows at that height: exactly the bilinear
/// weight, except that within a strip the sine of the polar angle is taken as constant. In the two caps
/// the weight does not depend on the height, and the cosine is uniform.
#[derive(Clone, Debug)]
pub(super) struct Distribution {
    width: usize,
    height: usize,
    /// Running integrals along each row, from the first texel centre around.
    columns: Vec<u32>,
    /// Sums of the rows' weights.
    rows: Vec<f64>,
    /// Running integral over the `height + 1` strips.
    strips: Vec<u32>,
}

/// Where a point lies: in strip `k` at `t`, after texel `i` by `s`.
#[derive(Clone, Copy, Debug)]
struct Place {
    k: usize,
    t: f64,
    i: usize,
    s: f64,
}

impl Distribution {
    /// For a picture of `width` by `height` texels with weights >= 0, finite. `None` if all
    /// are 0.
    pub(super) fn new(
        width: usize,
        height: usize,
        weight: impl Fn(usize, usize) -> f64,
    ) -> Option<Self> {
        let mut columns = vec![0; width * height];
        let mut rows = Vec::with_capacity(height);
        let mut cells = vec![0.0; width];
        for (y, starts) in columns.chunks_exact_mut(width).enumerate() {
            for (i, cell) in cells.iter_mut().enumerate() {
                *cell = 0.5 * (weight(i, y) + weight((i + 1) % width, y));
            }
            rows.push(accumulate(&cells, starts));
        }
        let strip = |k: usize| {
            let (above, below) = neighbours(k, height);
            let (top, bottom) = cap(k, height);
            0.5 * (rows[above] + rows[below]) * (top - bottom)
        };
        let masses: Vec<f64> = (0..=height).map(strip).collect();
        let mut strips = vec![0; height + 1];
        let sum = accumulate(&masses, &mut strips);
        (sum > 0.0).then_some(Self {
            width,
            height,
            columns,
            rows,
            strips,
        })
    }

    /// A point of the picture, `[u, v]` in [0,1]^2 from the top left, and its density per solid angle.
    pub(super) fn sample(
        &self,
        u: [f64; 2],
        weight: impl Fn(usize, usize) -> f64,
    ) -> ([f64; 2], f64) {
        let (k, into) = find(self.height + 1, u[1], |k| cell(&self.strips, k));
        let (above, below) = neighbours(k, self.height);
        let t = if self.is_cap(k) {
            self.cap_height(k, into)
        } else {
            invert_linear(self.rows[above], self.rows[below], into)
        };
        let blend = self.blend(k, t);
        let (i, into) = find(self.width, u[0], |i| self.blended(k, blend, i));
        let [a, b] = self.ends(k, blend, i, &weight);
        let s = invert_linear(a, b, into);
        let pdf = self.density(Place { k, t, i, s }, [a, b]);
        let x = (i as f64 + 0.5 + s) / self.width as f64;
        let y = (k as f64 - 0.5 + t) / self.height as f64;
        ([x - x.floor(), y.clamp(0.0, 1.0)], pdf)
    }

    /// Density per solid angle at `[u, v]` in [0,1]^2.
    pub(super) fn pdf(&self, [x, y]: [f64; 2], weight: impl Fn(usize, usize) -> f64) -> f64 {
        let y = y * self.height as f64 + 0.5;
        let k = (y as usize).min(self.height);
        let x = x * self.width as f64 - 0.5;
        let i = x.floor();
        let place = Place {
            k,
            t: y - k as f64,
            i: (i as i64).rem_euclid(self.width as i64) as usize,
            s: x - i,
        };
        let ends = self.ends(k, self.blend(k, place.t), place.i, &weight);
        self.density(place, ends)
    }

    fn density(&self, place: Place, [a, b]: [f64; 2]) -> f64 {
        let Place { k, t, s, .. } = place;
        let (_, mass) = cell(&self.strips, k);
        let along = self.width as f64 * (a + (b - a) * s);
        if self.is_cap(k) {
            let (top, bottom) = cap(k, self.height);
            return mass * along * 0.5 * FRAC_1_PI / (top - bottom);
        }
        let (above, below) = neighbours(k, self.height);
        let down = self.height as f64 * linear(self.rows[above], self.rows[below], t);
        let sin = libm::sin(PI * (k as f64 - 0.5 + t) / self.height as f64);
        mass * down * along * 0.5 * FRAC_1_PI * FRAC_1_PI / sin
    }

    /// Densities per column at both ends of column `i` of the blended row.
    fn ends(
        &self,
        k: usize,
        blend: f64,
        i: usize,
        weight: &impl Fn(usize, usize) -> f64,
    ) -> [f64; 2] {
        let (above, below) = neighbours(k, self.height);
        let next = (i + 1) % self.width;
        let [mut a, mut b] = [0.0; 2];
        for (y, share) in [(above, 1.0 - blend), (below, blend)] {
            let (_, mass) = cell(self.row(y), i);
            let (left, right) = (weight(i, y), weight(next, y));
            a += share * mass * linear(left, right, 0.0);
            b += share * mass * linear(left, right, 1.0);
        }
        [a, b]
    }

    /// Share of the lower row at height `t` of strip `k`.
    fn blend(&self, k: usize, t: f64) -> f64 {
        let (above, below) = neighbours(k, self.height);
        let (a, b) = ((1.0 - t) * self.rows[above], t * self.rows[below]);
        if a + b > 0.0 { b / (a + b) } else { t }
    }

    /// Start and width of column `i` of the blended row.
    fn blended(&self, k: usize, blend: f64, i: usize) -> (f64, f64) {
        let (above, below) = neighbours(k, self.height);
        let (a, wide_a) = cell(self.row(above), i);
        let (b, wide_b) = cell(self.row(below), i);
        (a + blend * (b - a), wide_a + blend * (wide_b - wide_a))
    }

    fn row(&self, y: usize) -> &[u32] {
        &self.columns[y * self.width..(y + 1) * self.width]
    }

    fn is_cap(&self, k: usize) -> bool {
        k == 0 || k == self.height
    }

    /// The height in cap `k` below which lies the share `into` of its area.
    fn cap_height(&self, k: usize, into: f64) -> f64 {
        let (top, bottom) = cap(k, self.height);
        let z = top + (bottom - top) * into;
        // 1 - z without cancellation near the upper pole, 1 + z near the lower one
        let sin = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
        let v = libm::atan2(sin, z) * FRAC_1_PI;
        (v * self.height as f64 + 0.5 - k as f64).clamp(0.0, 1.0)
    }
}

/// Rows of texel centres above and below strip `k`; a cap has the same on both sides.
fn neighbours(k: usize, height: usize) -> (usize, usize) {
    (k.saturating_sub(1), k.min(height - 1))
}

/// Cosines of the polar angles at the top and the bottom of strip `k`.
fn cap(k: usize, height: usize) -> (f64, f64) {
    let z = |row: f64| libm::cos(PI * (row / height as f64).clamp(0.0, 1.0));
    let row = k as f64;
    (z(row - 0.5), z(row + 0.5))
}
