//! The sum of a sample's paths has the mean that a path tracer has.

use kaustik_mcmc::{Mean, generator};
use kaustik_path::{Contributions, PathBuilder, ScalarTarget, Unidirectional};
use kaustik_scene::Scene;

use super::stage::scene;
use super::{Fresh, space};
use crate::{Path, Seeds};

fn traced(scene: &Scene, edges: u32, samples: u64) -> Mean {
    let builder = Unidirectional {
        settings: space(scene, edges).settings,
        next_event: true,
    };
    let mut out = Contributions::default();
    let mut rng = generator(7, 1);
    (0..samples)
        .map(|_| {
            builder.build(scene, &mut Fresh(&mut rng), &mut out);
            out.by_class(ScalarTarget::Xyz).iter().sum()
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

#[test]
fn seeds_are_as_bright_as_traced_paths() {
    for name in [
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
        "sky",
        "lens",
        "orthographic",
        "veil",
    ] {
        let scene = scene(name);
        let (a, b) = (traced(&scene, 5, 60_000), seeded(&scene, 5, 40_000));
        // What is traced is a mean over the window, what paths bring an integral over the raster.
        let area = space(&scene, 5).settings.window_area();
        let (mean, error) = (area * a.mean(), area * a.standard_error());
        let error = error.hypot(b.standard_error());
        let z = (mean - b.mean()) / error;
        assert!(z.abs() < 4.5, "{name}: {mean} and {}, z = {z}", b.mean());
        assert!(error < 0.03 * mean, "{name}: {error} of {mean}");
    }
}
