use glam::{DVec3, Vec2, Vec3};

use super::query::Query;
use super::stage::Stage;
use super::{BuiltinError, BuiltinScene, materials, patterns, shapes, spheres};
use crate::Description;
use crate::description::{MaterialDescription, Volume};

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "underwater",
    summary: "through a window under water: waves from below, a sea floor with caustics, and depth (STF figure 7)",
    parameters: &[],
    build,
};

/// The basin (x, z), one unit a metre, its sides, and the mean level of the water.
const BASIN: [Vec2; 2] = [Vec2::new(-20.0, 0.0), Vec2::new(20.0, 70.0)];
const LEVEL: f32 = 7.0;
const BOTTOM: f32 = -4.0;
/// The window in the cabin's wall, on both sides of the water's front.
const WINDOW: [[f32; 2]; 2] = [[-1.2, 1.2], [1.6, 3.2]];
/// Half the thickness of that wall.
const WALL: f32 = 0.2;

/// Amplitude and wave vector (x, z) of the waves.
const WAVES: [(f32, [f32; 2]); 4] = [
    (0.10, [0.9, 0.5]),
    (0.06, [-1.1, 1.6]),
    (0.03, [2.3, -1.9]),
    (0.02, [1.7, 3.6]),
];

fn build(_: &Query<'_>) -> Result<Description, BuiltinError> {
    let mut stage = Stage::new();
    let sea = MaterialDescription {
        volume: Some(Volume {
            thickness: 1.0,
            attenuation_distance: 12.0,
            attenuation_color: [0.25, 0.62, 0.7],
        }),
        ..materials::solid("sea", 1.33, 0.0)
    };
    let sea = stage.material(sea);
    let [min, max] = BASIN;
    stage.place("sea", sea, shapes::pool(min, max, BOTTOM, 120, surface));
    basin(&mut stage);
    floor(&mut stage);
    stage.sun(DVec3::new(0.3, -0.9, -0.25), 30.0);
    stage.sky([0.8, 1.0, 1.3]);
    stage.camera(DVec3::new(0.0, 2.2, -1.4), DVec3::new(0.3, 2.7, 12.0), 0.8);
    Ok(stage.finish())
}

/// Height and slopes of the surface.
fn surface(at: Vec2) -> (f32, Vec2) {
    let (mut height, mut slope) = (LEVEL, Vec2::ZERO);
    for (amplitude, k) in WAVES {
        let k = Vec2::from(k);
        let phase = k.dot(at);
        height += amplitude * libm::sinf(phase);
        slope += k * (amplitude * libm::cosf(phase));
    }
    (height, slope)
}

/// Walls that the water reaches into, and the cabin that looks through one.
fn basin(stage: &mut Stage) {
    let stone = stage.painted(materials::diffuse("stone", [1.0; 3]), patterns::strata());
    let [min, max] = BASIN;
    let (low, top) = (BOTTOM - 1.0, LEVEL + 1.5);
    let s = shapes::slab;
    let mut walls = vec![
        s([min.x - 2.0, low, -WALL], [min.x + 0.5, top, max.y + 2.0]),
        s([max.x - 0.5, low, -WALL], [max.x + 2.0, top, max.y + 2.0]),
        s([min.x, low, max.y - 0.5], [max.x, top, max.y + 2.0]),
        s(
            [min.x - 2.0, low, -4.0],
            [max.x + 2.0, BOTTOM + 0.2, max.y + 2.0],
        ),
        // the cabin, closed around the camera
        s([-3.0, 0.5, -3.0], [3.0, 1.0, -WALL]),
        s([-3.0, 4.0, -3.0], [3.0, 4.5, -WALL]),
        s([-3.0, 1.0, -3.0], [-2.6, 4.0, -WALL]),
        s([2.6, 1.0, -3.0], [3.0, 4.0, -WALL]),
        s([-3.0, 0.5, -3.4], [3.0, 4.5, -3.0]),
    ];
    let x = [min.x + 0.5, max.x - 0.5];
    walls.extend(shapes::pierced(x, [low, top], [-WALL, WALL], WINDOW));
    stage.place("basin", stone, patterns::draped(shapes::join(walls), 0.25));
}

/// Sand with boulders and pillars on it.
fn floor(stage: &mut Stage) {
    let sand = patterns::ground("sand", [150.0, 134.0, 100.0], [226.0, 210.0, 172.0]);
    let sand = stage.painted(materials::diffuse("sand", [1.0; 3]), sand);
    let height = |at: Vec2| {
        let slope = -0.03 * at.y;
        0.8 + slope + 1.2 * patterns::rough(at * 0.2, 4)
    };
    let area = [BASIN[0] + Vec2::splat(0.2), BASIN[1] - Vec2::splat(0.2)];
    stage.place(
        "sand",
        sand,
        patterns::terrain(area, [120, 200], 0.4, height),
    );
    let coral = stage.material(materials::diffuse("coral", [0.62, 0.2, 0.16]));
    let (mut boulders, mut pillars) = (Vec::new(), Vec::new());
    for k in 0..24 {
        let random = |j: u32| patterns::rough(Vec2::new(3.7 * k as f32, 5.1 * j as f32), 1);
        let at = Vec2::new(-9.0 + 18.0 * random(1), 4.0 + 2.2 * k as f32);
        let y = height(at);
        let radius = 0.3 + 0.7 * random(2);
        boulders.push(spheres::sphere(
            Vec3::new(at.x, y + 0.2 * radius, at.y),
            radius,
            18,
        ));
        if k % 3 == 0 {
            let tall = 2.0 + 2.5 * random(3);
            let outline: Vec<Vec2> = (0..=20)
                .map(|i| {
                    let t = i as f32 / 20.0;
                    let wave = 0.1 * libm::sinf(9.0 * t);
                    Vec2::new((0.55 - 0.35 * t + wave) * (1.0 - t * t * t * t), tall * t)
                })
                .collect();
            let foot = Vec3::new(at.x + 1.6, y - 0.4, at.y + 1.0);
            pillars.push(shapes::revolved(foot, &outline, 40));
        }
    }
    let rock = stage.material(materials::diffuse("rock", [0.34, 0.33, 0.3]));
    stage.place("boulders", rock, shapes::join(boulders));
    stage.place("pillars", coral, shapes::join(pillars));
}
