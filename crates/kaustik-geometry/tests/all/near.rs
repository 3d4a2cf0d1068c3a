//! Triangles near a ball.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use kaustik_geometry::{Instance, Motion, World};

use crate::support::{Random, instanced, placed, single};

/// All that is offered near a ball.
fn near(world: &World, center: Vec3, radius: f32) -> Vec<[Vec3; 3]> {
    let mut offered = Vec::new();
    let any = world.any_near(center, radius, |corners| {
        offered.push(corners);
        false
    });
    assert!(!any);
    offered
}

fn same(a: &[Vec3; 3], b: &[Vec3; 3]) -> bool {
    let near = |(p, q): (&Vec3, &Vec3)| p.abs_diff_eq(*q, 1e-4 * (1.0 + q.abs().max_element()));
    a.iter().zip(b).all(near)
}

/// Whatever the structure: a triangle one of whose points lies in the ball is offered, once, and most others are not.
#[test]
fn all_that_reach_into_a_ball_are_offered() {
    let mut random = Random(8);
    for number in 0..30 {
        let (mesh, transform) = (random.soup(600), random.transform());
        let world = match number % 3 {
            0 => single(mesh),
            1 => placed(mesh, transform),
            _ => instanced(mesh, transform),
        };
        let transform = world.instances()[0].transform;
        let mirrored = transform.matrix3.determinant() < 0.0;
        for primitive in 0..600 {
            let [a, b, c] = world.triangle(0, primitive);
            let (radius, [u, v]) = (0.05 * random.unit() + 1e-3, [random.unit(), random.unit()]);
            let (u, v) = if u + v > 1.0 {
                (1.0 - u, 1.0 - v)
            } else {
                (u, v)
            };
            let point = a + (b - a) * u + (c - a) * v;
            let center = point + random.direction() * (0.9 * radius);
            let offered = near(&world, center, radius);
            let front = if mirrored { [a, c, b] } else { [a, b, c] };
            let times = offered.iter().filter(|other| same(other, &front)).count();
            assert_eq!(times, 1, "{number} {primitive}");
            assert!(offered.len() < 200, "{}", offered.len());
        }
        assert!(near(&world, Vec3::splat(50.0), 1.0).is_empty());
    }
}

/// The same of what moves, for the instant.
#[test]
fn what_moves_is_near_where_it_stands() {
    let mut random = Random(10);
    for _ in 0..10 {
        let mesh = Arc::new(random.soup(200));
        let keys = [0.0, 1.0].map(|time| (time, random.transform()));
        let motion = Motion::new(keys.to_vec()).unwrap();
        let transform = Affine3A::IDENTITY;
        let instance = Instance { mesh: 0, transform };
        let moving = World::moving(
            vec![mesh.clone()],
            vec![instance],
            vec![(0, motion.clone())],
        );
        let moving = moving.unwrap();
        for time in [0.0, 0.4, 1.0] {
            let (world, transform) = (moving.at(time), motion.at(time));
            let mirrored = transform.matrix3.determinant() < 0.0;
            for primitive in 0..200 {
                let [a, b, c] = mesh
                    .corners(primitive)
                    .map(|p| transform.transform_point3(p));
                let radius = 0.05 * random.unit() + 1e-3;
                let center = (a + b + c) / 3.0 + random.direction() * (0.9 * radius);
                let front = if mirrored { [a, c, b] } else { [a, b, c] };
                let offered = near(&world, center, radius);
                let times = offered.iter().filter(|other| same(other, &front)).count();
                assert_eq!(times, 1, "{time} {primitive}");
            }
        }
    }
}

/// Balls that reach everywhere, or nowhere that there is.
#[test]
fn balls_without_end_are_looked_into() {
    let mut random = Random(12);
    let transform = random.transform();
    let motion = Motion::new(vec![(0.0, transform), (1.0, Affine3A::IDENTITY)]).unwrap();
    let instance = Instance { mesh: 0, transform };
    let mesh = Arc::new(random.soup(50));
    let moving = World::moving(vec![mesh], vec![instance], vec![(0, motion)]).unwrap();
    for world in [moving, instanced(random.soup(50), transform)] {
        for radius in [f32::INFINITY, 2e38, f32::MAX] {
            for center in [Vec3::ZERO, Vec3::splat(1e38)] {
                let count = near(&world, center, radius).len();
                assert!(count >= 50, "{center} {radius}: {count}");
            }
        }
        for (center, radius) in [
            (Vec3::ZERO, f32::NAN),
            (Vec3::NAN, 1.0),
            (Vec3::INFINITY, f32::INFINITY),
        ] {
            assert!(near(&world, center, radius).is_empty());
        }
    }
}

/// The look ends with the first that counts.
#[test]
fn one_that_counts_is_enough() {
    let world = placed(Random(9).soup(100), Affine3A::IDENTITY);
    let mut offered = 0;
    assert!(world.any_near(Vec3::ZERO, 2.0, |_| {
        offered += 1;
        offered == 3
    }));
    assert_eq!(offered, 3);
}
