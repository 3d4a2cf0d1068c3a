mod tree;

use std::time::Instant;

use glam::{DVec2, Vec3};
use kaustik_mcmc::{Draws, Independent, generator, sample_generator};
use kaustik_scene::testing::{Stage, diffuse, floor};
use kaustik_scene::{Scene, SceneOptions, builtin};
use kaustik_spectrum::{WavelengthSampling, Wavelengths};

use super::{Disc, Lookup, MeasurementPoints, MeasurementWalk, PhotonPath, PhotonTracing};
use crate::BuilderSettings;
use tree::Tree;

/// Balls of radii over five decades on a wavy sheet: what the grid finds is what holds the point, each once.
#[test]
fn a_lookup_finds_all_and_each_once() {
    let mut draws = generator(7, 0);
    let place = |draws: &mut dyn Draws| {
        let [x, y] = [0, 1].map(|_| 40.0 * draws.uniform() as f32 - 20.0);
        Vec3::new(x, y, (x * 0.3).sin())
    };
    let mut lookup = Lookup::default();
    for count in [0, 1, 3000] {
        let discs: Vec<Disc> = (0..count)
            .map(|_| Disc {
                center: place(&mut draws),
                radius: 10f32.powf(5.0 * draws.uniform() as f32 - 4.5),
            })
            .collect();
        lookup.rebuild(&discs);
        let mut met = 0;
        for query in 0..4000 {
            let point = match discs.get(query) {
                // Within a ball, however small.
                Some(disc) => disc.center + Vec3::splat(0.5 * disc.radius),
                None => place(&mut draws),
            };
            let mut found = Vec::new();
            lookup.holding(&discs, point, |index| found.push(index as usize));
            found.sort_unstable();
            let holds =
                |disc: &Disc| (point - disc.center).length_squared() <= disc.radius * disc.radius;
            let expected: Vec<usize> = (0..discs.len()).filter(|&i| holds(&discs[i])).collect();
            met += expected.len();
            assert_eq!(found, expected, "query {query} of {count}");
        }
        assert!(met >= count);
    }
}

/// A disc has pi times the area of its pixel's footprint at any slant: on a square wholly in view those of all pixels have pi times its
/// area.
#[test]
fn discs_are_as_large_as_footprints() {
    const SIDE: u32 = 128;
    // down to a cosine of 0.06
    for height in [4.0, 1.0, 0.2] {
        let scene = Stage::new()
            .look_at(Vec3::new(0.3, height, 3.0), Vec3::ZERO, 0.6)
            .add(diffuse([0.5; 3]), floor(0.0, 0.5))
            .build();
        let points = points(&scene, SIDE);
        let squares: f64 = (points.discs().iter())
            .map(|disc| f64::from(disc.radius).powi(2))
            .sum();
        assert!((squares - 1.0).abs() < 0.03, "{height}: {squares}");
    }
}

/// Points of a picture of `side` by `side` pixels.
fn points(scene: &Scene, side: u32) -> MeasurementPoints {
    let wavelengths = Wavelengths::sample(0.3, WavelengthSampling::Hero);
    let walk = MeasurementWalk {
        settings: BuilderSettings::default(),
        threshold: 0.39,
        pixels: DVec2::splat(f64::from(side)),
        radius: 1.0,
    };
    let mut points = MeasurementPoints::default();
    for pixel in 0..u64::from(side * side) {
        let mut u = Independent::new(sample_generator(1, 0, pixel));
        walk.trace(scene, &wavelengths, &mut u, &mut points);
    }
    points
}

/// Those points, and where photons land.
fn points_and_photons(words: &str, side: u32, paths: u64) -> (MeasurementPoints, Vec<Vec3>) {
    let options = SceneOptions {
        width: side,
        height: side,
        ..SceneOptions::default()
    };
    let description = builtin::load(words).expect("a built-in scene");
    let scene = Scene::new(&description, &options).expect("a sound scene");
    let wavelengths = Wavelengths::sample(0.3, WavelengthSampling::Hero);
    let points = points(&scene, side);
    let (mut path, mut photons) = (PhotonPath::default(), Vec::new());
    for index in 0..paths {
        let mut u = Independent::new(sample_generator(1, 1, index));
        PhotonTracing { max_edges: 12 }.build(&scene, &wavelengths, &mut u, &mut path);
        photons.extend(path.photons().iter().map(|photon| photon.position));
    }
    (points, photons)
}

/// Grids and tree find the same.
#[test]
fn grids_and_a_tree_find_the_same() {
    let (points, photons) = points_and_photons("ring-and-sphere", 48, 500);
    let balls = || points.discs().iter().map(|disc| (disc.center, disc.radius));
    let mut lookup = Lookup::default();
    lookup.rebuild(points.discs());
    let tree = Tree::new(balls());
    let mut total = 0;
    for photon in photons {
        let (mut a, mut b) = (Vec::new(), Vec::new());
        lookup.holding(points.discs(), photon, |index| a.push(index));
        tree.holding(photon, &mut |index| b.push(index));
        a.sort_unstable();
        b.sort_unstable();
        total += a.len();
        assert_eq!(a, b);
    }
    assert!(total > 1000, "{total}");
}

#[test]
#[ignore = "a measurement"]
fn how_long_a_look_takes() {
    for (words, side) in [("cornell", 256), ("ring-and-sphere", 512)] {
        let (points, photons) = points_and_photons(words, side, 100_000);
        let balls = || points.discs().iter().map(|disc| (disc.center, disc.radius));
        let mut lookup = Lookup::default();
        lookup.rebuild(points.discs());
        let start = Instant::now();
        lookup.rebuild(points.discs());
        let built = start.elapsed();
        let start = Instant::now();
        let tree = Tree::new(balls());
        let planted = start.elapsed();
        let (mut sums, mut times) = ([0_u64; 2], Vec::new());
        for _ in 0..3 {
            let start = Instant::now();
            for &photon in &photons {
                lookup.holding(points.discs(), photon, |_| sums[0] += 1);
            }
            times.push(start.elapsed());
            let start = Instant::now();
            for &photon in &photons {
                tree.holding(photon, &mut |_| sums[1] += 1);
            }
            times.push(start.elapsed());
        }
        assert_eq!(sums[0], sums[1]);
        println!(
            "{words}, {} points: grids built in {built:?}, tree in {planted:?}; {} looks by turns {times:?}, {} found",
            points.points().len(),
            photons.len(),
            sums[0] / 3
        );
    }
}
