use super::axis::{
    AxisPosition, alpha_at, alpha_axis, bump, bump_mean, cosine_at, cosine_axis, cosine_slope,
};
use crate::fresnel::schlick_weight;
use std::sync::OnceLock;

pub(super) const COSINES: usize = 48;
pub(super) const ALPHAS: usize = 32;

/// Loss and edge in units of [`LOSS_STEP`] and [`EDGE_STEP`], little-endian: by alpha, cosine. Made by a long test
/// in `generate`.
static DATA: &[u8] = include_bytes!("reflector.bin");
pub(super) const LOSS_STEP: f32 = 1.0 / 8192.0;
pub(super) const EDGE_STEP: f32 = 1.0 / 32767.0;

/// What a reflecting microsurface does to light from one direction, or on average.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ReflectorLoss {
    /// Lost by facets that reflect everything: `1 - E`.
    pub(crate) loss: f32,
    /// The part of `E` that Schlick's formula gives to F90.
    pub(crate) edge: f32,
}

struct Table {
    /// By alpha, then cosine: the loss over [`bump`], the edge without Schlick's weight at the
    /// cosine itself, so that what is interpolated varies slowly.
    nodes: Vec<[ReflectorLoss; COSINES]>,
    /// By alpha: cosine-weighted means, the loss's over [`bump_mean`].
    means: [ReflectorLoss; ALPHAS],
}

/// Loss at cosine `mu` in `[0, 1]`.
#[inline]
pub(crate) fn reflector_loss(mu: f64, alpha: f64) -> ReflectorLoss {
    let table = table();
    let row = AxisPosition::new(alpha_axis(alpha), ALPHAS);
    let column = AxisPosition::new(cosine_axis(mu, alpha), COSINES);
    let i = column.index();
    let (low, high) = (&table.nodes[row.index()], &table.nodes[row.index() + 1]);
    let at = low[i]
        .mix(low[i + 1], column)
        .mix(high[i].mix(high[i + 1], column), row);
    ReflectorLoss {
        loss: at.loss * bump(mu, alpha) as f32,
        edge: at.edge + schlick_weight(mu) as f32,
    }
}

impl ReflectorLoss {
    /// Cosine-weighted mean over the hemisphere.
    #[inline]
    pub(crate) fn mean(alpha: f64) -> Self {
        let row = AxisPosition::new(alpha_axis(alpha), ALPHAS);
        let at = table().means[row.index()].mix(table().means[row.index() + 1], row);
        Self {
            loss: at.loss * bump_mean(alpha) as f32,
            ..at
        }
    }

    #[inline]
    fn mix(self, high: Self, place: AxisPosition) -> Self {
        Self {
            loss: place.mix(self.loss, high.loss),
            edge: place.mix(self.edge, high.edge),
        }
    }
}

fn table() -> &'static Table {
    static TABLE: OnceLock<Table> = OnceLock::new();
    TABLE.get_or_init(|| {
        let mut values = DATA
            .chunks_exact(2)
            .map(|b| f32::from(i16::from_le_bytes([b[0], b[1]])));
        let mut next = |step: f32| values.next().unwrap_or(0.0) * step;
        let nodes: Vec<_> = (0..ALPHAS)
            .map(|_| {
                std::array::from_fn(|_| ReflectorLoss {
                    loss: next(LOSS_STEP),
                    edge: next(EDGE_STEP),
                })
            })
            .collect();
        let means = std::array::from_fn(|row| mean_of(&nodes[row], alpha_node(row)));
        Table { nodes, means }
    })
}

/// Roughness of a node.
pub(super) fn alpha_node(row: usize) -> f64 {
    alpha_at(row as f64 / (ALPHAS - 1) as f64)
}

/// `2` times the integral over `mu dmu` of the very function that is interpolated.
fn mean_of(row: &[ReflectorLoss; COSINES], alpha: f64) -> ReflectorLoss {
    let (mut loss, mut edge) = (0.0, 0.0);
    super::over_cells(COSINES, |t, weight| {
        let place = AxisPosition::new(t, COSINES);
        let at = row[place.index()].mix(row[place.index() + 1], place);
        let mu = cosine_at(t, alpha);
        let weight = weight * 2.0 * mu * cosine_slope(mu, alpha);
        loss += weight * f64::from(at.loss) * bump(mu, alpha);
        edge += weight * (f64::from(at.edge) + schlick_weight(mu));
    });
    ReflectorLoss {
        loss: (loss / bump_mean(alpha)) as f32,
        edge: edge as f32,
    }
}
