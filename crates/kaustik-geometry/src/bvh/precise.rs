//! One triangle in double precision, for the cases that single precision cannot decide.
//!
//! There are three: the ray meets an edge or a corner exactly (as far as `f32` sees), the triangle lies so near an end
//! of the ray that rounding could put it on the other side, or numbers leave the range of `f32`. The first decides
//! whether a mesh is watertight: the edge functions of the sheared corners are evaluated exactly enough for their sign,
//! from the very same rounded corners that a neighbour sees (Woop, Benthin, Wald, "Watertight Ray/Triangle
//! Intersection", 2013). The second decides whether a ray meets the surface that it leaves; there `t` comes from the
//! plane of the unsheared corners, in world space.

use glam::{DVec3, Vec3};

use super::node::Block;
use super::prepared::Prepared;
use super::walk::PlacedTree;
use crate::Ray;

/// The weights of the second and third corner, if the ray passes through the triangle.
#[cold]
#[inline(never)]
pub(crate) fn weights(block: &Block, lane: usize, ray: &Prepared) -> Option<(f64, f64)> {
    let [a, b, c] = block.corners(lane).map(|p| sheared(p, ray));
    let edge = |p: (f64, f64), q: (f64, f64)| p.0 * q.1 - p.1 * q.0;
    let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
    if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
        return None;
    }
    let det = u + v + w;
    // Not so where a number is undefined, too.
    (det.abs() > 0.0).then(|| (v / det, w / det))
}

/// Exactly as the block test computes it.
fn sheared(p: Vec3, ray: &Prepared) -> (f64, f64) {
    let [x, y, z] = ray.axes.map(|axis| p[axis] - ray.origin[axis]);
    (
        f64::from(x - ray.shear.x * z),
        f64::from(y - ray.shear.y * z),
    )
}

/// Where the ray crosses the plane of the triangle, if that is within the ray.
#[inline(always)]
pub(crate) fn plane(
    block: &Block,
    lane: usize,
    ray: &Ray,
    place: Option<&PlacedTree>,
) -> Option<f64> {
    let [a, b, c] = block.corners(lane);
    let [a, b, c] = match place {
        Some(place) => placed([a, b, c], place),
        None => [a.as_dvec3(), b.as_dvec3(), c.as_dvec3()],
    };
    let normal: DVec3 = (b - a).cross(c - a);
    let height = normal.dot(a - ray.origin.as_dvec3());
    let slope = normal.dot(ray.direction.as_dvec3());
    // Before the division: most that ask have just left this very plane.
    if ray.t_min >= 0.0 && height * slope < 0.0 {
        return None;
    }
    let t = height / slope;
    (f64::from(ray.t_min) < t && t <= f64::from(ray.t_max) && t < f64::INFINITY).then_some(t)
}

#[cold]
#[inline(never)]
fn placed(corners: [Vec3; 3], place: &PlacedTree) -> [DVec3; 3] {
    let to_world = place.to_world.as_daffine3();
    corners.map(|p| to_world.transform_point3(p.as_dvec3()))
}
