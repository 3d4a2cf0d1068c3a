use glam::{DVec3, Vec2, Vec3};

use super::query::Query;
use super::stage::Stage;
use super::{BuiltinError, BuiltinScene, materials, patterns, shapes, spheres};
use crate::Description;

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "mirror-balls",
    summary: "mirror balls on a tiled floor in an open room under one lamp: most light paths are seen (STF figure 10)",
    parameters: &[],
    build,
};

/// Balls: where on the floor, and radius.
pub(super) const BALLS: [([f32; 2], f32); 5] = [
    ([1.5, 2.2], 0.7),
    ([3.2, 3.0], 0.9),
    ([4.5, 1.8], 0.5),
    ([2.6, 1.2], 0.4),
    ([4.3, 4.1], 0.6),
];
/// Half the width of the room, and its height.
const ROOM: [f32; 2] = [3.0, 5.0];

fn build(_: &Query<'_>) -> Result<Description, BuiltinError> {
    let mut stage = Stage::new();
    let tiles = stage.painted(materials::diffuse("tiles", [1.0; 3]), patterns::tiles());
    let white = stage.material(materials::white());
    let p = Vec3::new;
    let [half, high] = ROOM;
    let (wide, middle) = (2.0 * half, p(half, 0.5 * high, half));
    let floor = [
        p(0.0, 0.0, 0.0),
        p(wide, 0.0, 0.0),
        p(wide, 0.0, wide),
        p(0.0, 0.0, wide),
    ];
    let floor = shapes::quad(floor, middle);
    stage.place("floor", tiles, patterns::draped(floor, 0.4));
    let walls = [
        [
            p(0.0, 0.0, wide),
            p(wide, 0.0, wide),
            p(wide, high, wide),
            p(0.0, high, wide),
        ],
        [
            p(0.0, 0.0, 0.0),
            p(0.0, 0.0, wide),
            p(0.0, high, wide),
            p(0.0, high, 0.0),
        ],
        [
            p(wide, 0.0, 0.0),
            p(wide, 0.0, wide),
            p(wide, high, wide),
            p(wide, high, 0.0),
        ],
    ];
    let walls = walls.map(|corners| shapes::quad(corners, middle));
    stage.place("walls", white, shapes::join(walls));
    let mirror = stage.material(materials::mirror());
    let balls = BALLS.map(|([x, z], radius)| spheres::sphere(p(x, radius + 0.002, z), radius, 32));
    stage.place("balls", mirror, shapes::join(balls));
    let lamp = stage.material(materials::lamp(30.0));
    let square = shapes::square_facing_down(Vec2::splat(half), high - 0.1, 1.0);
    stage.place("lamp", lamp, square);
    stage.camera(DVec3::new(3.0, 3.2, -6.5), DVec3::new(3.0, 1.3, 3.0), 0.7);
    Ok(stage.finish())
}
