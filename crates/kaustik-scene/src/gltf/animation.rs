//! Animations of nodes: which of them move by themselves, and what moves along.

use std::collections::HashMap;

use glam::DAffine3;

use super::accessor::{Accessor, Allowed};
use super::json::Cursor;
use super::node::Placed;
use super::reader::Reader;
use super::{ErrorKind, LoadError, transform, vertices};
use crate::description::{Channel, Interpolation, Joint};

type Result<T> = std::result::Result<T, LoadError>;

/// Moving nodes above a moving node. Each costs a product of matrices for each key of what moves below.
const MOST_ABOVE: usize = 256;
const TIME: Allowed = vertices::allowed(&[], false, "SCALAR of FLOAT");

/// What moves a placed node: a joint, and the way from the node's own space to the joint's.
pub(super) type Carrier = Option<(usize, DAffine3)>;

/// The nodes that move, and for each placed node (or for none, if nothing moves) what moves it.
#[derive(Debug, Default)]
pub(super) struct Rig {
    pub(super) joints: Vec<Joint>,
    carriers: Vec<Carrier>,
}

impl Rig {
    /// What moves the placed node of this position in the list.
    pub(super) fn carrier(&self, placed: usize) -> Carrier {
        self.carriers.get(placed).copied().flatten()
    }
}

/// The samplers that a node has.
#[derive(Debug, Default)]
struct Tracks {
    translation: Option<Channel<3>>,
    rotation: Option<Channel<4>>,
    scale: Option<Channel<3>>,
}

/// Reads all animations, if there is a camera that sees them (`seen`).
pub(super) fn load<'a>(reader: &mut Reader<'a>, nodes: &[Placed<'a>], seen: bool) -> Result<Rig> {
    let root = reader.root.clone();
    let animations = root.list("animations")?;
    if animations.is_empty() {
        return Ok(Rig::default());
    }
    if !seen {
        reader.warn(
            &root,
            "animations are not played, as no camera has a shutter interval (\"shutter\" in its extras.kaustik); \
             the scene stands as its nodes say",
        );
        return Ok(Rig::default());
    }
    let mut tracks = HashMap::new();
    for animation in &animations {
        channels(reader, animation, &mut tracks)?;
    }
    rig(reader, nodes, tracks)
}

fn channels<'a>(
    reader: &mut Reader<'a>,
    animation: &Cursor<'a>,
    tracks: &mut HashMap<usize, Tracks>,
) -> Result<()> {
    let samplers = animation.list("samplers")?;
    for channel in animation.list("channels")? {
        read_channel(reader, &channel, &samplers, tracks)?;
    }
    Ok(())
}

fn read_channel<'a>(
    reader: &mut Reader<'a>,
    channel: &Cursor<'a>,
    samplers: &[Cursor<'a>],
    tracks: &mut HashMap<usize, Tracks>,
) -> Result<()> {
    let target = channel.need("target")?;
    let path = target.need("path")?;
    let index = channel.need("sampler")?;
    let sampler = &samplers[index.index("the animation's samplers", samplers.len())?];
    let Some(node) = target.get("node")? else {
        reader.warn(&target, "ignored: it names no node");
        return Ok(());
    };
    let node = node.index("/nodes", reader.root.count("nodes")?)?;
    let free = match path.string()? {
        "translation" => {
            let read = read(reader, sampler, &vertices::VECTOR)?;
            set(&mut tracks.entry(node).or_default().translation, read)
        }
        "rotation" => {
            let read = read(reader, sampler, &vertices::ANIMATED_ROTATION)?;
            set(&mut tracks.entry(node).or_default().rotation, read)
        }
        "scale" => {
            let read = read(reader, sampler, &vertices::VECTOR)?;
            set(&mut tracks.entry(node).or_default().scale, read)
        }
        "weights" => {
            reader.warn(
                &path,
                "morph targets are not animated; the mesh keeps its shape",
            );
            true
        }
        "pointer" => {
            reader.warn(
                &path,
                "ignored: only translation, rotation and scale of nodes move",
            );
            true
        }
        _ => return Err(path.mismatch("translation, rotation, scale or weights")),
    };
    if !free {
        reader.warn(
            channel,
            "ignored: an earlier channel moves the same part of the node",
        );
    }
    Ok(())
}

/// Whether there was nothing yet.
fn set<T>(slot: &mut Option<T>, value: T) -> bool {
    let free = slot.is_none();
    if free {
        *slot = Some(value);
    }
    free
}

fn read<'a, const N: usize>(
    reader: &mut Reader<'a>,
    sampler: &Cursor<'a>,
    allowed: &Allowed,
) -> Result<Channel<N>> {
    let (interpolation, each) = match sampler.get("interpolation")? {
        None => (Interpolation::Linear, 1),
        Some(place) => match place.string()? {
            "STEP" => (Interpolation::Step, 1),
            "LINEAR" => (Interpolation::Linear, 1),
            "CUBICSPLINE" => (Interpolation::CubicSpline, 3),
            _ => return Err(place.mismatch("STEP, LINEAR or CUBICSPLINE")),
        },
    };
    let input = sampler.need("input")?;
    let output = sampler.need("output")?;
    let keys = Accessor::find(&reader.root, &input)?;
    let accessor = Accessor::find(&reader.root, &output)?;
    // Before anything is read: counts may be lies.
    if keys.count() == 0 {
        return Err(input.error(ErrorKind::Value, "no keys", "at least one"));
    }
    if keys.count().checked_mul(each) != Some(accessor.count()) {
        let found = format!("{} values for {} keys", accessor.count(), keys.count());
        let expected = if each == 3 {
            "three for each key: incoming tangent, value, outgoing tangent"
        } else {
            "one for each key"
        };
        return Err(output.error(ErrorKind::Value, found, expected));
    }
    let times: Vec<[f32; 1]> = keys.floats(&TIME, &reader.buffers, &mut reader.budget)?;
    let values: Vec<[f32; N]> = accessor.floats(allowed, &reader.buffers, &mut reader.budget)?;
    finite(&input, &times)?;
    finite(&output, &values)?;
    if let Some(at) = times.windows(2).position(|pair| pair[0] >= pair[1]) {
        let found = format!("{} after {}", times[at + 1][0], times[at][0]);
        return Err(input.error(
            ErrorKind::Value,
            found,
            "times that increase from key to key",
        ));
    }
    Ok(Channel {
        interpolation,
        times: times.into_iter().map(|[time]| time).collect(),
        values,
    })
}

fn finite<const N: usize>(place: &Cursor<'_>, values: &[[f32; N]]) -> Result<()> {
    let Some(at) = values.iter().position(|v| v.iter().any(|x| !x.is_finite())) else {
        return Ok(());
    };
    let found = format!("{:?} at index {at}", values[at]);
    Err(place.error(ErrorKind::NotFinite, found, "finite numbers"))
}

/// Goes through the placed nodes, parents before children.
fn rig<'a>(
    reader: &mut Reader<'a>,
    nodes: &[Placed<'a>],
    mut tracks: HashMap<usize, Tracks>,
) -> Result<Rig> {
    let each = size_of::<Carrier>() + size_of::<usize>();
    reader.budget.take_many("/nodes", nodes.len(), each)?;
    let mut rig = Rig::default();
    // For each joint, how many joints are above it.
    let mut above: Vec<usize> = Vec::new();
    for placed in nodes {
        let carrier = placed.parent.and_then(|parent| rig.carriers[parent]);
        let tracks = tracks.remove(&placed.index);
        let Some(tracks) = tracks.filter(|_| moves(reader, placed)) else {
            let carried = match carrier {
                Some((joint, offset)) => {
                    Some((joint, offset * transform::local(reader, &placed.node)?))
                }
                None => None,
            };
            rig.carriers.push(carried);
            continue;
        };
        let depth = carrier.map_or(0, |(joint, _)| above[joint] + 1);
        if depth > MOST_ABOVE {
            let found = format!("a moving node below {depth} others");
            let expected = format!("at most {MOST_ABOVE}");
            return Err(placed.node.error(ErrorKind::Hierarchy, found, expected));
        }
        above.push(depth);
        rig.joints
            .push(joint(reader, nodes, placed, carrier, tracks)?);
        rig.carriers
            .push(Some((rig.joints.len() - 1, DAffine3::IDENTITY)));
    }
    Ok(rig)
}

/// The joint of a node that moves by itself, and that `carrier` moves besides.
fn joint<'a>(
    reader: &mut Reader<'a>,
    nodes: &[Placed<'a>],
    placed: &Placed<'a>,
    carrier: Carrier,
    tracks: Tracks,
) -> Result<Joint> {
    let above = || (placed.parent).map_or(DAffine3::IDENTITY, |parent| nodes[parent].world);
    let name = placed.node.text("name")?;
    let size = size_of::<Joint>() + name.len();
    reader.budget.take(&placed.node.pointer(), size as u64)?;
    Ok(Joint {
        name: name.to_owned(),
        parent: carrier.map(|(joint, _)| joint),
        to_parent: carrier.map_or_else(above, |(_, offset)| offset),
        rest: transform::rest(&placed.node)?,
        translation: tracks.translation,
        rotation: tracks.rotation,
        scale: tracks.scale,
    })
}

/// May this node be animated?
fn moves(reader: &mut Reader<'_>, placed: &Placed<'_>) -> bool {
    let Ok(Some(matrix)) = placed.node.get("matrix") else {
        return true;
    };
    reader.warn(
        &matrix,
        "the node is animated, which takes translation, rotation and scale in place of a matrix; it stands still",
    );
    false
}
