//! Independent methods must agree in the mean, on every scene that they support.

use std::ops::Range;

use kaustik::scene::builtin;
use kaustik::scene::description::SpectralInput;
use kaustik::spectrum::Tabulated;
use kaustik::{Budget, Builder, Method, Mis, Normaliser, RenderSettings};

use crate::support::{
    Tile, Verdict, agree, compile, is_wanted, kept_tiles_of_seeds, scene, settings, shown_by_light,
    tiles_of_seeds,
};

const SIDE: u32 = 64;

/// A method to hold against `path`, with its samples a pixel and seed.
struct Rival {
    method: Method,
    builder: Builder,
    p_large: f64,
    spp: u64,
    /// The pooled standard error, as a share of a tile's mean, that it reaches beside `path`.
    share: f64,
}

/// Half a percent: with a larger error, too few samples would pass any test.
const HALF: f64 = 0.005;

impl Rival {
    const fn new(method: Method, spp: u64) -> Self {
        Self {
            method,
            builder: Builder::Unidirectional,
            p_large: 0.3,
            spp,
            share: HALF,
        }
    }

    const fn with(self, builder: Builder, p_large: f64) -> Self {
        Self {
            builder,
            p_large,
            ..self
        }
    }

    const fn within(self, share: f64) -> Self {
        Self { share, ..self }
    }

    fn name(&self) -> String {
        let Self {
            method,
            builder,
            p_large,
            spp,
            ..
        } = self;
        match method {
            Method::Pssmlt | Method::PssmltMultistage => {
                format!("{method} {builder:?} {p_large} {spp}")
            }
            _ => format!("{method} {spp}"),
        }
    }

    fn settings(&self) -> RenderSettings {
        let mut settings = settings(self.method, SIDE, self.spp);
        let options = &mut settings.options;
        options.builder = self.builder;
        options.p_large = self.p_large;
        // The scale of each run is its pilot's: it must not be what limits the comparison.
        options.normaliser = Normaliser::Initial;
        options.pilot = match self.method {
            // One strategy a sample: a scale as good as that of `pssmlt` takes more of them.
            Method::Mmlt => (self.spp * 2_000).clamp(100_000, 8_000_000),
            _ => (self.spp * 500).clamp(20_000, 4_000_000),
        };
        settings
    }
}

/// Whoever has little time takes a share of the samples, and is held to the larger error.
fn effort() -> f64 {
    std::env::var("KAUSTIK_EFFORT").map_or(1.0, |words| words.parse().expect("a number"))
}

/// Compares `path` with its rivals; says what differs.
#[expect(clippy::print_stdout, reason = "figures for whoever runs it")]
fn assert_agreement(words: &str, path: u64, rivals: &[Rival], seeds: u64, effort: f64) {
    let scene = scene(words, SIDE);
    let spp = |spp: u64| ((spp as f64 * effort) as u64).max(1);
    let tiles = |rival: &Rival, seeds: Range<u64>| {
        let name = format!("{words} {}", rival.name());
        kept_tiles_of_seeds(&name, &scene, &rival.settings(), seeds)
    };
    let path = tiles(&Rival::new(Method::Path, spp(path)), 0..seeds);
    let shown = shown_by_light(&scene, SIDE);
    let rivals = rivals.iter().filter(|rival| is_wanted(rival.method));
    assert!(
        rivals.clone().count() > 0,
        "{words}: no rival of these names"
    );
    for rival in rivals {
        let rival = Rival {
            spp: spp(rival.spp),
            ..*rival
        };
        let name = rival.name();
        let share = rival.share / effort.min(1.0).sqrt();
        let counts = |tile: usize| shown[tile] || rival.method != Method::Light;
        let compared = |rival: &[Tile]| {
            let verdict = agree(&path, rival, counts, share);
            println!(
                "{words}: path and {name}: differ in {:?}, worst error {:.4}, above {share}: {:?}",
                verdict.rejected, verdict.worst_error, verdict.uncertain
            );
            verdict
        };
        let mut verdict = compared(&tiles(&rival, 0..seeds));
        if !verdict.rejected.is_empty() {
            // One comparison of equal methods in a hundred is rejected by chance: seeds that had no part in
            // it tell. A fault is there again.
            verdict = compared(&tiles(&rival, seeds..2 * seeds));
        }
        assert!(verdict.rejected.is_empty(), "{words}, {name}: {verdict:?}");
        assert!(verdict.uncertain.len() <= 3, "{words}, {name}: {verdict:?}");
    }
}

#[test]
fn methods_agree_roughly() {
    let rivals = [
        Rival::new(Method::Light, 16),
        Rival::new(Method::Pssmlt, 32),
        Rival::new(Method::Bdpt, 8),
        Rival::new(Method::Mmlt, 64),
        Rival::new(Method::ErptPss, 16),
        Rival::new(Method::Mlt, 64),
        Rival::new(Method::Erpt, 16),
        Rival::new(Method::PssmltMultistage, 32),
        Rival::new(Method::MltMultistage, 64),
    ];
    assert_agreement("cornell", 16, &rivals.map(|r| r.within(0.2)), 8, 1.0);
}

/// One long test a scene, so that each can be run by itself.
macro_rules! agreement_on {
    ($($name:ident: $words:literal, $path:literal, $rivals:expr;)*) => {$(
        #[test]
        #[ignore = "long"]
        fn $name() {
            assert_agreement($words, $path, &$rivals, 32, effort());
        }
    )*};
}

// Where the light is easy to find, chains of any builder reach half a percent in minutes. Where it
// is not, 4,096 pixels are few for a chain: each tile is as uncertain as the number of times that
// an independent sample found its caustic, and a path tracer's samples do little else. So there the
// chains that must reach half a percent are those that find it best: bidirectional ones, or ones
// of nine large steps in ten; Kelemen's own setting is held to three percent. For all other methods see `by_tile`,
// which spends its time where the noise is.
agreement_on! {
    methods_agree_on_cornell: "cornell", 400, [
        Rival::new(Method::Light, 600), Rival::new(Method::Pssmlt, 5_000), Rival::new(Method::Bdpt, 300),
        Rival::new(Method::Mmlt, 10_000),
        Rival::new(Method::Mlt, 5_000), Rival::new(Method::Erpt, 400),
        Rival::new(Method::PssmltMultistage, 5_000), Rival::new(Method::MltMultistage, 5_000),
    ];
    methods_agree_on_direct_light: "cornell-direct", 200, [
        Rival::new(Method::Light, 600), Rival::new(Method::Pssmlt, 4_000), Rival::new(Method::Bdpt, 200),
        Rival::new(Method::Mmlt, 8_000), Rival::new(Method::Erpt, 400),
    ];
    methods_agree_on_indirect_light: "cornell-indirect", 12_000, [
        Rival::new(Method::Light, 1_000),
        Rival::new(Method::Pssmlt, 700).with(Builder::Bidirectional, 0.7),
        Rival::new(Method::Pssmlt, 3_500).within(0.03),
    ];
    methods_agree_on_ring_and_sphere: "ring-and-sphere?light=0.8", 4_500, [
        Rival::new(Method::Light, 600),
        Rival::new(Method::Pssmlt, 1_200).with(Builder::Bidirectional, 0.6),
        Rival::new(Method::Pssmlt, 3_500).within(0.03),
        Rival::new(Method::PssmltMultistage, 3_500).within(0.03),
        Rival::new(Method::MltMultistage, 5_000).within(0.03),
    ];
    methods_agree_on_glass_cube: "glass-cube?light=0.8", 14_000, [
        Rival::new(Method::Light, 1_000),
        Rival::new(Method::Pssmlt, 21_000).with(Builder::Unidirectional, 0.9),
        Rival::new(Method::Pssmlt, 3_500).within(0.03),
    ];
    methods_agree_on_water: "water-cornell?light=0.8", 1_000, [
        Rival::new(Method::Light, 200).within(0.02),
        Rival::new(Method::Pssmlt, 3_500).within(0.03),
    ];
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

/// Renders so short that each chain hardly leaves its start, from a pool of a few samples: only
/// what is exactly unbiased has the right mean over many of them.
fn short_chains(method: Method, mis: Mis, pool: u64, runs: u64) -> Verdict {
    const SIDE: u32 = 8;
    let scene = scene("cornell-direct", SIDE);
    let path = tiles_of_seeds(&scene, &settings(Method::Path, SIDE, 4_096), 0..8);
    let mut short = RenderSettings {
        budget: Budget::Total(80),
        ..settings(method, SIDE, 1)
    };
    short.options.ladders = 2;
    short.options.pilot = pool;
    short.options.mis = mis;
    short.options.normaliser = Normaliser::Initial;
    let short = tiles_of_seeds(&scene, &short, 0..runs);
    agree(&path, &short, |_| true, 0.01)
}

#[test]
#[ignore = "long"]
fn short_chains_are_unbiased() {
    // A pool of one is dark as often as a sample is.
    for (mis, pool) in [
        (Mis::Split, 8),
        (Mis::Off, 8),
        (Mis::Split, 1),
        (Mis::Off, 1),
    ] {
        let verdict = short_chains(Method::Pssmlt, mis, pool, 60_000);
        assert!(verdict.rejected.is_empty(), "{mis:?} {pool}: {verdict:?}");
        let error = verdict.worst_error;
        assert!(
            error < 0.01 * (8.0 / pool as f64).sqrt(),
            "{mis:?} {pool}: {error}"
        );
    }
}

/// Kelemen's printed weights take an estimate of b: the same test sees their bias.
#[test]
#[ignore = "long"]
fn short_chains_with_printed_weights_are_not() {
    let verdict = short_chains(Method::Pssmlt, Mis::Printed, 8, 60_000);
    assert!(!verdict.rejected.is_empty(), "{verdict:?}");
}

/// Chains on paths start at paths chosen from their pool.
#[test]
#[ignore = "long"]
fn short_chains_on_paths_are_unbiased() {
    for pool in [8, 1] {
        let verdict = short_chains(Method::Mlt, Mis::Off, pool, 60_000);
        assert!(verdict.rejected.is_empty(), "{pool}: {verdict:?}");
        assert!(verdict.worst_error < 0.005, "{pool}: {verdict:?}");
    }
}

/// The same as far as a few seconds show it: chains that start at any lit path of their pool are found.
#[test]
fn a_few_short_chains_on_paths_are_right_in_the_mean() {
    let verdict = short_chains(Method::Mlt, Mis::Off, 8, 3_000);
    assert!(verdict.rejected.is_empty(), "{verdict:?}");
    assert!(verdict.worst_error < 0.01, "{verdict:?}");
}
