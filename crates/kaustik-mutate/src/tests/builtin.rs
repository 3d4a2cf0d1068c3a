//! Long looks at built-in scenes: brightness by length against bidirectional path tracing, and what the kernels
//! do to each kind of path.

use glam::DVec2;
use kaustik_mcmc::testing::PairedTest;
use kaustik_mcmc::{Mean, generator};
use kaustik_path::{
    Bidirectional, BuilderSettings, Contributions, Form, Heuristic, PathBuilder, ScalarTarget,
};
use kaustik_scene::{Scene, SceneOptions, builtin};

use super::Fresh;
use super::kinds::{
    BIDIRECTIONAL, CAUSTIC, EVERY, Kind, LENS, MULTICHAIN, SUBPATH, WAVELENGTHS, with_pieces_in,
};
use crate::{Path, PathSpace, Seeds};

const EDGES: u32 = 9;

const SCENES: [&str; 4] = [
    "water-cornell?light=0.8",
    "ring-and-sphere",
    "glass-cube?light=0.8",
    "cornell",
];

fn load(name: &str) -> Scene {
    let description = builtin::load(name).expect("a built-in scene");
    let options = SceneOptions {
        width: 32,
        height: 32,
        ..SceneOptions::default()
    };
    Scene::new(&description, &options).expect("a sound scene")
}

fn settings(min_edges: u32, max_edges: u32) -> BuilderSettings {
    BuilderSettings {
        min_edges,
        max_edges,
        ..BuilderSettings::default()
    }
}

fn space(scene: &Scene) -> PathSpace<'_> {
    PathSpace {
        scene,
        settings: settings(1, EDGES),
        target: ScalarTarget::Xyz,
        pixels: DVec2::splat(32.0),
    }
}

/// What bidirectional path tracing finds by paths of so many edges.
fn traced(scene: &Scene, edges: u32, samples: u64) -> Mean {
    let builder = Bidirectional {
        settings: settings(edges, edges),
        form: Form::Full,
        heuristic: Heuristic::Power,
    };
    let mut out = Contributions::default();
    let mut rng = generator(7, u64::from(edges));
    (0..samples)
        .map(|_| {
            builder.build(scene, &mut Fresh(&mut rng), &mut out);
            out.by_class(ScalarTarget::Xyz).iter().sum()
        })
        .collect()
}

#[test]
#[ignore = "long"]
fn seeds_are_as_bright_as_bdpt_at_every_length() {
    // A wide lamp makes errors small where light goes through glass and water.
    let wide = ["water-cornell?light=2", "glass-cube?light=2"];
    for name in SCENES.into_iter().chain(wide) {
        let scene = load(name);
        let space = space(&scene);
        let mut found = vec![Mean::new(); EDGES as usize + 1];
        let mut seeds = Seeds::new(&space);
        let (mut path, mut rng) = (Path::default(), generator(9, 9));
        for _ in 0..1_000_000 {
            let weight = seeds.sample(&mut path, &mut rng);
            let edges = if weight > 0.0 { path.edges() } else { 0 };
            for (n, mean) in found.iter_mut().enumerate() {
                mean.push(if n == edges { weight } else { 0.0 });
            }
        }
        let mut worst = 0.0_f64;
        for n in 1..=EDGES {
            let (a, b) = (traced(&scene, n, 400_000), found[n as usize]);
            let error = a.standard_error().hypot(b.standard_error());
            let z = (b.mean() - a.mean()) / error.max(f64::MIN_POSITIVE);
            println!(
                "{name} {n}: bdpt {:.5} seeds {:.5} ({:+.2} % +- {:.2}) z {z:+.2}",
                a.mean(),
                b.mean(),
                100.0 * (b.mean() / a.mean() - 1.0),
                100.0 * error / a.mean()
            );
            worst = worst.max(z.abs());
        }
        assert!(worst < 4.5, "{name}: {worst}");
    }
}

/// Kinds of paths: lengths, numbers of Dirac scatterings, where they are.
fn strings(path: &Path) -> [f64; 20] {
    let n = path.edges();
    let specular = (1..n).filter(|&i| path.is_specular(i)).count();
    let at = |i: usize| i > 0 && i < n && path.is_specular(i);
    let is = |yes: bool| f64::from(u8::from(yes));
    let [x, y] = path.raster().to_array();
    [
        x,
        y,
        is(n == 1),
        is(n == 2),
        is(n == 3),
        is(n == 4),
        is(n == 5),
        is(n == 6),
        is(n >= 7),
        is(specular == 0),
        is(specular == 1),
        is(specular == 2),
        is(specular >= 3),
        is(at(1)),
        is(at(n - 1)),
        is(at(1) && at(n - 1)),
        is(n == 3 && specular == 1),
        is(n == 4 && specular == 2),
        is(n >= 5 && specular >= 2 && !at(n - 1)),
        path.wavelength_u(),
    ]
}

/// The means of these kinds, in the law that the kernels keep.
fn keeps(kind: Kind) {
    let test = PairedTest {
        starts: 200_000,
        steps: 12,
        seed: 29,
    };
    let mut broken = Vec::new();
    for name in SCENES {
        let scene = load(name);
        let found = with_pieces_in(&space(&scene), kind, None, |start, step| {
            test.run(|rng| start(rng), |path, rng| step(path, rng), strings)
        });
        let (chi, p) = (found.chi_square(), found.p_value());
        println!(
            "{:13} {name:24} chi2 {chi:.2} p {p:.4} moved {:.1} %",
            kind.0,
            100.0 * found.moved
        );
        // no path of a room without mirrors suits some kernels
        if (p.is_nan() || p < 1e-4) && found.moved > 0.0 {
            println!("{found}");
            broken.push((name, chi, p));
        }
    }
    assert!(broken.is_empty(), "{}: {broken:?}", kind.0);
}

#[test]
#[ignore = "long"]
fn kernels_keep_the_kinds_of_paths_in_built_in_scenes() {
    for kind in [
        LENS,
        MULTICHAIN,
        CAUSTIC,
        BIDIRECTIONAL,
        SUBPATH,
        WAVELENGTHS,
        EVERY,
    ] {
        keeps(kind);
    }
}
