//! Multi-stage Metropolis light transport: the mean, the dark, the crop.

use kaustik::film::{Filter, Window};
use kaustik::{Budget, Control, Method, Normaliser, RenderSettings, StageLadder, render};

use crate::support::{agree, picture, scene, settings, tiles_of_seeds};

const METHODS: [Method; 2] = [Method::MltMultistage, Method::PssmltMultistage];
const SIDE: u32 = 16;

/// Short renders of many stages, exactly unbiased ones.
fn short(method: Method, ladder: StageLadder) -> RenderSettings {
    let mut settings = settings(method, SIDE, 24);
    let options = &mut settings.options;
    options.ladders = 2;
    options.pilot = 1_000;
    options.normaliser = Normaliser::Initial;
    options.stages.budget = 12;
    options.stages.ladder = ladder;
    settings
}

/// The mean of many short renders is the picture, whatever maps their stages went by.
#[test]
fn short_stages_are_unbiased() {
    assert_unbiased(64, 0.08);
}

#[test]
#[ignore = "long"]
fn short_stages_are_unbiased_to_five_percent() {
    assert_unbiased(128, 0.05);
}

/// By the mean of so many, known to a share of each tile.
fn assert_unbiased(seeds: u64, share: f64) {
    let scene = scene("cornell", SIDE);
    let path = tiles_of_seeds(&scene, &settings(Method::Path, SIDE, 2_048), 0..8);
    for method in METHODS {
        for ladder in [StageLadder::Widths, StageLadder::Two] {
            let short = short(method, ladder);
            let stages = render(&scene, &short, &mut Control::default());
            let stages = stages.expect("a render").statistics.stages;
            let least = if ladder == StageLadder::Two { 2 } else { 8 };
            assert!(stages.len() >= least, "{method}: {stages:?}");
            let tiles = tiles_of_seeds(&scene, &short, 0..seeds);
            let verdict = agree(&path, &tiles, |_| true, share);
            assert!(
                verdict.rejected.is_empty() && verdict.uncertain.is_empty(),
                "{method}, {ladder:?}: {verdict:?}"
            );
        }
    }
}

/// What the statistics tell of stages adds up to the render.
#[test]
fn stages_are_told() {
    let scene = scene("cornell", SIDE);
    for method in METHODS {
        let mut settings = short(method, StageLadder::Widths);
        settings.budget = Budget::Total(12 * u64::from(SIDE * SIDE) + 7);
        let rendered = render(&scene, &settings, &mut Control::default()).expect("a render");
        let statistics = rendered.statistics;
        let stages = &statistics.stages;
        let sum: u64 = stages.iter().map(|stage| stage.mutations).sum();
        assert_eq!(sum, statistics.steps, "{method}");
        assert_eq!(stages[0].width, 1);
        assert_eq!(stages[stages.len() - 1].width, SIDE);
        assert!(stages.windows(2).all(|pair| pair[0].width <= pair[1].width));
        // The first follows the light, the others what it is over the picture.
        for (number, stage) in stages.iter().enumerate() {
            assert!(stage.normalisation > 0.0 && stage.normalisation_error > 0.0);
            // Noise of the picture is noise of the target: the mean of an inverse.
            let even = (0.6..4.0).contains(&stage.normalisation);
            assert_eq!(even, number > 0, "{method}: {stage:?}");
        }
    }
}

/// Windows, wide filters, images of a pixel or a row: the mean is that of path tracing.
#[test]
fn images_of_any_shape_are_rendered() {
    for (width, height, crop) in [
        (1, 1, None),
        (1, 24, None),
        (24, 1, None),
        (2, 2, None),
        (
            16,
            16,
            Some(Window {
                x0: 3,
                y0: 5,
                x1: 12,
                y1: 9,
            }),
        ),
    ] {
        let options = kaustik::scene::SceneOptions {
            width,
            height,
            ..Default::default()
        };
        let description = kaustik::scene::builtin::load("cornell").expect("a built-in scene");
        let scene = kaustik::scene::Scene::new(&description, &options).expect("a sound scene");
        let mean = |method, spp, ladders| {
            let mut settings = settings(method, SIDE, spp);
            (settings.width, settings.height, settings.crop) = (width, height, crop);
            settings.options.ladders = ladders;
            settings.options.stages.budget = 64;
            settings.filter = Filter::GAUSSIAN;
            let image = picture(&scene, &settings);
            let [_, green, _] = image.rgb();
            green.iter().map(|v| f64::from(*v)).sum::<f64>() / green.len() as f64
        };
        let pixels = crop.map_or(u64::from(width * height), |_| 36);
        let spp = 60_000 / pixels;
        let expected = mean(Method::Path, spp, 64);
        for method in METHODS {
            for ladders in [1, 64] {
                let found = mean(method, spp, ladders);
                assert!(
                    (found / expected - 1.0).abs() < 0.15,
                    "{method}, {width} x {height}, {ladders}: {found} against {expected}"
                );
            }
        }
    }
}

/// Where a pool sees nothing, the stage before goes on in its place: all steps are taken, and count.
#[test]
fn dark_pools_are_passed_over() {
    let scene = scene("cornell-indirect", SIDE);
    let mut settings = settings(Method::PssmltMultistage, SIDE, 64);
    settings.options.stages.budget = 64;
    // Lamps are small, and found by running into them alone.
    settings.options.next_event = false;
    settings.options.pilot = 400;
    settings.options.ladders = 4;
    let (mut fewest, mut most) = (usize::MAX, 0);
    for seed in 0..12 {
        settings.seed = seed;
        let rendered = render(&scene, &settings, &mut Control::default()).expect("a render");
        let stages = rendered.statistics.stages;
        let steps: u64 = stages.iter().map(|stage| stage.mutations).sum();
        assert_eq!(steps, rendered.statistics.steps);
        let later = &stages[1..];
        assert!(
            later.iter().all(|stage| stage.normalisation > 0.0),
            "{stages:?}"
        );
        fewest = fewest.min(stages.len());
        most = most.max(stages.len());
    }
    // With light in every pool there are as many.
    settings.options.next_event = true;
    let rendered = render(&scene, &settings, &mut Control::default()).expect("a render");
    let all = rendered.statistics.stages.len();
    assert!(fewest < all && most > 1, "{fewest} to {most} of {all}");
}
