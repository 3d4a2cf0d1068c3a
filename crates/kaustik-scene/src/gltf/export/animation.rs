//! What moves: samplers and channels, and whether they came back.

use std::collections::HashMap;

use glam::{Affine3A, DAffine3};
use serde_json::{Value, json};

use super::writer::{Object, Writer, numbers};
use crate::Description;
use crate::description::{AnimationDescription, Carried, Channel, Interpolation, Joint, Load};

/// Matrices of a file are in single precision, but products of them on the way to what moves are not:
/// transforms of what moves come back to within this share of their largest number.
const NEAR: f64 = 1e-5;

/// Writes one animation with all channels; `nodes` are those of the joints.
pub(super) fn animation(writer: &mut Writer, animation: &AnimationDescription, nodes: &[usize]) {
    let mut tracks = Tracks::default();
    for (joint, &node) in animation.joints.iter().zip(nodes) {
        tracks.add(writer, joint.translation.as_ref(), node, "translation");
        tracks.add(writer, joint.rotation.as_ref(), node, "rotation");
        tracks.add(writer, joint.scale.as_ref(), node, "scale");
    }
    if !tracks.channels.is_empty() {
        let all = json!({ "channels": tracks.channels, "samplers": tracks.samplers });
        writer.set("animations", vec![all]);
    }
}

#[derive(Default)]
struct Tracks {
    channels: Vec<Value>,
    samplers: Vec<Value>,
}

impl Tracks {
    fn add<const N: usize>(
        &mut self,
        writer: &mut Writer,
        channel: Option<&Channel<N>>,
        node: usize,
        path: &str,
    ) {
        let Some(channel) = channel else {
            return;
        };
        let input = writer.floats(channel.times.iter().map(|&time| [time]));
        if let (Some(&first), Some(&last)) = (channel.times.first(), channel.times.last()) {
            writer.bound(input, &[first], &[last]);
        }
        let output = writer.floats(channel.values.iter().copied());
        let interpolation = match channel.interpolation {
            Interpolation::Step => "STEP",
            Interpolation::Linear => "LINEAR",
            Interpolation::CubicSpline => "CUBICSPLINE",
        };
        let sampler = json!({ "input": input, "output": output, "interpolation": interpolation });
        let target = json!({ "node": node, "path": path });
        let index = self.samplers.len();
        self.samplers.push(sampler);
        self.channels
            .push(json!({ "sampler": index, "target": target }));
    }
}

/// The node of a joint, but for what is below it.
pub(super) fn node(joint: &Joint) -> Object {
    let rest = &joint.rest;
    let unless = |values: &[f32], usual: &[f32]| (values != usual).then(|| numbers(values));
    Object::default()
        .named(&joint.name)
        .maybe("translation", unless(&rest.translation, &[0.0; 3]))
        .maybe("rotation", unless(&rest.rotation, &[0.0, 0.0, 0.0, 1.0]))
        .maybe("scale", unless(&rest.scale, &[1.0; 3]))
}

/// What was read back, with the original in the place of all transforms of what moves that are [`NEAR`] it, and what is
/// carried in its order.
pub(super) fn reconciled(original: &Description, mut read: Description) -> Description {
    let (before, after) = (&original.animation, &mut read.animation);
    for (a, b) in before.joints.iter().zip(&mut after.joints) {
        if near(&a.to_parent, &b.to_parent) {
            b.to_parent = a.to_parent;
        }
    }
    let places = before.carried.iter().map(|carried| carried.load).zip(0..);
    let places: HashMap<Load, usize> = places.collect();
    let place = |carried: &Carried| places.get(&carried.load).copied();
    after.carried.sort_by_key(place);
    for (a, b) in before.carried.iter().zip(&mut after.carried) {
        if near(&a.offset, &b.offset) {
            b.offset = a.offset;
        }
    }
    for Carried { load, .. } in &before.carried {
        let pair = match *load {
            Load::Instance(i) => original
                .instances
                .get(i)
                .zip(read.instances.get_mut(i))
                .map(|(a, b)| (a.transform, &mut b.transform)),
            Load::Light(i) => original
                .lights
                .get(i)
                .zip(read.lights.get_mut(i))
                .map(|(a, b)| (a.transform, &mut b.transform)),
            Load::Camera(i) => original
                .cameras
                .get(i)
                .zip(read.cameras.get_mut(i))
                .map(|(a, b)| (a.transform, &mut b.transform)),
        };
        if let Some((a, b)) = pair
            && near(&double(&a), &double(b))
        {
            *b = a;
        }
    }
    read
}

fn double(transform: &Affine3A) -> DAffine3 {
    DAffine3::from_cols_array(&transform.to_cols_array().map(f64::from))
}

fn near(a: &DAffine3, b: &DAffine3) -> bool {
    let (a, b) = (a.to_cols_array(), b.to_cols_array());
    let largest = a.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let mut pairs = a.iter().zip(&b);
    pairs.all(|(a, b)| (a - b).abs() <= NEAR * largest)
}
