//! From what moves, by samplers over seconds, to keys over the interval of the shutter.

mod sample;

use std::sync::Arc;

use glam::{Affine3A, DAffine3, DVec3};
use kaustik_geometry::{Mesh, Motion};

use super::SceneError;
use crate::description::{AnimationDescription, Carried, Description, Joint, Load, Shutter};
use sample::{Side, local};

/// How far a point may be off its path, as a share of the size of what moves: 2^-16, less than a tenth of a pixel where
/// it fills a picture of 4096.
const TOLERANCE: f64 = 1.0 / 65_536.0;
/// Between two keys of the file there are at most 2 to the power of this many of ours.
const HALVINGS: u32 = 10;
/// Keys of all motions together, each as often as joints are above it.
const MOST: usize = 1 << 22;

/// The motions of a scene while its camera's shutter is open.
#[derive(Debug, Default)]
pub(super) struct Motions {
    /// Of instances, by index.
    pub(super) instances: Vec<(u32, Motion)>,
    /// Of punctual lights, by index.
    pub(super) lights: Vec<(usize, Motion)>,
    /// Of cameras, by index.
    pub(super) cameras: Vec<(usize, Motion)>,
}

impl Motions {
    /// `reach` is the size of the scene: how far off a turning light or camera may be.
    pub(super) fn new(
        description: &Description,
        shutter: Shutter,
        reach: f64,
    ) -> Result<Self, SceneError> {
        let animation = &description.animation;
        check(description)?;
        let mut clock = Clock {
            animation,
            shutter,
            left: MOST,
        };
        let mut motions = Self::default();
        let corners: Vec<_> = description.meshes.iter().map(corners).collect();
        let around = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axis * reach);
        for carried in &animation.carried {
            match carried.load {
                Load::Instance(index) => {
                    let corners = &corners[description.instances[index].mesh];
                    let motion = clock.motion(carried, corners)?;
                    motions.instances.push((index as u32, motion));
                }
                Load::Light(index) => {
                    let motion = clock.motion(carried, &around)?;
                    motions.lights.push((index, motion));
                }
                Load::Camera(index) => {
                    let motion = clock.motion(carried, &around)?;
                    motions.cameras.push((index, motion));
                }
            }
        }
        Ok(motions)
    }
}

/// Descriptions come from anyone: indices, counts and order of what is used below.
fn check(description: &Description) -> Result<(), SceneError> {
    let AnimationDescription { joints, carried } = &description.animation;
    let unsound = |index: usize, reason: &'static str| SceneError::Animation {
        joint: joints.get(index).map_or("", |j| &j.name).to_owned(),
        reason,
    };
    for (index, joint) in joints.iter().enumerate() {
        if joint.parent.is_some_and(|parent| parent >= index) {
            return Err(unsound(index, "its parent does not come before it"));
        }
        if !sample::is_sound(joint) {
            let reason = "its samplers need times that increase, a value each (three of a cubic spline), all finite";
            return Err(unsound(index, reason));
        }
    }
    for carried in carried {
        if carried.joint >= joints.len() {
            return Err(unsound(carried.joint, "there is no such joint"));
        }
        let sound = match carried.load {
            Load::Instance(i) => (description.instances.get(i))
                .is_some_and(|instance| instance.mesh < description.meshes.len()),
            Load::Light(i) => i < description.lights.len(),
            Load::Camera(i) => i < description.cameras.len(),
        };
        if !sound {
            return Err(unsound(carried.joint, "what it carries does not exist"));
        }
    }
    Ok(())
}

/// The corners of a mesh's box: what holds for them holds for all points in it, since motions are affine at any time.
fn corners(mesh: &Arc<Mesh>) -> [DVec3; 8] {
    let bounds = mesh.bounds();
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    std::array::from_fn(|k| {
        let pick = |axis: usize| if k >> axis & 1 == 0 { min } else { max }[axis];
        let corner = DVec3::new(pick(0), pick(1), pick(2));
        // An empty mesh has a box that is inside out.
        if corner.is_finite() {
            corner
        } else {
            DVec3::ZERO
        }
    })
}

struct Clock<'a> {
    animation: &'a AnimationDescription,
    shutter: Shutter,
    /// Keys that may still be made.
    left: usize,
}

/// A time as a share of the interval, and where something stands then.
type Key = (f64, DAffine3);

impl Clock<'_> {
    fn seconds(&self, share: f64) -> f64 {
        let (open, close) = (f64::from(self.shutter.open), f64::from(self.shutter.close));
        open + (close - open) * share
    }

    /// The joints that move something, from its own one up.
    fn chain(&self, carried: &Carried) -> impl Iterator<Item = &Joint> + use<'_> {
        let joints = &self.animation.joints;
        std::iter::successors(Some(&joints[carried.joint]), |joint| {
            joint.parent.map(|parent| &joints[parent])
        })
    }

    fn place(&self, carried: &Carried, share: f64, side: Side) -> DAffine3 {
        let seconds = self.seconds(share);
        self.chain(carried).fold(carried.offset, |below, joint| {
            joint.to_parent * local(joint, seconds, side) * below
        })
    }

    /// Keys such that all `points` stay near their paths.
    fn motion(&mut self, carried: &Carried, points: &[DVec3]) -> Result<Motion, SceneError> {
        let depth = self.chain(carried).count();
        let mut keys = vec![(0.0, self.place(carried, 0.0, Side::After))];
        for (share, jumps) in self.breaks(carried) {
            let last = keys[keys.len() - 1];
            let next = (share, self.place(carried, share, Side::Before));
            self.segment(carried, points, (last, next), HALVINGS, &mut keys);
            if jumps {
                keys.push((share, self.place(carried, share, Side::After)));
            }
            self.charge(carried, keys.len() * depth)?;
        }
        self.charge(carried, keys.len() * depth)?;
        self.left -= keys.len() * depth;
        let narrow = |(share, place): Key| {
            let columns = place.to_cols_array().map(|x| x as f32);
            (share as f32, Affine3A::from_cols_array(&columns))
        };
        Motion::new(keys.into_iter().map(narrow).collect())
            .ok_or_else(|| self.unsound(carried, "it leaves the finite numbers"))
    }

    fn charge(&self, carried: &Carried, keys: usize) -> Result<(), SceneError> {
        if keys <= self.left {
            return Ok(());
        }
        Err(self.unsound(
            carried,
            "so much moves while the shutter is open that its keys would take more than 300 MB; \
             a shorter interval takes fewer",
        ))
    }

    fn unsound(&self, carried: &Carried, reason: &'static str) -> SceneError {
        SceneError::Animation {
            joint: self.animation.joints[carried.joint].name.clone(),
            reason,
        }
    }

    /// Keys of the file within the interval, in order, with whether something jumps there; then the end. None in an
    /// instant, which has one place, also where something jumps.
    fn breaks(&self, carried: &Carried) -> Vec<(f64, bool)> {
        let (open, close) = (f64::from(self.shutter.open), f64::from(self.shutter.close));
        let mut breaks: Vec<(f64, bool)> = Vec::new();
        if close <= open {
            return breaks;
        }
        for joint in self.chain(carried) {
            sample::keys(joint, [open, close], |time, jumps| {
                breaks.push(((time - open) / (close - open), jumps));
            });
        }
        breaks.push((1.0, false));
        breaks.sort_by(|a, b| a.0.total_cmp(&b.0));
        breaks.dedup_by(|later, kept| {
            let same = later.0.total_cmp(&kept.0).is_eq();
            kept.1 |= same && later.1;
            same
        });
        breaks
    }

    /// Adds the second key, and before it what is needed to stay near the path.
    fn segment(
        &self,
        carried: &Carried,
        points: &[DVec3],
        (a, b): (Key, Key),
        halvings: u32,
        keys: &mut Vec<Key>,
    ) {
        if halvings == 0 || self.is_straight(carried, points, (a, b)) {
            keys.push(b);
            return;
        }
        let share = 0.5 * (a.0 + b.0);
        let middle = (share, self.place(carried, share, Side::After));
        self.segment(carried, points, (a, middle), halvings - 1, keys);
        self.segment(carried, points, (middle, b), halvings - 1, keys);
    }

    fn is_straight(&self, carried: &Carried, points: &[DVec3], (a, b): (Key, Key)) -> bool {
        let first = |key: &Key| key.1.transform_point3(points[0]);
        let size = |key: &Key| {
            let far = points.iter().map(|&p| key.1.transform_point3(p));
            far.map(|p| (p - first(key)).length()).fold(0.0, f64::max)
        };
        // Of a single point the way that it goes.
        let size = size(&a).max(size(&b));
        let off = TOLERANCE
            * if size > 0.0 {
                size
            } else {
                (first(&b) - first(&a)).length()
            };
        [0.25, 0.5, 0.75].into_iter().all(|at| {
            let share = a.0 + (b.0 - a.0) * at;
            let exact = self.place(carried, share, Side::After);
            points.iter().all(|&p| {
                let ends = [a.1.transform_point3(p), b.1.transform_point3(p)];
                let straight = ends[0] * (1.0 - at) + ends[1] * at;
                // What is not a number is refused later.
                let error = (exact.transform_point3(p) - straight).length();
                error.is_nan() || error <= off
            })
        })
    }
}

#[cfg(test)]
mod tests;
