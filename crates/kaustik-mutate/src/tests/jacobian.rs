//! Densities against finite differences of the maps that draw: rays are traced again in double precision through
//! the planes that a path runs through.

use glam::{DVec2, DVec3};
use kaustik_bsdf::Frame;
use kaustik_mcmc::generator;

use super::space;
use super::stage::scene;
use crate::density::{bending, geometry_to_eye, geometry_to_light};
use crate::vertex::PathVertex;
use crate::{Path, PathSpace, Seeds};

const STEP: f64 = 1e-5;

/// Where a ray meets the plane of a vertex.
pub(super) fn meet(origin: DVec3, direction: DVec3, vertex: &PathVertex) -> DVec3 {
    let (point, normal) = (vertex.vertex.position, vertex.vertex.normal);
    origin + direction * ((point - origin).dot(normal) / direction.dot(normal))
}

/// The direction after a smooth vertex that is reached along `direction`, with the path's own ratio of indices.
pub(super) fn bounce(direction: DVec3, vertex: &PathVertex, from_eye: bool) -> DVec3 {
    let normal = vertex.vertex.frame.z;
    if !vertex.transmitted {
        return direction - normal * (2.0 * direction.dot(normal));
    }
    let (back, on) = if from_eye {
        (vertex.toward_eye, vertex.toward_light)
    } else {
        (vertex.toward_light, vertex.toward_eye)
    };
    let sine = |w: DVec3| w.cross(normal).length();
    let ratio = sine(on) / sine(back);
    let across = (direction - normal * direction.dot(normal)) * ratio;
    let down = normal * direction.dot(normal).signum();
    across + down * (1.0 - across.length_squared()).sqrt()
}

/// Through vertices in their order to the plane of the last.
fn through(
    mut origin: DVec3,
    mut direction: DVec3,
    path: &Path,
    order: impl Iterator<Item = usize>,
    from_eye: bool,
) -> DVec3 {
    for i in order {
        let vertex = path.at(i);
        origin = meet(origin, direction, vertex);
        if vertex.specular {
            direction = bounce(direction, vertex, from_eye);
        }
    }
    origin
}

/// Area on the last plane per area of the two parameters.
fn stretch(map: impl Fn(DVec2) -> DVec3) -> f64 {
    let along = |step: DVec2| (map(step) - map(-step)) / (2.0 * STEP);
    along(DVec2::X * STEP)
        .cross(along(DVec2::Y * STEP))
        .length()
}

/// Directions about one, by solid angle.
fn about(direction: DVec3, step: DVec2) -> DVec3 {
    let frame = Frame::from_z(direction);
    (direction + frame.x * step.x + frame.y * step.y).normalize()
}

/// The vertex at the other end of the run that begins behind vertex `i`.
fn run_end(path: &Path, i: usize, toward_eye: bool) -> Option<usize> {
    if toward_eye {
        (i + 1..path.edges()).find(|&j| !path.is_specular(j))
    } else {
        (1..i).rev().find(|&j| !path.is_specular(j))
    }
}

fn paths(space: &PathSpace<'_>, count: usize) -> Vec<Path> {
    let mut seeds = Seeds::new(space);
    let mut rng = generator(3, 0);
    let mut found = Vec::new();
    while found.len() < count {
        let mut path = Path::default();
        if seeds.sample(&mut path, &mut rng) > 0.0 {
            found.push(path);
        }
    }
    found
}

fn close(found: f64, wanted: f64, what: &str) {
    assert!(
        (found / wanted - 1.0).abs() < 1e-5,
        "{what}: {found} and {wanted}"
    );
}

/// Raster points to the first surface.
#[test]
fn rays_from_the_lens_spread_as_the_density_says() {
    for name in ["diffuse", "lens", "orthographic"] {
        let scene = scene(name);
        let space = space(&scene, 4);
        let camera = scene.camera();
        let mut seen = 0;
        for path in paths(&space, 400).iter().filter(|path| path.edges() > 1) {
            let (n, lens) = (path.edges(), path.at(path.edges()));
            if path.is_specular(n - 1) {
                continue;
            }
            let area = stretch(|step| {
                let ray = camera.ray_from(lens.vertex.position, path.raster() + step);
                meet(ray.origin, ray.direction, path.at(n - 1))
            });
            let per_direction = space.raster_per_direction(lens.vertex.position, lens.toward_light);
            close(
                per_direction * geometry_to_light(path, n - 1) * area,
                1.0,
                name,
            );
            seen += 1;
        }
        assert!(seen > 100, "{name}: {seen}");
    }
}

/// Directions to the next surface, both ways.
#[test]
fn directions_spread_as_the_density_says() {
    let scene = scene("diffuse");
    let mut seen = 0;
    for path in &paths(&space(&scene, 5), 2_000) {
        for i in 2..path.edges() {
            let (light, eye) = (path.at(i - 1), path.at(i));
            // Positions are rounded to single precision: close by, that turns directions.
            if light.edge.squared < 0.25 || light.cos_eye.min(eye.cos_light) < 0.2 {
                continue;
            }
            let from = eye.vertex.position;
            let area = stretch(|step| meet(from, about(eye.toward_light, step), light));
            close(
                geometry_to_light(path, i - 1) * area,
                1.0,
                "toward the light",
            );
            let from = light.vertex.position;
            let area = stretch(|step| meet(from, about(light.toward_eye, step), eye));
            close(geometry_to_eye(path, i) * area, 1.0, "toward the eye");
            seen += 1;
        }
    }
    assert!(seen > 100, "{seen}");
}

/// Through runs of smooth surfaces only the ratio of the two ways is a matter of this crate.
#[test]
fn runs_spread_alike_both_ways() {
    for name in ["mirror", "glass", "inlay", "leaning", "leaning-glass"] {
        let scene = scene(name);
        let (mut seen, mut bent) = (0, 0);
        for path in &paths(&space(&scene, 6), 6_000) {
            for a in 1..path.edges() {
                if path.is_specular(a) || !path.is_specular(a + 1) {
                    continue;
                }
                let Some(b) = run_end(path, a, true) else {
                    continue;
                };
                let (light, eye) = (path.at(a), path.at(b));
                let from = light.vertex.position;
                let there = stretch(|step| {
                    through(from, about(light.toward_eye, step), path, a + 1..=b, false)
                });
                let from = eye.vertex.position;
                let back = stretch(|step| {
                    through(
                        from,
                        about(eye.toward_light, step),
                        path,
                        (a..b).rev(),
                        true,
                    )
                });
                let bending: f64 = (a + 1..b).map(|i| bending(path.at(i))).product();
                let to_eye: f64 = (a + 1..=b).map(|i| geometry_to_eye(path, i)).product();
                let to_light: f64 = (a..b).map(|i| geometry_to_light(path, i)).product();
                close(to_eye * bending / to_light, back / there, name);
                seen += 1;
                bent += i32::from((bending - 1.0).abs() > 1e-3);
            }
        }
        assert!(seen > 30, "{name}: {seen}");
        let plain = ["mirror", "glass"].contains(&name);
        assert_eq!(bent > 30, !plain, "{name}: {bent} of {seen}");
    }
}
