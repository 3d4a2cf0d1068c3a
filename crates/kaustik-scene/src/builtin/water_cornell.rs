use glam::{DVec3, Vec2};

use super::query::Query;
use super::stage::Stage;
use super::{BuiltinError, BuiltinScene, materials, room, shapes};
use crate::Description;

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "water-cornell",
    summary: "a box half full of water with waves and a small lamp: caustics on the floor, seen through the surface (RELT figure 7)",
    parameters: &[room::LIGHT],
    build,
};

/// How far the water reaches into the walls. Its sides lie behind the walls, so light meets the
/// wall first and no sliver of air is left between wall and water.
const OVERLAP: f32 = 0.002;

/// The walls reach forward of the water's front by this much, which hides the overlap from the
/// camera.
const LIP: f32 = 0.05;

/// Mean height of the surface.
const LEVEL: f32 = 1.9;

/// Amplitude and wave vector (x, z) of the waves.
const WAVES: [(f32, [f32; 2]); 4] = [
    (0.030, [2.3, 1.1]),
    (0.022, [-1.7, 3.2]),
    (0.012, [4.9, -2.6]),
    (0.008, [3.1, 6.3]),
];

fn build(query: &Query<'_>) -> Result<Description, BuiltinError> {
    let edge = room::light(query)?;
    let mut stage = Stage::new();
    room::walls(&mut stage, LIP);
    let water = stage.material(materials::solid("water", 1.33, 0.0));
    let min = Vec2::new(-OVERLAP, 0.0);
    let max = Vec2::new(room::SIZE.x + OVERLAP, room::SIZE.z + OVERLAP);
    stage.place(
        "water",
        water,
        shapes::pool(min, max, -OVERLAP, 48, surface),
    );
    room::lamp(&mut stage, edge, room::STRENGTH);
    // a little higher than usual, so that more of the surface shows
    let eye = DVec3::new(2.764, 4.2, -7.6);
    stage.camera(eye, DVec3::new(2.764, 2.35, 2.8), 0.7);
    Ok(stage.finish())
}

/// Height and slopes of the surface.
fn surface(at: Vec2) -> (f32, Vec2) {
    let mut height = LEVEL;
    let mut slope = Vec2::ZERO;
    for (amplitude, k) in WAVES {
        let k = Vec2::from(k);
        let phase = k.dot(at);
        height += amplitude * libm::sinf(phase);
        slope += k * (amplitude * libm::cosf(phase));
    }
    (height, slope)
}
