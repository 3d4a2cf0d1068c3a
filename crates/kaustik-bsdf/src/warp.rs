//! Maps from the unit square to where directions and points live, with their densities.
//!
//! All are continuous and bend the square as little as they can, since a Markov chain moves in
//! the square and hopes to move little on the sphere. No function of the C library is called:
//! the same square gives the same bits everywhere.

use glam::DVec3;
use std::f64::consts::{FRAC_1_PI, FRAC_PI_4, TAU};

/// Sine and cosine of `turns` full turns, within 1e-15; exact at quarter turns.
#[inline]
pub fn sin_cos_turns(turns: f64) -> (f64, f64) {
    let quarter = (turns * 4.0).round();
    let x = (turns - quarter * 0.25) * TAU; // within an eighth of a turn
    let (s, c) = sin_cos_eighth(x);
    // which quadrant; euclidean, so that negative turns work too
    match (quarter as i64) & 3 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

/// Taylor series for |x| <= pi/4; the first term left out is below 1e-16.
#[inline]
fn sin_cos_eighth(x: f64) -> (f64, f64) {
    let q = x * x;
    let s = 1.0 / 355_687_428_096_000.0;
    let s = -1.0 / 1_307_674_368_000.0 + q * s;
    let s = 1.0 / 6_227_020_800.0 + q * s;
    let s = -1.0 / 39_916_800.0 + q * s;
    let s = 1.0 / 362_880.0 + q * s;
    let s = -1.0 / 5_040.0 + q * s;
    let s = 1.0 / 120.0 + q * s;
    let s = -1.0 / 6.0 + q * s;
    let c = 1.0 / 20_922_789_888_000.0;
    let c = -1.0 / 87_178_291_200.0 + q * c;
    let c = 1.0 / 479_001_600.0 + q * c;
    let c = -1.0 / 3_628_800.0 + q * c;
    let c = 1.0 / 40_320.0 + q * c;
    let c = -1.0 / 720.0 + q * c;
    let c = 1.0 / 24.0 + q * c;
    let c = -0.5 + q * c;
    (x + x * q * s, 1.0 + q * c)
}

/// Point of the unit disk, uniform by area (Shirley and Chiu's concentric map).
#[inline]
pub fn concentric_disk(u: [f64; 2]) -> [f64; 2] {
    let (x, y) = disk(u[0], u[1]);
    [x, y]
}

/// The same in numbers that stay in registers: an array comes back through memory, where two stores of a number each
/// make a load of both wait.
#[inline]
fn disk(u: f64, v: f64) -> (f64, f64) {
    let a = 2.0 * u - 1.0;
    let b = 2.0 * v - 1.0;
    // each of the four triangles of the square fills a quarter of the disk
    let (r, slope, steep) = if a.abs() > b.abs() {
        (a, b / a, false)
    } else {
        (b, a / b, true)
    };
    if r == 0.0 {
        return (0.0, 0.0);
    }
    let (s, c) = sin_cos_eighth(slope * FRAC_PI_4);
    if steep {
        (r * s, r * c)
    } else {
        (r * c, r * s)
    }
}

/// Direction of the hemisphere z > 0 with density [`cosine_hemisphere_pdf`].
#[inline]
pub fn cosine_hemisphere(u: [f64; 2]) -> DVec3 {
    let (x, y) = disk(u[0], u[1]);
    DVec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt())
}

/// Density of [`cosine_hemisphere`] per solid angle: `cos / pi` above, 0 below.
#[inline]
pub fn cosine_hemisphere_pdf(cosine: f64) -> f64 {
    cosine.max(0.0) * FRAC_1_PI
}

/// Direction of the whole sphere, uniform: the disk's inner half area is the upper half.
#[inline]
pub fn uniform_sphere(u: [f64; 2]) -> DVec3 {
    cap(u, 2.0)
}

/// Density of [`uniform_sphere`] per solid angle.
pub const SPHERE_PDF: f64 = 0.25 * FRAC_1_PI;

/// Direction within the cone about +z whose half angle has the given cosine, uniform.
#[inline]
pub fn uniform_cone(u: [f64; 2], cos_half_angle: f64) -> DVec3 {
    cap(u, 1.0 - cos_half_angle)
}

/// Density of [`uniform_cone`] per solid angle within the cone.
#[inline]
pub fn uniform_cone_pdf(cos_half_angle: f64) -> f64 {
    0.5 * FRAC_1_PI / (1.0 - cos_half_angle)
}

/// Direction of the cap of the sphere about +z of the given height in `[0, 2]`, uniform: Lambert's
/// equal-area map of the disk. Density `1 / (2 pi height)`.
#[inline]
pub fn cap(u: [f64; 2], height: f64) -> DVec3 {
    let [x, y] = concentric_disk(u);
    let drop = (x * x + y * y).min(1.0) * height; // 1 - cos
    // sin^2 = drop (2 - drop), of which the disk's radius brings sqrt(drop / height)
    let scale = (height * (2.0 - drop)).max(0.0).sqrt();
    DVec3::new(x * scale, y * scale, 1.0 - drop)
}

/// Barycentric weights of the second and third corner, uniform over a triangle.
///
/// The square's lower half goes to one half of the triangle and the upper half to the other by
/// shears that meet on the diagonal (Heitz's map): continuous, no root.
#[inline]
pub fn uniform_triangle(u: [f64; 2]) -> [f64; 2] {
    if u[1] > u[0] {
        let x = u[0] * 0.5;
        [x, u[1] - x]
    } else {
        let y = u[1] * 0.5;
        [u[0] - y, y]
    }
}
