//! The maps of the square keep area, are continuous, and agree with their densities.

use crate::support::{Random, at};
use glam::DVec3;
use kaustik_bsdf::{Frame, warp};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// Directions from here and from a millionth beside it.
fn assert_near([a, b]: [f64; 2], turn: f64) {
    let (s, c) = warp::sin_cos_turns(turn);
    let near = [a + 1e-6 * s, b + 1e-6 * c].map(|x| x.clamp(0.0, 1.0));
    for map in [warp::uniform_sphere, |u| warp::uniform_cone(u, 0.3)] {
        // the rim of the disk is one point of the sphere, reached like a root
        assert!(map([a, b]).distance(map(near)) < 1e-2);
        assert!((map([a, b]).length() - 1.0).abs() < 1e-12);
    }
    let [x, y] = warp::concentric_disk([a, b]);
    let [p, q] = warp::concentric_disk(near);
    assert!((x - p).hypot(y - q) < 1e-5 && x.hypot(y) <= 1.0 + 1e-15);
}

#[test]
fn the_rim_is_near_itself() {
    assert_near([0.0, 0.988_182_714_123_845], 0.465_299_139_554_575_74);
}

proptest! {
    #[test]
    fn sine_and_cosine_are_right(turns in -3.0f64..3.0) {
        let (s, c) = warp::sin_cos_turns(turns);
        prop_assert!((s - (turns * TAU).sin()).abs() < 4e-15);
        prop_assert!((c - (turns * TAU).cos()).abs() < 4e-15);
        prop_assert!((s * s + c * c - 1.0).abs() < 1e-14);
    }

    #[test]
    fn near_numbers_give_near_directions(a in 0.0f64..1.0, b in 0.0f64..1.0, turn in 0.0f64..1.0) {
        assert_near([a, b], turn);
    }

    #[test]
    fn frames_are_orthonormal(z in -1.0f64..1.0, turns in 0.0f64..1.0, t in 0.0f64..1.0) {
        let normal = at(z, turns);
        for frame in [Frame::from_z(normal), Frame::from_z_x(normal, at(0.3, t)), Frame::from_z_x(normal, normal)] {
            prop_assert!((frame.x.cross(frame.y) - frame.z).length() < 1e-12);
            prop_assert!((frame.x.length() - 1.0).abs() < 1e-12 && frame.x.dot(frame.z).abs() < 1e-12);
            let w = at(-0.4, 0.2);
            prop_assert!((frame.to_world(frame.to_local(w)) - w).length() < 1e-12);
        }
    }
}

#[test]
fn frames_are_right_handed_at_the_poles() {
    for z in [DVec3::Z, -DVec3::Z, DVec3::X, -DVec3::Y] {
        let frame = Frame::from_z(z);
        assert!((frame.x.cross(frame.y) - z).length() < 1e-15);
    }
    let frame = Frame::from_z_x(DVec3::Z, DVec3::new(3.0, 0.0, 1.0));
    assert!((frame.x - DVec3::X).length() < 1e-15);
}

/// Mean of `f` over the map's points.
fn mean(f: impl Fn([f64; 2]) -> f64) -> f64 {
    let n = 400;
    let at = |i: usize| (i as f64 + 0.5) / f64::from(n);
    let cells = (n * n) as usize;
    (0..cells)
        .map(|i| f([at(i % n as usize), at(i / n as usize)]))
        .sum::<f64>()
        / cells as f64
}

#[test]
fn moments_are_those_of_the_density() {
    assert!((mean(|u| warp::cosine_hemisphere(u).z) - 2.0 / 3.0).abs() < 1e-4);
    assert!((mean(|u| warp::cosine_hemisphere(u).x.powi(2)) - 0.25).abs() < 1e-4);
    assert!((mean(|u| warp::uniform_sphere(u).z.powi(2)) - 1.0 / 3.0).abs() < 1e-4);
    assert!((mean(|u| warp::uniform_sphere(u).x.powi(4)) - 0.2).abs() < 1e-4);
    assert!((mean(|u| warp::uniform_cone(u, 0.2).z) - 0.6).abs() < 1e-4);
    assert!((mean(|u| warp::uniform_triangle(u)[0]) - 1.0 / 3.0).abs() < 1e-4);
    assert!((mean(|u| warp::uniform_triangle(u)[0].powi(2)) - 1.0 / 6.0).abs() < 1e-4);
    assert!((mean(|u| warp::uniform_triangle(u).iter().product()) - 1.0 / 12.0).abs() < 1e-4);
    let norm = mean(|u| warp::uniform_cone_pdf(0.2) * TAU * 0.8 + 0.0 * u[0]);
    assert!((norm - 1.0).abs() < 1e-12);
}

#[test]
fn triangles_are_filled_evenly() {
    let mut random = Random::new(12);
    let mut counts = [0.0f64; 4];
    for _ in 0..40_000 {
        let [b, c] = warp::uniform_triangle([random.uniform(), random.uniform()]);
        assert!(b >= 0.0 && c >= 0.0 && b + c <= 1.0);
        // the four triangles that halving the edges gives
        let which = if b > 0.5 {
            0
        } else if c > 0.5 {
            1
        } else if b + c < 0.5 {
            2
        } else {
            3
        };
        counts[which] += 1.0;
    }
    let chi2: f64 = counts
        .iter()
        .map(|c| (c - 10_000.0).powi(2) / 10_000.0)
        .sum();
    assert!(chi2 < 16.3, "{counts:?}");
}
