//! The five rules of Cline et al. 2005 for the change of density, as Batty lists them, against the ratios of this
//! crate (Batty sec. 4.2).
//!
//! The figure of a rule is made of positions alone, which are traced again in double precision through the planes
//! that a path runs through. What the crate says is f(y) T(y -> x) / (f(x) T(x -> y)) but for what
//! the surfaces scatter and the emitter emits: the rules are used with an f of these alone.

use glam::DVec3;
use kaustik_mcmc::{Kernel, Pcg64Dxsm, generator};

use super::jacobian::{bounce, meet};
use super::space;
use super::stage::scene;
use crate::{CausticPerturbation, LensPerturbation, Path, PathSpace, Radii, Run, Seeds};

const PAIRS: usize = 10_000;
/// Proposals from one path, until one is a path that counts.
const TRIES: usize = 16;
const TOLERANCE: f64 = 1e-5;

/// f but for scattering and emission.
fn measure(space: &PathSpace<'_>, path: &Path) -> f64 {
    let mut value = path.at(0).value * path.at(0).edge.transmittance;
    for i in 1..path.edges() {
        value *= path.at(i).value * path.at(i).edge.transmittance;
    }
    path.density() / space.target.of(path.wavelengths.to_xyz(value))
}

/// Where a walk from the lens meets the planes of vertices `last..`, the lens last.
fn from_lens(space: &PathSpace<'_>, path: &Path, last: usize) -> Vec<DVec3> {
    let n = path.edges();
    let camera = space.scene.camera();
    let ray = camera.ray_from(path.at(n).vertex.position, path.raster());
    let (mut at, mut direction) = (ray.origin, ray.direction);
    let mut found = vec![at];
    for i in (last..n).rev() {
        let vertex = path.at(i);
        at = meet(at, direction, vertex);
        found.push(at);
        direction = if vertex.specular {
            bounce(direction, vertex, true)
        } else {
            vertex.toward_light
        };
    }
    found.reverse();
    found
}

/// Where a walk from vertex `pivot` meets the planes of those after it, as far as the one that the lens sees.
fn from_pivot(path: &Path, pivot: usize) -> DVec3 {
    let (mut at, mut direction) = (path.at(pivot).vertex.position, path.at(pivot).toward_eye);
    for i in pivot + 1..path.edges() {
        let vertex = path.at(i);
        at = meet(at, direction, vertex);
        if vertex.specular {
            direction = bounce(direction, vertex, false);
        }
    }
    at
}

fn normal(path: &Path, i: usize) -> DVec3 {
    path.at(i).vertex.normal
}

/// G between two points of planes.
fn geometry([a, b]: [DVec3; 2], [m, n]: [DVec3; 2]) -> f64 {
    let along = b - a;
    let squared = along.length_squared();
    (along.dot(m) * along.dot(n)).abs() / (squared * squared)
}

/// Rule 2: the cosines where directions leave vertices that were turned, as far as vertex `last`.
fn cosines(path: &Path, points: &[DVec3], last: usize) -> f64 {
    let turned = (last + 1..path.edges()).filter(|&i| !path.is_specular(i));
    turned
        .map(|i| {
            let along = points[i - 1 - last] - points[i - last];
            (along.normalize().dot(normal(path, i))).abs()
        })
        .product()
}

/// Rule 5: raster area per area at a point that the lens sees, `cos / (r^2 cos_axis^3)`, but for a constant.
fn seen(space: &PathSpace<'_>, path: &Path, point: DVec3) -> f64 {
    let camera = space.scene.camera();
    let along = point - path.at(path.edges()).vertex.position;
    let squared = along.length_squared();
    let unit = along / squared.sqrt();
    let cos = unit.dot(camera.forward());
    unit.dot(normal(path, path.edges() - 1)).abs() / (squared * cos.powi(3))
}

/// Positions are rounded to single precision: close by, and where rays graze, that shows.
fn is_plain(path: &Path) -> bool {
    (0..path.edges()).all(|i| {
        let (light, eye) = (path.at(i), path.at(i + 1));
        light.edge.squared > 0.2 && light.cos_eye.min(eye.cos_light) > 0.2
    })
}

type Propose = fn(&PathSpace<'_>, &Path, &mut Path, &mut Pcg64Dxsm) -> f64;
type Figure = fn(&PathSpace<'_>, &Path) -> f64;

/// Largest relative difference between the figure and the crate's ratio on [`PAIRS`] random paths with `suits`, each with a
/// path proposed from it.
fn worst(name: &str, suits: fn(&Path) -> bool, propose: Propose, figure: Figure) -> f64 {
    let scene = scene(name);
    let space = space(&scene, 5);
    let mut seeds = Seeds::new(&space);
    let mut rng = generator(23, 0);
    let (mut x, mut y) = (Path::default(), Path::default());
    let (mut pairs, mut worst) = (0, 0.0_f64);
    for sample in 0.. {
        if pairs >= PAIRS {
            break;
        }
        assert!(sample < 10_000_000, "{name}: {pairs} pairs");
        if seeds.sample(&mut x, &mut rng) <= 0.0 || !suits(&x) || !is_plain(&x) {
            continue;
        }
        for _ in 0..TRIES {
            let ratio = propose(&space, &x, &mut y, &mut rng);
            if ratio > 0.0 && is_plain(&y) {
                let found = measure(&space, &y) / measure(&space, &x) * ratio;
                let wanted = figure(&space, &y) / figure(&space, &x);
                worst = worst.max((found / wanted - 1.0).abs());
                pairs += 1;
                break;
            }
        }
    }
    worst
}

fn lens<'a>(space: &'a PathSpace<'a>, run: Run) -> LensPerturbation<'a> {
    LensPerturbation {
        space,
        radii: Radii {
            least: 0.1,
            most: 4.0,
        },
        angles: Radii {
            least: 0.01,
            most: 0.5,
        },
        run,
    }
}

fn by_lens(space: &PathSpace<'_>, x: &Path, y: &mut Path, rng: &mut Pcg64Dxsm) -> f64 {
    lens(space, Run::Single).propose(&mut (), x, y, rng).ratio
}

fn by_chains(space: &PathSpace<'_>, x: &Path, y: &mut Path, rng: &mut Pcg64Dxsm) -> f64 {
    lens(space, Run::Multiple).propose(&mut (), x, y, rng).ratio
}

fn by_light(space: &PathSpace<'_>, x: &Path, y: &mut Path, rng: &mut Pcg64Dxsm) -> f64 {
    let radii = Radii {
        least: 0.1,
        most: 6.0,
    };
    let kernel = CausticPerturbation { space, radii };
    kernel.propose(&mut (), x, y, rng).ratio
}

/// The vertex nearest the eye that a lens perturbation joins; 0 if it traces on to the light.
fn joined(path: &Path) -> usize {
    let free = |i: usize| !path.is_specular(i) && (i == 1 || !path.is_specular(i - 1));
    (1..path.edges()).rev().find(|&i| free(i)).unwrap_or(0)
}

fn turns(path: &Path) -> usize {
    let traced = joined(path) + 1..path.edges();
    traced.filter(|&i| !path.is_specular(i)).count()
}

/// `L S* E`: the raster point moves, and nothing else counts.
#[test]
fn rule_1_raster_point() {
    let suits = |path: &Path| joined(path) == 0 && turns(path) == 0;
    let found = worst("pond", suits, by_lens, |_, _| 1.0);
    assert!(found < TOLERANCE, "{found}");
}

/// `L S+ D S* E`: the direction at D moves as well.
#[test]
fn rule_2_direction() {
    let suits = |path: &Path| joined(path) == 0 && turns(path) > 0;
    let figure: Figure = |space, path| cosines(path, &from_lens(space, path, 0), 0);
    let found = worst("gallery", suits, by_chains, figure);
    assert!(found < TOLERANCE, "{found}");
    assert!(worst("gallery", suits, by_chains, |_, _| 1.0) > 0.1);
}

/// `.. D D S* E`: two vertices of surfaces are joined.
#[test]
fn rule_3_surfaces_joined() {
    let suits = |path: &Path| joined(path) > 1 && turns(path) == 0;
    for name in ["diffuse", "mirror", "glass"] {
        let found = worst(name, suits, by_lens, joint);
        assert!(found < TOLERANCE, "{name}: {found}");
        assert!(worst(name, suits, by_lens, |_, _| 1.0) > 0.1);
    }
}

/// `L D S* E`: the old point of the light is joined, however the path was found at first.
#[test]
fn rule_4_light_joined() {
    let suits = |path: &Path| joined(path) == 1 && turns(path) == 0;
    for name in ["diffuse", "mirror"] {
        let found = worst(name, suits, by_lens, joint);
        assert!(found < TOLERANCE, "{name}: {found}");
        assert!(worst(name, suits, by_lens, |_, _| 1.0) > 0.1);
    }
}

/// Rules 2 and 3 or 4 together: `.. (L or D) D S+ D S* E`.
#[test]
fn rules_of_a_multi_chain() {
    let suits = |path: &Path| joined(path) > 0 && turns(path) > 0;
    let found = worst("mirror", suits, by_chains, joint);
    assert!(found < TOLERANCE, "{found}");
}

/// Rules 2, 3 and 4.
fn joint(space: &PathSpace<'_>, path: &Path) -> f64 {
    let last = joined(path);
    let points = from_lens(space, path, last);
    let ends = [path.at(last - 1).vertex.position, points[0]];
    let normals = [normal(path, last - 1), normal(path, last)];
    cosines(path, &points, last) * geometry(ends, normals)
}

/// The pivot of the caustic perturbation.
fn pivot(path: &Path) -> usize {
    let open = (0..path.edges() - 1).rev().find(|&i| !path.is_specular(i));
    open.unwrap_or(0)
}

/// `(L or D) S* D E`: the lens is joined, and the direction where light leaves the pivot moves. Batty's report
/// names rule 5 alone here; without rule 2 at the pivot the figure is wrong, and rule 3 has no place.
#[test]
fn rule_5_lens_joined() {
    let suits = |path: &Path| path.edges() > 1 && !path.is_specular(path.edges() - 1);
    let alone: Figure = |space, path| seen(space, path, from_pivot(path, pivot(path)));
    let both: Figure = |space, path| {
        let pivot = pivot(path);
        let leaves = path.at(pivot).toward_eye.dot(normal(path, pivot)).abs();
        leaves * seen(space, path, from_pivot(path, pivot))
    };
    for name in ["diffuse", "mirror", "gallery", "glass"] {
        let found = worst(name, suits, by_light, both);
        assert!(found < TOLERANCE, "{name}: {found}");
        assert!(worst(name, suits, by_light, alone) > 0.1, "{name}");
    }
}
