//! The nodes of a scene: what stands still below none, what moves below its joint.
//!
//! Readers go through nodes from the first root down. In order that they find all things of a kind in the
//! order of its list, a joint comes after what stands before the first of all that it carries, at any depth.

use std::collections::VecDeque;

use glam::{Affine3A, DAffine3};
use serde_json::Value;

use super::ExportError;
use super::animation::node;
use super::geometry::matrix;
use super::writer::Object;
use crate::Description;
use crate::description::{Carried, Joint, Load};

/// Instances, cameras, lights.
const KINDS: usize = 3;
type Kind = fn(usize) -> Load;
const LOADS: [Kind; KINDS] = [Load::Instance, Load::Camera, Load::Light];

fn numbered(load: Load) -> (usize, usize) {
    match load {
        Load::Instance(i) => (0, i),
        Load::Camera(i) => (1, i),
        Load::Light(i) => (2, i),
    }
}

pub(super) struct Nodes {
    list: Vec<(Object, Vec<usize>)>,
    roots: Vec<usize>,
    joints: Vec<usize>,
}

impl Nodes {
    /// `leaf` makes the node of a thing, but for its place.
    pub(super) fn new(
        description: &Description,
        leaf: impl Fn(Load) -> Result<Object, ExportError>,
    ) -> Result<Self, ExportError> {
        let mut nodes = Self {
            list: Vec::new(),
            roots: Vec::new(),
            joints: Vec::new(),
        };
        let mut plan = Plan::new(description);
        let joints = &description.animation.joints;
        // A place of the plan, its node, and how many of the joints below it are done.
        let mut open = vec![(0, None, 0)];
        while let Some((place, parent, done)) = open.last_mut() {
            let (place, parent) = (*place, *parent);
            let next = plan.below[place].get(*done).copied();
            *done += 1;
            for load in plan.due(place, next) {
                let thing = leaf(load)?.maybe("matrix", plan.matrix(description, load));
                nodes.add(parent, thing);
            }
            let Some(next) = next else {
                open.pop();
                continue;
            };
            let joint = &joints[next - 1];
            let between = matrix(&single(&joint.to_parent));
            let parent = match between {
                None => parent,
                between => Some(nodes.add(parent, Object::default().maybe("matrix", between))),
            };
            let at = nodes.add(parent, node(joint));
            nodes.joints.push(at);
            open.push((next, Some(at), 0));
        }
        Ok(nodes)
    }

    fn add(&mut self, parent: Option<usize>, node: Object) -> usize {
        let index = self.list.len();
        self.list.push((node, Vec::new()));
        match parent {
            Some(parent) => self.list[parent].1.push(index),
            None => self.roots.push(index),
        }
        index
    }

    /// Those that have no parent.
    pub(super) fn roots(&self) -> Vec<usize> {
        self.roots.clone()
    }

    /// Those of the joints, in their order.
    pub(super) fn joints(&self) -> &[usize] {
        &self.joints
    }

    pub(super) fn finish(self) -> Vec<Value> {
        let nodes = self.list.into_iter();
        let whole = |(node, below): (Object, Vec<usize>)| {
            node.maybe("children", (!below.is_empty()).then_some(below))
                .into()
        };
        nodes.map(whole).collect()
    }
}

/// Who is below whom. Place 0 is the world, place j + 1 joint j.
struct Plan {
    /// Places below each place.
    below: Vec<Vec<usize>>,
    /// What each place holds itself and has not been written yet.
    held: Vec<[VecDeque<usize>; KINDS]>,
    /// The first of each kind that a place holds at any depth.
    first: Vec<[Option<usize>; KINDS]>,
    offsets: [Vec<Option<DAffine3>>; KINDS],
}

impl Plan {
    fn new(description: &Description) -> Self {
        let animation = &description.animation;
        let places = animation.joints.len() + 1;
        let counts = [
            description.instances.len(),
            description.cameras.len(),
            description.lights.len(),
        ];
        let mut plan = Self {
            below: vec![Vec::new(); places],
            held: vec![Default::default(); places],
            first: vec![[None; KINDS]; places],
            offsets: counts.map(|count| vec![None; count]),
        };
        plan.hold(&animation.carried);
        // A place comes after the one above it. Where it does not, the finished file is found not to be the same.
        let above = |(joint, of): (usize, &Joint)| of.parent.map_or(0, |p| p + 1).min(joint);
        let above: Vec<usize> = animation.joints.iter().enumerate().map(above).collect();
        for (joint, &above) in above.iter().enumerate() {
            plan.below[above].push(joint + 1);
        }
        plan.find_first(&above);
        plan
    }

    /// Gives each thing to the joint that carries it, or else to the world.
    fn hold(&mut self, carried: &[Carried]) {
        let mut holders = self
            .offsets
            .each_ref()
            .map(|offsets| vec![0; offsets.len()]);
        for &Carried {
            load,
            joint,
            offset,
        } in carried
        {
            let (kind, index) = numbered(load);
            // what is not there is found when the finished file is compared
            if index < holders[kind].len() && joint + 1 < self.below.len() {
                holders[kind][index] = joint + 1;
                self.offsets[kind][index] = Some(offset);
            }
        }
        for (kind, holders) in holders.iter().enumerate() {
            for (index, &place) in holders.iter().enumerate() {
                self.held[place][kind].push_back(index);
            }
        }
    }

    /// From the last place to the world, `above` says of each joint's place which one is above it.
    fn find_first(&mut self, above: &[usize]) {
        for place in (0..self.below.len()).rev() {
            for (first, held) in self.first[place].iter_mut().zip(&self.held[place]) {
                *first = least([*first, held.front().copied()]);
            }
            if place > 0 {
                let first = self.first[place];
                for (up, first) in self.first[above[place - 1]].iter_mut().zip(first) {
                    *up = least([*up, first]);
                }
            }
        }
    }

    /// What a place holds itself and comes before the place below it; all that is left if there is none.
    fn due(&mut self, place: usize, below: Option<usize>) -> Vec<Load> {
        let first = below.map(|below| self.first[below]);
        let mut due = Vec::new();
        for (kind, held) in self.held[place].iter_mut().enumerate() {
            let before = |index: usize| match first {
                None => true,
                Some(first) => first[kind].is_some_and(|first| index < first),
            };
            while let Some(index) = held.front().copied().filter(|&index| before(index)) {
                held.pop_front();
                due.push(LOADS[kind](index));
            }
        }
        due
    }

    /// From a thing to its joint, or to the world.
    fn matrix(&self, description: &Description, load: Load) -> Option<Value> {
        let (kind, index) = numbered(load);
        let still = match load {
            Load::Instance(i) => description.instances[i].transform,
            Load::Camera(i) => description.cameras[i].transform,
            Load::Light(i) => description.lights[i].transform,
        };
        matrix(&self.offsets[kind][index].map_or(still, |offset| single(&offset)))
    }
}

fn least(numbers: [Option<usize>; 2]) -> Option<usize> {
    numbers.into_iter().flatten().min()
}

fn single(transform: &DAffine3) -> Affine3A {
    Affine3A::from_cols_array(&transform.to_cols_array().map(|x| x as f32))
}
