//! Against a loop in double precision, against obvhs' binary tree, and between the two implementations.

use std::sync::Arc;
use std::time::Duration;

use glam::{Affine3A, Vec3};
use kaustik_geometry::{Hit, Instance, Ray, World};
use obvhs::BvhBuildParams;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::triangle::Triangle;
use proptest::prelude::*;

use crate::support::{Random, agrees, all_hits, icosphere, instanced, single};

fn ray(random: &mut Random) -> Ray {
    Ray::new(
        random.cube() * 2.5,
        random.direction() * (0.1 + 3.0 * random.unit()),
    )
}

/// Meshes placed once (flattened), a large one placed several times (with its own tree), mirrored and sheared ones.
fn mixed(random: &mut Random) -> World {
    let meshes = vec![
        Arc::new(random.soup(200)),
        Arc::new(random.soup(4000)),
        Arc::new(random.soup(1)),
    ];
    let instances = [0, 1, 1, 2, 1, 1, 1, 2].map(|mesh| Instance {
        mesh,
        transform: random.transform(),
    });
    World::build(meshes, instances.to_vec()).unwrap()
}

#[test]
fn closest_hits_agree_with_the_loop() {
    let mut random = Random(1);
    for triangles in [1, 2, 7, 8, 9, 30, 100, 700] {
        let world = single(random.soup(triangles));
        for _ in 0..600 {
            let ray = ray(&mut random);
            agrees(&world, &ray, world.intersect(&ray)).unwrap();
        }
    }
}

#[test]
fn instances_agree_with_the_loop() {
    let mut random = Random(2);
    let world = mixed(&mut random);
    for _ in 0..600 {
        let ray = Ray {
            origin: random.cube() * 5.0,
            ..ray(&mut random)
        };
        agrees(&world, &ray, world.intersect(&ray)).unwrap();
    }
}

#[test]
fn any_hit_agrees_with_closest() {
    let mut random = Random(3);
    for world in [single(random.soup(500)), mixed(&mut random)] {
        for _ in 0..5000 {
            let ray = Ray {
                t_max: random.unit() * 3.0,
                ..ray(&mut random)
            };
            assert_eq!(
                world.occluded(&ray),
                world.intersect(&ray).is_some(),
                "{ray:?}"
            );
        }
    }
}

/// obvhs' own tree and triangle test: not watertight, so that a few rays near edges may differ.
#[test]
fn closest_hits_agree_with_obvhs() {
    let mut random = Random(4);
    let mesh = icosphere(5);
    let world = single(mesh.clone());
    let triangles: Vec<Triangle> = (0..mesh.triangle_count() as u32)
        .map(|i| mesh.corners(i))
        .map(|[a, b, c]| Triangle {
            v0: a.into(),
            v1: b.into(),
            v2: c.into(),
        })
        .collect();
    let tree = build_bvh2_from_tris(
        &triangles,
        BvhBuildParams::medium_build(),
        &mut Duration::default(),
    );
    let mut different = 0;
    for _ in 0..20_000 {
        let ray = ray(&mut random);
        let theirs = obvhs::ray::Ray::new_inf(ray.origin.into(), ray.direction.into());
        let mut found = obvhs::ray::RayHit::none();
        let hit = tree.ray_traverse(theirs, &mut found, |ray, slot| {
            triangles[tree.primitive_indices[slot] as usize].intersect(ray)
        });
        let ours = world.intersect(&ray);
        different += u32::from(hit != ours.is_some());
        if let (true, Some(ours)) = (hit, ours) {
            different += u32::from((ours.t - found.t).abs() > 1e-4 * found.t);
        }
    }
    assert!(different <= 4, "{different} of 20000");
}

fn bits(hit: Option<Hit>) -> Option<[u32; 5]> {
    hit.map(|h| {
        [
            h.t.to_bits(),
            h.u.to_bits(),
            h.v.to_bits(),
            h.instance,
            h.primitive,
        ]
    })
}

#[test]
fn vector_and_portable_walks_give_the_same_bits() {
    for seed in 0..4 {
        let mut random = Random(seed);
        let build = |seed| match seed {
            0 => mixed(&mut Random(9)),
            1 => single(icosphere(4)),
            2 => single(Random(10).soup(3000)),
            _ => instanced(icosphere(3), Random(11).transform()),
        };
        let (fast, plain) = (build(seed), build(seed).portable());
        for _ in 0..10_000 {
            let ray = ray(&mut random);
            let hit = fast.intersect(&ray);
            assert_eq!(bits(hit), bits(plain.intersect(&ray)), "{ray:?}");
            assert_eq!(fast.occluded(&ray), plain.occluded(&ray));
            if let Some(hit) = hit {
                // Rays from the surface exercise the double-precision path.
                let next = Ray::spawn(&fast.surface(&ray, &hit), random.direction());
                assert_eq!(
                    bits(fast.intersect(&next)),
                    bits(plain.intersect(&next)),
                    "{next:?}"
                );
            }
        }
    }
}

/// Answers are the same bits on every machine, in every build, with and without the feature `parallel`: they depend on
/// the ray and the triangles alone, not on the tree.
#[test]
fn answers_are_pinned() {
    let mix = |hash: u64, word: u32| (hash ^ u64::from(word)).wrapping_mul(0x0100_0000_01b3);
    let mut hash = 0xcbf2_9ce4_8422_2325;
    for mesh in [icosphere(5), Random(7).soup(3000)] {
        let world = single(mesh);
        let mut random = Random(12);
        for _ in 0..20_000 {
            let found = bits(world.intersect(&ray(&mut random)));
            hash = found.unwrap_or_default().into_iter().fold(hash, mix);
        }
    }
    assert_eq!(hash, 0x4716_5339_694c_ea21, "{hash:#x}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Whatever the mesh and the ray: the loop agrees, and the two walks do.
    #[test]
    fn any_soup_agrees(seed in any::<u64>(), triangles in 1u32..60, exponent in -6i32..6) {
        let mut random = Random(seed);
        let scale = 4f32.powi(exponent);
        let mesh = random.soup(triangles);
        let world = crate::support::placed(mesh, Affine3A::from_scale(Vec3::splat(scale)));
        let plain = single(random.soup(1)).portable();
        prop_assert!(plain.triangle_count() == 1);
        for _ in 0..20 {
            let ray = ray(&mut random);
            // In units of the world, so that the oracle's tolerance is.
            let ray = Ray { origin: ray.origin * scale, direction: ray.direction * scale, ..ray };
            if let Err(fault) = agrees(&world, &ray, world.intersect(&ray)) {
                return Err(TestCaseError::fail(fault));
            }
        }
    }

    /// Rays of any bits at all, also through instances: no panic, and the two walks agree.
    #[test]
    fn any_ray_is_survived(bits_of in prop::array::uniform8(any::<u32>())) {
        thread_local!(static WORLDS: [World; 2] = [mixed(&mut Random(5)), mixed(&mut Random(5)).portable()]);
        let f = bits_of.map(f32::from_bits);
        let ray = Ray {
            origin: Vec3::new(f[0], f[1], f[2]),
            direction: Vec3::new(f[3], f[4], f[5]),
            t_min: f[6],
            t_max: f[7],
        };
        WORLDS.with(|[fast, plain]| {
            prop_assert_eq!(bits(fast.intersect(&ray)), bits(plain.intersect(&ray)));
            prop_assert_eq!(fast.occluded(&ray), plain.occluded(&ray));
            Ok(())
        })?;
    }
}

#[test]
fn every_hit_is_met_once_in_order() {
    let mut random = Random(6);
    for world in [single(random.soup(300)), mixed(&mut random)] {
        for _ in 0..200 {
            let ray = ray(&mut random);
            let certain: Vec<_> = all_hits(&world, &ray)
                .into_iter()
                .filter(|h| h.3 > 1e-4)
                .collect();
            let mut met = Vec::new();
            let mut next = world.intersect(&ray);
            while let Some(hit) = next {
                met.push((hit.instance, hit.primitive));
                let after = world.intersect_after(&ray, &hit, |_| true);
                assert!(after.is_none_or(|a| hit.precedes(&a)));
                next = after;
            }
            for h in certain {
                let times = met.iter().filter(|&&m| m == (h.1, h.2)).count();
                assert_eq!(times, 1, "{h:?} of {ray:?}");
            }
        }
    }
}
