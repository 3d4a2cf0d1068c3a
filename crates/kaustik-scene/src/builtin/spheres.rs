//! Spheres: by latitude and longitude with smooth normals, or by subdivision and flat.

use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};
use kaustik_geometry::Mesh;

/// A sphere of `stacks` by `2 stacks` cells about the y axis with vertex normals: closed, no
/// vertex twice, 4 stacks (stacks - 1) triangles.
pub(super) fn sphere(centre: Vec3, radius: f32, stacks: u32) -> Mesh {
    let slices = 2 * stacks;
    let mut mesh = Mesh::default();
    let mut add = |normal: DVec3| {
        mesh.positions
            .push(centre + (normal * f64::from(radius)).as_vec3());
        mesh.normals.push(normal.as_vec3());
    };
    add(DVec3::Y);
    for stack in 1..stacks {
        let theta = PI * f64::from(stack) / f64::from(stacks);
        let (sin, y) = (libm::sin(theta), libm::cos(theta));
        for slice in 0..slices {
            let phi = TAU * f64::from(slice) / f64::from(slices);
            add(DVec3::new(sin * libm::cos(phi), y, sin * libm::sin(phi)));
        }
    }
    add(DVec3::NEG_Y);
    let vertex = |stack: u32, slice: u32| match stack {
        0 => 0,
        _ if stack == stacks => 1 + (stacks - 1) * slices,
        _ => 1 + (stack - 1) * slices + slice % slices,
    };
    for stack in 0..stacks {
        for slice in 0..slices {
            let [a, b] = [vertex(stack, slice), vertex(stack, slice + 1)];
            let [c, d] = [vertex(stack + 1, slice), vertex(stack + 1, slice + 1)];
            if stack > 0 {
                mesh.indices.push([a, b, c]);
            }
            if stack + 1 < stacks {
                mesh.indices.push([b, d, c]);
            }
        }
    }
    mesh
}

/// A polyhedron of 20 * 4^`level` flat, nearly equal triangles with corners on the sphere about
/// the origin. Without vertex normals, so that laws which hold for flat surfaces (a furnace)
/// hold exactly. `inward` turns the front to the inside.
pub(super) fn polyhedron(radius: f32, level: u32, inward: bool) -> Mesh {
    let (mut corners, mut triangles) = icosahedron();
    for _ in 0..level {
        triangles = subdivide(&mut corners, &triangles);
    }
    if inward {
        for triangle in &mut triangles {
            triangle.swap(1, 2);
        }
    }
    let at = |corner: &DVec3| (*corner * f64::from(radius)).as_vec3();
    Mesh {
        positions: corners.iter().map(at).collect(),
        indices: triangles,
        ..Mesh::default()
    }
}

fn icosahedron() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut corners = Vec::new();
    for s in [-1.0, 1.0] {
        for t in [-golden, golden] {
            corners.extend([
                DVec3::new(0.0, s, t),
                DVec3::new(s, t, 0.0),
                DVec3::new(t, 0.0, s),
            ]);
        }
    }
    // its faces are the triples of corners at edge length 2, turned outward
    let near = |a: usize, b: usize| (corners[a].distance(corners[b]) - 2.0).abs() < 1e-9;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(a, c) {
                    let [p, q, r] = [a, b, c].map(|i| corners[i]);
                    let outward = (q - p).cross(r - p).dot(p + q + r) > 0.0;
                    let order = if outward { [a, b, c] } else { [a, c, b] };
                    triangles.push(order.map(|i| i as u32));
                }
            }
        }
    }
    let unit = corners.into_iter().map(DVec3::normalize).collect();
    (unit, triangles)
}

/// Four triangles for each, their new corners on the unit sphere.
fn subdivide(corners: &mut Vec<DVec3>, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middles = HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            let sum = corners[a as usize] + corners[b as usize];
            corners.push(sum.normalize());
            corners.len() as u32 - 1
        })
    };
    let mut finer = Vec::with_capacity(4 * triangles.len());
    for &[a, b, c] in triangles {
        let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
        finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    finer
}
