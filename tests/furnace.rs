//! Scenes whose picture is known in closed form.

use kaustik::{Method, RenderSettings};

use crate::support::{means, picture, scene, settings};

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
        assert_one("furnace?kind=diffuse", method, 256, 0.01);
    }
}

#[test]
fn glass_disappears() {
    assert_one("furnace?kind=glass", Method::Path, 256, 0.01);
    assert_one("furnace?kind=rough", Method::Path, 256, 0.01);
}

#[test]
#[ignore = "long"]
fn closed_sphere_to_half_a_percent() {
    for method in Method::ALL {
        assert_one("furnace?kind=diffuse", method, 8_192, 0.005);
    }
}

#[test]
#[ignore = "long"]
fn glass_disappears_to_half_a_percent() {
    for kind in ["glass", "rough"] {
        for method in [Method::Path, Method::Pssmlt] {
            assert_one(&format!("furnace?kind={kind}"), method, 8_192, 0.005);
        }
    }
}
