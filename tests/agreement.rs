//! Independent methods must agree in the mean, on every scene that they support.

use kaustik::scene::description::SpectralInput;
use kaustik::scene::{Scene, builtin};
use kaustik::spectrum::Tabulated;
use kaustik::{Budget, Builder, Method, Mis, Normaliser, RenderSettings};

use crate::support::{
    TILE, Verdict, agree, compile, pixels_of_light, scene, settings, tiles_of_seeds,
};

const SIDE: u32 = 64;

/// Tiles that a light tracer shows in full.
fn shown_by_light(scene: &Scene) -> Vec<bool> {
    let tiles = SIDE as usize / TILE;
    let mut shown = vec![true; tiles * tiles];
    for (pixel, seen) in pixels_of_light(scene, SIDE).into_iter().enumerate() {
        let (x, y) = (pixel % SIDE as usize, pixel / SIDE as usize);
        shown[y / TILE * tiles + x / TILE] &= seen;
    }
    shown
}

struct Case {
    words: &'static str,
    /// Samples a pixel and seed of path, light, pssmlt, bdpt, mmlt.
    spp: [u64; 5],
    /// The pooled standard error, as a share of a tile's mean, that these samples reach.
    share: f64,
}

impl Case {
    /// The same with `KAUSTIK_EFFORT` times the samples, held to the error that so many must reach, at
    /// most half a percent: the scenes with caustics need an effort of some 40 for that, which is
    /// hours on two cores.
    fn with_effort(self) -> Self {
        let effort =
            std::env::var("KAUSTIK_EFFORT").map_or(1, |words| words.parse().expect("a number"));
        Self {
            spp: self.spp.map(|spp| spp * effort),
            share: (self.share / (effort as f64).sqrt()).max(0.005),
            ..self
        }
    }
}

/// Compares `path` with the others; returns what differs.
fn compare(case: &Case, seeds: u64) -> Vec<(String, Verdict)> {
    let scene = scene(case.words, SIDE);
    let run = |settings: &RenderSettings| tiles_of_seeds(&scene, settings, 0..seeds);
    let path = run(&settings(Method::Path, SIDE, case.spp[0]));
    let shown = shown_by_light(&scene);
    let light = run(&settings(Method::Light, SIDE, case.spp[1]));
    let mut verdicts = vec![(
        "light".to_owned(),
        agree(&path, &light, |tile| shown[tile], case.share),
    )];
    let mut pssmlt = settings(Method::Pssmlt, SIDE, case.spp[2]);
    pssmlt.options.normaliser = Normaliser::Initial;
    // The scale of each run is its pilot's: it must not be what limits the comparison.
    pssmlt.options.pilot = (case.spp[2] * 500).clamp(20_000, 4_000_000);
    verdicts.push((
        "pssmlt".to_owned(),
        agree(&path, &run(&pssmlt), |_| true, case.share),
    ));
    let bdpt = run(&settings(Method::Bdpt, SIDE, case.spp[3]));
    verdicts.push(("bdpt".to_owned(), agree(&path, &bdpt, |_| true, case.share)));
    let mut mmlt = settings(Method::Mmlt, SIDE, case.spp[4]);
    mmlt.options.normaliser = Normaliser::Initial;
    // One strategy a sample: a scale as good as that of `pssmlt` takes more of them.
    mmlt.options.pilot = (case.spp[4] * 2_000).clamp(100_000, 8_000_000);
    verdicts.push((
        "mmlt".to_owned(),
        agree(&path, &run(&mmlt), |_| true, case.share),
    ));
    verdicts
}

#[expect(clippy::print_stdout, reason = "figures for whoever runs it")]
fn assert_agreement(case: &Case, seeds: u64, uncertain: usize) {
    for (method, verdict) in compare(case, seeds) {
        assert!(
            verdict.rejected.is_empty(),
            "{}: path and {method} differ in tiles {:?}",
            case.words,
            verdict.rejected
        );
        println!(
            "{}: path and {method} agree, worst relative error {:.4}, above {}: {:?}",
            case.words, verdict.worst_error, case.share, verdict.uncertain
        );
        assert!(
            verdict.uncertain.len() <= uncertain,
            "{}, {method}: too uncertain in {:?}",
            case.words,
            verdict.uncertain
        );
    }
}

#[test]
fn methods_agree_roughly() {
    assert_agreement(
        &Case {
            words: "cornell",
            spp: [16, 16, 32, 8, 64],
            share: 0.2,
        },
        8,
        0,
    );
}

/// One long test a scene, so that each can be run by itself.
macro_rules! agreement_on {
    ($($name:ident: $words:literal, $spp:expr, $share:literal;)*) => {$(
        #[test]
        #[ignore = "long"]
        fn $name() {
            let case = Case { words: $words, spp: $spp, share: $share };
            assert_agreement(&case.with_effort(), 32, 3);
        }
    )*};
}

agreement_on! {
    methods_agree_on_cornell: "cornell", [400, 600, 5_000, 300, 10_000], 0.005;
    methods_agree_on_direct_light: "cornell-direct", [200, 600, 4_000, 200, 8_000], 0.005;
    methods_agree_on_indirect_light: "cornell-indirect", [1_500, 600, 3_500, 500, 7_000], 0.03;
    methods_agree_on_ring_and_sphere: "ring-and-sphere?light=0.8", [1_500, 600, 3_500, 500, 7_000], 0.03;
    methods_agree_on_glass_cube: "glass-cube?light=0.8", [1_500, 600, 3_500, 500, 7_000], 0.03;
    methods_agree_on_water: "water-cornell?light=0.8", [1_500, 600, 3_500, 500, 7_000], 0.03;
}

#[test]
#[ignore = "long"]
fn endpoint_walks_and_other_weights_agree() {
    let scene = scene("cornell", SIDE);
    let path = tiles_of_seeds(&scene, &settings(Method::Path, SIDE, 200), 0..32);
    let mut variants = Vec::new();
    for (name, change) in [
        (
            "endpoint",
            (|o| o.builder = Builder::Endpoint) as fn(&mut kaustik::Options),
        ),
        ("simple", |o| o.builder = Builder::Simple),
        ("bidirectional", |o| o.builder = Builder::Bidirectional),
        ("largest path, maximum heuristic", |o| {
            o.builder = Builder::Bidirectional;
            o.contribution = kaustik::estimate::Contribution::Maximum;
            o.heuristic = kaustik::path::Heuristic::Maximum;
        }),
        ("mis=off", |o| o.mis = Mis::Off),
        ("implicit hits only", |o| o.next_event = false),
        ("uniform steps", |o| {
            o.small_step = kaustik::SmallStep::Uniform(0.05);
        }),
        ("luminance", |o| {
            o.target = kaustik::estimate::ScalarTarget::Luminance;
        }),
    ] {
        let mut settings = settings(Method::Pssmlt, SIDE, 300);
        settings.options.normaliser = Normaliser::Initial;
        change(&mut settings.options);
        let tiles = tiles_of_seeds(&scene, &settings, 0..32);
        let verdict = agree(&path, &tiles, |_| true, 0.05);
        assert!(
            verdict.rejected.is_empty(),
            "{name}: {:?}",
            verdict.rejected
        );
        variants.push((name, verdict.worst_error));
    }
    println!("{variants:?}");
}

/// The test of the test: a wall 2 % too bright, as by a wrong weight, is found.
#[test]
fn a_planted_error_of_two_percent_is_rejected() {
    let right = builtin::load("cornell").expect("a built-in scene");
    let mut wrong = right.clone();
    for material in &mut wrong.materials {
        if material.reflectance == Some(SpectralInput::Named("cornell-white".into())) {
            let white = Tabulated::named("cornell-white").expect("a known table");
            let knots = white
                .knots()
                .map(|(nm, value)| (nm, value * 1.02))
                .collect();
            material.reflectance = Some(SpectralInput::Knots(knots));
        }
    }
    assert!(wrong != right, "the planted fault is there");
    let tiles = |description| {
        let scene = compile(description, 32);
        tiles_of_seeds(&scene, &settings(Method::Path, 32, 256), 0..8)
    };
    let verdict = agree(&tiles(&right), &tiles(&wrong), |_| true, 0.05);
    assert!(!verdict.rejected.is_empty(), "{verdict:?}");
}

/// Renders so short that each chain hardly leaves its start, from a pool of 8 samples: only
/// what is exactly unbiased has the right mean over many of them.
fn short_chains(mis: Mis, runs: u64) -> Verdict {
    const SIDE: u32 = 8;
    let scene = scene("cornell-direct", SIDE);
    let path = tiles_of_seeds(&scene, &settings(Method::Path, SIDE, 4_096), 0..8);
    let mut short = RenderSettings {
        budget: Budget::Total(80),
        ..settings(Method::Pssmlt, SIDE, 1)
    };
    short.options.ladders = 2;
    short.options.pilot = 8;
    short.options.mis = mis;
    short.options.normaliser = Normaliser::Initial;
    let short = tiles_of_seeds(&scene, &short, 0..runs);
    agree(&path, &short, |_| true, 0.01)
}

#[test]
#[ignore = "long"]
fn short_chains_are_unbiased() {
    for mis in [Mis::Split, Mis::Off] {
        let verdict = short_chains(mis, 60_000);
        assert!(verdict.rejected.is_empty(), "{mis:?}: {verdict:?}");
        assert!(verdict.worst_error < 0.01, "{mis:?}: {verdict:?}");
    }
}

/// Kelemen's printed weights take an estimate of b: the same test sees their bias.
#[test]
#[ignore = "long"]
fn short_chains_with_printed_weights_are_not() {
    let verdict = short_chains(Mis::Printed, 60_000);
    assert!(!verdict.rejected.is_empty(), "{verdict:?}");
}
