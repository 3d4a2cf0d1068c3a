//! Each kernel alone keeps the measure of the paths (spec: erpt.md 9.2), and with any factor of its densities
//! left out it does not.

use kaustik_mcmc::testing::{Changes, PairedTest, assert_invariant};
use kaustik_mcmc::{Kernel, Pcg64Dxsm, acceptance, decide};
use kaustik_scene::Scene;

use super::space;
use super::stage::scene;
use crate::bidirectional::tests::cuts_sum;
use crate::density::{geometry_to_eye, geometry_to_light};
use crate::{
    BidirectionalMutation, CausticPerturbation, LensMutation, LensPerturbation, Path, PathSpace,
    Radii, Run, Seeds, WavelengthMutation,
};

/// How many test functions there are.
const H: usize = 20;
/// Longest path.
const EDGES: u32 = 5;

/// What each part of a path shows.
fn functions(path: &Path) -> [f64; H] {
    let n = path.edges();
    let [x, y] = path.raster().to_array();
    let (first, last) = (path.position(1.min(n)), path.position(n - 1));
    let specular = (1..n).filter(|&i| path.is_specular(i)).count() as f64;
    let is = |yes: bool| f64::from(u8::from(yes));
    let [red, green, blue] = path.colour().0.map(f64::from);
    [
        x,
        y,
        x * x,
        y * y,
        x * y,
        is(x < 0.3),
        is(y < 0.3),
        is(n == 2),
        is(n == 3),
        is(n == 4),
        specular,
        first[0],
        first[1].min(5.0),
        first[2],
        last[0],
        last[2],
        path.wavelength(),
        red + 0.5 * green,
        blue,
        first[0] * last[0],
    ]
}

/// A kernel on paths in a space, and which paths it is started from.
type Kind = (&'static str, fn(&PathSpace<'_>, &Path) -> bool, Propose);
type Propose = fn(&PathSpace<'_>, &Path, &mut Path, &mut Pcg64Dxsm) -> f64;
/// A factor of the density of a path's moved part.
type Factor = fn(&PathSpace<'_>, &Path) -> f64;

fn lens<'a>(space: &'a PathSpace<'a>, run: Run) -> LensPerturbation<'a> {
    LensPerturbation {
        space,
        radii: Radii {
            least: 0.2,
            most: 3.0,
        },
        angles: Radii {
            least: 0.05,
            most: 1.0,
        },
        run,
    }
}

fn caustic<'a>(space: &'a PathSpace<'a>) -> CausticPerturbation<'a> {
    CausticPerturbation {
        space,
        radii: Radii {
            least: 0.2,
            most: 6.0,
        },
    }
}

const LENS: Kind = (
    "lens",
    |space, x| lens(space, Run::Single).suits(x),
    |space, x, y, rng| lens(space, Run::Single).propose(&mut (), x, y, rng).ratio,
);
const MULTICHAIN: Kind = (
    "multichain",
    |space, x| lens(space, Run::Multiple).suits(x),
    |space, x, y, rng| lens(space, Run::Multiple).propose(&mut (), x, y, rng).ratio,
);
const CAUSTIC: Kind = (
    "caustic",
    |space, x| caustic(space).suits(x),
    |space, x, y, rng| caustic(space).propose(&mut (), x, y, rng).ratio,
);
const BIDIRECTIONAL: Kind = (
    "bidirectional",
    |_, _| true,
    |space, x, y, rng| {
        BidirectionalMutation { space }
            .propose(&mut (), x, y, rng)
            .ratio
    },
);
const SUBPATH: Kind = (
    "lens mutation",
    |space, x| LensMutation { space }.suits(x),
    |space, x, y, rng| LensMutation { space }.propose(&mut (), x, y, rng).ratio,
);
const WAVELENGTHS: Kind = (
    "wavelengths",
    |space, x| WavelengthMutation { space }.suits(x),
    |space, x, y, rng| {
        WavelengthMutation { space }
            .propose(&mut (), x, y, rng)
            .ratio
    },
);

/// Starts from independent paths, steps, and hands `judge` the pieces.
fn with_pieces<R>(
    scene: &Scene,
    kind: Kind,
    left_out: Option<Factor>,
    judge: impl FnOnce(
        &mut dyn FnMut(&mut Pcg64Dxsm) -> (Path, f64),
        &mut dyn FnMut(&mut Path, &mut Pcg64Dxsm),
    ) -> R,
) -> R {
    let space = space(scene, EDGES);
    let (_, suits, propose) = kind;
    let mut seeds = Seeds::new(&space);
    let mut start = |rng: &mut Pcg64Dxsm| {
        let mut path = Path::default();
        let weight = seeds.sample(&mut path, rng);
        let suited = weight > 0.0 && suits(&space, &path);
        (path, if suited { weight } else { 0.0 })
    };
    let mut next = Path::default();
    let mut step = |path: &mut Path, rng: &mut Pcg64Dxsm| {
        let mut ratio = propose(&space, path, &mut next, rng);
        if ratio > 0.0 {
            ratio *= left_out.map_or(1.0, |factor| factor(&space, &next) / factor(&space, path));
            if decide(acceptance(path.density(), next.density(), ratio), rng) {
                std::mem::swap(path, &mut next);
            }
        }
    };
    judge(&mut start, &mut step)
}

fn changes(name: &str, kind: Kind, left_out: Option<Factor>, test: &PairedTest) -> Changes<H> {
    let scene = scene(name);
    with_pieces(&scene, kind, left_out, |start, step| {
        test.run(|rng| start(rng), |path, rng| step(path, rng), functions)
    })
}

/// Scenes for each kernel; together they have all kinds of vertices and ends.
const CASES: &[(Kind, &[&str])] = &[
    (
        LENS,
        &[
            "diffuse",
            "glossy",
            "mirror",
            "varnish",
            "glass",
            "inlay",
            "frosted",
            "rainbow",
            "point",
            "sun",
            "sky",
            "lens",
            "orthographic",
            "veil",
        ],
    ),
    (
        MULTICHAIN,
        &["gallery", "mirror", "glass", "varnish", "sky", "lens"],
    ),
    (
        CAUSTIC,
        &[
            "gallery",
            "diffuse",
            "mirror",
            "glass",
            "inlay",
            "varnish",
            "rainbow",
            "point",
            "point-glass",
            "sun-glass",
            "lens",
            "orthographic",
            "veil",
        ],
    ),
    (
        BIDIRECTIONAL,
        &[
            "gallery",
            "diffuse",
            "glossy",
            "mirror",
            "varnish",
            "glass",
            "inlay",
            "frosted",
            "rainbow",
            "point",
            "sun",
            "point-glass",
            "sun-glass",
            "sky",
            "lens",
            "orthographic",
            "veil",
        ],
    ),
    (
        SUBPATH,
        &["diffuse", "mirror", "glass", "varnish", "lens", "veil"],
    ),
    (
        WAVELENGTHS,
        &["diffuse", "glass", "frosted", "rainbow", "point"],
    ),
];

fn keeps(starts: u64, steps: u32) {
    let test = PairedTest {
        starts,
        steps,
        seed: 5,
    };
    for (kind, names) in CASES {
        for name in *names {
            println!("{} on {name}", kind.0);
            let scene = scene(name);
            with_pieces(&scene, *kind, None, |start, step| {
                assert_invariant(
                    &test,
                    |rng| start(rng),
                    |path, rng| step(path, rng),
                    functions,
                );
            });
        }
    }
}

#[test]
fn every_kernel_keeps_the_measure() {
    keeps(20_000, 8);
}

#[test]
#[ignore = "long"]
fn every_kernel_keeps_the_measure_with_a_million_starts() {
    keeps(1_000_000, 12);
}

/// The product over the part that a lens perturbation traces, as far as the first vertex after smooth ones.
fn traced_by_eye(path: &Path, factor: impl Fn(usize) -> f64) -> f64 {
    (1..path.edges())
        .rev()
        .scan(false, |done, i| {
            let stop = std::mem::replace(done, *done || !path.is_specular(i));
            (!stop).then(|| factor(i))
        })
        .product()
}

/// Each with the scene where it shows.
const FAULTS: &[(&str, &str, Kind, Factor)] = &[
    (
        "the raster's share of a direction",
        "diffuse",
        LENS,
        |space, path| {
            let lens = path.at(path.edges());
            space.raster_per_direction(lens.vertex.position, lens.toward_light)
        },
    ),
    (
        "the geometry of what the eye traces",
        "diffuse",
        LENS,
        |_, path| traced_by_eye(path, |i| geometry_to_light(path, i)),
    ),
    (
        "the cosine at the lens before a mirror",
        "mirror",
        LENS,
        |_, path| traced_by_eye(path, |i| geometry_to_light(path, i)),
    ),
    (
        "the geometry behind a turn",
        "gallery",
        MULTICHAIN,
        |_, path| {
            let turn = (2..path.edges())
                .rev()
                .find(|&i| !path.is_specular(i) && path.is_specular(i - 1));
            turn.map_or(1.0, |i| geometry_to_light(path, i - 1))
        },
    ),
    (
        "the geometry of what the light traces",
        "diffuse",
        CAUSTIC,
        |_, path| geometry_to_eye(path, path.edges() - 1),
    ),
    (
        "the cosine before a mirror",
        "gallery",
        CAUSTIC,
        |_, path| {
            if path.is_specular(path.edges() - 2) && path.edges() > 2 {
                let pivot = (0..path.edges() - 2).rev().find(|&i| !path.is_specular(i));
                1.0 / path.at(pivot.unwrap_or(0)).cos_eye
            } else {
                1.0
            }
        },
    ),
    (
        "the density of the whole new part",
        "diffuse",
        BIDIRECTIONAL,
        |space, path| space.all_ways(path, 0, path.len()),
    ),
    (
        "the sum of the weights of deletions",
        "diffuse",
        BIDIRECTIONAL,
        |space, path| 1.0 / cuts_sum(space, path),
    ),
    (
        "the density of the lens subpath",
        "mirror",
        SUBPATH,
        |space, path| traced_by_eye(path, |i| space.step_to_light_pdf(path, i)),
    ),
];

#[test]
fn a_factor_left_out_is_found() {
    let test = PairedTest {
        starts: 160_000,
        steps: 10,
        seed: 11,
    };
    let mut missed = Vec::new();
    for (what, name, kind, factor) in FAULTS {
        let found = changes(name, *kind, Some(*factor), &test);
        println!(
            "{} without {what}, {name}: chi2 {:.1}, moved {:.2}",
            kind.0,
            found.chi_square(),
            found.moved
        );
        if found.p_value() > 1e-6 {
            missed.push((*what, found.chi_square(), found.p_value()));
        }
    }
    assert!(missed.is_empty(), "{missed:?}");
}
