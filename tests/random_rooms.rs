//! Methods agree in rooms that chance puts together ([`rooms`](crate::rooms)): materials, lamps and cameras in combinations of
//! which no built-in scene thinks.

use std::fmt;
use std::ops::Range;

use kaustik::scene::Scene;
use kaustik::{Method, PhotonOptions, RenderSettings};

use crate::rooms::{Room, room};
use crate::support::{
    TILE, Tile, Verdict, agree, by_tile, compile, from_both_sides, is_wanted, picture, settings,
    shown_by_light, tile_means,
};

const SIDE: u32 = 32;
/// Behind the tiles: the whole picture.
const WHOLE: usize = (SIDE as usize / TILE).pow(2);
/// What chance alone rejects, once in a hundred comparisons, is looked at with so many others.
const AGAIN: Range<u64> = 100..140;
/// Tiles that are known less well count for nothing.
const SHARE: f64 = 0.03;

/// Held against the first, with their samples a pixel and seed.
const METHODS: [(Method, u64); 10] = [
    (Method::Bdpt, 64),
    (Method::Path, 192),
    (Method::Light, 128),
    (Method::Pssmlt, 128),
    (Method::Mmlt, 512),
    (Method::Relt, 128),
    (Method::Annealing, 64),
    (Method::Mlt, 512),
    (Method::Erpt, 24),
    (Method::ErptPss, 24),
];

impl Room {
    /// What is lit by a single point through smooth glass is seen by no walk from the camera alone.
    fn is_for(&self, method: Method) -> bool {
        method != Method::Path || !(self.has_points && self.has_dirac)
    }

    fn settings(&self, (method, spp): (Method, u64)) -> RenderSettings {
        let mut settings = settings(method, SIDE, spp);
        settings.max_depth = self.max_depth;
        settings.options.pilot = 20_000;
        from_both_sides(&mut settings);
        if method == Method::Mmlt {
            settings.options.pilot = 200_000;
        }
        settings
    }
}

/// The tiles of each picture, and their mean as the last.
fn runs(scene: &Scene, settings: &RenderSettings, seeds: Range<u64>) -> Vec<Tile> {
    let run = |seed| {
        let settings = RenderSettings {
            seed,
            ..settings.clone()
        };
        let mut tiles = tile_means(&picture(scene, &settings));
        let sum = |c: usize| tiles.iter().map(|tile| tile[c]).sum::<f64>();
        let whole = [0, 1, 2].map(|c| sum(c) / tiles.len() as f64);
        tiles.push(whole);
        tiles
    };
    by_tile(&seeds.map(run).collect::<Vec<_>>())
}

/// A verdict in a line.
struct Short<'a>(&'a Verdict);

impl fmt::Display for Short<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Verdict {
            differences,
            uncertain,
            ..
        } = self.0;
        let (all, known) = (differences.len(), differences.len() - uncertain.len());
        write!(
            out,
            "{known} of {all} known, off {:?}",
            self.0.known_to_differ()
        )?;
        let Some(whole) = differences.last().filter(|d| d.tile == WHOLE) else {
            return Ok(());
        };
        let [share, error] = [whole.share, whole.error].map(|x| 100.0 * x);
        write!(out, ", all {share:+.2} +- {error:.2} %")
    }
}

/// What differs between a method and the first, at first sight and at the second.
#[expect(clippy::print_stdout, reason = "figures for whoever runs it")]
fn differences(number: u64) -> Vec<String> {
    let room = room(number);
    println!("room {number}: {}", room.words);
    let scene = compile(&room.description, SIDE);
    let shown = shown_by_light(&scene, SIDE);
    let counts = |method: Method, tile: usize| {
        method != Method::Light || shown.get(tile).copied().unwrap_or(!shown.contains(&false))
    };
    let first = room.settings(METHODS[0]);
    let expected = runs(&scene, &first, seeds());
    let mut found = Vec::new();
    for rival in METHODS.into_iter().skip(1) {
        let (method, _) = rival;
        if !(is_wanted(method) && room.is_for(method)) {
            continue;
        }
        let settings = room.settings(rival);
        let told = agree(
            &expected,
            &runs(&scene, &settings, seeds()),
            |tile| counts(method, tile),
            SHARE,
        );
        println!("  {method}: {}", Short(&told));
        if told.uncertain.contains(&WHOLE) {
            found.push(format!("room {number}, {method}: known too little"));
        }
        if told.known_to_differ().is_empty() {
            continue;
        }
        let again = agree(
            &runs(&scene, &first, AGAIN),
            &runs(&scene, &settings, AGAIN),
            |tile| counts(method, tile),
            SHARE,
        );
        let differs = again.known_to_differ();
        println!("  {method} again: {}", Short(&again));
        if !differs.is_empty() {
            found.push(format!(
                "room {number} ({}), {method}: {differs:?}",
                room.words
            ));
        }
    }
    found
}

/// `KAUSTIK_ROOMS=20..60` asks for others.
fn wanted_rooms() -> Range<u64> {
    wanted("KAUSTIK_ROOMS", 0..24)
}

/// `KAUSTIK_SEEDS=200..260` asks for others.
fn seeds() -> Range<u64> {
    wanted("KAUSTIK_SEEDS", 0..12)
}

fn wanted(name: &str, usual: Range<u64>) -> Range<u64> {
    let Ok(words) = std::env::var(name) else {
        return usual;
    };
    let range = words.split_once("..").and_then(|(from, to)| {
        let [from, to] = [from, to].map(|word| word.parse().ok());
        Some(from?..to?)
    });
    range.unwrap_or_else(|| panic!("{name}={words}: expected from..to"))
}

#[test]
#[ignore = "long"]
fn every_method_agrees_in_rooms_by_chance() {
    let found: Vec<String> = wanted_rooms().flat_map(differences).collect();
    assert!(found.is_empty(), "{found:#?}");
}

/// Discs blur; what photons bring in all stays.
const PHOTONS: [Method; 3] = [
    Method::Sppm,
    Method::PhotonVisibility,
    Method::PhotonSpatial,
];
/// By how much a picture of theirs may differ as a whole: light that discs take over edges of things and pixels.
const BLUR: f64 = 0.03;

#[test]
#[ignore = "long"]
fn photons_bring_as_much_light_in_rooms_by_chance() {
    let mut found = Vec::new();
    for number in wanted_rooms() {
        let room = room(number);
        println!("room {number}: {}", room.words);
        // Photons alone show what a point lights through glass and glass shows.
        if room.has_points && room.has_dirac {
            continue;
        }
        let scene = compile(&room.description, SIDE);
        let expected = runs(&scene, &room.settings(METHODS[0]), seeds());
        for method in PHOTONS {
            let mut settings = room.settings((method, 4));
            settings.options.photon = PhotonOptions {
                photons: Some(60_000),
                radius: 0.5,
                reduction: None,
                ..PhotonOptions::default()
            };
            let told = runs(&scene, &settings, seeds());
            let told = agree(&expected, &told, |tile| tile == WHOLE, SHARE);
            println!("  {method}: {}", Short(&told));
            let whole = told.differences[0];
            if whole.share.abs() > BLUR.max(4.0 * whole.error) || whole.error > SHARE {
                found.push(format!(
                    "room {number} ({}), {method}: {whole:?}",
                    room.words
                ));
            }
        }
    }
    assert!(found.is_empty(), "{found:#?}");
}

/// A picture without the paths of most edges is another one.
#[test]
fn a_bounce_too_few_is_found() {
    let shallow = |room: &Room| room.max_depth == 4;
    let room = (0..).map(room).find(shallow).expect("a room in six");
    let scene = compile(&room.description, SIDE);
    let whole = room.settings((Method::Bdpt, 24));
    let mut short = whole.clone();
    short.max_depth -= 1;
    let told = agree(
        &runs(&scene, &whole, 0..6),
        &runs(&scene, &short, 6..12),
        |_| true,
        SHARE,
    );
    assert!(!told.known_to_differ().is_empty(), "{told:?}");
}
