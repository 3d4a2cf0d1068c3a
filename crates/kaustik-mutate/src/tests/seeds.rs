//! The sum of a sample's paths has the mean that a path tracer has.

use glam::DVec2;
use kaustik_mcmc::{Draws, Mean, generator};
use kaustik_path::{Contributions, PathBuilder, ScalarTarget, Unidirectional};
use kaustik_scene::Scene;

use super::stage::scene;
use super::{Fresh, space};
use crate::{Path, Seeds, Tracer};

fn traced(scene: &Scene, edges: u32, samples: u64) -> Mean {
    let builder = Unidirectional {
        settings: space(scene, edges).settings,
        next_event: true,
    };
    let area = builder.settings.window_area();
    let mut out = Contributions::default();
    let mut rng = generator(7, 1);
    (0..samples)
        .map(|_| {
            builder.build(scene, &mut Fresh(&mut rng), &mut out);
            // a mean over the window; what paths bring is an integral over the raster
            area * out.by_class(ScalarTarget::Xyz).iter().sum::<f64>()
        })
        .collect()
}

fn seeded(scene: &Scene, edges: u32, samples: u64) -> Mean {
    let space = space(scene, edges);
    let mut seeds = Seeds::new(&space);
    let mut path = Path::default();
    let mut rng = generator(7, 2);
    (0..samples)
        .map(|_| seeds.sample(&mut path, &mut rng))
        .collect()
}

/// Samples of the path tracer that keeps its paths.
fn kept(scene: &Scene, edges: u32, samples: u64, next_event: bool) -> Mean {
    let space = space(scene, edges);
    let mut tracer = Tracer::new();
    let mut rng = generator(7, 3);
    (0..samples)
        .map(|_| {
            let (low, high) = (space.settings.window_min, space.settings.window_max);
            let raster = low + (high - low) * DVec2::new(rng.uniform(), rng.uniform());
            let start = (raster, rng.uniform());
            let mut sum = 0.0;
            tracer.sample(&space, start, next_event, &mut rng, &mut |path, weight| {
                assert!(path.density() > 0.0 && weight > 0.0);
                sum += weight;
            });
            sum
        })
        .collect()
}

const SCENES: [&str; 25] = [
    "diffuse",
    "glossy",
    "mirror",
    "varnish",
    "glass",
    "inlay",
    "frosted",
    "rainbow",
    "point",
    "sun",
    "huge-sun",
    "sky",
    "huge-sky",
    "lens",
    "huge-lens",
    "orthographic",
    "outlook",
    "veil",
    "pane",
    "moving",
    "moving-mirror",
    "moving-point",
    "lamps",
    "moving-lamps",
    "daylight",
];

fn assert_alike(name: &str, a: &Mean, b: &Mean, most: f64) {
    let error = a.standard_error().hypot(b.standard_error());
    let z = (a.mean() - b.mean()) / error;
    assert!(
        z.abs() < 4.5,
        "{name}: {} and {}, z = {z}",
        a.mean(),
        b.mean()
    );
    assert!(error < most * a.mean(), "{name}: {error} of {}", a.mean());
}

#[test]
fn seeds_are_as_bright_as_traced_paths() {
    for name in SCENES {
        let scene = scene(name);
        let (a, b) = (traced(&scene, 5, 60_000), seeded(&scene, 5, 40_000));
        assert_alike(name, &a, &b, 0.03);
    }
}

#[test]
fn kept_paths_are_as_bright_as_traced_ones() {
    for name in SCENES {
        let scene = scene(name);
        let (a, b) = (traced(&scene, 5, 60_000), kept(&scene, 5, 60_000, true));
        assert_alike(name, &a, &b, 0.03);
        // Without next events a light of no size is not found at all.
        if !scene.has_punctual_lights() {
            assert_alike(name, &a, &kept(&scene, 5, 120_000, false), 0.06);
        }
    }
}
