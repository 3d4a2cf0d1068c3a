//! Which emitters stand together in the tree.

use std::array::from_fn;

use glam::{DVec3, Vec3};
use kaustik_geometry::Aabb;

use super::cone::Cone;
use super::frame::Frame;
use super::group::Group;
use super::node::{Below, Node, WIDTH};
use super::{LightTree, Place};

/// An emitter as the tree sees it.
#[derive(Clone, Copy, Debug)]
pub(in crate::emitter) struct Light {
    /// Its number in the list of emitters.
    pub(super) emitter: u32,
    pub(super) group: Group,
}

/// Slices along an axis between which a group may be parted.
const BINS: usize = 12;

/// Deeper than this groups are halved by number, so that no arrangement makes a tree of more than some 70 levels.
const DEEPEST: u32 = 48;

impl LightTree {
    /// Of lights with a power above 0; `emitters` is the length of the list that they are numbers in.
    pub(in crate::emitter) fn new(mut lights: Vec<Light>, emitters: usize) -> Self {
        let add = |whole: Group, light: &Light| whole.union(&light.group);
        let whole = lights.iter().fold(Group::NOTHING, add);
        let mut tree = Self {
            frame: Frame::new(&whole),
            nodes: Vec::with_capacity(lights.len() / 2),
            parents: Vec::with_capacity(lights.len() / 2),
            places: vec![Place::NONE; emitters],
        };
        if !lights.is_empty() {
            tree.grow(&mut lights, Place::NONE, 0);
            tree.nodes.shrink_to_fit();
            tree.parents.shrink_to_fit();
        }
        tree
    }

    /// Makes the node that hangs in a place, and all below it; returns its number and what is in it.
    fn grow(&mut self, lights: &mut [Light], parent: Place, depth: u32) -> (u32, Group) {
        let node = self.nodes.len() as u32;
        self.nodes.push(Node::EMPTY);
        self.parents.push(parent);
        let mut whole = Group::NOTHING;
        for (lane, part) in parts(lights, depth).into_iter().enumerate() {
            let place = Place {
                node,
                lane: lane as u32,
            };
            let (below, group) = match part.lights {
                [] => continue,
                [light] => {
                    self.places[light.emitter as usize] = place;
                    (Below::Emitter(light.emitter), light.group)
                }
                lights => {
                    let (below, group) = self.grow(lights, place, part.depth);
                    (Below::Node(below), group)
                }
            };
            self.nodes[node as usize].set(lane, &group, &self.frame, below);
            whole = whole.union(&group);
        }
        (node, whole)
    }
}

/// Lights that stand together, after so many cuts.
struct Part<'a> {
    lights: &'a mut [Light],
    depth: u32,
}

/// Cuts lights into up to [`WIDTH`] groups, each time the one that has most of them.
fn parts(lights: &mut [Light], depth: u32) -> [Part<'_>; WIDTH] {
    let mut parts = from_fn(|_| Part {
        lights: &mut [],
        depth,
    });
    parts[0].lights = lights;
    for empty in 1..WIDTH {
        let most = (0..empty).max_by_key(|&i| parts[i].lights.len());
        let Some(largest) = most.map(|i| &mut parts[i]).filter(|p| p.lights.len() > 1) else {
            break;
        };
        let lights = std::mem::take(&mut largest.lights);
        let middle = cut(lights, largest.depth);
        let (left, right) = lights.split_at_mut(middle);
        largest.depth += 1;
        let depth = largest.depth;
        largest.lights = left;
        parts[empty] = Part {
            lights: right,
            depth,
        };
    }
    parts
}

/// Puts two or more lights in the order of two groups and returns how many are in the first: at least one, and not all.
fn cut(lights: &mut [Light], depth: u32) -> usize {
    let half = lights.len() / 2;
    let plane = (depth < DEEPEST).then(|| best_plane(lights)).flatten();
    let Some((axis, plane)) = plane else {
        return half;
    };
    let mut first = 0;
    for i in 0..lights.len() {
        if lights[i].group.bounds.center()[axis] < plane {
            lights.swap(first, i);
            first += 1;
        }
    }
    // By rounding all may be on one side.
    if (1..lights.len()).contains(&first) {
        first
    } else {
        half
    }
}

/// The axis and the place on it where a cut makes the groups of the least cost; `None` where all stand in one place.
fn best_plane(lights: &[Light]) -> Option<(usize, f32)> {
    let centers = Aabb::from_points(lights.iter().map(|light| light.group.bounds.center()));
    let extent = centers.extent();
    let mut best: Option<(f64, usize, f32)> = None;
    for axis in 0..3 {
        let step = extent[axis] / BINS as f32;
        if !(step > 0.0 && step.is_finite()) {
            continue;
        }
        let mut bins = [Side::EMPTY; BINS];
        for light in lights {
            let bin = (light.group.bounds.center()[axis] - centers.min[axis]) / step;
            bins[(bin as usize).min(BINS - 1)].add(light);
        }
        for (cut, cost) in costs(&bins) {
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, centers.min[axis] + step * cut as f32));
            }
        }
    }
    best.map(|(_, axis, plane)| (axis, plane))
}

/// The cost of each cut that leaves something on both sides, by the number of bins before it.
fn costs(bins: &[Side; BINS]) -> impl Iterator<Item = (usize, f64)> {
    let mut after = [Side::EMPTY; BINS + 1];
    for i in (0..BINS).rev() {
        after[i] = after[i + 1].with(&bins[i]);
    }
    let mut before = Side::EMPTY;
    (1..BINS).filter_map(move |cut| {
        before = before.with(&bins[cut - 1]);
        let sides = [&before, &after[cut]];
        let both = sides.iter().all(|side| side.power > 0.0);
        both.then(|| (cut, sides.map(Side::cost).iter().sum()))
    })
}

/// What a cut has on one side.
#[derive(Clone, Copy, Debug)]
struct Side {
    bounds: Aabb,
    power: f64,
    /// Sum of the normals times powers.
    normals: DVec3,
}

impl Side {
    const EMPTY: Self = Self {
        bounds: Aabb::EMPTY,
        power: 0.0,
        normals: DVec3::ZERO,
    };

    fn add(&mut self, light: &Light) {
        self.bounds = self.bounds.union(&light.group.bounds);
        self.power += light.group.power;
        // What shines everywhere has none.
        if light.group.cone.spread < std::f64::consts::FRAC_PI_2 {
            self.normals += light.group.cone.axis * light.group.power;
        }
    }

    fn with(&self, other: &Self) -> Self {
        Self {
            bounds: self.bounds.union(&other.bounds),
            power: self.power + other.power,
            normals: self.normals + other.normals,
        }
    }

    /// How poorly one bound tells of all: the power, times the square of the extent, times one to four, as of the solid angles
    /// that a side and a sphere of normals shine into, by how far the mean of the normals is from 1.
    fn cost(&self) -> f64 {
        let extent = self.bounds.extent().as_dvec3().length_squared();
        let unlike = 1.0 - (self.normals.length() / self.power).min(1.0);
        self.power * extent * (1.0 + 3.0 * unlike)
    }
}

impl Light {
    /// A triangle with these corners and this front normal (unit).
    pub(in crate::emitter) fn triangle(
        emitter: u32,
        power: f64,
        corners: [Vec3; 3],
        normal: DVec3,
    ) -> Self {
        let group = Group {
            bounds: Aabb::from_points(corners),
            cone: Cone::side(normal),
            power,
            range: f64::INFINITY,
        };
        Self { emitter, group }
    }

    /// A lamp at a place, which shines within an angle (radians) of an axis (unit) and fades to nothing at `range`.
    pub(in crate::emitter) fn lamp(
        emitter: u32,
        power: f64,
        place: DVec3,
        (axis, angle): (DVec3, f64),
        range: f64,
    ) -> Self {
        let group = Group {
            bounds: Aabb::from_points([place.as_vec3()]),
            cone: Cone::spot(axis, angle),
            power,
            range,
        };
        Self { emitter, group }
    }

    /// The same, which shines on both sides.
    pub(in crate::emitter) fn both_sides(mut self) -> Self {
        self.group.cone = Cone::ALL;
        self
    }

    /// The same, which moves: at some time it may shine anywhere.
    pub(in crate::emitter) fn moving(self) -> Self {
        let mut light = self.both_sides();
        light.group.range = f64::INFINITY;
        light
    }

    /// Are all its numbers finite, but for a range?
    pub(in crate::emitter) fn is_finite(&self) -> bool {
        let Group {
            bounds,
            cone,
            power,
            range,
        } = &self.group;
        let places = bounds.min.is_finite() && bounds.max.is_finite();
        places && cone.axis.is_finite() && power.is_finite() && !range.is_nan()
    }
}
