//! Tangents that meshes get, beside those of single triangles, which need nothing but that triangle.

use std::f32::consts::{PI, TAU};
use std::sync::Arc;
use std::time::Instant;

use glam::{Affine3A, Vec2, Vec3, Vec4};
use kaustik_geometry::{Hit, Instance, Mesh, Unwrapping, World};
use proptest::prelude::*;

use super::super::tangents::complete;

const COLUMNS: u32 = 12;
const ROWS: u32 = 8;

/// A coarse ball under a map of the world: u to the east, v to the south.
fn globe() -> Mesh {
    let mut mesh = Mesh::default();
    for row in 0..=ROWS {
        for column in 0..=COLUMNS {
            let (u, v) = (column as f32 / COLUMNS as f32, row as f32 / ROWS as f32);
            let (east, south) = ((TAU * u).sin_cos(), (PI * v).sin_cos());
            let normal = Vec3::new(south.0 * east.1, south.1, -south.0 * east.0);
            mesh.positions.push(normal);
            mesh.normals.push(normal);
            mesh.uv[0].push(Vec2::new(u, v));
        }
    }
    let at = |row, column| row * (COLUMNS + 1) + column;
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let [a, b] = [at(row, column), at(row + 1, column)];
            mesh.indices.push([a, b, b + 1]);
            mesh.indices.push([a, b + 1, a + 1]);
        }
    }
    mesh
}

fn standing(mesh: u32) -> Instance {
    Instance {
        mesh,
        transform: Affine3A::IDENTITY,
    }
}

fn completed(mesh: Mesh) -> Arc<Mesh> {
    let mut instances = [standing(0)];
    let along = |_| Some(Unwrapping::default());
    let list = complete(&[Arc::new(mesh)], &mut instances, along);
    assert_eq!((list.len(), instances[0].mesh), (1, 0));
    Arc::clone(&list[0])
}

fn tangent(mesh: &Arc<Mesh>, primitive: usize, [u, v]: [f32; 2]) -> Vec4 {
    let world = World::build(vec![Arc::clone(mesh)], vec![standing(0)]).expect("a world");
    let hit = Hit {
        t: 1.0,
        instance: 0,
        primitive: primitive as u32,
        u,
        v,
    };
    let [a, b, c] = mesh.indices[primitive].map(|i| mesh.normals[i as usize]);
    let normal = (a * (1.0 - u - v) + b * u + c * v).normalize();
    let along = Unwrapping::default();
    world.tangent(&hit, normal, &along).expect("a tangent")
}

/// They have the side and roughly the direction of each triangle's own, and go on where triangles meet.
#[test]
fn tangents_go_on_across_edges() {
    let (plain, smooth) = (Arc::new(globe()), completed(globe()));
    assert_eq!(plain.indices.len(), smooth.indices.len());
    let (mut jumps, mut steps) = (0.0_f32, 0.0_f32);
    // Without the triangles at the poles, some of which are none.
    let inner = 2 * COLUMNS as usize..2 * (COLUMNS * (ROWS - 1)) as usize;
    for triangle in inner.step_by(2) {
        let middle = [1.0 / 3.0; 2];
        for triangle in [triangle, triangle + 1] {
            let of = |mesh| tangent(mesh, triangle, middle);
            let (own, made) = (of(&plain), of(&smooth));
            assert_eq!(own.w.to_bits(), made.w.to_bits());
            assert!(own.truncate().dot(made.truncate()) > 0.95, "{own} {made}");
        }
        if (triangle / 2 + 1).is_multiple_of(COLUMNS as usize) {
            continue;
        }
        // Halfway along the meridian that this column shares with the next.
        let across = |mesh| {
            let west = tangent(mesh, triangle + 1, [0.5, 0.5]);
            (west - tangent(mesh, triangle + 2, [0.5, 0.0])).length()
        };
        jumps = jumps.max(across(&plain));
        steps = steps.max(across(&smooth));
    }
    assert!(steps < 1e-5 && jumps > 0.1, "{steps} {jumps}");
}

/// Where a texture is mirrored, each side has its own tangents, and vertices of its own.
#[test]
fn mirrored_sides_stay_apart() {
    let mut mesh = Mesh::default();
    for x in [-1.0_f32, 0.0, 1.0] {
        for y in [0.0, 1.0] {
            mesh.positions.push(Vec3::new(x, y, 0.0));
            mesh.normals.push(Vec3::Z);
            mesh.uv[0].push(Vec2::new(x.abs(), 1.0 - y));
            mesh.colors.push([x, y, 0.5, 1.0]);
        }
    }
    mesh.indices = vec![[0, 2, 3], [0, 3, 1], [2, 4, 5], [2, 5, 3]];
    let made = completed(mesh);
    assert_eq!((made.positions.len(), made.tangents.len()), (8, 8));
    for (triangle, x) in [(0, -1.0), (1, -1.0), (2, 1.0), (3, 1.0)] {
        let found = tangent(&made, triangle, [0.3, 0.3]);
        assert!(
            (found - Vec4::new(x, 0.0, 0.0, x)).length() < 1e-6,
            "{found}"
        );
        for vertex in made.indices[triangle].map(|i| i as usize) {
            let (place, color) = (made.positions[vertex], made.colors[vertex]);
            assert_eq!(
                [place.x, place.y].map(f32::to_bits),
                [color[0], color[1]].map(f32::to_bits)
            );
            assert!(place.x * x >= 0.0);
        }
    }
}

/// Each instance has the mesh that its material needs, but that one gets tangents once; what nobody needs as it was is not kept.
#[test]
fn instances_get_what_they_need() {
    let meshes = [Arc::new(globe()), Arc::new(globe())];
    let plain = Some(Unwrapping::default());
    let turned = Some(Unwrapping {
        turned: glam::DMat2::from_angle(1.0),
        ..Unwrapping::default()
    });
    let needs = [None, plain, turned, turned, turned];
    let mut instances = [0, 0, 0, 1, 1].map(standing);
    let list = complete(&meshes, &mut instances, |i| needs[i]);
    assert_eq!(instances.each_ref().map(|i| i.mesh), [0, 2, 0, 1, 1]);
    assert_eq!(list.len(), 3);
    assert!(Arc::ptr_eq(&list[0], &meshes[0]));
    assert!(list[1..].iter().all(|mesh| !mesh.tangents.is_empty()));
    assert_ne!(list[1].tangents, list[2].tangents);
}

/// Textures that lie in a thousand ways make no thousand meshes.
#[test]
fn a_mesh_gets_tangents_once() {
    let mut instances = vec![standing(0); 1000];
    let list = complete(&[Arc::new(globe())], &mut instances, |i| {
        Some(Unwrapping {
            turned: glam::DMat2::from_angle(i as f64 * 1e-3),
            ..Unwrapping::default()
        })
    });
    assert_eq!(list.len(), 2);
}

/// A wheel of so many triangles around one vertex would take the square of their number, and a stack as deep.
#[test]
fn crowded_vertices_are_left() {
    const SPOKES: u32 = 100_000;
    let rim = (0..SPOKES).map(|i| TAU * i as f32 / SPOKES as f32);
    let mut mesh = Mesh {
        positions: vec![Vec3::ZERO],
        ..Mesh::default()
    };
    mesh.positions
        .extend(rim.map(|angle| Vec3::new(angle.cos(), angle.sin(), 0.0)));
    mesh.normals = vec![Vec3::Z; mesh.positions.len()];
    mesh.uv[0] = mesh.positions.iter().map(|p| p.truncate()).collect();
    mesh.indices = (1..SPOKES).map(|i| [0, i, i + 1]).collect();
    let started = Instant::now();
    assert!(completed(mesh).tangents.is_empty());
    assert!(started.elapsed().as_secs() < 5);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Whatever the mesh: its triangles stay where they are, and tangents are finite.
    #[test]
    fn any_mesh_keeps_its_triangles(
        vertices in prop::collection::vec((prop::array::uniform8(-2_i8..3), any::<bool>()), 1..12),
        triangles in prop::collection::vec(prop::array::uniform3(0_u32..12), 0..40),
    ) {
        let mut mesh = Mesh::default();
        for (v, huge) in &vertices {
            let [x, y, z, i, j, k, s, t] = v.map(|v| f32::from(v) * if *huge { 1e37 } else { 1.0 });
            mesh.positions.push(Vec3::new(x, y, z));
            mesh.normals.push(Vec3::new(i, j, k));
            mesh.uv[0].push(Vec2::new(s, t));
        }
        let count = vertices.len() as u32;
        mesh.indices = triangles.iter().map(|t| t.map(|i| i % count)).collect();
        let made = completed(mesh.clone());
        prop_assert_eq!(made.indices.len(), mesh.indices.len());
        for (a, b) in made.indices.iter().zip(&mesh.indices) {
            for (a, b) in a.iter().zip(b) {
                prop_assert_eq!(made.positions[*a as usize], mesh.positions[*b as usize]);
                prop_assert_eq!(made.uv[0][*a as usize], mesh.uv[0][*b as usize]);
            }
        }
        prop_assert!(made.tangents.iter().all(|t| t.is_finite()));
    }
}
