use super::axis::AxisPosition;
use super::quadrature::gauss_legendre;
use crate::sheen::{LEAST_ALPHA, white};
use crate::warp::sin_cos_turns;
use glam::DVec3;
use std::sync::OnceLock;

const COSINES: usize = 32;
const ALPHAS: usize = 16;

type Table = [[f32; COSINES]; ALPHAS];

/// Share of light from cosine `mu` in `[0, 1]` that white sheen of the given alpha sends back. Where fibres are
/// smooth it is more than comes in, see [`sheen_peak`].
pub(crate) fn sheen_albedo(mu: f64, alpha: f64) -> f32 {
    let table = table();
    let row = AxisPosition::new(alpha_axis(alpha), ALPHAS);
    let column = AxisPosition::new(mu.sqrt(), COSINES);
    let i = column.index();
    let (low, high) = (&table[row.index()], &table[row.index() + 1]);
    row.mix(
        column.mix(low[i], low[i + 1]),
        column.mix(high[i], high[i + 1]),
    )
}

/// Its largest value over all cosines.
pub(crate) fn sheen_peak(alpha: f64) -> f32 {
    let most = |row: &[f32; COSINES]| row.iter().copied().fold(0.0, f32::max);
    let row = AxisPosition::new(alpha_axis(alpha), ALPHAS);
    row.mix(most(&table()[row.index()]), most(&table()[row.index() + 1]))
}

fn table() -> &'static Table {
    static TABLE: OnceLock<Table> = OnceLock::new();
    TABLE.get_or_init(|| {
        std::array::from_fn(|row| {
            std::array::from_fn(|column| integral(cosine_at(column), alpha_at(row)) as f32)
        })
    })
}

fn cosine_at(node: usize) -> f64 {
    let t = node as f64 / (COSINES - 1) as f64;
    (t * t).max(1e-4)
}

/// Nodes are even in the perceptual roughness, from the smoothest fibres up.
fn alpha_axis(alpha: f64) -> f64 {
    let low = LEAST_ALPHA.sqrt();
    (alpha.sqrt() - low) / (1.0 - low)
}

fn alpha_at(node: usize) -> f64 {
    let low = LEAST_ALPHA.sqrt();
    let root = low + node as f64 / (ALPHAS - 1) as f64 * (1.0 - low);
    root * root
}

/// Of `white cos` over the directions above.
fn integral(mu: f64, alpha: f64) -> f64 {
    const AZIMUTHS: usize = 24;
    let wo = DVec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu);
    let mut sum = 0.0;
    for (x, weight) in gauss_legendre::<24>() {
        // squared, so that half of the points lie near the plane, where sheen does
        let (z, slope) = (x * x, 2.0 * x);
        let r = (1.0 - z * z).sqrt();
        for step in 0..AZIMUTHS {
            let (sin, cos) = sin_cos_turns((step as f64 + 0.5) / (2 * AZIMUTHS) as f64);
            let wi = DVec3::new(r * cos, r * sin, z);
            sum += weight * slope * white(wo, wi, alpha) * z;
        }
    }
    sum * std::f64::consts::TAU / AZIMUTHS as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against many more points, between the nodes.
    #[test]
    fn the_table_is_the_integral() {
        for alpha in [0.02, 0.09, 0.3, 0.7, 1.0] {
            for mu in [0.05, 0.21, 0.5, 0.77, 0.96] {
                let wo = DVec3::new((1.0f64 - mu * mu).sqrt(), 0.0, mu);
                let n = 400;
                let mut sum = 0.0;
                for i in 0..n {
                    // the square of an even spread, as sheen lies near the plane
                    let x = (f64::from(i) + 0.5) / f64::from(n);
                    let (z, slope) = (x * x, 2.0 * x);
                    for j in 0..n {
                        let (sin, cos) = sin_cos_turns((f64::from(j) + 0.5) / f64::from(2 * n));
                        let r = (1.0 - z * z).sqrt();
                        sum += white(wo, DVec3::new(r * cos, r * sin, z), alpha) * z * slope;
                    }
                }
                let exact = sum * std::f64::consts::TAU / f64::from(n * n);
                let found = f64::from(sheen_albedo(mu, alpha));
                assert!(
                    (found - exact).abs() < 0.015,
                    "{alpha} {mu}: {found} {exact}"
                );
            }
        }
    }
}
