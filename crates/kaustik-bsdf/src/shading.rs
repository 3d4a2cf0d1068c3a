//! Shading normals: what they do to the adjoint (Veach 1997 ch. 5).
//!
//! A shading normal `ns` other than the geometric normal `ng` makes scattering asymmetric: the
//! eye's walk weighs with `f |wi.ns|`, so a light's walk must weigh with
//! `f |wo.ns| |wi.ng| / |wo.ng|` to estimate the same image. Where `ns` and `ng` disagree about
//! the side of a direction, light would leak through; such pairs are rejected by every strategy
//! alike, but for what passes straight through. All directions here are local (z = `ns`), `ng` is the geometric normal in that frame.

use crate::Mode;
use glam::DVec3;

/// Directions whose sum is shorter, squared, are one straight line: of rounding, and less than a ray resolves.
const STRAIGHT: f64 = 1e-12;

/// Do both normals put both directions on the same side? If not, the vertex scatters nothing. What passes straight
/// through, as through a pane, is on no wrong side of anything.
#[inline]
pub fn sides_agree(wo: DVec3, wi: DVec3, ng: DVec3) -> bool {
    let (out, into) = (wo.z * wo.dot(ng), wi.z * wi.dot(ng));
    (out > 0.0 && into > 0.0) || ((wo + wi).length_squared() < STRAIGHT && out * into != 0.0)
}

/// What to multiply [`Sample::weight`](crate::Sample::weight) by at a vertex of a walk: 1 in
/// radiance mode, `|wo.ns| |wi.ng| / (|wo.ng| |wi.ns|)` in importance mode, 0 where the sides disagree.
///
/// `wo` is where the walk came from. The result is finite: where the sides agree no divisor is 0.
#[inline]
pub fn walk_factor(wo: DVec3, wi: DVec3, ng: DVec3, mode: Mode) -> f64 {
    if !sides_agree(wo, wi, ng) {
        return 0.0;
    }
    match mode {
        Mode::Radiance => 1.0,
        // a walk from the light: wo points to it
        Mode::Importance => (wo.z * wi.dot(ng) / (wo.dot(ng) * wi.z)).abs(),
    }
}

/// What to multiply `f` by at a vertex of a connection whose geometry terms carry geometric
/// cosines: `|to_light.ns| / |to_light.ng|`, or 0 where the sides disagree.
///
/// `to_light` is the direction that light comes from and `to_eye` the one it leaves by, whichever
/// end the vertex was reached from.
#[inline]
pub fn connection_factor(to_eye: DVec3, to_light: DVec3, ng: DVec3) -> f64 {
    if !sides_agree(to_eye, to_light, ng) {
        return 0.0;
    }
    (to_light.z / to_light.dot(ng)).abs()
}
