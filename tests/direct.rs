//! Direct light rendered apart: the sum is the whole, and each part is what it is said to be.

use std::time::{Duration, Instant};

use glam::Vec3;
use kaustik::film::Image;
use kaustik::scene::description::{EnvironmentDescription, Lens, MaterialDescription};
use kaustik::scene::{Scene, builtin};
use kaustik::{
    Budget, Builder, Control, Direct, EvenSamples, Method, RenderSettings, Rendered, Strategies,
    render,
};

use crate::support::{
    Tile, Verdict, agree, compile, describe, means, scene, settings, square, tiles_of,
    tiles_of_seeds,
};

const SIDE: u32 = 16;
const SEEDS: std::ops::Range<u64> = 0..8;

fn apart(method: Method, spp: u64) -> RenderSettings {
    let mut settings = settings(method, SIDE, spp);
    settings.options.direct = Direct::Apart;
    settings
}

fn rendered(scene: &Scene, settings: &RenderSettings, seed: u64) -> Rendered {
    let settings = RenderSettings {
        seed,
        features: true,
        ..settings.clone()
    };
    render(scene, &settings, &mut Control::default()).expect("a render")
}

/// The part of a picture that direct light is.
fn direct_layer(image: &Image) -> Image {
    let layer = image.layer("direct").expect("the part");
    let plane = |name| layer.channel(name).expect("a colour").to_vec();
    let planes = ["R", "G", "B"].map(plane);
    Image::from_rgb(image.width(), image.height(), planes).expect("an image")
}

fn assert_agree(name: &str, a: &[Tile], b: &[Tile], share: f64) {
    let Verdict {
        rejected,
        uncertain,
        worst_error,
        ..
    } = agree(a, b, |_| true, share);
    assert!(rejected.is_empty(), "{name}: {rejected:?}");
    assert!(uncertain.is_empty(), "{name}: {uncertain:?}, {worst_error}");
}

/// However few samples are asked for, a picture has the light of chains as well.
#[test]
fn a_short_render_has_both_parts() {
    let scene = scene("cornell", SIDE);
    for method in [
        Method::Relt,
        Method::Pssmlt,
        Method::Mmlt,
        Method::Mlt,
        Method::Erpt,
    ] {
        let image = rendered(&scene, &apart(method, 1), 0).image;
        let [whole, direct] = [means(&image)[1], means(&direct_layer(&image))[1]];
        assert!(whole > 1.1 * direct, "{method}: {whole} {direct}");
    }
}

/// Ladders that own no pixel have nothing to do, neither directly nor by chains.
#[test]
fn fewer_pixels_than_ladders_are_enough() {
    let scene = scene("cornell", 3);
    for method in Method::ALL {
        // multi-stage methods know other words
        let mut keys = method.keys();
        if !keys.any(|key| key.name == "direct" && key.range.contains("apart")) {
            continue;
        }
        let mut settings = settings(method, 3, 4);
        settings.options.direct = Direct::Apart;
        settings.options.ladders = 64;
        let image = rendered(&scene, &settings, 1).image;
        assert!(means(&image)[1] > 0.01, "{method}");
    }
}

type Change = fn(&mut kaustik::Options);

/// The first few in the fast half.
const VARIANTS: [(Method, &str, Change); 9] = [
    (Method::Pssmlt, "full", |o| {
        o.builder = Builder::Bidirectional;
    }),
    (Method::Mmlt, "learned", |_| {}),
    (Method::Relt, "standard", |_| {}),
    (Method::Mlt, "standard", |_| {}),
    (Method::Pssmlt, "unidirectional", |_| {}),
    (Method::Pssmlt, "endpoint", |o| {
        o.builder = Builder::Endpoint;
    }),
    (Method::Pssmlt, "simple", |o| o.builder = Builder::Simple),
    (Method::Mmlt, "even", |o| o.strategies = Strategies::Even),
    (Method::ErptPss, "unidirectional", |_| {}),
];

fn assert_sums(variants: &[(Method, &str, Change)]) {
    let scene = scene("cornell", SIDE);
    let path = tiles_of_seeds(&scene, &settings(Method::Path, SIDE, 256), SEEDS);
    for (method, name, change) in variants {
        let mut settings = apart(*method, 128);
        change(&mut settings.options);
        let sum = tiles_of_seeds(&scene, &settings, SEEDS);
        assert_agree(&format!("{method}, {name}"), &path, &sum, 0.1);
    }
}

#[test]
fn the_sum_of_the_parts_is_the_whole() {
    assert_sums(&VARIANTS[..4]);
}

#[test]
#[ignore = "long"]
fn the_sum_of_the_parts_is_the_whole_for_all() {
    assert_sums(&VARIANTS);
}

/// The direct part is what `path` renders of two edges, of methods without lamps of their own up to two, and chains have none of
/// it: up to two edges they are black.
#[test]
fn the_direct_part_is_path_of_two_edges() {
    assert_direct_parts(&[Method::Pssmlt, Method::Relt]);
}

#[test]
#[ignore = "long"]
fn the_direct_part_of_others_is_path_of_two_edges() {
    assert_direct_parts(&[Method::Mmlt, Method::ErptPss, Method::Mlt]);
}

/// Lamps seen by way of one mirror or one surface of glass have two edges as well, and chains leave them out.
#[test]
fn lamps_in_one_mirror_are_there_once() {
    for words in ["glass-cube?light=1.5", "mirror-balls"] {
        let scene = scene(words, SIDE);
        let short = |method, spp| RenderSettings {
            max_depth: 2,
            ..settings(method, SIDE, spp)
        };
        let path = tiles_of_seeds(&scene, &short(Method::Path, 2048), SEEDS);
        for method in [Method::Pssmlt, Method::Mmlt, Method::Mlt, Method::Relt] {
            let settings = RenderSettings {
                max_depth: 2,
                ..apart(method, 512)
            };
            let seen = tiles_of_seeds(&scene, &settings, SEEDS);
            assert_agree(&format!("{words}, {method}"), &path, &seen, 0.1);
        }
    }
}

fn assert_direct_parts(methods: &[Method]) {
    let scene = scene("cornell", SIDE);
    let up_to = |max_depth| RenderSettings {
        max_depth,
        ..settings(Method::Path, SIDE, 256)
    };
    let pictures = |settings: &RenderSettings| -> Vec<Image> {
        SEEDS
            .map(|seed| rendered(&scene, settings, seed).image)
            .collect()
    };
    let [one, two] = [1, 2].map(|edges| pictures(&up_to(edges)));
    // of the same walks
    let of_two = tiles_of(std::iter::zip(&two, &one).map(|(two, one)| less(two, one)));
    let up_to_two = tiles_of(two.into_iter());
    for &method in methods {
        let settings = apart(method, 128);
        let layers = pictures(&settings);
        let layers = layers.iter().map(direct_layer);
        let has_lamps = ![Method::Relt, Method::ErptPss].contains(&method);
        let path = if has_lamps { &of_two } else { &up_to_two };
        assert_agree(method.name(), path, &tiles_of(layers), 0.05);
        let short = RenderSettings {
            max_depth: 2,
            ..settings
        };
        let images = pictures(&short);
        let only = images[0].rgb() == direct_layer(&images[0]).rgb();
        assert_eq!(only, !has_lamps, "{method}");
        assert_agree(
            method.name(),
            &up_to_two,
            &tiles_of(images.into_iter()),
            0.05,
        );
    }
}

/// The difference of two pictures.
fn less(a: &Image, b: &Image) -> Image {
    let planes = std::iter::zip(a.rgb(), b.rgb());
    let planes: Vec<Vec<f32>> = planes
        .map(|(a, b)| a.iter().zip(b).map(|(a, b)| a - b).collect())
        .collect();
    let planes = planes.try_into().expect("three planes");
    Image::from_rgb(a.width(), a.height(), planes).expect("an image")
}

/// What is seen by way of glass or a varnish is there once, whether chains see to it or samples of its own.
#[test]
fn what_is_seen_through_glass_is_there_once() {
    let methods = [
        Method::Pssmlt,
        Method::Relt,
        Method::Mlt,
        Method::Erpt,
        Method::MltMultistage,
    ];
    for words in [
        "material-ball?material=glass",
        "material-ball?material=coated",
    ] {
        let scene = scene(words, SIDE);
        let path = tiles_of_seeds(&scene, &settings(Method::Path, SIDE, 512), SEEDS);
        for method in [Method::Mlt, Method::Erpt] {
            let sum = tiles_of_seeds(&scene, &apart(method, 256), SEEDS);
            let name = format!("{words}, {method}, direct light apart");
            assert_agree(&name, &path, &sum, 0.1);
        }
        for method in methods {
            let sum = tiles_of_seeds(&scene, &settings(method, SIDE, 256), SEEDS);
            assert_agree(&format!("{words}, {method}"), &path, &sum, 0.1);
        }
    }
}

/// A lamp of a seventh of a pixel, also before a bright sky and out of focus, is as bright as camera rays see it, after few
/// samples; and so is a large one.
#[test]
fn lamps_of_any_size_are_seen() {
    let quad = square(Vec3::new(0.13, 0.17, 0.0), 0.01);
    let bright = MaterialDescription {
        emissive: [1e3; 3],
        ..MaterialDescription::default()
    };
    let mut before_sky = describe(Vec3::new(0.0, 0.0, 2.0), 0.4, [(bright, quad)]);
    before_sky.environment = Some(EnvironmentDescription::Constant([0.5; 3]));
    let mut blurred = builtin::load("ring-and-sphere?light=0.1").expect("a built-in scene");
    blurred.cameras[0].lens = Some(Lens {
        aperture: 0.4,
        focus: 2.0,
        blades: None,
    });
    let scenes = [
        ("small", scene("ring-and-sphere?light=0.1", SIDE)),
        ("before the sky", compile(&before_sky, SIDE)),
        ("out of focus", compile(&blurred, SIDE)),
        ("large", scene("cornell", SIDE)),
    ];
    let seen = |method, spp| RenderSettings {
        max_depth: 1,
        ..settings(method, SIDE, spp)
    };
    for (name, scene) in &scenes {
        let path = tiles_of_seeds(scene, &seen(Method::Path, 4096), SEEDS);
        for method in [Method::Mlt, Method::Relt] {
            let lamps = tiles_of_seeds(scene, &seen(method, 64), SEEDS);
            assert_agree(&format!("{name}, {method}"), &path, &lamps, 0.1);
        }
    }
}

/// Where nothing is seen but by way of glass, chains on paths have nothing, and the picture is right after a few samples.
#[test]
fn all_may_be_seen_through_glass() {
    let scene = scene("furnace?kind=glass", SIDE);
    for method in [Method::Mlt, Method::Erpt, Method::MltMultistage] {
        let image = rendered(&scene, &settings(method, SIDE, 16), 0).image;
        let values = || image.rgb().into_iter().flatten();
        let mean = values().map(|&v| f64::from(v)).sum::<f64>() / values().count() as f64;
        assert!((mean - 1.0).abs() < 0.02, "{method}: {mean}");
        let least = values().fold(f32::MAX, |least, &v| least.min(v));
        assert!(least > 0.3, "{method}: {least}");
    }
}

/// Where chains find no light, lamps and direct light take the budget's passes all the same, and it comes to an end.
#[test]
fn chains_in_the_dark_use_up_their_budget() {
    let scene = scene("furnace?kind=diffuse", SIDE);
    let pixels = u64::from(SIDE * SIDE);
    // Of lamps seen directly alone.
    let lamps = |method, budget| RenderSettings {
        max_depth: 1,
        budget,
        ..settings(method, SIDE, 1)
    };
    for method in [Method::Mlt, Method::Pssmlt] {
        let short = Budget::Time(Duration::from_millis(300));
        let begun = Instant::now();
        rendered(&scene, &lamps(method, short), 0);
        assert!(begun.elapsed() >= Duration::from_millis(300), "{method}");
        let all = Budget::PerPixel(64);
        let statistics = rendered(&scene, &lamps(method, all), 0).statistics;
        assert_eq!(statistics.steps, 64 * pixels, "{method}");
    }
    let mut settings = RenderSettings {
        max_depth: 2,
        budget: Budget::PerPixel(32),
        ..apart(Method::Mlt, 1)
    };
    settings.options.even = EvenSamples::Count(0);
    let statistics = rendered(&scene, &settings, 0).statistics;
    assert_eq!(statistics.direct.expect("direct light").samples, 8 * pixels);
    assert_eq!(statistics.steps, 32 * pixels);
}

/// A quarter of the steps, in whole passes, and all steps are counted.
#[test]
fn its_share_of_the_steps_is_told() {
    let scene = scene("cornell", SIDE);
    let pixels = u64::from(SIDE * SIDE);
    for method in [Method::Pssmlt, Method::Mmlt, Method::Relt, Method::Mlt] {
        for (budget, passes, steps) in [
            (Budget::PerPixel(1), 1, 2 * pixels),
            (Budget::PerPixel(32), 8, 32 * pixels),
            (Budget::Total(41 * pixels + 7), 11, 41 * pixels),
        ] {
            let mut settings = RenderSettings {
                budget,
                ..apart(method, 1)
            };
            settings.options.even = EvenSamples::Count(0);
            let statistics = rendered(&scene, &settings, 0).statistics;
            let direct = statistics.direct.expect("direct light apart");
            assert_eq!(direct.max_edges, 2);
            assert_eq!(direct.samples, passes * pixels, "{method}, {budget:?}");
            // The chains of `relt` take whole sweeps, of three steps here: each of 64 ladders may end two early.
            let early = if method == Method::Relt { 2 * 64 } else { 0 };
            let least = steps - early;
            assert!(
                (least..=steps).contains(&statistics.steps),
                "{method}, {budget:?}: {} of {steps}",
                statistics.steps
            );
        }
        let mut lamps = settings(method, SIDE, 2);
        lamps.options.direct = Direct::Lamps;
        assert!(rendered(&scene, &lamps, 0).statistics.direct.is_none());
    }
}
