use super::axis::{Place, alpha_at, alpha_axis, cosine_at, cosine_axis, cosine_slope};
use super::quadrature::{gauss_legendre, over_visible};
use crate::fresnel;
use crate::ggx::Ggx;
use crate::interface::refract;
use crate::local::reflect;
use std::sync::OnceLock;

const COSINES: usize = 32;
const ALPHAS: usize = 16;
const INDICES: usize = 16;
const RINGS: usize = 12;
const AZIMUTHS: usize = 8;

/// A row of losses by cosine, seen from the thinner and from the denser side.
type Row = [[f32; 2]; COSINES];

struct Table {
    /// By index, then alpha.
    rows: Vec<Row>,
    /// Cosine-weighted means of the rows.
    means: Vec<[f32; 2]>,
}

/// The place of an interface in the tables, found once a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct InterfaceLoss {
    alpha: f64,
    row: Place,
    index: Place,
}

impl InterfaceLoss {
    /// `n` >= 1 is the denser medium's index over the thinner's; above 4 it counts as 4.
    #[inline]
    pub(crate) fn new(n: f64, alpha: f64) -> Self {
        Self {
            alpha,
            row: Place::new(alpha_axis(alpha), ALPHAS),
            index: Place::new(index_axis(n), INDICES),
        }
    }

    /// Mean losses over the thinner and the denser hemisphere.
    #[inline]
    pub(crate) fn means(self) -> [f32; 2] {
        let means = &table().means;
        [0, 1].map(|side| self.mix(|row| means[row][side]))
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
    let column = Place::new(cosine_axis(mu, place.alpha), COSINES);
    let i = column.index();
    place.mix(|row| column.mix(rows[row][i][side], rows[row][i + 1][side]))
}

/// Index to axis: the root of the amplitude reflected at normal incidence.
#[inline]
fn index_axis(n: f64) -> f64 {
    ((n - 1.0) / (n + 1.0)).sqrt() / HIGHEST
}

/// `index_axis` of 4 before scaling, `sqrt(3/5)`.
const HIGHEST: f64 = 0.774_596_669_241_483_4;

/// Inverse of [`index_axis`]; an index of exactly 1 has no facets and is passed by.
fn index_at(t: f64) -> f64 {
    let r = t * HIGHEST * t * HIGHEST;
    ((1.0 + r) / (1.0 - r)).max(1.0 + 1e-6)
}

fn table() -> &'static Table {
    static TABLE: OnceLock<Table> = OnceLock::new();
    TABLE.get_or_init(|| {
        let rings = gauss_legendre::<RINGS>();
        let mut rows = vec![[[0.0; 2]; COSINES]; INDICES * ALPHAS];
        for row in 0..ALPHAS {
            let alpha = alpha_at(row as f64 / (ALPHAS - 1) as f64);
            for column in 0..COSINES {
                let mu = cosine_at(column as f64 / (COSINES - 1) as f64, alpha);
                let losses = node(mu, alpha, &rings);
                for (index, loss) in losses.into_iter().enumerate() {
                    rows[index * ALPHAS + row][column] = loss;
                }
            }
        }
        let means = (0..rows.len())
            .map(|i| mean_of(&rows[i], alpha_at((i % ALPHAS) as f64 / (ALPHAS - 1) as f64)))
            .collect();
        Table { rows, means }
    })
}

/// Losses from both sides for all indices at once: the facets are the same.
fn node(mu: f64, alpha: f64, rings: &[(f64, f64); RINGS]) -> [[f32; 2]; INDICES] {
    let ggx = Ggx::new(alpha);
    let indices: [f64; INDICES] = std::array::from_fn(|i| index_at(i as f64 / (INDICES - 1) as f64));
    let mut away = [[0.0; 2]; INDICES];
    over_visible::<RINGS, AZIMUTHS>(ggx, mu, rings, |wo, h, weight| {
        let cosine = wo.dot(h);
        let mirrored = reflect(wo, h);
        let reflected = if mirrored.z > 0.0 { ggx.escape(wo, mirrored) } else { 0.0 };
        for (n, away) in indices.iter().zip(&mut away) {
            for (ahead, away) in [*n, 1.0 / *n].into_iter().zip(away) {
                let (f, beyond) = fresnel::dielectric(cosine, ahead);
                *away += weight * f * reflected;
                if beyond > 0.0 {
                    let wi = refract(wo, h, cosine, beyond, ahead);
                    if wi.z < 0.0 {
                        *away += weight * (1.0 - f) * ggx.escape(wo, wi);
                    }
                }
            }
        }
    });
    away.map(|sides| sides.map(|away| (1.0f64 - away).max(0.0) as f32))
}

fn mean_of(row: &Row, alpha: f64) -> [f32; 2] {
    let mut mean = [0.0; 2];
    super::over_cells(COSINES, |t, weight| {
        let place = Place::new(t, COSINES);
        let i = place.index();
        let weight = weight * 2.0 * cosine_at(t, alpha) * cosine_slope(t, alpha);
        for (side, mean) in mean.iter_mut().enumerate() {
            *mean += weight * f64::from(place.mix(row[i][side], row[i + 1][side]));
        }
    });
    mean.map(|mean| mean as f32)
}
