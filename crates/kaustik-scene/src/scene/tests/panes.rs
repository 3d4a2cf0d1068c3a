//! Smooth panes: which share of rays they stop, how much light passes them.

use glam::{DVec3, Vec3};
use kaustik_geometry::Ray;
use kaustik_spectrum::{Spectrum, uplift_reflectance};

use super::solids::{AXIS, BLUE, slab, solid};
use crate::description::{AlphaMode, Clearcoat, MaterialDescription, Pixels, Transmission};
use crate::testing::{
    Stage, dielectric, floor, grey, image, rectangle, rectangle_with_uv, wavelengths,
};
use crate::{Interior, Passed, Scene, Vertex};

const NUMBERS: u32 = 1_000;

/// What is transparent without thickness.
fn pane(transmission: f32, color: [f32; 3]) -> MaterialDescription {
    let [r, g, b] = color;
    MaterialDescription {
        transmission: Some(Transmission {
            factor: transmission,
            texture: None,
        }),
        base_color: [r, g, b, 1.0],
        metallic: 0.0,
        roughness: 0.0,
        ior: 1.5,
        ..MaterialDescription::default()
    }
}

fn lying(stage: Stage, material: MaterialDescription, height: f32) -> Stage {
    let square = rectangle(Vec3::Y * height, Vec3::Z * 30.0, Vec3::X * 30.0);
    stage.add(material, square)
}

/// Reflected by both sides of a pane of an index, all rebounds together.
fn reflected(cos: f64, index: f64) -> f64 {
    let within = (1.0 - (1.0 - cos * cos) / (index * index)).sqrt();
    let s = (cos - index * within) / (cos + index * within);
    let p = (index * cos - within) / (index * cos + within);
    let once = (s * s + p * p) / 2.0;
    2.0 * once / (1.0 + once)
}

/// From 2 above the ground to 2 below at a cosine.
fn slanting(cos: f64) -> (Ray, f32) {
    let direction = DVec3::new((1.0 - cos * cos).sqrt(), -cos, 0.0);
    let length = 4.0 / cos as f32;
    (
        Ray::new(Vec3::new(0.3, 2.0, 0.7), direction.as_vec3()),
        length,
    )
}

fn near(a: Spectrum, b: Spectrum, within: f32) -> bool {
    (a - b).map(f32::abs).max() < within
}

/// What walks bring beyond all panes in the mean, and what stays on the first.
fn walks(scene: &Scene, ray: &Ray, materials: usize) -> Vec<Spectrum> {
    let mut brought = vec![Spectrum::ZERO; materials + 1];
    for i in 0..NUMBERS {
        let u = (f64::from(i) + 0.5) / f64::from(NUMBERS);
        let (mut vertex, mut interior) = (Vertex::default(), Interior::VACUUM);
        let segment = scene.advance(ray, &mut interior, &wavelengths(), || u, &mut vertex);
        let at = match segment.escapes() {
            true => materials,
            false => vertex.material as usize,
        };
        assert!(at == 0 || segment.through_pane);
        brought[at] += segment.factor() * (1.0 / NUMBERS as f32);
    }
    brought
}

/// Fresnel's share passes: to what lies behind, out of the scene, and on shadow rays from either end.
#[test]
fn what_is_not_reflected_passes() {
    for cos in [1.0, 0.7, 0.2] {
        for (transmission, color) in [(1.0, [1.0; 3]), (1.0, [0.9, 0.5, 0.1]), (0.4, [0.5; 3])] {
            let scene = lying(Stage::new(), pane(transmission, color), 0.0).build();
            let (ray, length) = slanting(cos);
            let through = (1.0 - reflected(cos, 1.5)) as f32 * transmission;
            let tint = uplift_reflectance(color).eval(&wavelengths());
            let expected = tint * through;
            let down = Ray {
                t_max: length,
                ..ray
            };
            let up = Ray {
                t_max: length,
                ..Ray::new(ray.at(length), -ray.direction)
            };
            for ray in [down, up] {
                let passed = scene.visibility(&ray, &Interior::VACUUM, &wavelengths());
                assert!(
                    near(passed.share, expected, 2e-5),
                    "{passed:?} {expected:?}"
                );
                assert!((passed.chance - f64::from(expected.mean())).abs() < 1e-5);
            }
            let brought = walks(&scene, &ray, 1);
            assert!(near(brought[1], expected, 2e-3), "{cos}: {brought:?}");
            // Who meets the pane stands for all that came.
            assert!(near(brought[0], Spectrum::ONE, 2e-2), "{cos}: {brought:?}");
        }
    }
}

/// Panes one behind the other, holes among them, and the ground: each has what passes all before.
#[test]
fn panes_and_veils_multiply() {
    let veiled = MaterialDescription {
        alpha_mode: AlphaMode::Blend,
        base_color: [0.9, 0.5, 0.1, 0.6],
        ..pane(1.0, [1.0; 3])
    };
    let stage = lying(Stage::new(), pane(1.0, [1.0; 3]), 1.0);
    let stage = lying(stage, pane(0.5, BLUE), 0.5);
    let stage = lying(stage, veiled, 0.0);
    let scene = stage.add(grey(0.5), floor(-2.0, 20.0)).build();
    let clear = (1.0 - reflected(0.7, 1.5)) as f32;
    let colour = |color| uplift_reflectance(color).eval(&wavelengths()) * clear;
    let second = Spectrum::splat(clear) * colour(BLUE) * 0.5;
    let third = second * (colour([0.9, 0.5, 0.1]) * 0.6 + Spectrum::splat(0.4));
    let (ray, length) = slanting(0.7);
    let brought = walks(&scene, &ray, 4);
    let expected = [
        Spectrum::ONE,
        Spectrum::splat(clear),
        second * 0.6, // the veil has holes
        third,
        Spectrum::ZERO,
    ];
    for (found, expected) in brought.iter().zip(expected) {
        assert!(near(*found, expected, 3e-2), "{brought:?}");
    }
    let short = Ray {
        t_max: length * 0.99,
        ..ray
    };
    let passed = scene.visibility(&short, &Interior::VACUUM, &wavelengths());
    assert!(near(passed.share, third, 2e-5), "{passed:?} {third:?}");
    let onto = Ray {
        t_max: length * 1.01,
        ..ray
    };
    let blocked = scene.visibility(&onto, &Interior::VACUUM, &wavelengths());
    assert_eq!(blocked, Passed::NOTHING);
}

/// However many panes of one colour, and however dark the others get: what passes is a number from 0 to 1.
#[test]
fn long_rows_of_panes_stay_within_bounds() {
    let row = (0..400).fold(Stage::new(), |stage, i| {
        lying(stage, pane(1.0, [0.95, 0.0, 0.0]), i as f32 * 1e-3)
    });
    let scene = row.build();
    let (ray, length) = slanting(0.9);
    for share in [0.501, 0.52, 0.55, 0.6, 1.0] {
        let ray = Ray {
            t_max: length * share,
            ..ray
        };
        let passed = scene.visibility(&ray, &Interior::VACUUM, &wavelengths());
        let lanes = passed.share.lanes();
        assert!(
            lanes.iter().all(|lane| (0.0..=1.0).contains(lane)),
            "{passed:?}"
        );
        assert!(
            passed.tint().is_finite() && passed.chance >= 0.0,
            "{passed:?}"
        );
    }
}

/// What is frosted, thick, varnished, alight or metal is met by every ray; a pane that does not bend is there for none.
#[test]
fn nothing_else_is_a_pane() {
    let glass = || pane(1.0, [1.0; 3]);
    let share = |material: MaterialDescription| {
        let scene = lying(Stage::new(), material, 0.0).build();
        let (ray, length) = slanting(0.7);
        let ray = Ray {
            t_max: length,
            ..ray
        };
        scene.visibility(&ray, &Interior::VACUUM, &wavelengths())
    };
    let others = [
        MaterialDescription {
            roughness: 0.3,
            ..glass()
        },
        MaterialDescription {
            metallic: 1.0,
            ..glass()
        },
        MaterialDescription {
            emissive: [0.1; 3],
            ..glass()
        },
        MaterialDescription {
            clearcoat: Some(Clearcoat {
                factor: 0.5,
                texture: None,
                roughness: 0.0,
                roughness_texture: None,
                normal_texture: None,
                normal_scale: 1.0,
            }),
            ..glass()
        },
        dielectric(1.5, 0.0, [1.0; 3]),
        grey(0.5),
    ];
    for material in others {
        assert_eq!(share(material), Passed::NOTHING);
    }
    assert!(share(glass()).chance > 0.8);
    let air = MaterialDescription {
        ior: 1.0,
        ..glass()
    };
    let passed = share(air);
    assert!(near(passed.share, Spectrum::ONE, 1e-6) && passed.chance > 1.0 - 1e-6);
}

/// Where a texture makes it rough a pane is met, and passed where that says 0.
#[test]
fn a_pane_is_smooth_where_its_texture_says_so() {
    let texels = [0, 200].map(|roughness| [0, roughness, 0, 255]);
    let (stage, slot) = Stage::new().texture(image(2, 1, Pixels::Rgba8(texels.concat())));
    let material = MaterialDescription {
        roughness: 1.0,
        metallic_roughness_texture: Some(slot),
        ..pane(1.0, [1.0; 3])
    };
    let square = rectangle_with_uv(Vec3::ZERO, Vec3::X, Vec3::Y);
    let scene = stage.add(material, square).build();
    let through = |x: f32| {
        let ray = Ray::new(Vec3::new(x, 0.1, 1.0), Vec3::NEG_Z);
        scene.visibility(&ray, &Interior::VACUUM, &wavelengths())
    };
    let clear = (1.0 - reflected(1.0, 1.5)) as f32;
    assert!(near(through(-0.8).share, Spectrum::splat(clear), 1e-5));
    assert_eq!(through(0.8), Passed::NOTHING);
}

/// A pane in water reflects as its index over that of the water says, and hidden interfaces are none.
#[test]
fn a_pane_in_water_reflects_less() {
    let upright = rectangle(AXIS + Vec3::X * 3.0, Vec3::Y, Vec3::Z);
    let scene = Stage::new()
        .add(solid(1.33, 0, [1.0; 3]), slab(0.0, 4.0))
        .and(slab(1.0, 2.0))
        .add(pane(1.0, [1.0; 3]), upright)
        .build();
    let inside = Interior::VACUUM.with(0);
    let ray = Ray::new(AXIS + Vec3::new(0.5, 0.3, 0.11), Vec3::X);
    let short = Ray { t_max: 3.0, ..ray };
    let passed = scene.visibility(&short, &inside, &wavelengths());
    let expected = (1.0 - reflected(1.0, 1.5 / 1.33)) as f32;
    assert!(
        near(passed.share, Spectrum::splat(expected), 1e-5),
        "{passed:?}"
    );
    let mut vertex = Vertex::default();
    let segment = scene.advance(&ray, &mut { inside }, &wavelengths(), || 0.5, &mut vertex);
    assert!(segment.through_pane && vertex.material == 0);
    assert!((segment.distance - 3.5).abs() < 1e-5);
}
