use glam::{Vec2, Vec3};
use kaustik_geometry::Mesh;

/// A rectangle around `centre`, from `-u` to `u` and from `-v` to `v`; its front faces `u` x `v`.
pub fn rectangle(centre: Vec3, u: Vec3, v: Vec3) -> Mesh {
    Mesh {
        positions: vec![
            centre - u - v,
            centre + u - v,
            centre + u + v,
            centre - u + v,
        ],
        indices: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// The same with texture coordinates, which run along `u` and against `v`, as a picture lies.
pub fn rectangle_with_uv(centre: Vec3, u: Vec3, v: Vec3) -> Mesh {
    Mesh {
        uv: [
            vec![Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::X, Vec2::ZERO],
            Vec::new(),
        ],
        ..rectangle(centre, u, v)
    }
}

/// A level square at the height `y` that faces up, from `-half` to `half`.
pub fn floor(y: f32, half: f32) -> Mesh {
    rectangle(Vec3::Y * y, Vec3::Z * half, Vec3::X * half)
}

/// A level square that faces down; its edge is twice `half`.
pub fn ceiling(centre: Vec3, half: f32) -> Mesh {
    rectangle(centre, Vec3::X * half, Vec3::Z * half)
}

/// A closed box, facing outward.
pub fn cuboid(min: Vec3, max: Vec3) -> Mesh {
    let (centre, half) = ((min + max) * 0.5, (max - min) * 0.5);
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        let along = |i: usize, sign: f32| {
            let mut v = Vec3::ZERO;
            v[(axis + i) % 3] = half[(axis + i) % 3] * sign;
            v
        };
        for sign in [1.0, -1.0] {
            let face = rectangle(centre + along(0, sign), along(1, 1.0), along(2, sign));
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(face.positions);
            mesh.indices
                .extend(face.indices.iter().map(|t| t.map(|i| i + first)));
        }
    }
    mesh
}

/// A coarse sphere with interpolated normals, facing outward.
pub fn sphere(centre: Vec3, radius: f32) -> Mesh {
    const RINGS: u32 = 6;
    let mut mesh = Mesh::default();
    let normal = |ring: u32, spoke: u32| {
        let theta = std::f32::consts::PI * ring as f32 / RINGS as f32;
        let phi = std::f32::consts::PI * (spoke % (2 * RINGS)) as f32 / RINGS as f32;
        let (y, across) = (theta.cos(), theta.sin());
        Vec3::new(across * phi.cos(), y, across * phi.sin())
    };
    for ring in 0..RINGS {
        for spoke in 0..2 * RINGS {
            let first = mesh.positions.len() as u32;
            let corners = [(0, 0), (0, 1), (1, 1), (1, 0)];
            let normals = corners.map(|(r, s)| normal(ring + r, spoke + s));
            mesh.positions.extend(normals.map(|n| centre + n * radius));
            mesh.normals.extend(normals);
            if ring + 1 < RINGS {
                mesh.indices.push([first, first + 2, first + 3]);
            }
            if ring > 0 {
                mesh.indices.push([first, first + 1, first + 2]);
            }
        }
    }
    mesh
}
