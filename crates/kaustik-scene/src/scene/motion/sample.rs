//! The value of a sampler at a time (glTF 2.0, appendix C).

use glam::{DAffine3, DQuat, DVec3};

use crate::description::{Channel, Interpolation, Joint};

/// Of a jump, the value before it or after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Before,
    After,
}

/// A joint's own transform to its parent at a time in seconds.
pub(super) fn local(joint: &Joint, seconds: f64, side: Side) -> DAffine3 {
    let vector = |channel: &Option<Channel<3>>, rest: [f32; 3]| {
        let value = match channel {
            Some(channel) => sample(channel, seconds, side, straight),
            None => rest.map(f64::from),
        };
        DVec3::from_array(value)
    };
    let rotation = match &joint.rotation {
        Some(channel) => sample(channel, seconds, side, arc),
        None => joint.rest.rotation.map(f64::from),
    };
    DAffine3::from_scale_rotation_translation(
        vector(&joint.scale, joint.rest.scale),
        DQuat::from_array(unit(rotation)),
        vector(&joint.translation, joint.rest.translation),
    )
}

/// Tells `each` key of a joint between two times, these left out: its time, and whether the value may jump there. Takes no time for
/// those outside: every copy of what moves asks.
pub(super) fn keys(joint: &Joint, [open, close]: [f64; 2], mut each: impl FnMut(f64, bool)) {
    let mut of = |interpolation: Interpolation, times: &[f32]| {
        let first = times.partition_point(|&time| f64::from(time) <= open);
        let within = times[first..].iter();
        for &time in within.take_while(|time| f64::from(**time) < close) {
            each(f64::from(time), interpolation == Interpolation::Step);
        }
    };
    for channel in [&joint.translation, &joint.scale].into_iter().flatten() {
        of(channel.interpolation, &channel.times);
    }
    if let Some(channel) = &joint.rotation {
        of(channel.interpolation, &channel.times);
    }
}

/// Has it keys in order, values for them, and are all numbers finite?
pub(super) fn is_sound(joint: &Joint) -> bool {
    let vectors = [&joint.translation, &joint.scale].into_iter().flatten();
    vectors.into_iter().all(is_sound_channel) && joint.rotation.iter().all(is_sound_channel)
}

fn is_sound_channel<const N: usize>(channel: &Channel<N>) -> bool {
    let Channel {
        interpolation,
        times,
        values,
    } = channel;
    let each = if *interpolation == Interpolation::CubicSpline {
        3
    } else {
        1
    };
    !times.is_empty()
        && times.iter().all(|time| time.is_finite())
        && times.windows(2).all(|pair| pair[0] < pair[1])
        && times.len().checked_mul(each) == Some(values.len())
        && values.as_flattened().iter().all(|value| value.is_finite())
}

fn sample<const N: usize>(
    channel: &Channel<N>,
    seconds: f64,
    side: Side,
    blend: impl Fn([f64; N], [f64; N], f64) -> [f64; N],
) -> [f64; N] {
    let Channel {
        interpolation,
        times,
        values,
    } = channel;
    let spline = *interpolation == Interpolation::CubicSpline;
    let wide = |index: usize| values[index].map(f64::from);
    let value = |key: usize| wide(if spline { 3 * key + 1 } else { key });
    let next = times.partition_point(|&key| match side {
        Side::After => f64::from(key) <= seconds,
        Side::Before => f64::from(key) < seconds,
    });
    if next == 0 {
        return value(0);
    }
    if next == times.len() {
        return value(next - 1);
    }
    let [t0, t1] = [next - 1, next].map(|key| f64::from(times[key]));
    let share = (seconds - t0) / (t1 - t0);
    let (a, b) = (value(next - 1), value(next));
    match interpolation {
        Interpolation::Step => a,
        Interpolation::Linear => blend(a, b, share),
        Interpolation::CubicSpline => {
            // Out of the key before, into the key after.
            let tangents = (wide(3 * next - 1), wide(3 * next));
            hermite(a, b, tangents, t1 - t0, share)
        }
    }
}

fn straight<const N: usize>(a: [f64; N], b: [f64; N], share: f64) -> [f64; N] {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share)
}

fn hermite<const N: usize>(
    a: [f64; N],
    b: [f64; N],
    (out, into): ([f64; N], [f64; N]),
    seconds: f64,
    t: f64,
) -> [f64; N] {
    let (t2, t3) = (t * t, t * t * t);
    std::array::from_fn(|i| {
        (2.0 * t3 - 3.0 * t2 + 1.0) * a[i]
            + seconds * (t3 - 2.0 * t2 + t) * out[i]
            + (3.0 * t2 - 2.0 * t3) * b[i]
            + seconds * (t3 - t2) * into[i]
    })
}

/// Along the shorter arc at even speed.
fn arc(a: [f64; 4], b: [f64; 4], share: f64) -> [f64; 4] {
    /// Beyond this cosine straight and round are the same.
    const NEAR: f64 = 1.0 - 1e-9;
    let (a, b) = (unit(a), unit(b));
    let dot: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    let b = if dot < 0.0 { b.map(|b| -b) } else { b };
    let cos = dot.abs();
    if cos >= NEAR {
        return straight(a, b, share);
    }
    let angle = libm::acos(cos);
    let weights = [(1.0 - share) * angle, share * angle].map(libm::sin);
    let whole = libm::sin(angle);
    std::array::from_fn(|i| (a[i] * weights[0] + b[i] * weights[1]) / whole)
}

/// Of length one; no rotation where there is no length.
fn unit(q: [f64; 4]) -> [f64; 4] {
    let length = q.iter().map(|q| q * q).sum::<f64>().sqrt();
    if length > 0.0 {
        q.map(|q| q / length)
    } else {
        [0.0, 0.0, 0.0, 1.0]
    }
}
