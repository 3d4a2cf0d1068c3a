use glam::{DVec3, Vec2};

use super::query::Query;
use super::stage::Stage;
use super::{BuiltinError, BuiltinScene, materials, patterns};
use crate::Description;

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "canyon",
    summary: "a deep and winding gorge of rock from its floor: sunlit rims, dark foot, long depth; diffuse (STF figures 7, 8)",
    parameters: &[],
    build,
};

/// The land (x, z), one unit a metre.
const LAND: [Vec2; 2] = [Vec2::new(-70.0, -10.0), Vec2::new(70.0, 190.0)];
/// Height of the rims over the floor.
const RIM: f32 = 42.0;

fn build(_: &Query<'_>) -> Result<Description, BuiltinError> {
    let mut stage = Stage::new();
    let rock = stage.painted(materials::diffuse("rock", [1.0; 3]), patterns::strata());
    let land = patterns::terrain(LAND, [200, 220], 0.02, height);
    stage.place("land", rock, land);
    // Low from one side: it meets rims and the upper walls of that side alone.
    stage.sun(DVec3::new(0.8, -0.5, 0.25), 60.0);
    stage.sky([0.02, 0.03, 0.05]);
    let eye = DVec3::new(
        f64::from(middle(2.0)),
        f64::from(height(Vec2::new(middle(2.0), 2.0))) + 2.0,
        2.0,
    );
    let target = DVec3::new(f64::from(middle(34.0)), eye.y + 5.0, 34.0);
    stage.camera(eye, target, 1.0);
    Ok(stage.finish())
}

/// Where the gorge runs.
fn middle(z: f32) -> f32 {
    7.0 * libm::sinf(0.055 * z) + 3.0 * libm::sinf(0.13 * z + 1.0)
}

/// A floor with rubble, walls in two steps, and a plateau; the gorge closes at both ends.
fn height(at: Vec2) -> f32 {
    let rubble = patterns::rough(at * 0.12, 4);
    let bumps = 6.0 * (rubble - 0.5);
    let wide = 4.5 + 3.0 * patterns::rough(Vec2::new(at.y * 0.05, 9.0), 2);
    let ends = (4.0 - (at.y + 8.0)).max(at.y - 150.0).max(0.0);
    let away = (at.x - middle(at.y)).abs() + bumps + 0.7 * ends;
    let step = |from: f32, to: f32| {
        let t = ((away - from) / (to - from)).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    };
    let walls = 0.55 * step(wide, wide + 5.0) + 0.45 * step(wide + 8.0, wide + 13.0);
    RIM * walls + 2.5 * rubble
}
