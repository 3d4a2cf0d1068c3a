//! Scenes whose picture is known in closed form.

use glam::Vec3;
use kaustik::geometry::Mesh;
use kaustik::scene::description::{
    EnvironmentDescription, MaterialDescription, Transmission, Volume,
};
use kaustik::{Method, RenderSettings};

use crate::support::{compile, describe, means, picture, pixels_of_light, scene, settings};

/// Mean of a furnace over its picture; each must be 1.
fn mean(words: &str, method: Method, spp: u64) -> f64 {
    let settings = RenderSettings {
        max_depth: 128,
        ..settings(method, 32, spp)
    };
    let [r, g, b] = means(&picture(&scene(words, 32), &settings));
    (r + g + b) / 3.0
}

fn assert_one(words: &str, method: Method, spp: u64, tolerance: f64) {
    let mean = mean(words, method, spp);
    assert!((mean - 1.0).abs() <= tolerance, "{words}, {method}: {mean}");
}

#[test]
fn closed_sphere() {
    for method in Method::ALL {
        assert_one("furnace?kind=diffuse", method, 24, 0.02);
    }
}

#[test]
#[ignore = "long"]
fn closed_sphere_to_a_percent() {
    for method in Method::ALL {
        assert_one("furnace?kind=diffuse", method, 96, 0.01);
    }
}

#[test]
fn glass_disappears() {
    for method in [Method::Path, Method::Bdpt] {
        assert_one("furnace?kind=glass", method, 256, 0.01);
        assert_one("furnace?kind=rough", method, 256, 0.01);
    }
}

/// A white plate under a glass sphere in uniform light, where `method` can show it: the pixels
/// whose first surface is the plate.
fn assert_plate_is_one(method: Method, spp: u64, tolerance: f64) {
    const SIDE: u32 = 32;
    let scene = scene("furnace?kind=plate", SIDE);
    let settings = RenderSettings {
        max_depth: 128,
        ..settings(method, SIDE, spp)
    };
    let image = picture(&scene, &settings);
    let shown = pixels_of_light(&scene, SIDE);
    let plate: Vec<usize> = (0..shown.len()).filter(|&pixel| shown[pixel]).collect();
    assert!(plate.len() > 150, "{} pixels show the plate", plate.len());
    for plane in image.rgb() {
        let sum: f64 = plate.iter().map(|&pixel| f64::from(plane[pixel])).sum();
        let mean = sum / plate.len() as f64;
        assert!((mean - 1.0).abs() <= tolerance, "{method}: {mean}");
    }
}

#[test]
fn plate_under_glass() {
    assert_plate_is_one(Method::Light, 256, 0.02);
    assert_plate_is_one(Method::Path, 64, 0.02);
    assert_plate_is_one(Method::Bdpt, 64, 0.02);
}

#[test]
#[ignore = "long"]
fn plate_under_glass_to_half_a_percent() {
    for method in Method::ALL {
        // A sample of `mmlt` is one strategy, and those by way of the glass bring much.
        let spp = if method == Method::Mmlt {
            32_768
        } else {
            2_048
        };
        assert_plate_is_one(method, spp, 0.005);
    }
}

#[test]
#[ignore = "long"]
fn closed_sphere_to_half_a_percent() {
    for method in Method::ALL {
        assert_one("furnace?kind=diffuse", method, 2_048, 0.005);
    }
}

#[test]
#[ignore = "long"]
fn glass_disappears_to_half_a_percent() {
    for kind in ["glass", "rough"] {
        for method in [
            Method::Path,
            Method::Bdpt,
            Method::Pssmlt,
            Method::Mmlt,
            Method::Mlt,
            Method::Erpt,
            Method::ErptPss,
        ] {
            assert_one(&format!("furnace?kind={kind}"), method, 2_048, 0.005);
        }
    }
}

/// Two solids of one priority, which share a part of their room, in even light of 1: each boundary bends light once, so that no factor
/// of squared indices is left over, whichever of the two is met first.
#[test]
fn overlapping_solids_make_no_light() {
    let glass = |ior: f32| MaterialDescription {
        roughness: 0.0,
        metallic: 0.0,
        base_color: [1.0; 4],
        ior,
        transmission: Some(Transmission {
            factor: 1.0,
            texture: None,
        }),
        volume: Some(Volume {
            thickness: 1.0,
            attenuation_distance: f32::INFINITY,
            attenuation_color: [1.0; 3],
        }),
        ..MaterialDescription::default()
    };
    for [first, second] in [[1.5, 1.33], [1.33, 1.5]] {
        let things = [
            (glass(first), slab(-2.0, 0.0)),
            (glass(second), slab(-3.0, -1.0)),
        ];
        let mut description = describe(Vec3::new(0.0, 0.0, 3.0), 0.5, things);
        description.environment = Some(EnvironmentDescription::Constant([1.0; 3]));
        let scene = compile(&description, 16);
        let settings = RenderSettings {
            max_depth: 64,
            ..settings(Method::Path, 16, 64)
        };
        let [r, g, b] = means(&picture(&scene, &settings));
        let mean = (r + g + b) / 3.0;
        assert!((mean - 1.0).abs() < 0.01, "{first}, {second}: {mean}");
    }
}

/// A closed box between two planes across the z axis, wider than what is seen of it.
fn slab(back: f32, front: f32) -> Mesh {
    let at = |i: u32| {
        let side = |bit: u32| if i >> bit & 1 == 1 { 9.0 } else { -9.0 };
        let z = if i >> 2 & 1 == 1 { front } else { back };
        Vec3::new(side(0), side(1), z)
    };
    let faces = [
        [4, 5, 7, 6],
        [0, 2, 3, 1],
        [1, 3, 7, 5],
        [0, 4, 6, 2],
        [2, 6, 7, 3],
        [0, 1, 5, 4],
    ];
    let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
    Mesh {
        positions: (0..8).map(at).collect(),
        indices: faces.into_iter().flat_map(halves).collect(),
        ..Mesh::default()
    }
}

/// A pane whose shading normals say that it is seen from behind lets light through all the same: nothing bends there.
#[test]
fn a_bent_pane_is_no_wall() {
    let glass = MaterialDescription {
        roughness: 0.0,
        metallic: 0.0,
        base_color: [1.0; 4],
        double_sided: true,
        transmission: Some(Transmission {
            factor: 1.0,
            texture: None,
        }),
        ..MaterialDescription::default()
    };
    // It stands on edge before the camera, turned by 75 degrees, and its normals lean away by 25 more.
    let (sin, cos) = 75f32.to_radians().sin_cos();
    let across = Vec3::new(cos, 0.0, sin);
    let (sin, cos) = 100f32.to_radians().sin_cos();
    let corner = |x: f32, y: f32| across * x + Vec3::Y * y;
    let pane = Mesh {
        positions: [(-4.0, -4.0), (4.0, -4.0), (4.0, 4.0), (-4.0, 4.0)]
            .into_iter()
            .map(|(x, y)| corner(x, y))
            .collect(),
        indices: vec![[0, 1, 2], [0, 2, 3]],
        normals: vec![Vec3::new(-sin, 0.0, cos); 4],
        ..Mesh::default()
    };
    let mut description = describe(Vec3::new(0.0, 0.0, 6.0), 0.2, [(glass, pane)]);
    description.environment = Some(EnvironmentDescription::Constant([1.0; 3]));
    let scene = compile(&description, 16);
    let brightness = |method| {
        let [_, green, _] = means(&picture(&scene, &settings(method, 16, 256)));
        green
    };
    let truth = brightness(Method::Path);
    assert!(truth > 0.2, "{truth}");
    for method in [Method::Bdpt, Method::Mlt, Method::Relt, Method::Pssmlt] {
        let found = brightness(method);
        assert!(
            (found / truth - 1.0).abs() < 0.03,
            "{method}: {found}, {truth}"
        );
    }
}
