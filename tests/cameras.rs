//! Cameras in every method: orthographic, a lens with blades, a window of the image.

use kaustik::film::{Image, Window};
use kaustik::scene::builtin;
use kaustik::scene::description::{Blades, CameraDescription, Lens, Projection};
use kaustik::scene::{Description, Scene};
use kaustik::{Method, RenderSettings};

use crate::support::{Tile, agree, compile, picture, settings, tiles_of, tiles_of_seeds};

const SIDE: u32 = 16;
const SEEDS: std::ops::Range<u64> = 0..8;
const AGAIN: std::ops::Range<u64> = 100..132;

/// Methods without bias, with samples a pixel that make their tiles certain to some per cent. Stages are made of `mlt` and `pssmlt`;
/// their windows have a test of their own.
const RIVALS: [(Method, u64); 8] = [
    (Method::Light, 128),
    (Method::Bdpt, 64),
    (Method::Pssmlt, 256),
    (Method::Mmlt, 512),
    (Method::Relt, 128),
    (Method::Mlt, 512),
    (Method::ErptPss, 32),
    (Method::Erpt, 32),
];

fn seen_by(change: impl FnOnce(&mut CameraDescription)) -> Description {
    let mut description = builtin::load("cornell").expect("a built-in scene");
    change(&mut description.cameras[0]);
    description
}

fn orthographic() -> Description {
    seen_by(|camera| {
        camera.projection = Projection::Orthographic {
            xmag: 2.2,
            ymag: 2.2,
        };
    })
}

fn bladed() -> Description {
    seen_by(|camera| {
        camera.lens = Some(Lens {
            aperture: 0.5,
            focus: 9.0,
            blades: Some(Blades {
                count: 3,
                rotation: 0.3,
            }),
        });
    })
}

fn assert_agree(name: &str, a: &[Tile], b: &[Tile]) {
    let verdict = agree(a, b, |_| true, 0.1);
    assert!(verdict.rejected.is_empty(), "{name}: {verdict:?}");
    assert!(verdict.uncertain.is_empty(), "{name}: {verdict:?}");
}

#[test]
fn every_method_sees_through_every_camera() {
    for (camera, description) in [("orthographic", orthographic()), ("blades", bladed())] {
        let scene = compile(&description, SIDE);
        let path = tiles_of_seeds(&scene, &settings(Method::Path, SIDE, 128), SEEDS);
        for (method, spp) in RIVALS {
            let name = format!("{camera}, {method}");
            let of = |seeds| tiles_of_seeds(&scene, &settings(method, SIDE, spp), seeds);
            let verdict = agree(&path, &of(SEEDS), |_| true, 0.1);
            if verdict.rejected.is_empty() {
                assert!(verdict.uncertain.is_empty(), "{name}: {verdict:?}");
            } else {
                // One comparison in a hundred is rejected by chance: others, and more, decide.
                let path = settings(Method::Path, SIDE, 128);
                let path = tiles_of_seeds(&scene, &path, AGAIN);
                assert_agree(&name, &path, &of(AGAIN));
            }
        }
    }
    // the test of the test: a picture of another size of window, and of another lens, differ
    let path = |description: &Description| {
        let settings = settings(Method::Path, SIDE, 128);
        tiles_of_seeds(&compile(description, SIDE), &settings, SEEDS)
    };
    let mut wider = orthographic();
    wider.cameras[0].projection = Projection::Orthographic {
        xmag: 2.4,
        ymag: 2.4,
    };
    let verdict = agree(&path(&orthographic()), &path(&wider), |_| true, 0.1);
    assert!(!verdict.rejected.is_empty(), "{verdict:?}");
}

fn shot(scene: &Scene, method: Method, spp: u64, crop: Option<Window>, seed: u64) -> Image {
    let settings = RenderSettings {
        seed,
        crop,
        ..settings(method, SIDE, spp)
    };
    picture(scene, &settings)
}

/// What a window shows is the same part of the whole image in the mean, for every method: chains that
/// see the window alone are scaled by what falls into it.
#[test]
fn a_crop_is_a_part_of_the_whole() {
    assert_part_of_the_whole(&[RIVALS[1], RIVALS[2], RIVALS[4], RIVALS[5]]);
}

#[test]
#[ignore = "long"]
fn a_crop_is_a_part_of_the_whole_by_every_method() {
    assert_part_of_the_whole(&RIVALS);
}

fn assert_part_of_the_whole(methods: &[(Method, u64)]) {
    let window = Window {
        x0: 3,
        y0: 5,
        x1: 11,
        y1: 13,
    };
    let scene = compile(&builtin::load("cornell").expect("a built-in scene"), SIDE);
    let whole = SEEDS
        .map(|seed| shot(&scene, Method::Path, 256, None, seed))
        .map(|image| image.cropped(window).expect("a part"));
    let whole = tiles_of(whole);
    for (method, spp) in methods.iter().copied().chain([(Method::Path, 256)]) {
        // as many samples over the window as were over the image
        let part = SEEDS.map(|seed| shot(&scene, method, 4 * spp, Some(window), seed));
        let part = tiles_of(part);
        assert_agree(&format!("{method}"), &whole, &part);
    }
    let beside = Window {
        x0: 4,
        x1: 12,
        ..window
    };
    let shifted = SEEDS.map(|seed| shot(&scene, Method::Path, 256, Some(beside), seed));
    let shifted = tiles_of(shifted);
    assert!(!agree(&whole, &shifted, |_| true, 0.1).rejected.is_empty());
}
