//! Partly transparent surfaces: which share of rays they stop, how much light they let by.

use glam::{Affine3A, Vec3};
use kaustik_geometry::Ray;

use super::{meet, passed_share};
use crate::description::{AlphaMode, MaterialDescription, Pixels};
use crate::testing::{Stage, blended, grey, image, lamp, rectangle_with_uv, wavelengths};
use crate::{Interior, Passed, Scene, Vertex};

const NUMBERS: u32 = 10_000;

fn veil(opacity: f32) -> MaterialDescription {
    blended(grey(0.5), opacity)
}

fn square(z: f32) -> kaustik_geometry::Mesh {
    rectangle_with_uv(Vec3::Z * z, Vec3::X, Vec3::Y)
}

/// Veils at these heights in this order, over a black floor.
fn layers(layers: &[(f32, f32)]) -> Scene {
    let veils = layers.iter().fold(Stage::new(), |stage, &(opacity, z)| {
        stage.add(veil(opacity), square(z))
    });
    veils.add(grey(0.0), square(-5.0)).build()
}

const START: Vec3 = Vec3::new(0.1, 0.23, 3.0);

/// How many of evenly spread numbers end a ray at each material.
fn stops(scene: &Scene, materials: usize) -> Vec<u32> {
    let mut count = vec![0; materials];
    let ray = Ray::new(START, Vec3::NEG_Z);
    for i in 0..NUMBERS {
        let u = (f64::from(i) + 0.5) / f64::from(NUMBERS);
        let (vertex, _) = meet(scene, &ray, &mut { Interior::VACUUM }, u).expect("the floor");
        count[vertex.material as usize] += 1;
    }
    count
}

#[test]
fn each_layer_stops_its_share() {
    // the last three coincide; the camera looks from the front and, below, from behind
    let opacities = [0.2_f32, 0.5, 0.1, 0.7, 0.4];
    let heights = [1.0, 0.5, 0.0, 0.0, 0.0];
    let list: Vec<(f32, f32)> = opacities.into_iter().zip(heights).collect();
    let scene = layers(&list);
    let found = stops(&scene, list.len() + 1);
    let mut passed = 1.0;
    for (index, opacity) in opacities.into_iter().enumerate() {
        let expected = passed * opacity * NUMBERS as f32;
        assert!(
            (found[index] as f32 - expected).abs() < 1.5,
            "{found:?}: {index} {expected}"
        );
        passed *= 1.0 - opacity;
    }
    let through = found[list.len()] as f32;
    assert!((through - passed * NUMBERS as f32).abs() < 1.5, "{found:?}");
    let down = Ray {
        t_max: 7.9,
        ..Ray::new(START, Vec3::NEG_Z)
    };
    let up = Ray::new(START - Vec3::Z * 7.9, Vec3::Z);
    for ray in [down, up] {
        let visibility = passed_share(&scene, &ray, &Interior::VACUUM);
        assert!((visibility - passed).abs() < 1e-6, "{visibility}");
    }
}

/// What a walk says of its way is what a look back finds: clear if no veil was passed by chance, and only then.
#[test]
fn a_walk_knows_whether_its_way_was_clear() {
    let scene = layers(&[(0.0, 2.0), (0.2, 1.0), (0.5, 0.5), (0.7, 0.0)]);
    let ray = Ray::new(START, Vec3::NEG_Z);
    let mut clear = 0;
    for i in 0..100 {
        let u = (f64::from(i) + 0.5) / 100.0;
        let (mut vertex, mut interior) = (Vertex::default(), Interior::VACUUM);
        let segment = scene.advance(&ray, &mut interior, &wavelengths(), || u, &mut vertex);
        let back = Ray {
            t_max: segment.distance as f32 - 0.1,
            ..ray
        };
        let share = passed_share(&scene, &back, &Interior::VACUUM);
        assert_eq!(segment.by_chance, share < 1.0, "{u}: {share}");
        clear += u32::from(!segment.by_chance);
    }
    assert_eq!(clear, 20);
}

#[test]
fn the_floor_and_full_opacity_block() {
    let scene = layers(&[(0.5, 1.0), (1.0, 0.0), (0.0, 2.0)]);
    let ray = Ray::new(START, Vec3::NEG_Z);
    let blocked = scene.visibility(&ray, &Interior::VACUUM, &wavelengths());
    assert_eq!(blocked, Passed::NOTHING);
    assert_eq!(stops(&scene, 4), [NUMBERS / 2, NUMBERS / 2, 0, 0]);
}

/// One number serves a whole segment, and is asked for only where it is needed.
#[test]
fn a_number_is_asked_for_at_most_once() {
    let asked = |scene: &Scene| {
        let mut asked = 0;
        let ask = || {
            asked += 1;
            0.01
        };
        let ray = Ray::new(START, Vec3::NEG_Z);
        let mut vertex = Vertex::default();
        let interior = &mut { Interior::VACUUM };
        scene.advance(&ray, interior, &wavelengths(), ask, &mut vertex);
        asked
    };
    assert_eq!(asked(&layers(&[(0.5, 1.0), (0.5, 0.0), (0.3, 0.0)])), 1);
    assert_eq!(asked(&layers(&[(1.0, 1.0), (0.5, 0.0)])), 0);
    assert_eq!(asked(&layers(&[(0.0, 1.0)])), 0);
    assert_eq!(asked(&layers(&[])), 0);
}

/// A veil placed many times over: instances count one by one.
#[test]
fn instances_of_one_veil_multiply() {
    let stage = (0..20).fold(Stage::new(), |stage, i| {
        let transform = Affine3A::from_translation(Vec3::Z * (i / 4) as f32 * 0.1);
        stage.add_at(veil(0.1), square(0.0), transform)
    });
    let scene = stage.build();
    let ray = Ray::new(START, Vec3::NEG_Z);
    let expected = 0.9_f32.powi(20);
    let found = passed_share(&scene, &ray, &Interior::VACUUM);
    assert!((found - expected).abs() < 1e-6);
    let met = (0..NUMBERS).filter(|i| {
        let u = (f64::from(*i) + 0.5) / f64::from(NUMBERS);
        meet(&scene, &ray, &mut { Interior::VACUUM }, u).is_some()
    });
    let share = met.count() as f32 / NUMBERS as f32;
    assert!((share - (1.0 - expected)).abs() < 2e-4);
}

/// A square whose left half has the alpha 102 of 255, its right half 153.
fn halves(alpha_mode: AlphaMode) -> Scene {
    let texels = [102, 153].map(|alpha| [255, 255, 255, alpha]);
    let (stage, slot) = Stage::new().texture(image(2, 1, Pixels::Rgba8(texels.concat())));
    let material = MaterialDescription {
        base_color_texture: Some(slot),
        alpha_mode,
        ..grey(0.5)
    };
    stage.add(material, square(0.0)).build()
}

#[test]
fn alpha_comes_from_the_texture() {
    let through = |scene: &Scene, x: f32| {
        let ray = Ray::new(Vec3::new(x, 0.1, 1.0), Vec3::NEG_Z);
        let passed = passed_share(scene, &ray, &Interior::VACUUM);
        for i in 0..100_u8 {
            let u = (f64::from(i) + 0.5) / 100.0;
            let met = meet(scene, &ray, &mut { Interior::VACUUM }, u).is_some();
            assert_eq!(met, u >= f64::from(passed), "{x} {u}");
        }
        passed
    };
    let blocks = |scene: &Scene| [-0.4, 0.4].map(|x| through(scene, x) <= 0.0);
    let cut = halves(AlphaMode::Mask(0.5));
    assert!(through(&cut, -0.4) >= 1.0);
    assert_eq!(blocks(&cut), [false, true]);
    let blend = halves(AlphaMode::Blend);
    assert!((through(&blend, -0.4) - 0.6).abs() < 1e-6);
    assert!((through(&blend, 0.4) - 0.4).abs() < 1e-6);
    let opaque = halves(AlphaMode::Opaque);
    assert_eq!(blocks(&opaque), [true, true]);
}

/// The cutoff itself is opaque.
#[test]
fn a_mask_is_opaque_from_its_cutoff_on() {
    for (alpha, there) in [(0.5, true), (0.49999, false), (0.6, true)] {
        let material = MaterialDescription {
            alpha_mode: AlphaMode::Mask(0.5),
            ..veil(alpha)
        };
        let stage = Stage::new().add(material, square(0.0));
        let ray = Ray::new(START, Vec3::NEG_Z);
        let met = meet(&stage.build(), &ray, &mut { Interior::VACUUM }, 0.999);
        assert_eq!(met.is_some(), there, "{alpha}");
    }
}

/// A lamp that is met by chance only is dimmed by that chance where it is chosen.
#[test]
fn a_veil_that_shines_is_dimmed_where_it_is_chosen() {
    let radiance = |opacity: f32| {
        let material = MaterialDescription {
            emissive: [2.0; 3],
            ..veil(opacity)
        };
        let scene = Stage::new().add(material, square(0.0)).build();
        let from = START.as_dvec3();
        let sample = scene.sample_direct(from, &wavelengths(), |_| 0.4);
        sample.expect("a lamp").radiance.hero()
    };
    let full = Stage::new()
        .add(lamp(2.0), square(0.0))
        .build()
        .sample_direct(START.as_dvec3(), &wavelengths(), |_| 0.4)
        .expect("a lamp")
        .radiance
        .hero();
    assert!((radiance(0.25) / full - 0.25).abs() < 1e-6);
    assert!((radiance(1.0) / full - 1.0).abs() < 1e-6);
}
