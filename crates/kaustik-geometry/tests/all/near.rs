//! Triangles near a ball.

use glam::{Affine3A, Vec3};
use kaustik_geometry::World;

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
