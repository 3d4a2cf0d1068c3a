//! The brightness of chains' pictures, with errors that are right; annealing as a renderer.

use kaustik::{Builder, Control, Lamps, Method, Normaliser, RenderSettings, render};

use crate::support::{agree, means, picture, scene, settings, tiles_of_seeds};

/// Normalisations of many seeds spread as each of them says.
fn chi_square(settings: &RenderSettings, seeds: u64) -> f64 {
    let scene = scene("cornell", settings.width);
    let runs: Vec<[f64; 2]> = (0..seeds)
        .map(|seed| {
            let settings = RenderSettings {
                seed,
                ..settings.clone()
            };
            let done = render(&scene, &settings, &mut Control::default()).expect("a render");
            let chain = done.statistics.chain.expect("statistics of chains");
            [chain.normalisation, chain.normalisation_error]
        })
        .collect();
    let mean = runs.iter().map(|run| run[0]).sum::<f64>() / seeds as f64;
    let squares = runs
        .iter()
        .map(|[b, error]| ((b - mean) / error) * ((b - mean) / error));
    squares.sum()
}

#[test]
fn stated_errors_of_the_normalisation_are_right() {
    let mut relt = settings(Method::Relt, 16, 64);
    relt.options.ladders = 16;
    let mut annealing = settings(Method::Annealing, 16, 128);
    annealing.options.particles = 1_000;
    let mut bridge = settings(Method::Pssmlt, 16, 64);
    bridge.options.normaliser = Normaliser::Bridge;
    bridge.options.builder = Builder::Bidirectional;
    for settings in [relt, annealing, bridge, settings(Method::Pssmlt, 16, 64)] {
        let chi2 = chi_square(&settings, 16);
        // 15 degrees of freedom: one in 10,000 on either side
        assert!((2.0..48.0).contains(&chi2), "{}: {chi2}", settings.method);
    }
}

/// Ways to come by the scale, and by what is seen directly, that all have one picture.
#[test]
fn the_scale_and_the_lamps_do_not_show() {
    const SIDE: u32 = 16;
    let scene = scene("cornell", SIDE);
    let path = tiles_of_seeds(&scene, &settings(Method::Path, SIDE, 256), 0..8);
    for (builder, normaliser, lamps) in [
        (Builder::Unidirectional, Normaliser::Bridge, Lamps::Apart),
        (Builder::Unidirectional, Normaliser::Running, Lamps::Chain),
        (Builder::Endpoint, Normaliser::Running, Lamps::Apart),
        (Builder::Bidirectional, Normaliser::Bridge, Lamps::Chain),
        (Builder::Simple, Normaliser::Initial, Lamps::Apart),
    ] {
        let mut settings = settings(Method::Pssmlt, SIDE, 512);
        settings.options.builder = builder;
        settings.options.normaliser = normaliser;
        settings.options.lamps = lamps;
        let tiles = tiles_of_seeds(&scene, &settings, 0..8);
        let verdict = agree(&path, &tiles, |_| true, 0.1);
        let name = (builder, normaliser, lamps);
        assert!(verdict.rejected.is_empty(), "{name:?}: {verdict:?}");
        assert!(verdict.uncertain.is_empty(), "{name:?}: {verdict:?}");
    }
}

/// A lamp of a few pixels is as bright as a path tracer sees it, whatever the chains do.
#[test]
fn small_lamps_are_seen_well() {
    const SIDE: u32 = 48;
    let scene = scene("ring-and-sphere", SIDE);
    let mut path = settings(Method::Path, SIDE, 1_024);
    path.max_depth = 1;
    let wanted = means(&picture(&scene, &path))[1];
    for seed in 0..4 {
        let mut pssmlt = settings(Method::Pssmlt, SIDE, 48);
        (pssmlt.seed, pssmlt.max_depth) = (seed, 1);
        let found = means(&picture(&scene, &pssmlt))[1];
        assert!((found / wanted - 1.0).abs() < 0.03, "{found} {wanted}");
    }
}

#[test]
fn annealing_agrees_roughly_with_path() {
    const SIDE: u32 = 16;
    let (words, share) = ("cornell", 0.15);
    let scene = scene(words, SIDE);
    let path = tiles_of_seeds(&scene, &settings(Method::Path, SIDE, 256), 0..8);
    let mut annealing = settings(Method::Annealing, SIDE, 256);
    annealing.options.particles = 1_000;
    let tiles = tiles_of_seeds(&scene, &annealing, 0..8);
    let verdict = agree(&path, &tiles, |_| true, share);
    assert!(verdict.rejected.is_empty(), "{words}: {verdict:?}");
    assert!(verdict.uncertain.is_empty(), "{words}: {verdict:?}");
}

#[test]
#[ignore = "long"]
fn annealing_agrees_with_path() {
    const SIDE: u32 = 32;
    for words in [
        "cornell",
        "ring-and-sphere?light=0.8",
        "water-cornell?light=0.8",
        "glass-cube?light=0.8",
    ] {
        let scene = scene(words, SIDE);
        let path = tiles_of_seeds(&scene, &settings(Method::Path, SIDE, 2_000), 0..16);
        let mut annealing = settings(Method::Annealing, SIDE, 2_000);
        annealing.options.particles = 4_000;
        let tiles = tiles_of_seeds(&scene, &annealing, 0..16);
        let verdict = agree(&path, &tiles, |_| true, 0.03);
        assert!(verdict.rejected.is_empty(), "{words}: {verdict:?}");
        assert!(verdict.uncertain.len() <= 3, "{words}: {verdict:?}");
    }
}
