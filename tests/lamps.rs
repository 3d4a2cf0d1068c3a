//! A floor under many small lamps, in closed form: next event chooses among them by place.

use std::f64::consts::PI;

use glam::{Affine3A, DVec3, Quat, Vec3};
use kaustik::scene::Scene;
use kaustik::scene::description::{LightDescription, LightKind, MaterialDescription};

use crate::support::{compile, describe, direct_light_by_all, paint, square};

const SIDE: u32 = 16;
const ALBEDO: f64 = 0.6;
/// Radiance of the squares, intensity of the points, irradiance of the sun.
const BRIGHTNESS: [f64; 3] = [8.0, 0.05, 0.4];
const HALF: f64 = 0.04;
/// Half of what is seen of the floor, and its middle.
const SEEN: f64 = 0.4504;
const MIDDLE: [f64; 2] = [0.03, 0.02];

/// Squares that shine to both sides, and points, around what is seen.
fn places() -> ([DVec3; 9], [DVec3; 4]) {
    let around = |i: u32, of: u32, radius: f64| {
        let turn = 2.0 * PI * f64::from(i) / f64::from(of);
        let height = 0.1 + 0.09 * f64::from(i * 5 % of);
        DVec3::new(radius * turn.cos(), radius * turn.sin(), height)
    };
    (
        [0, 1, 2, 3, 4, 5, 6, 7, 8].map(|i| around(i, 9, 0.75)),
        [0, 1, 2, 3].map(|i| around(i, 4, 0.9)),
    )
}

fn light(kind: LightKind, intensity: f64, place: DVec3) -> LightDescription {
    LightDescription {
        name: "light".to_owned(),
        kind,
        color: [1.0; 3],
        intensity: intensity as f32,
        range: None,
        // Along -z, as it is made.
        transform: Affine3A::from_rotation_translation(Quat::IDENTITY, place.as_vec3()),
    }
}

fn floor_and_lamps() -> Scene {
    let (squares, points) = places();
    let [radiance, intensity, irradiance] = BRIGHTNESS;
    let shining = MaterialDescription {
        emissive: [radiance as f32; 3],
        double_sided: true,
        ..paint([0.0; 3])
    };
    let floor = (paint([ALBEDO as f32; 3]), square(Vec3::ZERO, 0.6));
    let lamps = squares.map(|place| (shining.clone(), square(place.as_vec3(), HALF as f32)));
    let things = std::iter::once(floor).chain(lamps);
    let eye = Vec3::new(MIDDLE[0] as f32, MIDDLE[1] as f32, 9.0);
    let mut description = describe(eye, 0.1, things);
    let points = points.map(|place| light(LightKind::Point, intensity, place));
    let sun = light(LightKind::Directional, irradiance, DVec3::ZERO);
    description.lights.extend(points);
    description.lights.push(sun);
    compile(&description, SIDE)
}

/// Points in the middle of equal cells of a square, `count` along a side, from -1 to 1.
fn cells(count: u32) -> impl Iterator<Item = [f64; 2]> {
    let at = move |i: u32| (2.0 * f64::from(i) + 1.0) / f64::from(count) - 1.0;
    (0..count).flat_map(move |i| (0..count).map(move |j| [at(i), at(j)]))
}

/// Irradiance of a point of the floor.
fn irradiance(point: DVec3) -> f64 {
    let (squares, points) = places();
    let [radiance, intensity, sun] = BRIGHTNESS;
    let area = 4.0 * HALF * HALF;
    let of_square = |place: &DVec3| {
        let parts = cells(6).map(|[x, y]| {
            let to = *place + DVec3::new(x, y, 0.0) * HALF - point;
            (to.z / to.length_squared()).powi(2) * area / 36.0
        });
        radiance * parts.sum::<f64>()
    };
    let of_point = |place: &DVec3| {
        let to = *place - point;
        intensity * to.z / to.length().powi(3)
    };
    let squares: f64 = squares.iter().map(of_square).sum();
    squares + points.iter().map(of_point).sum::<f64>() + sun
}

/// Mean radiance of what is seen.
fn expected() -> f64 {
    let seen = cells(64).map(|[x, y]| {
        let place = DVec3::new(MIDDLE[0] + SEEN * x, MIDDLE[1] + SEEN * y, 0.0);
        irradiance(place) * ALBEDO / PI
    });
    seen.sum::<f64>() / (64.0 * 64.0)
}

#[test]
fn a_floor_under_many_lamps_is_as_bright_as_it_should_be() {
    let (scene, expected) = (floor_and_lamps(), expected());
    assert!(scene.chooses_emitters_by_place());
    for (method, mean) in direct_light_by_all(&scene, SIDE) {
        println!("{method}: {:.4}", mean / expected);
        assert!(
            (mean / expected - 1.0).abs() < 0.02,
            "{method}: {mean}, {expected}"
        );
    }
}
