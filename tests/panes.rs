//! What is lit through a smooth pane and seen through it, in closed form.

use glam::Vec3;
use kaustik::scene::Scene;
use kaustik::scene::description::{MaterialDescription, Transmission};

use crate::support::{compile, describe, direct_light_by_all, paint, square, sun};

const SIDE: u32 = 16;
const ALBEDO: f64 = 0.6;
const IRRADIANCE: f64 = 5.0;

/// Clear glass of index 1.5 without thickness.
fn pane() -> MaterialDescription {
    MaterialDescription {
        roughness: 0.0,
        metallic: 0.0,
        base_color: [1.0; 4],
        transmission: Some(Transmission {
            factor: 1.0,
            texture: None,
        }),
        ..MaterialDescription::default()
    }
}

/// A floor under panes one above the other, seen from above under a sun whose height has this sine.
fn showcase(panes: u8, height: f32) -> Scene {
    let floor = (paint([ALBEDO as f32; 3]), square(Vec3::ZERO, 0.6));
    let sheets = (1..=panes).map(|i| (pane(), square(Vec3::Z * (0.1 * f32::from(i)), 1.3)));
    let things = std::iter::once(floor).chain(sheets);
    let mut description = describe(Vec3::new(0.03, 0.02, 9.0), 0.1, things);
    let axis = Vec3::new((1.0 - height * height).sqrt(), 0.0, -height);
    description.lights.push(sun(axis, IRRADIANCE));
    compile(&description, SIDE)
}

/// Share that passes a pane at this cosine.
fn passes(cos: f64) -> f64 {
    let within = (1.0 - (1.0 - cos * cos) / 2.25).sqrt();
    let s = (cos - 1.5 * within) / (cos + 1.5 * within);
    let p = (1.5 * cos - within) / (1.5 * cos + within);
    let once = (s * s + p * p) / 2.0;
    (1.0 - once) / (1.0 + once)
}

/// Direct light on the floor, with what the panes take of it on its way down and up again.
fn expected(panes: u8, sun: f64) -> f64 {
    let both = (passes(sun) * passes(1.0)).powi(i32::from(panes));
    ALBEDO / std::f64::consts::PI * IRRADIANCE * sun * both
}

/// All methods show a floor in the sun below panes: what passes them is no vertex, and takes no edge of the path.
#[test]
fn a_floor_below_panes_is_lit_and_seen() {
    for (panes, sun) in [(0, 1.0_f32), (1, 0.9), (2, 0.35)] {
        let (scene, expected) = (showcase(panes, sun), expected(panes, f64::from(sun)));
        for (method, mean) in direct_light_by_all(&scene, SIDE) {
            println!("{panes} panes, {method}: {:.4}", mean / expected);
            assert!(
                (mean / expected - 1.0).abs() < 0.03,
                "{panes} panes, {method}: {mean}, {expected}"
            );
        }
    }
}
