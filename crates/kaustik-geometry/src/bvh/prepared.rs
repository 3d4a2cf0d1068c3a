//! What a walk precomputes of a ray.

use glam::{Affine3A, DAffine3, DVec3, Vec3};

use crate::Ray;

/// Relative widening of a box's far side and of the distance beyond which nothing is visited: 2^-20, many times the
/// three roundings of a plane's distance.
pub(crate) const WIDEN: f32 = 1.0 + 1.0 / 1_048_576.0;

/// A ray in the space of one tree.
pub(crate) struct Prepared {
    pub(crate) origin: Vec3,
    /// Reciprocal direction, finite.
    pub(crate) inverse: Vec3,
    /// The same, [`WIDEN`]ed.
    pub(crate) inverse_far: Vec3,
    /// For each axis the row of [`super::node::Node::planes`] that the ray meets first.
    pub(crate) near_row: [usize; 3],
    /// And the one that it meets last.
    pub(crate) far_row: [usize; 3],
    /// The axes, that of the largest direction component last, keeping the winding.
    pub(crate) axes: [usize; 3],
    /// Shear that makes the direction the last axis (Woop, Benthin, Wald), and the factor from that axis to `t`.
    pub(crate) shear: Vec3,
    /// The ray's own limits.
    pub(crate) t_min: f32,
    pub(crate) t_max: f32,
    /// Size of the numbers that `origin` is the rounded sum of; zero in world space.
    pub(crate) blur: f32,
    /// What `blur` means in `t`.
    pub(crate) slack: f32,
}

impl Prepared {
    /// None of a ray that meets nothing: with a zero, infinite or undefined direction, or an undefined origin.
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Option<Prepared> {
        let d = ray.direction;
        let size = d.abs();
        // In the manner of Woop et al. the winding is kept, here by cyclic order and the sign of the shear.
        let last = if size.x > size.y {
            if size.x > size.z { 0 } else { 2 }
        } else if size.y > size.z {
            1
        } else {
            2
        };
        let largest = size[last];
        // Every component takes part, so that one that is not a number is seen.
        let usable =
            largest >= f32::MIN_POSITIVE * 4.0 && (size.x + size.y + size.z) < f32::INFINITY;
        if !(usable && ray.origin.is_finite() && ray.t_min <= ray.t_max) {
            return None;
        }
        let floor = (largest * FLOOR).max(f32::MIN_POSITIVE);
        let away = |x: f32| {
            if x.abs() < floor {
                floor.copysign(x)
            } else {
                x
            }
        };
        let inverse = Vec3::new(1.0 / away(d.x), 1.0 / away(d.y), 1.0 / away(d.z));
        let axes = AXES[last];
        let negative = d.to_array().map(|x| usize::from(x.is_sign_negative()));
        let scale = inverse[last];
        Some(Prepared {
            origin: ray.origin,
            inverse,
            inverse_far: inverse * WIDEN,
            near_row: [negative[0] * 3, 1 + negative[1] * 3, 2 + negative[2] * 3],
            far_row: [
                3 - negative[0] * 3,
                4 - negative[1] * 3,
                5 - negative[2] * 3,
            ],
            axes,
            shear: Vec3::new(d[axes[0]] * scale, d[axes[1]] * scale, scale),
            t_min: ray.t_min,
            t_max: ray.t_max,
            blur: 0.0,
            slack: 0.0,
        })
    }

    /// The same ray in the space of an instance, `t` unchanged.
    pub(crate) fn into_instance(ray: &Ray, to_object: &Affine3A) -> Option<Prepared> {
        let direction = to_object.transform_vector3(ray.direction);
        let object = Ray {
            origin: to_object.transform_point3(ray.origin),
            direction,
            ..*ray
        };
        let mut prepared = Prepared::new(&object)?;
        let m = &to_object.matrix3;
        let reach = m.x_axis.abs() * ray.origin.x.abs()
            + m.y_axis.abs() * ray.origin.y.abs()
            + m.z_axis.abs() * ray.origin.z.abs()
            + to_object.translation.abs();
        prepared.blur = reach.max_element();
        prepared.slack = prepared.blur * (WIDEN - 1.0) / direction.abs().max_element();
        Some(prepared)
    }
}

/// Direction components below this fraction of the largest count as that much: 2^-60.
const FLOOR: f32 = 1.0 / (1u64 << 60) as f32;

const AXES: [[usize; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];

/// The ray in double precision, and how a tree's corners become points of its space.
#[derive(Clone, Copy)]
pub(crate) struct Exact {
    pub(crate) origin: DVec3,
    pub(crate) direction: DVec3,
    /// None in world space.
    pub(crate) to_world: Option<DAffine3>,
}
