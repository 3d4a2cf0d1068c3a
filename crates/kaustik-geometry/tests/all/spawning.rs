//! Rays that leave a surface neither meet it nor pass through it, at any scale and any distance from the origin.

use glam::{Affine3A, Vec3};
use kaustik_geometry::{Mesh, Ray, Surface, World};

use crate::support::{Random, cube, icosphere, instanced, placed, torus};

/// What a random walk inside a closed mesh saw.
#[derive(Default, Debug, PartialEq)]
struct Seen {
    bounces: u32,
    /// Rays that met the triangle they left.
    own: u32,
    /// Rays that met nothing.
    lost: u32,
}

/// Walks inside, each direction on the side from which the last ray came; a third of them grazing.
fn walk(
    world: &World,
    random: &mut Random,
    start: Vec3,
    bounces: u32,
    spawn: impl Fn(&Surface, Vec3) -> Ray,
) -> Seen {
    let mut seen = Seen::default();
    let mut ray = Ray::new(start, random.direction());
    for _ in 0..bounces {
        let Some(hit) = world.intersect(&ray) else {
            seen.lost += 1;
            ray = Ray::new(start, random.direction());
            continue;
        };
        let surface = world.surface(&ray, &hit);
        let n = surface.geometric_normal * -surface.geometric_normal.dot(ray.direction).signum();
        let mut d = random.direction();
        if random.unit() < 0.33 {
            d = (d.reject_from_normalized(n) + n * 1e-4 * random.unit()).normalize();
        }
        if d.dot(n) < 0.0 {
            d = -d;
        }
        if d.dot(n) < 1e-6 {
            // So near the tangent plane that the rounded normal does not tell its side.
            d = n;
        }
        ray = spawn(&surface, d);
        seen.bounces += 1;
        let next = world.intersect(&ray);
        seen.own += u32::from(
            next.is_some_and(|h| (h.instance, h.primitive) == (hit.instance, hit.primitive)),
        );
    }
    seen
}

fn worlds(mesh: &Mesh) -> Vec<(String, World, Vec3)> {
    let mut worlds = Vec::new();
    for exponent in [-5, -3, 0, 3, 5] {
        for shift in [0.0, 7.3, 1000.0] {
            let scale = 10f32.powi(exponent);
            let middle = Vec3::new(1.0, -0.7, 0.4) * shift * scale;
            let transform =
                Affine3A::from_translation(middle) * Affine3A::from_scale(Vec3::splat(scale));
            let name = format!("scale {scale}, shift {shift}");
            worlds.push((
                format!("flat, {name}"),
                placed(mesh.clone(), transform),
                middle,
            ));
            worlds.push((
                format!("instance, {name}"),
                instanced(mesh.clone(), transform),
                middle,
            ));
        }
    }
    worlds
}

#[test]
fn spawned_rays_neither_meet_nor_pass_their_surface() {
    for mesh in [icosphere(3), cube(3)] {
        for (name, world, middle) in worlds(&mesh) {
            let seen = walk(&world, &mut Random(1), middle, 3000, Ray::spawn);
            assert_eq!((seen.own, seen.lost), (0, 0), "{name}");
        }
    }
}

#[test]
#[ignore = "long"]
fn spawned_rays_neither_meet_nor_pass_their_surface_in_many() {
    for mesh in [icosphere(3), cube(3)] {
        for (name, world, middle) in worlds(&mesh) {
            let seen = walk(&world, &mut Random(1), middle, 1_000_000, Ray::spawn);
            assert_eq!((seen.own, seen.lost), (0, 0), "{name}");
        }
    }
}

/// The walk sees a spawn that does nothing, and one that moves to the wrong side.
#[test]
fn planted_faults_are_seen() {
    let world = placed(icosphere(3), Affine3A::from_translation(Vec3::splat(7.3)));
    let still = walk(&world, &mut Random(1), Vec3::splat(7.3), 3000, |s, d| {
        Ray::new(s.position, d)
    });
    assert!(still.own + still.lost > 0, "{still:?}");
    let wrong = walk(&world, &mut Random(1), Vec3::splat(7.3), 3000, |s, d| Ray {
        direction: d,
        ..Ray::spawn(s, -d)
    });
    assert!(wrong.own + wrong.lost > 0, "{wrong:?}");
}

/// Inside a convex mesh any two points see each other; a plate between them hides them.
#[test]
fn shadow_rays_meet_neither_end() {
    for mesh in [icosphere(3), cube(3)] {
        for (name, world, _) in worlds(&mesh) {
            let mut random = Random(2);
            let triangles = if mesh.triangle_count() == 1280 {
                1280.0
            } else {
                108.0
            };
            let mut pick = || {
                let (u, v) = (random.unit(), random.unit());
                let (u, v) = if u + v > 1.0 {
                    (1.0 - u, 1.0 - v)
                } else {
                    (u, v)
                };
                world.surface_at(0, (random.unit() * triangles) as u32, u, v)
            };
            for _ in 0..1500 {
                let (a, b) = (pick(), pick());
                let apart = |s: &Surface, t: &Surface| {
                    let d = t.position - s.position;
                    d.dot(s.geometric_normal).abs() / d.length()
                };
                // Not two points of one side of the cube, or neighbours on what rounding makes one plane.
                let ulps = a
                    .position_error
                    .max_element()
                    .max(b.position_error.max_element());
                let clear = 1e-3 + 100.0 * ulps / a.position.distance(b.position);
                if apart(&a, &b) > clear && apart(&b, &a) > clear {
                    let ray = Ray::between(&a, &b);
                    assert!(
                        !world.occluded(&ray),
                        "{name}: {a:?} {b:?} {:?}",
                        world.intersect(&ray)
                    );
                    // Far enough behind for the rounded coordinates to tell.
                    let depth = apart(&b, &a) * a.position.distance(b.position);
                    let behind = Ray {
                        t_max: (1.0 + 20.0 * ulps / depth).max(1.001),
                        ..ray
                    };
                    assert!(world.occluded(&behind), "{name}: the far side is there");
                }
            }
        }
    }
}

#[test]
fn a_thin_plate_hides() {
    // A torus' tube from outside: the two surfaces across the tube must not see each other through it.
    let world = placed(torus(40, 20, 0.3), Affine3A::IDENTITY);
    let mut random = Random(3);
    for _ in 0..3000 {
        let s = world.surface_at(
            0,
            (random.unit() * 1600.0) as u32,
            random.unit() * 0.5,
            random.unit() * 0.5,
        );
        let through = Ray::spawn(&s, -s.geometric_normal + random.direction() * 0.3);
        assert!(world.occluded(&through));
        let point = s.position + s.geometric_normal * 1e-3;
        assert!(!world.occluded(&Ray::towards(&s, point)));
        let point = s.position - s.geometric_normal;
        assert!(world.occluded(&Ray::towards(&s, point)));
    }
}

/// A world and a copy of it a power of two larger answer with the same bits.
#[test]
fn scale_changes_nothing() {
    let mut random = Random(4);
    let mesh = random.soup(500);
    for exponent in [-12, -5, 9] {
        let scale = 2f32.powi(exponent);
        let (one, other) = (
            placed(mesh.clone(), Affine3A::IDENTITY),
            placed(mesh.clone(), Affine3A::from_scale(Vec3::splat(scale))),
        );
        for _ in 0..3000 {
            let ray = Ray::new(random.cube(), random.direction());
            let bigger = Ray {
                origin: ray.origin * scale,
                ..ray
            };
            let (a, b) = (one.intersect(&ray), other.intersect(&bigger));
            assert_eq!(
                a.map(|h| (h.primitive, h.t * scale, h.u, h.v)),
                b.map(|h| (h.primitive, h.t, h.u, h.v))
            );
            if let (Some(a), Some(b)) = (a, b) {
                let d = random.direction();
                let (a, b) = (
                    Ray::spawn(&one.surface(&ray, &a), d),
                    Ray::spawn(&other.surface(&bigger, &b), d),
                );
                assert!((a.origin * scale).abs_diff_eq(b.origin, scale * 1e-7));
                assert_eq!(
                    one.intersect(&a).map(|h| h.primitive),
                    other.intersect(&b).map(|h| h.primitive)
                );
            }
        }
    }
}
