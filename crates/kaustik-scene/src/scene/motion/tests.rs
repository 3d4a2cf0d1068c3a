use glam::DVec3;

use super::*;
use crate::description::Interpolation;
use crate::testing::{channel, joint};

/// Two joints, one upon the other: a turn by half a circle about z in two steps below a way along x, seen from 1 s
/// to 3 s.
fn turning() -> AnimationDescription {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let mut carrier = joint();
    carrier.translation = Some(channel(
        Interpolation::Linear,
        &[0.0, 4.0],
        &[[0.0; 3], [8.0, 0.0, 0.0]],
    ));
    let mut turned = joint();
    turned.parent = Some(0);
    turned.rotation = Some(channel(
        Interpolation::Linear,
        &[1.0, 2.0, 3.0],
        &[
            [0.0, 0.0, 0.0, 1.0],
            [0.0, 0.0, half, half],
            // The same rotation from the far side: the shorter arc leads to its opposite.
            [0.0, 0.0, -1.0, 0.0],
        ],
    ));
    AnimationDescription {
        joints: vec![carrier, turned],
        carried: vec![Carried {
            load: Load::Camera(0),
            joint: 1,
            offset: DAffine3::IDENTITY,
        }],
    }
}

fn clock(animation: &AnimationDescription, open: f32, close: f32) -> Clock<'_> {
    Clock {
        animation,
        shutter: Shutter { open, close },
        left: MOST,
    }
}

/// A point goes the way that the closed form says, at times that are no keys, as near as was promised.
#[test]
fn keys_keep_to_the_arc() {
    let animation = turning();
    let carried = animation.carried[0];
    let points = [DVec3::ZERO, DVec3::X * 3.0];
    let motion = clock(&animation, 1.0, 3.0).motion(&carried, &points);
    let motion = motion.expect("a sound motion");
    for step in 0..=1000_u32 {
        let share = f64::from(step) / 1000.0;
        let angle = std::f64::consts::PI * share;
        let expected = DVec3::new(
            2.0 + 4.0 * share + 3.0 * libm::cos(angle),
            3.0 * libm::sin(angle),
            0.0,
        );
        let found = motion
            .at(share as f32)
            .transform_point3(glam::Vec3::X * 3.0);
        let off = (found.as_dvec3() - expected).length();
        assert!(off < 3.0 * TOLERANCE + 1e-5, "{share}: off by {off}");
    }
    assert!(motion.keys().len() < 1000, "{}", motion.keys().len());
}

/// Step: nothing moves but at the key, where it jumps.
#[test]
fn steps_jump() {
    let mut animation = turning();
    animation.joints[0].translation = Some(channel(
        Interpolation::Step,
        &[0.0, 2.0],
        &[[1.0, 0.0, 0.0], [5.0, 0.0, 0.0]],
    ));
    let carried = Carried {
        joint: 0,
        ..animation.carried[0]
    };
    let motion = clock(&animation, 0.0, 4.0).motion(&carried, &[DVec3::ZERO]);
    let motion = motion.expect("a sound motion");
    for (share, x) in [(0.0, 1.0), (0.49, 1.0), (0.51, 5.0), (1.0, 5.0)] {
        let found = motion.at(share).translation.x;
        assert!((found - x).abs() < 1e-6, "{share}: {found}");
    }
    assert_eq!(motion.keys().len(), 4);
}

/// A cubic spline through zeros that leaves at 4 a second and arrives at -2.
#[test]
fn splines_follow_their_tangents() {
    let mut animation = turning();
    let (up, down) = ([0.0, 4.0, 0.0], [0.0, -2.0, 0.0]);
    animation.joints[0].translation = Some(channel(
        Interpolation::CubicSpline,
        &[0.0, 2.0],
        &[[9.0; 3], [0.0; 3], up, down, [0.0; 3], [9.0; 3]],
    ));
    let carried = Carried {
        joint: 0,
        ..animation.carried[0]
    };
    let motion = clock(&animation, 0.0, 2.0).motion(&carried, &[DVec3::ZERO]);
    let motion = motion.expect("a sound motion");
    for step in 0..=100_u32 {
        let t = f64::from(step) / 100.0;
        let expected = 2.0 * t * (1.0 - t) * (4.0 * (1.0 - t) + 2.0 * t);
        let found = f64::from(motion.at(t as f32).translation.y);
        assert!((found - expected).abs() < 1e-3, "{t}: {found} {expected}");
    }
}

/// A shutter that opens for no time sees one instant.
#[test]
fn an_instant_is_still() {
    let animation = turning();
    let motion = clock(&animation, 2.0, 2.0).motion(&animation.carried[0], &[DVec3::X]);
    let motion = motion.expect("a sound motion");
    assert!(motion.is_still());
    let found = motion.at(0.3).transform_point3(glam::Vec3::X);
    assert!(
        (found - glam::Vec3::new(4.0, 1.0, 0.0)).length() < 1e-6,
        "{found}"
    );
}

/// Also where something jumps at that very time: it has jumped.
#[test]
fn an_instant_of_a_jump_is_still() {
    let mut animation = turning();
    animation.joints[0].translation = Some(channel(
        Interpolation::Step,
        &[0.0, 2.0],
        &[[0.0; 3], [8.0, 0.0, 0.0]],
    ));
    animation.joints[1].rotation = None;
    let motion = clock(&animation, 2.0, 2.0).motion(&animation.carried[0], &[DVec3::X]);
    let motion = motion.expect("a sound motion");
    assert!(motion.is_still());
    for time in [0.0, 0.9999, 1.0] {
        let found = motion.at(time).transform_point3(glam::Vec3::X);
        assert!(
            (found - glam::Vec3::new(9.0, 0.0, 0.0)).length() < 1e-6,
            "{found}"
        );
    }
}

/// What would take too many keys is refused before it is made.
#[test]
fn too_much_is_refused() {
    let animation = turning();
    let mut clock = clock(&animation, 1.0, 3.0);
    clock.left = 10;
    let result = clock.motion(&animation.carried[0], &[DVec3::ZERO, DVec3::X]);
    assert!(
        matches!(result, Err(SceneError::Animation { .. })),
        "{result:?}"
    );
}
