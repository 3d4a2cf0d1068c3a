use glam::{DVec3, Vec2, Vec3};

use super::query::Query;
use super::stage::Stage;
use super::{BuiltinError, BuiltinScene, materials, shapes, spheres};
use crate::Description;

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "dinner-hall",
    summary: "a laid table in the dark; all light comes through an open door from a bright hall behind it (STF figure 7)",
    parameters: &[],
    build,
};

/// The dining room from the origin, one unit a metre; the camera stands in it.
const ROOM: Vec3 = Vec3::new(6.0, 3.6, 9.0);
/// Thickness of the wall with the door.
const WALL: f32 = 0.2;
/// Depth and width of the hall behind it.
const HALL: Vec2 = Vec2::new(9.0, 15.0);
/// The doorway: from, to along x, and its height.
const DOOR: [f32; 3] = [4.2, 5.2, 2.2];
/// Where lamps hang in the hall, and how bright they are.
const LAMPS: [Vec2; 2] = [Vec2::new(2.0, 20.0), Vec2::new(7.0, 13.0)];
const RADIANCE: f32 = 120.0;

fn build(_: &Query<'_>) -> Result<Description, BuiltinError> {
    let mut stage = Stage::new();
    let plaster = stage.material(materials::diffuse("plaster", [0.72, 0.68, 0.6]));
    let boards = stage.material(materials::diffuse("boards", [0.35, 0.2, 0.1]));
    let oak = stage.material(materials::diffuse("oak", [0.45, 0.27, 0.13]));
    rooms(&mut stage, plaster, boards);
    furniture(&mut stage, oak);
    dishes(&mut stage);
    let lamp = stage.material(materials::lamp(RADIANCE));
    for (index, at) in LAMPS.into_iter().enumerate() {
        let mesh = shapes::square_facing_down(at, ROOM.y - 0.05, 0.5);
        stage.place(&format!("lamp {index}"), lamp, mesh);
    }
    let eye = DVec3::new(1.2, 1.7, 0.4);
    stage.camera(eye, DVec3::new(3.6, 1.2, 7.0), 1.0);
    Ok(stage.finish())
}

/// Both rooms, closed but for the doorway between them.
fn rooms(stage: &mut Stage, plaster: usize, boards: usize) {
    let (near, far) = (ROOM.z, ROOM.z + WALL);
    let end = far + HALL.y;
    let p = Vec3::new;
    let flat = |x0: f32, x1: f32, y: f32, z0: f32, z1: f32, toward: f32| {
        let corners = [p(x0, y, z0), p(x1, y, z0), p(x1, y, z1), p(x0, y, z1)];
        shapes::quad(corners, p(0.5 * (x0 + x1), toward, 0.5 * (z0 + z1)))
    };
    let across = |x0: f32, x1: f32, y0: f32, y1: f32, z: f32, toward: f32| {
        let corners = [p(x0, y0, z), p(x1, y0, z), p(x1, y1, z), p(x0, y1, z)];
        shapes::quad(corners, p(0.5 * (x0 + x1), 0.5 * (y0 + y1), toward))
    };
    let along = |x: f32, y1: f32, z0: f32, z1: f32, toward: f32| {
        let corners = [p(x, 0.0, z0), p(x, y1, z0), p(x, y1, z1), p(x, 0.0, z1)];
        shapes::quad(corners, p(toward, 0.5 * y1, 0.5 * (z0 + z1)))
    };
    let [left, right, lintel] = DOOR;
    let middle = 0.5 * (left + right);
    let floors = [
        flat(0.0, ROOM.x, 0.0, 0.0, near, 1.0),
        flat(left, right, 0.0, near, far, 1.0),
        flat(0.0, HALL.x, 0.0, far, end, 1.0),
    ];
    stage.place("floor", boards, shapes::join(floors));
    let mut walls = vec![
        flat(0.0, ROOM.x, ROOM.y, 0.0, near, 1.0),
        flat(0.0, HALL.x, ROOM.y, far, end, 1.0),
        flat(left, right, lintel, near, far, 1.0),
        across(0.0, ROOM.x, 0.0, ROOM.y, 0.0, 1.0),
        across(0.0, HALL.x, 0.0, ROOM.y, end, far),
        along(0.0, ROOM.y, 0.0, near, 1.0),
        along(ROOM.x, ROOM.y, 0.0, near, 1.0),
        along(0.0, ROOM.y, far, end, 1.0),
        along(HALL.x, ROOM.y, far, end, 1.0),
        along(left, lintel, near, far, middle),
        along(right, lintel, near, far, middle),
    ];
    for (z, width, toward) in [(near, ROOM.x, 1.0), (far, HALL.x, end)] {
        walls.push(across(0.0, left, 0.0, lintel, z, toward));
        walls.push(across(right, width, 0.0, lintel, z, toward));
        walls.push(across(0.0, width, lintel, ROOM.y, z, toward));
    }
    stage.place("walls", plaster, shapes::join(walls));
}

/// A table, eight chairs, the leaf of the door.
fn furniture(stage: &mut Stage, oak: usize) {
    let solid = |x: f32, y: f32, z: f32, half: [f32; 3]| {
        shapes::cuboid(Vec3::new(x, y, z), Vec3::from(half), 0.0)
    };
    let mut table = vec![solid(2.9, 0.75, 4.8, [0.55, 0.03, 1.9])];
    for (x, z) in [(2.45, 3.0), (3.35, 3.0), (2.45, 6.6), (3.35, 6.6)] {
        table.push(solid(x, 0.355, z, [0.04, 0.355, 0.04]));
    }
    stage.place("table", oak, shapes::join(table));
    let mut chairs = Vec::new();
    for row in 0..4 {
        for side in [-1.0, 1.0] {
            let (x, z) = (2.9 + side * 0.85, 3.4 + 0.95 * row as f32);
            chairs.push(solid(x, 0.45, z, [0.22, 0.02, 0.22]));
            chairs.push(solid(x + side * 0.21, 0.75, z, [0.015, 0.27, 0.22]));
            for (dx, dz) in [(-0.2, -0.2), (0.2, -0.2), (-0.2, 0.2), (0.2, 0.2)] {
                chairs.push(solid(x + dx, 0.214, z + dz, [0.02, 0.214, 0.02]));
            }
        }
    }
    stage.place("chairs", oak, shapes::join(chairs));
    let leaf = Vec3::new(5.44, 1.1, ROOM.z - 0.44);
    let leaf = shapes::cuboid(leaf, Vec3::new(0.48, 1.08, 0.02), 1.05);
    stage.place("door", oak, leaf);
}

/// Bowls of china and a glass ball on the table.
fn dishes(stage: &mut Stage) {
    let china = stage.material(materials::diffuse("china", [0.8, 0.8, 0.78]));
    let bowls = (0..8).map(|index| {
        let (side, row) = ((index % 2) as f32 - 0.5, (index / 2) as f32);
        let at = Vec3::new(2.9 + 0.6 * side, 0.861, 3.4 + 0.95 * row);
        spheres::sphere(at, 0.08, 16)
    });
    stage.place("bowls", china, shapes::join(bowls));
    let glass = stage.material(materials::solid("glass", 1.5, 0.0));
    let ball = spheres::sphere(Vec3::new(2.9, 0.931, 4.4), 0.15, 32);
    stage.place("ball", glass, ball);
}
