use glam::DVec3;
use kaustik_geometry::Aabb;

use super::cone::Cone;

/// Emitters that stand together, or one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group {
    pub(super) bounds: Aabb,
    pub(super) cone: Cone,
    pub(super) power: f64,
    /// The distance at which the last of them has faded to nothing; infinite where one does not fade.
    pub(super) range: f64,
}

impl Group {
    /// None of them.
    pub(super) const NOTHING: Self = Self {
        bounds: Aabb::EMPTY,
        cone: Cone::ALL,
        power: 0.0,
        range: 0.0,
    };

    /// Both; each emitter has a power above 0.
    pub(super) fn union(&self, other: &Self) -> Self {
        if self.power <= 0.0 {
            return *other;
        }
        Self {
            bounds: self.bounds.union(&other.bounds),
            cone: self.cone.union(other.cone),
            power: self.power + other.power,
            range: self.range.max(other.range),
        }
    }

    /// The middle of its bounds.
    pub(super) fn center(&self) -> DVec3 {
        0.5 * (self.bounds.min.as_dvec3() + self.bounds.max.as_dvec3())
    }

    /// Of the sphere around its bounds.
    pub(super) fn radius(&self) -> f64 {
        (0.5 * (self.bounds.max.as_dvec3() - self.bounds.min.as_dvec3())).length()
    }
}
