//! What a walk precomputes of a ray.

use glam::{Affine3A, Vec3, Vec3A};

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
    /// For each axis 1 if the direction is negative there: the plane that the ray meets first.
    pub(crate) negative: [usize; 3],
    /// The axes, that of the largest direction component last, keeping the winding.
    pub(crate) axes: [usize; 3],
    /// `origin` in the order of `axes`.
    pub(crate) turned_origin: [f32; 3],
    /// Shear that makes the direction the last axis (Woop, Benthin, Wald), and the factor from that axis to `t`.
    pub(crate) shear: Vec3,
    /// The largest direction component, absolute.
    pub(crate) stride: f32,
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
        let largest = size.x.max(size.y).max(size.z);
        // Every component takes part, so that one that is not a number is seen.
        let usable = largest >= LEAST && (size.x + size.y + size.z) < f32::INFINITY;
        if !(usable && ray.origin.is_finite() && ray.t_min <= ray.t_max) {
            return None;
        }
        let floor = (largest * FLOOR).max(LEAST);
        let inverse = Vec3::new(
            1.0 / away(d.x, floor),
            1.0 / away(d.y, floor),
            1.0 / away(d.z, floor),
        );
        // The winding is kept: cyclic order, and the sign of the last axis goes into the shear. Chosen
        // without branches, which would be mispredicted; the minima tell the compiler the range.
        let last = usize::from(size.y > size.x);
        let last = if size.z > size.x.max(size.y) { 2 } else { last };
        let first = if last == 2 { 0 } else { last + 1 }.min(2);
        let second = if last == 0 { 2 } else { last - 1 }.min(2);
        let axes = [first, second, last];
        let (o, along) = (ray.origin.to_array(), d.to_array());
        let scale = inverse.to_array()[last];
        let turned_origin = [o[first], o[second], o[last]];
        let shear = Vec3::new(along[first] * scale, along[second] * scale, scale);
        let negative = d.to_array().map(|x| usize::from(x.is_sign_negative()));
        Some(Prepared {
            origin: ray.origin,
            inverse,
            inverse_far: inverse * WIDEN,
            negative,
            axes,
            turned_origin,
            shear,
            stride: largest,
            blur: 0.0,
            slack: 0.0,
        })
    }

    /// The same ray in the space of an instance, `t` unchanged.
    pub(crate) fn in_instance(ray: &Ray, to_object: &Affine3A) -> Option<Prepared> {
        let direction = to_object.transform_vector3(ray.direction);
        let object = Ray {
            origin: to_object.transform_point3(ray.origin),
            direction,
            ..*ray
        };
        let mut prepared = Prepared::new(&object)?;
        let sizes = reach(to_object, ray.origin) + to_object.translation.abs();
        prepared.blur = sizes.max_element();
        prepared.slack = prepared.blur * (WIDEN - 1.0) / direction.abs().max_element();
        Some(prepared)
    }
}

/// How large the coordinates of a turned vector can be, whatever the signs of its own.
#[inline(always)]
pub(crate) fn reach(turn: &Affine3A, v: Vec3) -> Vec3A {
    let m = &turn.matrix3;
    m.x_axis.abs() * v.x.abs() + m.y_axis.abs() * v.y.abs() + m.z_axis.abs() * v.z.abs()
}

/// The smallest usable size of a direction.
const LEAST: f32 = f32::MIN_POSITIVE * 4.0;

/// `x`, or its sign with the size `floor`.
#[inline(always)]
fn away(x: f32, floor: f32) -> f32 {
    if x.abs() < floor {
        floor.copysign(x)
    } else {
        x
    }
}

/// Direction components below this fraction of the largest count as that much: 2^-60.
const FLOOR: f32 = 1.0 / (1u64 << 60) as f32;
