//! Rays and hits.

use glam::Vec3;

use crate::surface::{offset_point, rounding};
use crate::{Surface, offset_origin};

/// The largest `f32` below one: where a ray between two points ends.
const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// The points `origin + t * direction` with `t_min < t <= t_max`.
///
/// A ray with a zero direction, or with a component that is not a number, meets nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where `t` is zero.
    pub origin: Vec3,
    /// Need not be unit; `t` is in its units.
    pub direction: Vec3,
    /// Open lower end, not negative.
    pub t_min: f32,
    /// Closed upper end, may be infinite.
    pub t_max: f32,
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Along the ray, in units of its direction.
    pub t: f32,
    /// Weight of the triangle's second corner: `p = (1 - u - v) p0 + u p1 + v p2`.
    pub u: f32,
    /// Weight of the third corner.
    pub v: f32,
    /// Index into the world's instances.
    pub instance: u32,
    /// Index of the triangle in its mesh.
    pub primitive: u32,
}

impl Ray {
    /// The half line from `origin`, its start excluded.
    #[inline]
    pub fn new(origin: Vec3, direction: Vec3) -> Ray {
        Ray {
            origin,
            direction,
            t_min: 0.0,
            t_max: f32::INFINITY,
        }
    }

    /// The half line that leaves a surface towards `direction`: on the side into which the direction points, so that
    /// it does not meet the triangle it leaves. See [`offset_origin`].
    #[inline]
    pub fn spawn(from: &Surface, direction: Vec3) -> Ray {
        Ray::new(offset_origin(from, direction), direction)
    }

    /// The open segment between two points on surfaces: `t` runs from 0 at `from` to (just below) 1 at `to`. Meets
    /// neither of the two triangles. For shadow rays.
    #[inline]
    pub fn between(from: &Surface, to: &Surface) -> Ray {
        Self::segment(from, to.position, to.position_error, to.geometric_normal)
    }

    /// The same to a [bare](Surface::bare) point of a plane.
    #[inline]
    pub fn reaching(from: &Surface, point: Vec3, normal: Vec3) -> Ray {
        Self::segment(from, point, rounding(point), normal)
    }

    #[inline]
    fn segment(from: &Surface, to: Vec3, error: Vec3, normal: Vec3) -> Ray {
        let origin = offset_origin(from, to - from.position);
        // The direction is rounded too: its end may fall short of, or behind, the far surface by half an ulp of it.
        let back = origin - to;
        let end = offset_point(to, error + back.abs() * f32::EPSILON, normal, back);
        Ray {
            t_max: BELOW_ONE,
            ..Ray::new(origin, end - origin)
        }
    }

    /// The segment from a surface to a point that lies on none (a camera, a point light): `t` runs from 0 to just
    /// below 1.
    #[inline]
    pub fn towards(from: &Surface, point: Vec3) -> Ray {
        let origin = offset_origin(from, point - from.position);
        Ray {
            t_max: BELOW_ONE,
            ..Ray::new(origin, point - origin)
        }
    }

    /// The point at `t`. Less accurate than [`Surface::position`].
    #[inline]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}

impl Hit {
    /// Order along a ray: by `t`, equal ones by instance and primitive. What
    /// [`World::intersect_after`](crate::World::intersect_after) continues after.
    #[inline]
    pub fn precedes(&self, other: &Hit) -> bool {
        (self.t, self.instance, self.primitive) < (other.t, other.instance, other.primitive)
    }
}
