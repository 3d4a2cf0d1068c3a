use glam::{DVec3, Vec2, Vec3};

use super::query::Query;
use super::stage::Stage;
use super::{BuiltinError, BuiltinScene, materials, patterns, shapes, spheres};
use crate::Description;

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "dinner-hall",
    summary: "a laid table in the dark; light comes through an open door and a passage from a bright entrance hall far behind (STF figure 7)",
    parameters: &[],
    build,
};

/// The dining room from the origin, one unit a metre; the camera stands in it.
const ROOM: Vec3 = Vec3::new(6.0, 3.4, 9.0);
/// Thickness of walls.
const WALL: f32 = 0.3;
/// The door: along x, and its height.
const DOOR: ([f32; 2], f32) = ([3.7, 5.3], 2.5);
/// The passage: along x, its height, and where it ends.
const PASSAGE: ([f32; 2], f32, f32) = ([3.5, 5.9], 2.9, 11.5);
/// The entrance hall: along x, its height, and where it ends.
const HALL: ([f32; 2], f32, f32) = ([-3.0, 11.0], 6.5, 23.0);
/// Its windows to the street: along x; from, to in height.
const WINDOWS: ([[f32; 2]; 3], [f32; 2]) = ([[-2.0, -0.5], [1.0, 2.5], [8.0, 9.5]], [1.2, 4.8]);

fn build(_: &Query<'_>) -> Result<Description, BuiltinError> {
    let mut stage = Stage::new();
    let plaster = stage.material(materials::diffuse("plaster", [0.72, 0.68, 0.6]));
    let boards = stage.painted(materials::diffuse("boards", [1.0; 3]), patterns::boards());
    let tiles = stage.painted(materials::diffuse("tiles", [1.0; 3]), patterns::tiles());
    let oak = stage.painted(materials::diffuse("oak", [1.0; 3]), patterns::boards());
    rooms(&mut stage, plaster);
    let floor = |low, high, scale| patterns::draped(shapes::slab(low, high), scale);
    let (z, end) = (ROOM.z + WALL, HALL.2);
    stage.place(
        "floor",
        boards,
        floor([-WALL, -0.3, -WALL], [ROOM.x + WALL, 0.0, z], 0.6),
    );
    let stone = [
        floor(
            [PASSAGE.0[0] - WALL, -0.3, z],
            [PASSAGE.0[1] + WALL, 0.0, PASSAGE.2],
            0.5,
        ),
        floor(
            [HALL.0[0] - WALL, -0.3, PASSAGE.2],
            [HALL.0[1] + WALL, 0.0, end + WALL],
            0.5,
        ),
    ];
    stage.place("stone", tiles, shapes::join(stone));
    furniture(&mut stage, oak);
    dishes(&mut stage);
    let street = shapes::slab([-60.0, -0.4, -30.0], [68.0, -0.3, 90.0]);
    stage.place("street", plaster, street);
    // Low from the street's side: it shines into the hall and no farther.
    stage.sun(DVec3::new(0.25, -0.62, -0.8), 60.0);
    stage.sky([1.0, 1.2, 1.5]);
    stage.camera(DVec3::new(2.6, 1.65, 0.3), DVec3::new(3.5, 1.15, 7.0), 0.9);
    Ok(stage.finish())
}

/// Three rooms one behind the other, closed but for a door, the passage's mouth and the hall's windows.
fn rooms(stage: &mut Stage, plaster: usize) {
    let (near, far) = (ROOM.z, ROOM.z + WALL);
    let ([p0, p1], low, mouth) = PASSAGE;
    let ([h0, h1], high, end) = HALL;
    let s = shapes::slab;
    let mut walls = vec![
        // dining room
        s([-WALL, ROOM.y, -WALL], [ROOM.x + WALL, ROOM.y + WALL, far]),
        s([-WALL, 0.0, -WALL], [0.0, ROOM.y, far]),
        s([ROOM.x, 0.0, -WALL], [ROOM.x + WALL, ROOM.y, far]),
        s([-WALL, 0.0, -WALL], [ROOM.x + WALL, ROOM.y, 0.0]),
        // passage
        s([p0 - WALL, low, far], [p1 + WALL, low + WALL, mouth]),
        s([p0 - WALL, 0.0, far], [p0, low, mouth]),
        s([p1, 0.0, far], [p1 + WALL, low, mouth]),
        // hall
        s(
            [h0 - WALL, high, mouth],
            [h1 + WALL, high + WALL, end + WALL],
        ),
        s([h0 - WALL, 0.0, mouth], [h0, high, end + WALL]),
        s([h1, 0.0, mouth], [h1 + WALL, high, end + WALL]),
    ];
    let (door, lintel) = DOOR;
    walls.extend(shapes::pierced(
        [0.0, ROOM.x],
        [-0.3, ROOM.y],
        [near, far],
        [door, [-0.2, lintel]],
    ));
    walls.extend(shapes::pierced(
        [h0, h1],
        [-0.3, high],
        [mouth, mouth + WALL],
        [[p0, p1], [-0.2, low]],
    ));
    let (windows, [sill, top]) = WINDOWS;
    let outer = [end, end + WALL];
    let mut from = h0;
    for window in windows {
        let to = window[1] + 0.5;
        walls.extend(shapes::pierced(
            [from, to],
            [0.0, high],
            [outer[0], outer[1]],
            [window, [sill, top]],
        ));
        from = to;
    }
    walls.push(s([from, 0.0, outer[0]], [h1, high, outer[1]]));
    stage.place("walls", plaster, shapes::join(walls));
    let columns = [-0.5, 2.0, 7.5, 9.5].into_iter().flat_map(|x| {
        [14.5, 19.5].map(|z| {
            let outline: Vec<Vec2> = (0..=24)
                .map(|k| {
                    let t = k as f32 / 24.0;
                    let swell = 4.0 * t * (1.0 - t);
                    Vec2::new(0.3 - 0.05 * swell, high * t)
                })
                .collect();
            shapes::revolved(Vec3::new(x, 0.0, z), &outline, 48)
        })
    });
    stage.place("columns", plaster, shapes::join(columns));
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
    stage.place("table", oak, patterns::draped(shapes::join(table), 0.8));
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
    stage.place("chairs", oak, patterns::draped(shapes::join(chairs), 1.5));
    let leaf = Vec3::new(5.62, 1.22, ROOM.z - 0.62);
    let leaf = shapes::cuboid(leaf, Vec3::new(0.65, 1.2, 0.02), 1.05);
    stage.place("door", oak, patterns::draped(leaf, 0.8));
}

/// Bowls of china and glass balls on the table.
fn dishes(stage: &mut Stage) {
    let china = stage.material(materials::diffuse("china", [0.8, 0.8, 0.78]));
    let bowls = (0..8).map(|index| {
        let (side, row) = ((index % 2) as f32 - 0.5, (index / 2) as f32);
        let at = Vec3::new(2.9 + 0.6 * side, 0.861, 3.4 + 0.95 * row);
        spheres::sphere(at, 0.08, 24)
    });
    stage.place("bowls", china, shapes::join(bowls));
    let glass = stage.material(materials::solid("glass", 1.5, 0.0));
    for (number, z) in [3.9, 4.9, 5.8].into_iter().enumerate() {
        let ball = spheres::sphere(Vec3::new(2.9, 0.881, z), 0.1, 24);
        stage.place(&format!("ball {number}"), glass, ball);
    }
}
