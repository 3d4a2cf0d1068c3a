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
use super::prepared::{Exact, Prepared};

/// `t` and the weights of the second and third corner.
#[cold]
#[inline(never)]
pub(crate) fn meet(
    block: &Block,
    lane: usize,
    ray: &Prepared,
    exact: &Exact,
) -> Option<(f64, f64, f64)> {
    let corners: [Vec3; 3] = std::array::from_fn(|c| {
        Vec3::from_array(std::array::from_fn(|axis| block.corners[c][axis][lane]))
    });
    let [a, b, c] = corners.map(|p| sheared(p, ray));
    let edge = |p: (f64, f64), q: (f64, f64)| p.0 * q.1 - p.1 * q.0;
    let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
    if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
        return None;
    }
    let det = u + v + w;
    let t = plane(corners, exact);
    // Not so where a number is undefined, too.
    (det != 0.0 && t.is_finite()).then(|| (t, v / det, w / det))
}

/// Exactly as the block test computes it.
fn sheared(p: Vec3, ray: &Prepared) -> (f64, f64) {
    let [x, y, z] = ray.axes.map(|axis| p[axis] - ray.origin[axis]);
    (
        f64::from(x - ray.shear.x * z),
        f64::from(y - ray.shear.y * z),
    )
}

/// Where the ray crosses the plane of the triangle; not finite if it does not.
fn plane(corners: [Vec3; 3], exact: &Exact) -> f64 {
    let place = |p: Vec3| match &exact.to_world {
        Some(to_world) => to_world.transform_point3(p.as_dvec3()),
        None => p.as_dvec3(),
    };
    let [a, b, c] = corners.map(place);
    let normal: DVec3 = (b - a).cross(c - a);
    normal.dot(a - exact.origin) / normal.dot(exact.direction)
}
