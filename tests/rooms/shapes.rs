//! What rooms are made of: sheets, blocks, balls.

use std::sync::Arc;

use glam::{Quat, Vec2, Vec3};
use kaustik::geometry::Mesh;
use kaustik::scene::builtin;

/// The square from -1 to 1 that looks along z, with texture coordinates.
pub(super) fn sheet() -> Mesh {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    Mesh {
        positions: corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec(),
        indices: vec![[0, 1, 2], [0, 2, 3]],
        uv: [
            corners
                .map(|(x, y)| Vec2::new(0.5 + 0.5 * x, 0.5 - 0.5 * y))
                .to_vec(),
            Vec::new(),
        ],
        ..Mesh::default()
    }
}

/// The faces of the cube from -1 to 1, seen from without (`side` 1) or from within (-1); the one above is the last.
pub(super) fn faces(side: f32) -> [Mesh; 6] {
    let quarter = std::f32::consts::FRAC_PI_2;
    let turns = [
        Quat::IDENTITY,
        Quat::from_rotation_y(quarter),
        Quat::from_rotation_y(2.0 * quarter),
        Quat::from_rotation_y(3.0 * quarter),
        Quat::from_rotation_x(quarter),
        Quat::from_rotation_x(-quarter),
    ];
    turns.map(|turn| {
        let mut face = sheet();
        for at in &mut face.positions {
            *at = turn * (*at + Vec3::Z);
        }
        if side < 0.0 {
            for triangle in &mut face.indices {
                triangle.swap(1, 2);
            }
        }
        face
    })
}

pub(super) fn cube() -> Mesh {
    let mut cube = Mesh::default();
    for face in faces(1.0) {
        let first = cube.positions.len() as u32;
        let indices = face.indices.iter().map(|t| t.map(|i| i + first));
        cube.indices.extend(indices);
        cube.positions.extend(face.positions);
        cube.uv[0].extend(&face.uv[0]);
    }
    cube
}

/// A ball of radius 1 with smooth normals, and texture coordinates that are about one in longitude.
pub(super) fn ball() -> Mesh {
    let scene = builtin::load("ring-and-sphere").expect("a built-in scene");
    let smooth = |mesh: &&Arc<Mesh>| !mesh.normals.is_empty();
    let largest = |mesh: &&Arc<Mesh>| mesh.triangle_count();
    let found = scene.meshes.iter().filter(smooth).max_by_key(largest);
    let mut ball = Mesh::clone(found.expect("a ball"));
    ball.positions.clone_from(&ball.normals);
    let uv = |n: &Vec3| Vec2::new(0.5 + 0.5 * n.x, 0.5 - 0.5 * n.y);
    ball.uv[0] = ball.normals.iter().map(uv).collect();
    ball
}
