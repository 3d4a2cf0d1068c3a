//! Scenes of caustics with their lamps as they are: so small that independent samples meet their light through glass once in a
//! million. [`by_tile`](crate::by_tile) has larger lamps there, as no chain comes to all that light in a test's time.
//!
//! So renders are many here and short: a chain that starts at one of a pool of independent samples, and whose picture is
//! scaled by that pool, is right in the mean however short it is. What decides is how many samples all pools have
//! together; and of these the part of the picture where the light comes through glass has all. (A sample of `mmlt` shows one strategy of
//! one length, so that some tens of times as many know as much: not here.)

use kaustik::film::Window;
use kaustik::{Budget, Method, Normaliser, RenderSettings};

use crate::support::{
    Tile, agree, by_tile, from_both_sides, is_wanted, keep, kept_file, merged, picture, scene,
    settings, side_by_side, tile_means,
};

const SIDE: u32 = 64;
/// Independent samples that a render's chains begin at, and that scale its picture.
const POOL: u64 = 50_000;
/// Renders that are kept together.
const BATCH: u64 = 20;

/// Where to look: a scene and a quarter of its picture, with paths no longer than those in question.
#[derive(Clone, Copy)]
struct Place {
    words: &'static str,
    /// Its left upper corner.
    corner: [u32; 2],
    max_depth: u32,
}

/// The ball with the caustic below it, which is seen through it: camera, glass, glass, floor, glass, glass, lamp.
const BALL: Place = Place {
    words: "ring-and-sphere",
    corner: [32, 32],
    max_depth: 6,
};
/// The cube cast in glass: camera, glass, cube, glass, lamp.
const CUBE: Place = Place {
    words: "glass-cube",
    corner: [32, 32],
    max_depth: 5,
};
/// The floor below the water.
const FLOOR: Place = Place {
    words: "water-cornell",
    corner: [0, 32],
    max_depth: 5,
};

/// Renders of a method, of so many chain steps each.
#[derive(Clone, Copy)]
struct Short {
    method: Method,
    renders: u64,
    steps: u64,
}

impl Place {
    fn settings(&self, Short { method, steps, .. }: Short) -> RenderSettings {
        let [x0, y0] = self.corner;
        let mut settings = settings(method, SIDE, 1);
        from_both_sides(&mut settings);
        settings.budget = Budget::Total(steps);
        settings.max_depth = self.max_depth;
        settings.crop = Some(Window {
            x0,
            y0,
            x1: x0 + SIDE / 2,
            y1: y0 + SIDE / 2,
        });
        let options = &mut settings.options;
        options.pilot = POOL;
        options.normaliser = Normaliser::Initial;
        settings
    }

    /// Four tiles of the quarter, from means of batches of renders.
    fn tiles(&self, short: Short) -> Vec<Tile> {
        let scene = scene(self.words, SIDE);
        let settings = self.settings(short);
        let of_seed = |seed| {
            let settings = RenderSettings {
                seed,
                ..settings.clone()
            };
            merged(&tile_means(&picture(&scene, &settings)), 4, 2)
        };
        let batch = |number: u64| {
            let name = format!(
                "{} short {} {} {number}",
                self.words, short.method, short.steps
            );
            let file = kept_file(&name);
            let text = file
                .as_ref()
                .and_then(|file| std::fs::read_to_string(file).ok());
            if let Some(text) = text {
                return serde_json::from_str(&text).expect("means");
            }
            let renders = side_by_side(number * BATCH..(number + 1) * BATCH, of_seed);
            let means = mean(&renders);
            if let Some(file) = file {
                keep(&file, &serde_json::to_string(&means).expect("numbers"));
            }
            means
        };
        by_tile(&(0..short.renders / BATCH).map(batch).collect::<Vec<_>>())
    }
}

fn mean(renders: &[Vec<[f64; 3]>]) -> Vec<[f64; 3]> {
    let of = |tile: usize| {
        [0, 1, 2].map(|c| renders.iter().map(|r| r[tile][c]).sum::<f64>() / renders.len() as f64)
    };
    (0..renders[0].len()).map(of).collect()
}

/// What a tile is to be known to.
const KNOWN: f64 = 0.03;

/// The first is what the others are held against.
#[expect(clippy::print_stdout, reason = "figures for whoever runs it")]
fn assert_agreement(place: Place, all: &[Short]) {
    let [first, others @ ..] = all else {
        panic!("nothing to compare");
    };
    let reference = place.tiles(*first);
    for short in others.iter().filter(|short| is_wanted(short.method)) {
        let verdict = agree(&reference, &place.tiles(*short), |_| true, KNOWN);
        let told: Vec<String> = (verdict.differences.iter())
            .map(|d| format!("{:+.2} ± {:.2} %", 100.0 * d.share, 100.0 * d.error))
            .collect();
        println!(
            "{}: {} over {}: {}",
            place.words,
            short.method,
            first.method,
            told.join(", ")
        );
        assert!(
            verdict.rejected.is_empty(),
            "{}, {}: {verdict:?}",
            place.words,
            short.method
        );
        assert!(
            verdict.uncertain.is_empty(),
            "{}, {}: {verdict:?}",
            place.words,
            short.method
        );
    }
}

const fn short(method: Method, renders: u64, steps: u64) -> Short {
    Short {
        method,
        renders,
        steps,
    }
}

const METHODS: [Short; 3] = [
    short(Method::Path, 200, 400_000),
    short(Method::Pssmlt, 600, 20_000),
    short(Method::Mlt, 600, 40_000),
];

#[test]
#[ignore = "long; KAUSTIK_KEEP keeps what is done"]
fn the_ball_is_as_bright_by_every_method() {
    assert_agreement(BALL, &METHODS);
}

#[test]
#[ignore = "long; KAUSTIK_KEEP keeps what is done"]
fn the_cube_is_as_bright_by_every_method() {
    assert_agreement(CUBE, &METHODS);
}

#[test]
#[ignore = "long; KAUSTIK_KEEP keeps what is done"]
fn the_floor_is_as_bright_by_every_method() {
    assert_agreement(FLOOR, &METHODS);
}
