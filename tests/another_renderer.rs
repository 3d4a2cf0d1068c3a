//! Pictures of another renderer: four small scenes with the means of its tiles, to which every method must come.
//!
//! Its path tracer follows 32 edges, with a box filter of a pixel. Of its pictures, 128x128, the folder
//! `another_renderer` has the mean of each tile of 16x16 pixels and the standard error of that, three scenes in grey (where spectral
//! renderers and those of three colours must agree) and one spectral, its reflectances uplifted by another table.

use std::collections::BTreeMap;

use kaustik::scene::{Description, Scene, SceneOptions, gltf};
use kaustik::{Builder, Method, RenderSettings};

use crate::support::{
    Runs, TILE, from_both_sides, is_wanted, merged, picture, settings, tile_means,
};

const SIDE: u32 = 128;
/// The other renderer's longest paths.
const EDGES: u32 = 32;
/// Of the other renderer's tiles, along a side of the picture.
const TILES: usize = 8;
/// Of ours along a side of one of its.
const FINER: usize = SIDE as usize / TILE / TILES;

/// What the other renderer has found of each tile, row by row: red, green, blue, or grey alone.
type Tiles = Vec<Vec<f64>>;

/// Independent renders of each method.
const SEEDS: u64 = 8;
/// A mean of so few is off by more than so many of its standard errors once in five thousand times (Student's t).
const SURE: f64 = 7.0;

/// A scene of the folder.
#[derive(Clone, Copy)]
struct Check {
    name: &'static str,
    bytes: &'static [u8],
    /// By how much brightness may differ, as a share.
    brightness: f64,
    /// The same of a tile.
    tile: f64,
}

macro_rules! check {
    ($name:literal, $brightness:literal, $tile:literal) => {
        Check {
            name: $name,
            bytes: include_bytes!(concat!("another_renderer/", $name, ".glb")),
            brightness: $brightness,
            tile: $tile,
        }
    };
}

const GREY: Check = check!("cornell-gray", 0.003, 0.01);
/// A perfect mirror and smooth glass, with normals at their vertices; a caustic.
const RING: Check = check!("ring-sphere-gray", 0.003, 0.01);
/// A wall of rough metal, without what scatters between its facets.
const GLOSSY: Check = check!("glossy-backwall-gray", 0.003, 0.01);
const SPECTRAL: Check = check!("cornell-spectral", 0.005, 0.02);

impl Check {
    fn description(&self) -> Description {
        let options = gltf::LoadOptions::default();
        let loaded = gltf::load_bytes(self.bytes, self.name, &options);
        loaded.expect("a sound file").description
    }

    /// Means, and their standard errors.
    fn reference(&self) -> [Tiles; 2] {
        let text = include_str!("another_renderer/tiles.json");
        let all: BTreeMap<String, BTreeMap<String, Tiles>> =
            serde_json::from_str(text).expect("tiles");
        ["means", "errors"].map(|of| all[self.name][of].clone())
    }

    /// Where ours differs, with paths of so many edges at most.
    #[expect(clippy::print_stdout, reason = "figures for whoever runs it")]
    fn differences(&self, description: &Description, how: &How, max_depth: u32) -> Vec<String> {
        let compensation = self.name != GLOSSY.name;
        let options = SceneOptions {
            width: SIDE,
            height: SIDE,
            compensation,
            ..SceneOptions::default()
        };
        let scene = Scene::new(description, &options).expect("a sound scene");
        let [means, errors] = self.reference();
        let colours = means[0].len();
        let runs: Vec<Vec<Vec<f64>>> = (0..SEEDS)
            .map(|seed| {
                let mut settings = settings(how.method, SIDE, how.spp);
                settings.seed = seed;
                settings.max_depth = max_depth;
                settings.options.pilot = 50_000;
                settings.options.compensation = compensation;
                from_both_sides(&mut settings);
                (how.change)(&mut settings);
                // Discs of a quarter of a pixel's radius, where light is joined across edges but little.
                settings.options.photon.photons = Some(400_000);
                settings.options.photon.radius = 0.25;
                settings.options.photon.reduction = None;
                coarser(&tile_means(&picture(&scene, &settings)), colours)
            })
            .collect();
        let mut found = Vec::new();
        let mut doubts = Vec::new();
        for tile in 0..TILES * TILES {
            for colour in 0..colours {
                let ours: Vec<f64> = runs.iter().map(|run| run[tile][colour]).collect();
                let told = Told::of(&ours, means[tile][colour], errors[tile][colour]);
                doubts.push(told.error);
                if told.share.abs() > self.tile.max(SURE * told.error) {
                    found.push(format!("tile {tile}, colour {colour}: {told:?}"));
                }
            }
        }
        let whole = |tiles: &[Vec<f64>]| tiles.iter().flatten().sum::<f64>();
        let ours: Vec<f64> = runs.iter().map(|run| whole(run)).collect();
        let squares: f64 = errors.iter().flatten().map(|error| error * error).sum();
        let told = Told::of(&ours, whole(&means), squares.sqrt());
        doubts.sort_by(f64::total_cmp);
        let median = doubts[doubts.len() / 2];
        println!(
            "{} by {}: brightness {:+.5} +- {:.5}, median error of a tile {median:.4}, off {found:?}",
            self.name,
            how.name(),
            told.share,
            told.error
        );
        if told.share.abs() > self.brightness.max(SURE * told.error) {
            found.push(format!("brightness: {told:?}"));
        }
        if median > 0.5 * self.tile || told.error > 0.5 * self.brightness {
            found.push(format!("known too little: {median}, {told:?}"));
        }
        found
    }
}

/// By how much we are brighter, and the standard error of that, both as shares of the other renderer's.
#[derive(Clone, Copy, Debug)]
struct Told {
    share: f64,
    error: f64,
}

impl Told {
    fn of(ours: &[f64], theirs: f64, error: f64) -> Self {
        let runs = Runs::of(ours);
        Self {
            share: runs.mean / theirs - 1.0,
            error: runs.variance.sqrt().hypot(error) / theirs,
        }
    }
}

/// Means of the other renderer's tiles, from ours, which are finer; of three colours or of grey.
fn coarser(tiles: &[[f64; 3]], colours: usize) -> Vec<Vec<f64>> {
    let seen = |[r, g, b]: [f64; 3]| match colours {
        1 => vec![0.2126 * r + 0.7152 * g + 0.0722 * b],
        _ => vec![r, g, b],
    };
    let tiles = merged(tiles, TILES * FINER, FINER);
    tiles.into_iter().map(seen).collect()
}

/// A method and its samples a pixel.
struct How {
    method: Method,
    variant: &'static str,
    spp: u64,
    change: fn(&mut RenderSettings),
}

impl How {
    const fn new(method: Method, spp: u64) -> Self {
        Self {
            method,
            variant: "",
            spp,
            change: |_| {},
        }
    }

    /// Chains over other paths than bidirectional ones.
    const fn with(variant: &'static str, change: fn(&mut RenderSettings)) -> Self {
        Self {
            variant,
            change,
            ..Self::new(Method::Pssmlt, 1024)
        }
    }

    fn name(&self) -> String {
        format!("{}{}", self.method, self.variant)
    }
}

const METHODS: [How; 9] = [
    How::new(Method::Path, 512),
    How::new(Method::Bdpt, 256),
    How::new(Method::Pssmlt, 512),
    How::new(Method::Mmlt, 3072),
    How::new(Method::Relt, 512),
    How::new(Method::Mlt, 2048),
    How::new(Method::Erpt, 64),
    How::new(Method::ErptPss, 64),
    How::new(Method::Sppm, 64),
];

/// Beside them where no light comes by way of a mirror or smooth glass, which `light` does not show, and which others meet seldom.
const BETWEEN_WALLS: [How; 5] = [
    How::new(Method::Light, 512),
    How::new(Method::Annealing, 512),
    How::with(" unidirectional", |settings| {
        settings.options.builder = Builder::Unidirectional;
    }),
    How::with(" endpoint", |settings| {
        settings.options.builder = Builder::Endpoint;
    }),
    How::with(" simple", |settings| {
        settings.options.builder = Builder::Simple;
    }),
];

#[test]
fn bdpt_comes_to_grey_walls_and_faults_are_found() {
    let bdpt = &How::new(Method::Bdpt, 8);
    let right = GREY.description();
    let off = GREY.differences(&right, bdpt, EDGES);
    assert!(off.is_empty(), "{off:?}");
    // Walls that reflect a fiftieth less.
    let mut darker = right.clone();
    for material in &mut darker.materials {
        for channel in &mut material.base_color[..3] {
            *channel *= 0.98;
        }
    }
    // And paths that end early.
    for (description, edges) in [(&darker, EDGES), (&right, 5)] {
        let off = GREY.differences(description, bdpt, edges);
        assert!(!off.is_empty());
    }
}

macro_rules! come_to {
    ($($name:ident: $check:expr, $methods:expr;)*) => {$(
        #[test]
        #[ignore = "long"]
        fn $name() {
            let description = $check.description();
            for how in $methods.iter().filter(|how| is_wanted(how.method)) {
                let off = $check.differences(&description, how, EDGES);
                assert!(off.is_empty(), "{}: {off:?}", how.name());
            }
        }
    )*};
}

come_to! {
    every_method_comes_to_grey_walls: GREY, METHODS;
    every_method_comes_to_ring_and_sphere: RING, METHODS;
    every_method_comes_to_a_glossy_wall: GLOSSY, METHODS;
    every_method_comes_to_spectral_walls: SPECTRAL, METHODS;
    other_builders_come_to_grey_walls: GREY, BETWEEN_WALLS;
    other_builders_come_to_a_glossy_wall: GLOSSY, BETWEEN_WALLS;
    other_builders_come_to_spectral_walls: SPECTRAL, BETWEEN_WALLS;
}
