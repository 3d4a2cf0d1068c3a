//! Small geometry of the local frame, where the normal is z.

use glam::DVec3;

/// Cosine below which a direction counts as grazing and nothing scatters: densities and
/// quotients of cosines stay finite above it.
const GRAZING: f64 = 1e-10;

/// Is this a direction one can scatter from (finite, not in the surface's plane)?
#[inline]
pub(crate) fn usable(w: DVec3) -> bool {
    // false for NaN, and for infinities too
    w.z.abs() > GRAZING && w.length_squared() < 2.0
}

/// `x` brought into `[low, high]`; what is not a number becomes `low`, which `clamp` does not do.
#[inline]
pub(crate) fn within(x: f64, low: f64, high: f64) -> f64 {
    x.max(low).min(high)
}

/// Do both lie on the same side, away from the surface's plane?
#[inline]
pub(crate) fn same_side(a: DVec3, b: DVec3) -> bool {
    usable(a) && usable(b) && a.z * b.z > 0.0
}

/// Mirror direction about the normal.
#[inline]
pub(crate) fn mirror(w: DVec3) -> DVec3 {
    DVec3::new(-w.x, -w.y, w.z)
}

/// `w` seen in the mirror that the surface is: to the other side, tangential part kept.
#[inline]
pub(crate) fn flip(w: DVec3) -> DVec3 {
    DVec3::new(w.x, w.y, -w.z)
}

/// `w` on the upper side, tangential part kept.
#[inline]
pub(crate) fn lift(w: DVec3) -> DVec3 {
    DVec3::new(w.x, w.y, w.z.abs())
}

/// `w`, given for z > 0, moved to the side of `side`.
#[inline]
pub(crate) fn to_side_of(side: DVec3, w: DVec3) -> DVec3 {
    if side.z < 0.0 { flip(w) } else { w }
}

/// Mirror direction of `w` about the unit vector `h`.
#[inline]
pub(crate) fn reflect(w: DVec3, h: DVec3) -> DVec3 {
    h * (2.0 * w.dot(h)) - w
}

/// Splits `[0, 1)` at `p`: were we below it, and the rest stretched to `[0, 1)` again.
#[inline]
pub(crate) fn choose(uc: f64, p: f64) -> (bool, f64) {
    const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;
    if uc < p {
        (true, (uc / p).min(BELOW_ONE))
    } else {
        (false, ((uc - p) / (1.0 - p)).clamp(0.0, BELOW_ONE))
    }
}
