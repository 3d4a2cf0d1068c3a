//! Layers at equal distance, and filters.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{Affine3A, Vec2, Vec3};
use kaustik_geometry::{Instance, Mesh, Ray, World};

use crate::support::{Random, single};

/// `copies` identical triangles in one mesh, of which `instances` lie at the same place.
fn pile(copies: u32, instances: usize) -> World {
    let positions = vec![
        Vec3::new(-1.0, -1.0, 0.3),
        Vec3::new(2.0, -1.0, 0.1),
        Vec3::new(-1.0, 2.0, 0.2),
    ];
    let mesh = Mesh::new(positions, vec![[0, 1, 2]; copies as usize]).unwrap();
    let placed = Instance {
        mesh: 0,
        transform: Affine3A::IDENTITY,
    };
    World::build(vec![Arc::new(mesh)], vec![placed; instances]).unwrap()
}

#[test]
fn layers_at_one_place_are_each_met_once() {
    // Flattened, and (the last) with a tree of their own.
    for (copies, instances) in [(1, 1), (5, 1), (40, 1), (3, 7), (6000, 3)] {
        for world in [pile(copies, instances), pile(copies, instances).portable()] {
            let ray = Ray::new(Vec3::new(0.1, -0.2, -1.0), Vec3::new(0.05, 0.1, 1.0));
            let (mut next, mut met) = (world.intersect(&ray), HashMap::new());
            let limit = 200;
            while let Some(hit) = next
                && met.len() < limit
            {
                *met.entry((hit.instance, hit.primitive)).or_insert(0) += 1;
                next = world.intersect_after(&ray, &hit, |_| true);
            }
            assert_eq!(met.len(), (copies as usize * instances).min(limit));
            assert!(met.values().all(|&n| n == 1));
        }
    }
}

#[test]
fn the_least_identifier_wins_a_tie() {
    let world = pile(20, 3);
    let ray = Ray::new(Vec3::new(0.1, -0.2, -1.0), Vec3::Z);
    let hit = world.intersect(&ray).unwrap();
    assert_eq!((hit.instance, hit.primitive), (0, 0));
    let odd = world
        .intersect_filtered(&ray, |h| h.primitive % 2 == 1 && h.instance == 2)
        .unwrap();
    assert_eq!((odd.instance, odd.primitive), (2, 1));
}

#[test]
fn filters_are_asked_at_most_once_about_each() {
    let mut random = Random(1);
    let world = single(random.soup(2000));
    for _ in 0..500 {
        let ray = Ray::new(random.cube() * 2.0, random.direction());
        let mut asked = HashMap::new();
        let hit = world.intersect_filtered(&ray, |h| {
            *asked.entry((h.instance, h.primitive)).or_insert(0) += 1;
            h.primitive % 3 == 0
        });
        assert!(asked.values().all(|&n| n == 1));
        let mut offered = HashMap::new();
        let blocked = world.occluded_filtered(&ray, |h| {
            *offered.entry((h.instance, h.primitive)).or_insert(0) += 1;
            h.primitive % 3 == 0
        });
        assert!(offered.values().all(|&n| n == 1));
        assert_eq!(blocked, hit.is_some());
        // A filter that counts nothing sees everything on the ray.
        let mut seen = 0;
        assert!(!world.occluded_filtered(&ray, |_| {
            seen += 1;
            false
        }));
        let (mut all, mut next) = (0, world.intersect(&ray));
        while let Some(hit) = next {
            all += 1;
            next = world.intersect_after(&ray, &hit, |_| true);
        }
        assert_eq!(seen, all);
    }
}

#[test]
fn an_alpha_test_reads_texture_coordinates_and_colours() {
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let mesh = Mesh::new(positions, vec![[0, 1, 2]])
        .and_then(|m| m.with_uv([vec![Vec2::ZERO, Vec2::X, Vec2::Y], vec![]]))
        .and_then(|m| m.with_colors(vec![[0.0; 4], [1.0; 4], [0.5; 4]]))
        .unwrap();
    let world = single(mesh);
    let ray = |x, y| Ray::new(Vec3::new(x, y, 1.0), -Vec3::Z);
    let left = |r: &Ray| {
        world
            .intersect_filtered(r, |h| world.uv(h, 0).x < 0.5)
            .is_some()
    };
    assert!(left(&ray(0.25, 0.25)) && !left(&ray(0.75, 0.2)));
    let hit = world.intersect(&ray(0.25, 0.5)).unwrap();
    assert!((world.color(&hit)[3] - 0.5).abs() < 1e-6);
    assert_eq!(world.uv(&hit, 1), Vec2::ZERO);
}
