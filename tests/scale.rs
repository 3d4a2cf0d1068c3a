//! Nothing depends on the unit of length.

use glam::{Affine3A, Vec3};
use kaustik::Method;
use kaustik::scene::{Description, builtin};

use crate::support::{compile, means, picture, settings};

/// The same scene in another unit. Radiance has no length in it.
pub(crate) fn scaled(description: &Description, factor: f32) -> Description {
    let mut scaled = description.clone();
    let scale = Affine3A::from_scale(Vec3::splat(factor));
    for instance in &mut scaled.instances {
        instance.transform = scale * instance.transform;
    }
    for camera in &mut scaled.cameras {
        camera.transform.translation *= factor;
    }
    scaled
}

#[test]
fn a_thousandth_and_a_thousandfold_look_alike() {
    for words in ["cornell", "glass-cube?light=0.8"] {
        let description = builtin::load(words).expect("a built-in scene");
        let mean = |factor| {
            let scene = compile(&scaled(&description, factor), 24);
            means(&picture(&scene, &settings(Method::Path, 24, 64)))
        };
        let plain = mean(1.0);
        for factor in [1e-3, 1e3] {
            let other = mean(factor);
            for c in 0..3 {
                // The same random numbers: only roundings differ, which may turn single paths.
                let ratio = other[c] / plain[c];
                assert!(
                    (ratio - 1.0).abs() < 5e-3,
                    "{words} x {factor}: {plain:?} {other:?}"
                );
            }
        }
    }
}
