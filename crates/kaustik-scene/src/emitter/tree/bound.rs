//! What a node of the tree knows of the emitters below it.

use glam::{DVec3, Vec3};
use kaustik_geometry::Aabb;

use super::cone::Cone;

/// A group of emitters, or one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group {
    pub(super) bounds: Aabb,
    pub(super) cone: Cone,
    pub(super) power: f64,
    /// The distance at which the last of them has faded to nothing; infinite where one does not fade.
    pub(super) range: f64,
}

impl Group {
    pub(super) fn union(&self, other: &Self) -> Self {
        Self {
            bounds: self.bounds.union(&other.bounds),
            cone: self.cone.union(other.cone),
            power: self.power + other.power,
            range: self.range.max(other.range),
        }
    }
}

/// A sphere around a group of emitters, the cone of what they shine into, and what they send out in all. Angles are in single precision,
/// so that two of these and what belongs to them fit into three lines of a cache.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bound {
    center: DVec3,
    radius: f64,
    power: f64,
    axis: Vec3,
    cos_spread: f32,
    sin_spread: f32,
    cos_reach: f32,
    /// Distance from the center beyond which all have faded to nothing.
    end: f32,
}

/// No sphere is smaller: a lamp may stand where it is asked from.
const SMALLEST: f64 = 1e-50;

/// Cosines that are too small by less are taken to be rounded so, and none above 0 is smaller: what shines at a point must not be lost.
const LEAST_COS: f32 = 1e-3;

/// By which ranges are longer, for the same reason.
const LONGER: f64 = 1.0 + 1e-5;

impl Bound {
    /// Around no emitter.
    pub(super) const NOTHING: Self = Self {
        center: DVec3::ZERO,
        radius: SMALLEST,
        power: 0.0,
        axis: Vec3::Z,
        cos_spread: 1.0,
        sin_spread: 0.0,
        cos_reach: 1.0,
        end: 0.0,
    };

    pub(super) fn new(group: &Group) -> Self {
        let (min, max) = (group.bounds.min.as_dvec3(), group.bounds.max.as_dvec3());
        let radius = (0.5 * (max - min)).length();
        let cone = &group.cone;
        Self {
            center: 0.5 * (min + max),
            radius: radius.max(SMALLEST),
            power: group.power,
            axis: cone.axis.as_vec3(),
            cos_spread: libm::cos(cone.spread) as f32,
            sin_spread: libm::sin(cone.spread) as f32,
            cos_reach: libm::cos(cone.reach) as f32,
            end: ((group.range + radius) * LONGER) as f32,
        }
    }

    /// About how much light comes to a point: the power over the square of the distance, times the largest cosine at
    /// which any of the emitters may send out light toward it. 0 where none does.
    #[inline]
    pub(super) fn importance(&self, point: DVec3) -> f64 {
        let to = point - self.center;
        let squared = to.length_squared();
        let distance = squared.sqrt();
        if distance <= self.radius {
            return self.power / (self.radius * self.radius);
        }
        if distance > f64::from(self.end) {
            return 0.0;
        }
        let near = self.power / squared;
        // The angle between the axis and the way to the point, less the spread of the normals, less the angle that the sphere fills.
        let scale = 1.0 / distance;
        let cos = self.axis.dot((to * scale).as_vec3());
        if cos >= self.cos_spread {
            return near;
        }
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let beyond_cos = cos * self.cos_spread + sin * self.sin_spread;
        let beyond_sin = sin * self.cos_spread - cos * self.sin_spread;
        let filled_sin = (self.radius * scale) as f32;
        let filled_cos = (1.0 - filled_sin * filled_sin).max(0.0).sqrt();
        if beyond_cos >= filled_cos {
            return near;
        }
        let cos = beyond_cos * filled_cos + beyond_sin * filled_sin;
        if cos < self.cos_reach - LEAST_COS {
            return 0.0;
        }
        near * f64::from(cos.max(LEAST_COS))
    }
}
