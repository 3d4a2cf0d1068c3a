//! What lets diffuse light through is as bright from behind as its share says, in closed form.

use glam::Vec3;
use kaustik::scene::Scene;
use kaustik::scene::description::{DiffuseTransmission, MaterialDescription};

use crate::support::{compile, describe, direct_light_by_all, paint, square, sun};

const SIDE: u32 = 16;
const IRRADIANCE: f64 = 5.0;
/// Of the diffuse light, what goes through.
const THROUGH: f64 = 0.7;
/// Colours of what comes back and of what goes through.
const COLOURS: [f64; 2] = [0.8, 0.5];
/// Cosine at which the sun meets the sheet.
const SUN: f64 = 0.6;

/// A sheet without gloss.
fn leaf() -> MaterialDescription {
    MaterialDescription {
        diffuse_transmission: Some(DiffuseTransmission {
            factor: THROUGH as f32,
            texture: None,
            color: [COLOURS[1] as f32; 3],
            color_texture: None,
        }),
        ..paint([COLOURS[0] as f32; 3])
    }
}

/// The sheet seen from above, with the sun on the same side or on the other.
fn sunlit(behind: bool) -> Scene {
    let sheet = (leaf(), square(Vec3::ZERO, 0.6));
    let mut description = describe(Vec3::new(0.03, 0.02, 9.0), 0.1, [sheet]);
    let down = if behind { 1.0 } else { -1.0 };
    let axis = Vec3::new((1.0 - SUN * SUN).sqrt() as f32, 0.0, down * SUN as f32);
    description.lights.push(sun(axis, IRRADIANCE));
    compile(&description, SIDE)
}

#[test]
fn a_leaf_is_lit_from_both_sides() {
    for behind in [false, true] {
        let share = match behind {
            true => THROUGH * COLOURS[1],
            false => (1.0 - THROUGH) * COLOURS[0],
        };
        let expected = share / std::f64::consts::PI * IRRADIANCE * SUN;
        for (method, mean) in direct_light_by_all(&sunlit(behind), SIDE) {
            println!("behind: {behind}, {method}: {:.4}", mean / expected);
            assert!(
                (mean / expected - 1.0).abs() < 0.03,
                "behind: {behind}, {method}: {mean}, {expected}"
            );
        }
    }
}
