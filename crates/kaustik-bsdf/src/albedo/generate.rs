//! Makes the tables, and checks the ones that stand.

use super::axis::{bump, cosine_at};
use super::interface::{
    ALPHAS, COSINES, INDICES, InterfaceLoss, STEP, alpha_node, index_at, interface_loss,
};
use super::quadrature::{WEIGHT, over_visible};
use super::reflector::{self, reflector_loss};
use crate::fresnel;
use crate::ggx::Ggx;
use crate::interface::refract;
use crate::local::reflect;

/// Losses from both sides for the given indices: the facets are the same for all.
fn losses(mu: f64, alpha: f64, indices: &[f64]) -> Vec<[f64; 2]> {
    let ggx = Ggx::new(alpha);
    let mut away = vec![[0.0; 2]; indices.len()];
    over_visible(ggx, mu, |wo, h| {
        let cosine = wo.dot(h).clamp(0.0, 1.0);
        let mirrored = reflect(wo, h);
        let reflected = if mirrored.z > 0.0 {
            ggx.escape(wo, mirrored)
        } else {
            0.0
        };
        for (n, away) in indices.iter().zip(&mut away) {
            for (ahead, away) in [*n, 1.0 / *n].into_iter().zip(away) {
                let (f, beyond) = fresnel::dielectric(cosine, ahead);
                *away += WEIGHT * f * reflected;
                if beyond > 0.0 {
                    let wi = refract(wo, h, cosine, beyond, ahead);
                    if wi.z < 0.0 {
                        *away += WEIGHT * (1.0 - f) * ggx.escape(wo, wi);
                    }
                }
            }
        }
    });
    away.into_iter()
        .map(|sides| sides.map(|away| (1.0 - away).max(0.0)))
        .collect()
}

/// Loss of facets that reflect everything, and what Schlick's formula gives to F90.
fn reflected(mu: f64, alpha: f64) -> [f64; 2] {
    let ggx = Ggx::new(alpha);
    let (mut total, mut edge) = (0.0, 0.0);
    over_visible(ggx, mu, |wo, h| {
        let wi = reflect(wo, h);
        if wi.z > 0.0 {
            let away = WEIGHT * ggx.escape(wo, wi);
            total += away;
            edge += away * fresnel::schlick_weight(wo.dot(h));
        }
    });
    [(1.0 - total).max(0.0), edge]
}

fn index_nodes() -> Vec<f64> {
    (0..INDICES)
        .map(|i| index_at(i as f64 / (INDICES - 1) as f64))
        .collect()
}

#[test]
#[ignore = "writes the table into the sources"]
fn write_the_table() {
    let indices = index_nodes();
    let mut data = vec![0u8; INDICES * ALPHAS * COSINES * 4];
    for row in 0..ALPHAS {
        for column in 0..COSINES {
            let mu = cosine_at(column as f64 / (COSINES - 1) as f64, alpha_node(row));
            for (index, sides) in losses(mu, alpha_node(row), &indices)
                .into_iter()
                .enumerate()
            {
                for (side, loss) in sides.into_iter().enumerate() {
                    let at = (((index * ALPHAS + row) * COSINES + column) * 2 + side) * 2;
                    let held = loss / bump(mu, alpha_node(row)) / f64::from(STEP);
                    let step = held.round().min(f64::from(u16::MAX)) as u16;
                    data[at..at + 2].copy_from_slice(&step.to_le_bytes());
                }
            }
        }
    }
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/albedo/interface.bin");
    std::fs::write(path, data).unwrap();
}

#[test]
#[ignore = "writes the table into the sources"]
fn write_the_reflectors_table() {
    let mut data = Vec::new();
    for row in 0..reflector::ALPHAS {
        let alpha = reflector::alpha_node(row);
        for column in 0..reflector::COSINES {
            let mu = cosine_at(column as f64 / (reflector::COSINES - 1) as f64, alpha);
            let [loss, edge] = reflected(mu, alpha);
            let loss = loss / bump(mu, alpha) / f64::from(reflector::LOSS_STEP);
            let edge = (edge - fresnel::schlick_weight(mu)) / f64::from(reflector::EDGE_STEP);
            for value in [loss, edge] {
                data.extend((value.round() as i16).to_le_bytes());
            }
        }
    }
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/albedo/reflector.bin");
    std::fs::write(path, data).unwrap();
}

#[test]
fn the_reflectors_table_is_near_everywhere() {
    for alpha in [0.0012, 0.004, 0.01, 0.03, 0.1, 0.22, 0.4, 0.6, 0.83, 1.0] {
        for mu in [
            0.001, 0.004, 0.01, 0.04, 0.1, 0.2, 0.33, 0.5, 0.7, 0.85, 0.95, 1.0,
        ] {
            let [loss, edge] = reflected(mu, alpha);
            let got = reflector_loss(mu, alpha);
            let off = (f64::from(got.loss) - loss)
                .abs()
                .max((f64::from(got.edge) - edge).abs());
            assert!(off < 1.5e-3, "alpha {alpha} mu {mu}: {got:?} {loss} {edge}");
        }
    }
}

#[test]
fn the_table_that_stands_is_the_one_computed() {
    let indices = index_nodes();
    for (row, column) in [(0, 3), (5, 20), (11, 7), (14, 39), (26, 12)] {
        let alpha = alpha_node(row);
        let mu = cosine_at(column as f64 / (COSINES - 1) as f64, alpha);
        for (n, sides) in indices.iter().zip(losses(mu, alpha, &indices)).skip(1) {
            for (side, loss) in sides.into_iter().enumerate() {
                let got = f64::from(interface_loss(InterfaceLoss::new(*n, alpha), mu, side));
                assert!(
                    (got - loss).abs() < 1.5e-4,
                    "n {n} alpha {alpha} mu {mu}: {got} {loss}"
                );
            }
        }
    }
}

#[test]
#[ignore = "long"]
fn between_the_nodes_the_table_is_near() {
    let (mut worst, mut where_) = (0.0, String::new());
    let indices = [1.1, 1.2, 1.33, 1.45, 1.5, 1.62, 1.8, 2.0, 2.2, 2.4];
    for alpha in [
        0.005, 0.01, 0.02, 0.05, 0.1, 0.17, 0.25, 0.4, 0.55, 0.75, 0.95, 1.0,
    ] {
        for mu in [
            0.003, 0.01, 0.03, 0.08, 0.15, 0.25, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0,
        ] {
            for (n, sides) in indices.iter().zip(losses(mu, alpha, &indices)) {
                for (side, loss) in sides.into_iter().enumerate() {
                    let got = f64::from(interface_loss(InterfaceLoss::new(*n, alpha), mu, side));
                    if (got - loss).abs() > worst {
                        worst = (got - loss).abs();
                        where_ = format!("n {n} alpha {alpha} mu {mu} side {side}: {got} {loss}");
                    }
                }
            }
        }
    }
    assert!(worst < 0.002, "{where_}");
}
