//! A seated figure, swept about the vertical: closed, smooth, of about 300,000 triangles.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};
use kaustik_geometry::Mesh;

/// Rings from the bottom to the top, and cells around: 2 * 548 * 273 = 299,208 triangles.
const RINGS: u32 = 274;
const AROUND: u32 = 548;

/// Height of the figure; it is about as wide.
pub(super) const HEIGHT: f64 = 2.6;

/// Ellipsoids about the axis: height of the middle, radius, half height.
const PARTS: [(f64, f64, f64); 6] = [
    (0.22, 1.12, 0.26), // plinth
    (0.62, 1.00, 0.42), // crossed legs
    (1.20, 0.62, 0.75), // trunk
    (1.62, 0.66, 0.28), // shoulders
    (2.10, 0.36, 0.38), // head
    (2.44, 0.17, 0.17), // knot of hair
];

/// The figure standing on the origin, its front toward -z turned by `turn` radians about the
/// vertical; shifted to `foot`.
pub(super) fn statue(foot: Vec3, turn: f64) -> Mesh {
    let mut mesh = Mesh::default();
    let (bottom, top) = (PARTS[0].0 - PARTS[0].2, HEIGHT);
    let add = |mesh: &mut Mesh, point: DVec3| mesh.positions.push(foot + point.as_vec3());
    add(&mut mesh, DVec3::Y * bottom);
    for ring in 1..RINGS {
        let share = 0.5 * (1.0 - libm::cos(PI * f64::from(ring) / f64::from(RINGS)));
        let y = bottom + (top - bottom) * share;
        for cell in 0..AROUND {
            let phi = TAU * f64::from(cell) / f64::from(AROUND);
            let radius = radius(y, phi);
            let at = phi + turn;
            let point = DVec3::new(radius * libm::sin(at), y, -radius * libm::cos(at));
            add(&mut mesh, point);
        }
    }
    add(&mut mesh, DVec3::Y * top);
    mesh.indices = indices();
    mesh.normals = normals(&mesh);
    mesh
}

/// Distance of the surface from the axis; `phi` is 0 in front.
fn radius(y: f64, phi: f64) -> f64 {
    let mut sum = 0.0;
    for (part, &(middle, width, half)) in PARTS.iter().enumerate() {
        let t = (y - middle) / half;
        let width = match part {
            1 => width * (0.92 + 0.16 * libm::sin(phi) * libm::sin(phi)), // knees
            3 => width * (0.78 + 0.3 * libm::sin(phi) * libm::sin(phi)),
            _ => width,
        };
        let level = width * (1.0 - t * t).max(0.0).sqrt();
        sum += libm::pow(level, 10.0);
    }
    let plain = libm::pow(sum, 0.1);
    // folds of a robe, strongest at the middle of the body, none at the head and at the ends
    let robe = bump((y - 1.0) / 0.9);
    let folds = 0.022 * libm::sin(13.0 * phi + 5.0 * y) + 0.012 * libm::sin(31.0 * phi - 11.0 * y);
    let lotus = 0.05 * bump((y - 0.22) / 0.26) * libm::cos(24.0 * phi).abs();
    let hair = 0.015 * bump((y - 2.3) / 0.25) * libm::sin(40.0 * phi) * libm::sin(60.0 * y);
    let nose = 0.09 * bump((y - 2.05) / 0.12) * bump(turned(phi) / 0.22);
    plain * (1.0 + robe * folds + lotus + hair + nose)
}

/// 1 at 0, 0 beyond 1, smooth.
fn bump(t: f64) -> f64 {
    let room = (1.0 - t * t).max(0.0);
    room * room
}

/// The angle in [-pi, pi).
fn turned(phi: f64) -> f64 {
    if phi < PI { phi } else { phi - TAU }
}

fn indices() -> Vec<[u32; 3]> {
    let last = 1 + (RINGS - 1) * AROUND;
    let vertex = |ring: u32, cell: u32| match ring {
        0 => 0,
        RINGS => last,
        _ => 1 + (ring - 1) * AROUND + cell % AROUND,
    };
    let mut triangles = Vec::with_capacity((2 * AROUND * (RINGS - 1)) as usize);
    for ring in 0..RINGS {
        for cell in 0..AROUND {
            let [a, b] = [vertex(ring, cell), vertex(ring, cell + 1)];
            let [c, d] = [vertex(ring + 1, cell), vertex(ring + 1, cell + 1)];
            if ring > 0 {
                triangles.push([a, c, b]);
            }
            if ring + 1 < RINGS {
                triangles.push([b, c, d]);
            }
        }
    }
    triangles
}

/// Means of the faces about each corner, by area.
fn normals(mesh: &Mesh) -> Vec<Vec3> {
    let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
    for triangle in &mesh.indices {
        let [a, b, c] = triangle.map(|i| mesh.positions[i as usize].as_dvec3());
        let normal = (b - a).cross(c - a);
        for &i in triangle {
            sums[i as usize] += normal;
        }
    }
    sums.into_iter()
        .map(|sum| sum.normalize().as_vec3())
        .collect()
}
