use glam::{Vec2, Vec3};

use super::query::Query;
use super::stage::Stage;
use super::{BuiltinError, BuiltinScene, cornell_direct, materials, room, shapes};
use crate::Description;

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "cornell-indirect",
    summary: "diffuse box lit by way of the ceiling: indirect light alone (RELT figure 5, Batty 2 and 3)",
    parameters: &[],
    build,
};

/// Where the tray hangs: its bottom, the lamp in it, its rim.
const BOTTOM: f32 = 4.3;
const LAMP: f32 = 4.36;
const RIM: f32 = 4.72;

/// Half edges of the lamp and of the tray's inside and outside.
const LAMP_HALF: f32 = 0.3;
const INSIDE: f32 = 0.4;
const OUTSIDE: f32 = 0.44;

fn build(_: &Query<'_>) -> Result<Description, BuiltinError> {
    let mut stage = Stage::new();
    let paints = room::walls(&mut stage, 0.0);
    cornell_direct::blocks(&mut stage, paints.white);
    tray(&mut stage, paints.white);
    room::camera(&mut stage);
    Ok(stage.finish())
}

/// A lamp that faces the ceiling out of a tray so deep that its light meets nothing else: the
/// lowest ray over the rim rises by 0.36 over 0.7 and reaches the ceiling before a wall.
fn tray(stage: &mut Stage, paint: usize) {
    let Vec2 { x, y: z } = room::LAMP_CENTRE;
    let centre = |y| Vec3::new(x, y, z);
    let at = |y: f32, half: f32| {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(i, k): (f32, f32)| Vec3::new(x + half * i, y, z + half * k))
    };
    let mut parts = vec![shapes::quad(at(BOTTOM, OUTSIDE), centre(0.0))];
    let floor = BOTTOM + 0.03;
    parts.push(shapes::quad(at(floor, INSIDE), centre(RIM)));
    let [low, inside, high, rim] = [
        at(BOTTOM, OUTSIDE),
        at(floor, INSIDE),
        at(RIM, OUTSIDE),
        at(RIM, INSIDE),
    ];
    for i in 0..4 {
        let j = (i + 1) % 4;
        let out = (low[i] + low[j]) * 0.5 - centre(BOTTOM);
        let away = centre(BOTTOM) + out * 10.0;
        parts.push(shapes::quad([low[i], low[j], high[j], high[i]], away));
        parts.push(shapes::quad(
            [inside[i], inside[j], rim[j], rim[i]],
            centre(RIM),
        ));
        parts.push(shapes::quad(
            [rim[i], rim[j], high[j], high[i]],
            centre(10.0),
        ));
    }
    stage.place("tray", paint, shapes::join(parts));
    let lamp = stage.material(materials::lamp(320.0));
    stage.place("lamp", lamp, shapes::quad(at(LAMP, LAMP_HALF), centre(RIM)));
}
