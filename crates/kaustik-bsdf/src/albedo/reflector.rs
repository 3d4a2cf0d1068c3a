use super::axis::{Place, alpha_at, alpha_axis, cosine_at, cosine_axis, cosine_slope};
use super::quadrature::{gauss_legendre, over_visible};
use crate::fresnel::schlick_weight;
use crate::ggx::Ggx;
use crate::local::reflect;
use std::sync::OnceLock;

const COSINES: usize = 48;
const ALPHAS: usize = 32;

/// What a reflecting microsurface does to light from one direction, or on average.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ReflectorLoss {
    /// Lost by facets that reflect everything: `1 - E`.
    pub(crate) loss: f32,
    /// The part of `E` that Schlick's formula gives to F90.
    pub(crate) edge: f32,
}

struct Table {
    /// By alpha, then cosine.
    nodes: Vec<[ReflectorLoss; COSINES]>,
    /// By alpha: cosine-weighted means.
    means: [ReflectorLoss; ALPHAS],
}

/// Loss at cosine `mu` in `[0, 1]`.
#[inline]
pub(crate) fn reflector_loss(mu: f64, alpha: f64) -> ReflectorLoss {
    let table = table();
    let row = Place::new(alpha_axis(alpha), ALPHAS);
    let column = Place::new(cosine_axis(mu, alpha), COSINES);
    let i = column.index();
    let (low, high) = (&table.nodes[row.index()], &table.nodes[row.index() + 1]);
    low[i].mix(low[i + 1], column).mix(high[i].mix(high[i + 1], column), row)
}

impl ReflectorLoss {
    /// Cosine-weighted mean over the hemisphere.
    #[inline]
    pub(crate) fn mean(alpha: f64) -> Self {
        let row = Place::new(alpha_axis(alpha), ALPHAS);
        table().means[row.index()].mix(table().means[row.index() + 1], row)
    }

    #[inline]
    fn mix(self, high: Self, place: Place) -> Self {
        Self {
            loss: place.mix(self.loss, high.loss),
            edge: place.mix(self.edge, high.edge),
        }
    }
}

fn table() -> &'static Table {
    static TABLE: OnceLock<Table> = OnceLock::new();
    TABLE.get_or_init(|| {
        let rings = gauss_legendre::<24>();
        let nodes: Vec<_> = (0..ALPHAS)
            .map(|row| {
                let alpha = alpha_at(row as f64 / (ALPHAS - 1) as f64);
                std::array::from_fn(|column| {
                    node(cosine_at(column as f64 / (COSINES - 1) as f64, alpha), alpha, &rings)
                })
            })
            .collect();
        let means = std::array::from_fn(|row| {
            mean_of(&nodes[row], alpha_at(row as f64 / (ALPHAS - 1) as f64))
        });
        Table { nodes, means }
    })
}

fn node(mu: f64, alpha: f64, rings: &[(f64, f64); 24]) -> ReflectorLoss {
    let ggx = Ggx::new(alpha);
    let (mut total, mut edge) = (0.0, 0.0);
    over_visible::<24, 16>(ggx, mu, rings, |wo, h, weight| {
        let wi = reflect(wo, h);
        if wi.z > 0.0 {
            let away = weight * ggx.escape(wo, wi);
            total += away;
            edge += away * schlick_weight(wo.dot(h));
        }
    });
    ReflectorLoss { loss: (1.0 - total).max(0.0) as f32, edge: edge as f32 }
}

/// `2` times the integral of the row over `mu dmu`, of the very function that is interpolated:
/// Gauss in each cell, where it is linear in the axis.
fn mean_of(row: &[ReflectorLoss; COSINES], alpha: f64) -> ReflectorLoss {
    let (mut loss, mut edge) = (0.0, 0.0);
    super::over_cells(COSINES, |t, weight| {
        let place = Place::new(t, COSINES);
        let at = row[place.index()].mix(row[place.index() + 1], place);
        let weight = weight * 2.0 * cosine_at(t, alpha) * cosine_slope(t, alpha);
        loss += weight * f64::from(at.loss);
        edge += weight * f64::from(at.edge);
    });
    ReflectorLoss { loss: loss as f32, edge: edge as f32 }
}
