//! What the camera and the emitters are inside of.

use glam::Vec3;

use super::solids::{AXIS, BLUE, GLASS, GREEN, WATER, slab, solid};
use crate::description::{LightKind, MaterialDescription};
use crate::testing::{Rng, Stage, cuboid, grey, lamp, punctual, rectangle, wavelengths};

#[test]
fn the_camera_knows_what_it_is_in() {
    let around = |eye: Vec3| {
        let stage = Stage::new()
            .eye(eye)
            .add(solid(1.33, 1, BLUE), slab(1.0, 4.0))
            .add(solid(1.5, 2, GREEN), slab(0.0, 2.0))
            // an open wall and a hollow within the water count for nothing
            .add(grey(0.5), rectangle(Vec3::X * 2.5, Vec3::Y, Vec3::Z));
        stage.build().camera_interior()
    };
    assert!(around(AXIS - Vec3::X).is_vacuum());
    assert!(around(AXIS + Vec3::X * 7.0).is_vacuum());
    assert_eq!(around(AXIS + Vec3::X * 0.5).solids(), [GLASS]);
    assert_eq!(around(AXIS + Vec3::X * 3.0).solids(), [WATER]);
    let mut both = around(AXIS + Vec3::X * 1.5).solids().to_vec();
    both.sort_unstable();
    assert_eq!(both, [WATER, GLASS]);
}

#[test]
fn a_hollow_is_outside() {
    let mut hollow = cuboid(Vec3::splat(-1.0), Vec3::splat(1.0));
    let mut inner = cuboid(Vec3::splat(-0.5), Vec3::splat(0.5));
    inner.indices.iter_mut().for_each(|t| t.swap(0, 1));
    let first = hollow.positions.len() as u32;
    hollow.positions.extend(inner.positions);
    hollow
        .indices
        .extend(inner.indices.iter().map(|t| t.map(|i| i + first)));
    let stage = Stage::new().add(solid(1.5, 0, GREEN), hollow);
    assert!(stage.build().camera_interior().is_vacuum());
    let within = stage.eye(Vec3::new(0.1, 0.75, 0.2));
    assert_eq!(within.build().camera_interior().solids(), [0]);
}

/// Emitters know what surrounds them, on each of their sides.
#[test]
fn emitters_know_what_they_are_in() {
    let inside_of = |add: &dyn Fn(Stage) -> Stage| {
        let stage = Stage::new().add(solid(1.33, 0, BLUE), slab(1.0, 4.0));
        let scene = add(stage).build();
        let mut rng = Rng::new(2);
        let mut found: Vec<(bool, usize)> = (0..64)
            .map(|_| {
                let sample = scene
                    .sample_emission(&wavelengths(), |_| rng.uniform())
                    .expect("an emission");
                if let Some(area) = &sample.area {
                    let toward = sample.ray.direction.as_dvec3();
                    assert_eq!(scene.area_interior(area, toward), sample.interior);
                }
                (sample.ray.direction.x > 0.0, sample.interior.solids().len())
            })
            .collect();
        found.sort_unstable();
        found.dedup();
        found
    };
    let panel = |x: f32| rectangle(Vec3::X * x, Vec3::Y * 0.5, Vec3::Z * 0.5);
    let (dry, wet) = ([(false, 0), (true, 0)], [(false, 1), (true, 1)]);
    let point = |x: f32| {
        let light = punctual(LightKind::Point, 1.0, AXIS + Vec3::X * x, Vec3::X);
        inside_of(&|s| s.light(light.clone()))
    };
    assert_eq!(point(0.5), dry);
    assert_eq!(point(2.0), wet);
    let plate = |x: f32, sides: bool| {
        let lamp = MaterialDescription {
            double_sided: sides,
            ..lamp(1.0)
        };
        inside_of(&|s| s.add(lamp.clone(), panel(x)))
    };
    assert_eq!(plate(2.0, false), [(true, 1)]);
    assert_eq!(plate(2.0, true), wet);
    assert_eq!(plate(0.0, true), dry);
    // floating on the surface: air on one side, water on the other
    assert_eq!(plate(1.0 - 1e-6, true), [(false, 0), (true, 1)]);
}

/// How far the ground reaches says nothing about how long the edges of paths are.
#[test]
fn the_typical_length_is_that_of_what_is_seen() {
    let stage = Stage::new().add(grey(0.5), cuboid(Vec3::splat(-2.0), Vec3::splat(2.0)));
    let room = stage.build().typical_length();
    assert!((2.0..4.0).contains(&room), "{room}");
    let (u, v) = (Vec3::X * 1e6, Vec3::Z * 1e6);
    let scene = stage
        .add(grey(0.5), rectangle(Vec3::NEG_Y * 3.0, u, v))
        .build();
    assert!(scene.bounding_sphere().1 > 1e6);
    assert_eq!(scene.typical_length().to_bits(), room.to_bits());
    // what sees nothing has the size of all there is
    let scene = Stage::new()
        .eye(Vec3::Y * 1e3)
        .add(grey(0.5), rectangle(Vec3::Y * 2e3, Vec3::Z, Vec3::X))
        .build();
    let (_, radius) = scene.bounding_sphere();
    assert_eq!(scene.typical_length().to_bits(), radius.to_bits());
}
