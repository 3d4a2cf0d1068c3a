//! What is refused, and what must be survived.

use std::sync::Arc;

use glam::{Affine3A, Mat3A, Vec2, Vec3, Vec3A};
use kaustik_geometry::{Aabb, Instance, Mesh, MeshError, Ray, World, WorldError};

use crate::support::{Random, cube, icosphere, single};

fn triangle() -> Mesh {
    Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]).unwrap()
}

#[test]
fn meshes_say_what_is_wrong_with_them() {
    let positions = || vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    assert_eq!(
        Mesh::new(positions(), vec![[0, 1, 2], [0, 1, 3]]),
        Err(MeshError::IndexOutOfRange {
            triangle: 1,
            vertex: 3,
            vertices: 3
        })
    );
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut wrong = positions();
        wrong[1].z = bad;
        let expected = Err(MeshError::NonFinite {
            attribute: "position",
            vertex: 1,
        });
        assert_eq!(Mesh::new(wrong, vec![[0, 1, 2]]), expected);
        let uv = vec![Vec2::ZERO, Vec2::ZERO, Vec2::new(bad, 0.0)];
        let expected = Err(MeshError::NonFinite {
            attribute: "uv 1",
            vertex: 2,
        });
        assert_eq!(triangle().with_uv([vec![], uv]), expected);
    }
    let expected = Err(MeshError::Length {
        attribute: "normals",
        found: 2,
        vertices: 3,
    });
    assert_eq!(triangle().with_normals(vec![Vec3::Z; 2]), expected);
    let message = triangle()
        .with_colors(vec![[0.0; 4]])
        .unwrap_err()
        .to_string();
    assert_eq!(message, "1 values of colors for 3 vertices");
}

#[test]
fn worlds_say_what_is_wrong_with_them() {
    let build = |mesh, transform| {
        let fine = Instance {
            mesh: 0,
            transform: Affine3A::IDENTITY,
        };
        World::build(
            vec![Arc::new(triangle())],
            vec![fine, Instance { mesh, transform }],
        )
        .map(|_| ())
    };
    let expected = Err(WorldError::NoSuchMesh {
        instance: 1,
        mesh: 3,
        meshes: 1,
    });
    assert_eq!(build(3, Affine3A::IDENTITY), expected);
    let flat = Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0));
    assert_eq!(build(0, flat), Err(WorldError::Singular { instance: 1 }));
    let dependent =
        Affine3A::from_mat3(Mat3A::from_cols(Vec3A::X, Vec3A::Y, Vec3A::X + Vec3A::Y).into());
    assert_eq!(
        build(0, dependent),
        Err(WorldError::Singular { instance: 1 })
    );
    for bad in [f32::NAN, f32::INFINITY] {
        let shift = Affine3A::from_translation(Vec3::new(0.0, bad, 0.0));
        assert_eq!(build(0, shift), Err(WorldError::NonFinite { instance: 1 }));
        let size = Affine3A::from_scale(Vec3::splat(bad));
        assert!(matches!(
            build(0, size),
            Err(WorldError::NonFinite { .. } | WorldError::Singular { .. })
        ));
    }
    let broken = Mesh {
        indices: vec![[0, 1, 7]],
        ..triangle()
    };
    let source = MeshError::IndexOutOfRange {
        triangle: 0,
        vertex: 7,
        vertices: 3,
    };
    let found = World::build(vec![Arc::new(triangle()), Arc::new(broken)], vec![]).map(|_| ());
    assert_eq!(found, Err(WorldError::Mesh { mesh: 1, source }));
}

#[test]
fn empty_worlds_hold_nothing() {
    let ray = Ray::new(Vec3::ZERO, Vec3::X);
    let placed = Instance {
        mesh: 0,
        transform: Affine3A::IDENTITY,
    };
    let nothing = Arc::new(Mesh::default());
    for world in [
        World::build(vec![], vec![]).unwrap(),
        World::build(vec![Arc::new(triangle())], vec![]).unwrap(),
        World::build(vec![nothing.clone()], vec![placed]).unwrap(),
        World::build(vec![nothing], vec![placed; 5]).unwrap(),
    ] {
        assert!(world.intersect(&ray).is_none());
        assert!(!world.occluded(&ray));
        assert_eq!(world.bounds(), Aabb::EMPTY);
        assert_eq!(world.triangle_count(), 0);
    }
}

#[test]
fn degenerate_triangles_are_never_met() {
    let points = vec![Vec3::ZERO, Vec3::X, Vec3::X * 2.0, Vec3::Y];
    let indices = vec![[0, 0, 0], [0, 1, 2], [0, 1, 1], [3, 3, 0]];
    let world = single(Mesh::new(points, indices).unwrap());
    let mut random = Random(1);
    for _ in 0..10_000 {
        let target = Vec3::X * 2.0 * random.unit();
        let origin = random.cube();
        assert!(
            world
                .intersect(&Ray::new(origin, target - origin))
                .is_none()
        );
        assert!(world.intersect(&Ray::new(origin, -Vec3::Z)).is_none());
    }
    assert!(
        world
            .surface_at(0, 0, 0.3, 0.3)
            .geometric_normal
            .is_normalized()
    );
}

/// Every mesh that fits `f32` builds and is walked without a panic, and is still found where its numbers allow.
#[test]
fn extreme_coordinates_are_survived() {
    for exponent in [-38, -30, -20, -10, 10, 20, 30, 38] {
        let scale = 10f32.powi(exponent);
        let mesh = crate::support::scaled(icosphere(2), scale);
        for world in [single(mesh.clone()), single(mesh).portable()] {
            let mut random = Random(2);
            let mut leaks = 0;
            for _ in 0..2000 {
                let ray = Ray::new(random.cube() * scale * 0.3, random.direction());
                leaks += u32::from(world.intersect(&ray).is_none());
                world.occluded(&Ray {
                    t_max: scale,
                    ..ray
                });
            }
            if exponent.abs() <= 10 {
                assert_eq!(leaks, 0, "at 1e{exponent}");
            }
        }
    }
    let mut random = Random(3);
    let far = |random: &mut Random| random.cube() * 3e38;
    let positions: Vec<Vec3> = (0..300).map(|_| far(&mut random)).collect();
    let indices = (0..100).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let world = single(Mesh::new(positions, indices).unwrap());
    for _ in 0..1000 {
        let ray = Ray::new(far(&mut random), random.direction());
        if let Some(hit) = world.intersect(&ray) {
            let surface = world.surface(&ray, &hit);
            Ray::between(&surface, &world.surface_at(0, 5, 0.2, 0.3));
            world.intersect(&Ray::spawn(&surface, random.direction()));
        }
    }
}

/// Flat, collinear and coincident meshes have boxes without an extent in some axis.
#[test]
fn flat_meshes_are_found() {
    let mut mesh = cube(20);
    for p in &mut mesh.positions {
        p.y = 0.25;
    }
    let world = single(mesh);
    let mut random = Random(4);
    for _ in 0..2000 {
        let target = Vec3::new(random.unit() - 0.5, 0.25, random.unit() - 0.5);
        let origin = target + random.direction() + Vec3::Y * 1.1;
        assert!(world.occluded(&Ray::new(origin, target - origin)));
        assert!(world.occluded(&Ray::new(Vec3::new(target.x, 3.0, target.z), -Vec3::Y)));
    }
    let heap = Mesh::new(triangle().positions, vec![[0, 1, 2]; 5000]).unwrap();
    let ray = Ray::new(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z);
    assert_eq!(single(heap).intersect(&ray).unwrap().primitive, 0);
}

#[test]
fn rays_without_direction_meet_nothing() {
    let world = single(icosphere(1));
    for bad in [
        Vec3::ZERO,
        Vec3::NAN,
        Vec3::INFINITY,
        Vec3::new(1.0, f32::NAN, 0.0),
        Vec3::splat(1e-45),
    ] {
        assert!(world.intersect(&Ray::new(Vec3::ZERO, bad)).is_none());
        assert!(!world.occluded(&Ray::new(Vec3::ZERO, bad)));
    }
    assert!(world.intersect(&Ray::new(Vec3::NAN, Vec3::X)).is_none());
    assert!(
        world
            .intersect(&Ray {
                t_max: -1.0,
                ..Ray::new(Vec3::ZERO, Vec3::X)
            })
            .is_none()
    );
    assert!(
        world
            .intersect(&Ray {
                t_max: f32::NAN,
                ..Ray::new(Vec3::ZERO, Vec3::X)
            })
            .is_none()
    );
}

#[test]
fn memory_stays_below_150_bytes_a_triangle() {
    let mesh = icosphere(6);
    let arrays = mesh.memory();
    let world = single(mesh);
    let each = (world.memory() + arrays) as f64 / world.triangle_count() as f64;
    assert!(each < 150.0, "{each}");
    // Copies cost no triangles.
    let mesh = Arc::new(icosphere(5));
    let placed = |x| Instance {
        mesh: 0,
        transform: Affine3A::from_translation(Vec3::X * x),
    };
    let two = World::build(vec![mesh.clone()], vec![placed(0.0), placed(3.0)]).unwrap();
    let many = World::build(
        vec![mesh],
        (0..100).map(|i| placed(3.0 * i as f32)).collect(),
    )
    .unwrap();
    assert!(many.memory() < two.memory() + 100 * 300);
}
