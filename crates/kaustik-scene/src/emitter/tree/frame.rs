use glam::{DVec3, Vec3};

use super::group::Group;

/// Where a tree stands and how large it is, so that single precision does for what is in it: places are told from its center, in units
/// of its radius, and powers as shares of all.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Frame {
    center: DVec3,
    /// Units in a length of 1.
    units: f64,
    /// What the power of all is divided by.
    power: f64,
}

/// In units, more than what rounding moves a point or a center by, together with what the root of three adds: spheres are larger by it, so that
/// they hold what they held, and fill the angle by which a direction may be off.
pub(super) const ROUNDING: f32 = 1e-6;

/// From no farther away is a tree looked at, in units: all its emitters lie in one direction then.
const FAR: f64 = 1e6;

/// No emitter has a smaller share of the power: its part of what comes from afar must not round to 0.
const LEAST_POWER: f32 = 1e-20;

impl Frame {
    pub(super) fn new(whole: &Group) -> Self {
        let radius = whole.radius();
        Self {
            center: whole.center(),
            units: if radius > 0.0 { 1.0 / radius } else { 1.0 },
            power: whole.power,
        }
    }

    /// A place; one that is too far away in its direction.
    #[inline]
    pub(super) fn local(&self, point: DVec3) -> Vec3 {
        let from = (point - self.center) * self.units;
        let most = from.abs().max_element();
        let near = if most > FAR {
            from * (FAR / most)
        } else {
            from
        };
        near.as_vec3()
    }

    pub(super) fn length(&self, length: f64) -> f32 {
        (length * self.units) as f32
    }

    pub(super) fn power(&self, power: f64) -> f32 {
        ((power / self.power) as f32).max(LEAST_POWER)
    }
}
