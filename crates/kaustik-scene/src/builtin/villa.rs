use glam::{DVec3, Vec2, Vec3};

use super::query::Query;
use super::stage::Stage;
use super::{BuiltinError, BuiltinScene, materials, patterns, shapes, spheres};
use crate::Description;

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "villa",
    summary: "a bright garden through the windows of a dim living room, under sun and sky (STF figure 7)",
    parameters: &[],
    build,
};

/// The living room from the origin, one unit a metre; windows at its far end.
const ROOM: Vec3 = Vec3::new(9.0, 3.0, 11.0);
const WALL: f32 = 0.3;
/// Two windows: along x; from, to in height.
const WINDOWS: ([[f32; 2]; 2], [f32; 2]) = ([[3.4, 4.5], [5.0, 6.1]], [0.7, 2.1]);

fn build(_: &Query<'_>) -> Result<Description, BuiltinError> {
    let mut stage = Stage::new();
    let plaster = stage.material(materials::diffuse("plaster", [0.55, 0.5, 0.44]));
    let boards = stage.painted(materials::diffuse("boards", [1.0; 3]), patterns::boards());
    house(&mut stage, plaster);
    let floor = shapes::slab([-WALL, -0.3, -WALL], [ROOM.x + WALL, 0.0, ROOM.z]);
    stage.place("floor", boards, patterns::draped(floor, 0.5));
    furniture(&mut stage, boards);
    garden(&mut stage);
    // From behind the house, so that no sunlight comes straight in.
    stage.sun(DVec3::new(0.35, -0.75, 0.55), 40.0);
    stage.sky([1.6, 2.0, 2.8]);
    stage.camera(DVec3::new(5.6, 1.6, 0.4), DVec3::new(4.6, 1.2, 8.0), 0.95);
    Ok(stage.finish())
}

fn house(stage: &mut Stage, plaster: usize) {
    let Vec3 { x, y, z } = ROOM;
    let s = shapes::slab;
    let mut walls = vec![
        // the roof reaches over the windows
        s([-WALL, y, -WALL], [x + WALL, y + WALL, z + 1.5]),
        s([-WALL, -0.3, -WALL], [0.0, y, z + WALL]),
        s([x, -0.3, -WALL], [x + WALL, y, z + WALL]),
        s([0.0, -0.3, -WALL], [x, y, 0.0]),
    ];
    let (windows, height) = WINDOWS;
    let mut from = 0.0;
    for (index, window) in windows.into_iter().enumerate() {
        let to = if index == 0 { 4.75 } else { x };
        walls.extend(shapes::pierced(
            [from, to],
            [-0.3, y],
            [z, z + WALL],
            [window, height],
        ));
        from = to;
    }
    stage.place("house", plaster, shapes::join(walls));
}

/// A sofa, a table with a vase and a mirror over it, shelves with balls.
fn furniture(stage: &mut Stage, oak: usize) {
    let cloth = stage.material(materials::diffuse("cloth", [0.35, 0.12, 0.1]));
    let s = shapes::slab;
    let sofa = [
        s([1.0, 0.1, 4.0], [1.9, 0.45, 6.8]),
        s([0.7, 0.1, 4.0], [1.0, 0.95, 6.8]),
        s([0.9, 0.45, 3.8], [1.9, 0.65, 4.05]),
        s([0.9, 0.45, 6.75], [1.9, 0.65, 7.0]),
    ];
    stage.place("sofa", cloth, shapes::join(sofa));
    let mut table = vec![s([3.2, 0.42, 4.6], [4.4, 0.47, 6.4])];
    for (x, z) in [(3.25, 4.65), (4.28, 4.65), (3.25, 6.27), (4.28, 6.27)] {
        table.push(s([x, 0.0, z], [x + 0.07, 0.42, z + 0.07]));
    }
    for k in 0..5 {
        let y = 0.4 + 0.45 * k as f32;
        table.push(s([8.6, y, 3.0], [9.0, y + 0.03, 8.0]));
    }
    stage.place("oak", oak, patterns::draped(shapes::join(table), 0.7));
    let china = stage.material(materials::diffuse("china", [0.75, 0.75, 0.78]));
    let mut things = vec![shapes::revolved(Vec3::new(3.8, 0.47, 5.6), &vase(), 64)];
    for k in 0..20 {
        let (row, column) = (k / 5, k % 5);
        let radius = 0.1 + 0.02 * ((k * 7) % 4) as f32;
        let y = 0.43 + 0.45 * row as f32 + radius;
        let at = Vec3::new(8.78, y + 0.001, 3.5 + column as f32);
        things.push(spheres::sphere(at, radius, 20));
    }
    stage.place("china", china, shapes::join(things));
    let mirror = stage.material(materials::mirror());
    let corners = [(3.5, 0.9), (6.0, 0.9), (6.0, 2.4), (3.5, 2.4)];
    let corners = corners.map(|(z, y)| Vec3::new(0.02, y, z));
    stage.place(
        "mirror",
        mirror,
        shapes::quad(corners, Vec3::new(9.0, 1.5, 5.0)),
    );
}

/// Radius and height from the foot to the rim.
fn vase() -> Vec<Vec2> {
    let radius = |t: f32| 0.09 + 0.35 * t * (1.0 - t) * (1.0 - 0.8 * t);
    let at = |k: u32| {
        let t = k as f32 / 32.0;
        Vec2::new(radius(t), 0.45 * t)
    };
    (0..=32).map(at).collect()
}

/// Rolling grass and trees to the horizon.
fn garden(stage: &mut Stage) {
    let grass = patterns::ground("grass", [60.0, 84.0, 30.0], [128.0, 150.0, 70.0]);
    let grass = stage.painted(materials::diffuse("grass", [1.0; 3]), grass);
    let area = [Vec2::new(-55.0, -40.0), Vec2::new(65.0, 80.0)];
    let height = |at: Vec2| {
        let away = ((at.y - 14.0) * 0.02).clamp(0.0, 1.0);
        -0.35 + 9.0 * away * away * patterns::rough(at * 0.06, 3)
    };
    stage.place(
        "grass",
        grass,
        patterns::terrain(area, [120, 120], 0.3, height),
    );
    let bark = stage.material(materials::diffuse("bark", [0.2, 0.13, 0.08]));
    let leaves = stage.material(materials::diffuse("leaves", [0.16, 0.3, 0.08]));
    let (mut trunks, mut crowns) = (Vec::new(), Vec::new());
    for k in 0..14 {
        let x = -12.0 + 2.4 * k as f32;
        let z =
            19.0 + 6.0 * patterns::rough(Vec2::new(7.3 * k as f32, 1.0), 1) + 1.5 * (k % 3) as f32;
        let y = height(Vec2::new(x, z)) - 0.2;
        trunks.push(shapes::cuboid(
            Vec3::new(x, y + 1.2, z),
            Vec3::new(0.12, 1.2, 0.12),
            0.3,
        ));
        crowns.push(spheres::sphere(Vec3::new(x, y + 3.2, z), 1.3, 20));
    }
    stage.place("trunks", bark, shapes::join(trunks));
    stage.place("crowns", leaves, shapes::join(crowns));
}
