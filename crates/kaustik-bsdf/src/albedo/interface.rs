use super::axis::{
    AxisPosition, alpha_at, alpha_axis, bump, bump_mean, cosine_at, cosine_axis, cosine_slope,
};
use std::sync::OnceLock;

pub(super) const COSINES: usize = 48;
pub(super) const ALPHAS: usize = 27;
pub(super) const INDICES: usize = 28;

/// Losses over [`bump`] in units of [`STEP`], little-endian: by index, alpha, cosine, side. Made by
/// a long test in `generate`.
static DATA: &[u8] = include_bytes!("interface.bin");
pub(super) const STEP: f32 = 1.0 / 4096.0;

/// A row of losses over [`bump`] by cosine, seen from the thinner and from the denser side.
type Row = [[f32; 2]; COSINES];

struct Table {
    /// By index, then alpha.
    rows: Vec<Row>,
    /// Cosine-weighted means of the losses over [`bump_mean`].
    means: Vec<[f32; 2]>,
}

/// The place of an interface in the tables, found once a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct InterfaceLoss {
    alpha: f64,
    row: AxisPosition,
    index: AxisPosition,
}

impl InterfaceLoss {
    /// `n` >= 1 is the denser medium's index over the thinner's; above 3 it counts as 3.
    #[inline]
    pub(crate) fn new(n: f64, alpha: f64) -> Self {
        Self {
            alpha,
            row: AxisPosition::new(alpha_axis(alpha), ALPHAS),
            index: AxisPosition::new(index_axis(n), INDICES),
        }
    }

    /// Mean losses over the thinner and the denser hemisphere.
    #[inline]
    pub(crate) fn means(self) -> [f32; 2] {
        let means = &table().means;
        let scale = bump_mean(self.alpha) as f32;
        [0, 1].map(|side| scale * self.mix(|row| means[row][side]))
    }

    /// Interpolates what `at` gives for a row of the table.
    #[inline]
    fn mix(self, at: impl Fn(usize) -> f32) -> f32 {
        let row = self.index.index() * ALPHAS + self.row.index();
        let low = self.row.mix(at(row), at(row + 1));
        let high = self.row.mix(at(row + ALPHAS), at(row + ALPHAS + 1));
        self.index.mix(low, high)
    }
}

/// Share of light from cosine `mu` lost, on the thinner (0) or denser (1) side.
#[inline]
pub(crate) fn interface_loss(place: InterfaceLoss, mu: f64, side: usize) -> f32 {
    let rows = &table().rows;
    let column = AxisPosition::new(cosine_axis(mu, place.alpha), COSINES);
    let i = column.index();
    let scale = bump(mu, place.alpha) as f32;
    scale * place.mix(|row| column.mix(rows[row][i][side], rows[row][i + 1][side]))
}

/// Index to axis: the cosine of total reflection, `sqrt(1 - 1/n^2)`, as that is where the denser
/// side's loss turns.
#[inline]
fn index_axis(n: f64) -> f64 {
    (1.0 - 1.0 / (n * n)).sqrt() / HIGHEST
}

/// The cosine of total reflection at the index of 3, `sqrt(8/9)`.
const HIGHEST: f64 = 0.942_809_041_582_063_4;

/// Inverse of [`index_axis`]; an index of exactly 1 has no facets and is passed by.
#[cfg(test)]
pub(super) fn index_at(t: f64) -> f64 {
    let critical = t * HIGHEST;
    (1.0 / (1.0 - critical * critical).sqrt()).max(1.0 + 1e-6)
}

fn table() -> &'static Table {
    static TABLE: OnceLock<Table> = OnceLock::new();
    TABLE.get_or_init(|| {
        let mut losses = DATA
            .chunks_exact(2)
            .map(|b| f32::from(u16::from_le_bytes([b[0], b[1]])) * STEP);
        let mut next = || losses.next().unwrap_or(0.0);
        let rows: Vec<Row> = (0..INDICES * ALPHAS)
            .map(|_| std::array::from_fn(|_| [next(), next()]))
            .collect();
        let means = (0..rows.len())
            .map(|i| mean_of(&rows[i], alpha_node(i % ALPHAS)))
            .collect();
        Table { rows, means }
    })
}

/// Roughness of a node.
pub(super) fn alpha_node(row: usize) -> f64 {
    alpha_at(row as f64 / (ALPHAS - 1) as f64)
}

/// `2` times the integral over `mu dmu` of the very function that is interpolated, for both sides,
/// over [`bump_mean`].
fn mean_of(row: &Row, alpha: f64) -> [f32; 2] {
    let mut mean = [0.0; 2];
    super::over_cells(COSINES, |t, weight| {
        let place = AxisPosition::new(t, COSINES);
        let i = place.index();
        let mu = cosine_at(t, alpha);
        let weight = weight * 2.0 * mu * cosine_slope(mu, alpha) * bump(mu, alpha);
        for (side, mean) in mean.iter_mut().enumerate() {
            *mean += weight * f64::from(place.mix(row[i][side], row[i + 1][side]));
        }
    });
    mean.map(|mean| (mean / bump_mean(alpha)) as f32)
}
