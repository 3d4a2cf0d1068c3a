//! Surfaces: positions, normals, tangents, and what transforms do to them.

use glam::{Affine3A, DMat2, DVec2, Quat, Vec2, Vec3, Vec4};
use kaustik_geometry::{Hit, Mesh, Ray, Unwrapping, World};

use crate::support::{Random, icosphere, instanced, placed};

/// A square in the xy plane with texture coordinates as glTF has them (v down), and all attributes.
fn square() -> Mesh {
    let positions = vec![
        Vec3::new(-1.0, -1.0, 0.0),
        Vec3::new(1.0, -1.0, 0.0),
        Vec3::new(1.0, 1.0, 0.0),
        Vec3::new(-1.0, 1.0, 0.0),
    ];
    let uv = positions
        .iter()
        .map(|p| Vec2::new(p.x, -p.y) * 0.5 + 0.5)
        .collect();
    Mesh::new(positions, vec![[0, 1, 2], [0, 2, 3]])
        .and_then(|m| m.with_uv([uv, vec![]]))
        .and_then(|m| m.with_normals(vec![Vec3::new(0.1, 0.2, 1.0); 4]))
        .unwrap()
}

fn both(mesh: &Mesh, transform: Affine3A) -> [World; 2] {
    [
        placed(mesh.clone(), transform),
        instanced(mesh.clone(), transform),
    ]
}

#[test]
fn the_front_stays_where_gltf_puts_it() {
    let turn = Quat::from_rotation_y(0.5);
    for mirror in [
        Vec3::ONE,
        Vec3::new(-1.0, 1.0, 1.0),
        Vec3::new(1.0, 1.0, -2.0),
        Vec3::splat(-1.0),
    ] {
        let transform = Affine3A::from_scale_rotation_translation(mirror, turn, Vec3::X);
        for world in both(&square(), transform) {
            // The object's own front is +z, and it goes where the transform takes +z.
            let front = transform.transform_vector3(Vec3::Z).normalize();
            let ray = Ray::new(Vec3::X + front * 2.0, -front);
            let hit = world.intersect(&ray).unwrap();
            let surface = world.surface(&ray, &hit);
            assert!(
                surface.front && surface.geometric_normal.dot(front) > 0.999,
                "{mirror}"
            );
            assert!(surface.shading_normal.dot(front) > 0.9);
            let back = Ray::new(Vec3::X - front * 2.0, front);
            let surface = world.surface(&back, &world.intersect(&back).unwrap());
            assert!(!surface.front && surface.geometric_normal.dot(front) > 0.999);
        }
    }
}

/// The tangent at a point of a triangle, to its shading normal.
fn tangent_at(world: &World, primitive: u32, place: [f32; 2]) -> Option<Vec4> {
    tangent_along(world, primitive, place, &Unwrapping::default())
}

fn tangent_along(
    world: &World,
    primitive: u32,
    [u, v]: [f32; 2],
    along: &Unwrapping,
) -> Option<Vec4> {
    let normal = world.surface_at(0, primitive, u, v).shading_normal;
    let hit = Hit {
        t: 0.0,
        u,
        v,
        instance: 0,
        primitive,
    };
    world.tangent(&hit, normal, along)
}

/// Normals follow the inverse transpose: they stay orthogonal to tangents, which follow the transform.
#[test]
fn normals_and_tangents_follow_transforms() {
    let mut random = Random(1);
    let tangent = Vec3::new(1.0, 0.0, -0.1).normalize();
    let with = square()
        .with_tangents(vec![tangent.extend(-1.0); 4])
        .unwrap();
    let normal = Vec3::new(0.1, 0.2, 1.0);
    for _ in 0..50 {
        let transform = random.transform();
        for world in both(&with, transform) {
            let surface = world.surface_at(0, 1, 0.2, 0.3);
            let found = tangent_at(&world, 1, [0.2, 0.3]).unwrap();
            let expected = transform.transform_vector3(tangent);
            let across = normal.cross(tangent);
            // Two vectors that the shading normal is orthogonal to in the mesh's space.
            for along in [across, across.cross(normal)] {
                let moved = transform.transform_vector3(along).normalize();
                assert!(surface.shading_normal.dot(moved).abs() < 1e-5);
            }
            assert!(found.truncate().dot(surface.shading_normal).abs() < 1e-6);
            assert!(found.truncate().is_normalized());
            let reject = expected.reject_from(surface.shading_normal).normalize();
            assert!(reject.dot(found.truncate()) > 0.9999);
            // The bitangent goes where the transform takes it.
            let bitangent = surface.shading_normal.cross(found.truncate()) * found.w;
            assert!(bitangent.dot(transform.transform_vector3(-across)) > 0.0);
        }
    }
}

#[test]
fn tangents_come_from_texture_coordinates_where_none_are_given() {
    for (transform, sign) in [
        (Affine3A::IDENTITY, 1.0),
        (Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0)), -1.0),
    ] {
        for world in both(&square(), transform) {
            let surface = world.surface_at(0, 0, 0.2, 0.3);
            let tangent = tangent_at(&world, 0, [0.2, 0.3]).unwrap();
            let along = transform.transform_vector3(Vec3::X);
            assert!(tangent.truncate().dot(along) > 0.9);
            assert_eq!(tangent.w, sign);
            // Up the picture, where v decreases.
            assert!(
                (surface.shading_normal.cross(tangent.truncate()) * tangent.w).dot(Vec3::Y) > 0.9
            );
        }
    }
    let plain = placed(icosphere(0), Affine3A::IDENTITY);
    assert_eq!(tangent_at(&plain, 0, [0.2, 0.2]), None::<Vec4>);
    assert_eq!(plain.surface_at(0, 0, 0.2, 0.2).color, [1.0; 4]);
}

/// A frame follows the coordinates that its texture is read by, turned as that is.
#[test]
fn tangents_follow_the_texture_that_asks() {
    let mut mesh = square();
    // The second set is the first one turned by a quarter: u runs down, v to the left.
    mesh.uv[1] = mesh.uv[0].iter().map(|t| Vec2::new(t.y, -t.x)).collect();
    let world = placed(mesh.clone(), Affine3A::IDENTITY);
    let at = |set, turned| {
        let along = Unwrapping { set, turned };
        tangent_along(&world, 0, [0.2, 0.3], &along).unwrap()
    };
    let near = |found: Vec4, wanted: Vec3| found.truncate().dot(wanted) > 0.9;
    assert!(near(at(0, DMat2::IDENTITY), Vec3::X));
    assert!(near(at(1, DMat2::IDENTITY), Vec3::NEG_Y));
    let quarter = DMat2::from_angle(std::f64::consts::FRAC_PI_2);
    assert!(near(at(0, quarter), Vec3::Y), "{}", at(0, quarter));
    let mirrored = DMat2::from_diagonal(DVec2::new(-1.0, 1.0));
    assert!(near(at(0, mirrored), Vec3::NEG_X));
    assert_eq!(at(0, mirrored).w, -at(0, DMat2::IDENTITY).w);
    // Given ones stand in for all sets, but not without normals.
    let given = mesh.with_tangents(vec![Vec4::new(0.0, 1.0, 0.0, 1.0); 4]);
    let mut given = given.unwrap();
    let world = placed(given.clone(), Affine3A::IDENTITY);
    assert!(near(tangent_at(&world, 0, [0.2, 0.3]).unwrap(), Vec3::Y));
    given.normals.clear();
    let world = placed(given, Affine3A::IDENTITY);
    assert!(near(tangent_at(&world, 0, [0.2, 0.3]).unwrap(), Vec3::X));
}

#[test]
fn bad_normals_give_way_to_the_geometric_one() {
    for bad in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
        let mesh = Mesh {
            normals: vec![bad; 4],
            ..square()
        };
        let world = placed(mesh, Affine3A::IDENTITY);
        assert_eq!(world.surface_at(0, 0, 0.1, 0.2).shading_normal, Vec3::Z);
        assert!(tangent_at(&world, 0, [0.1, 0.2]).unwrap().is_finite());
    }
}

/// The true point of the triangle, in double precision, lies within the error of the position.
#[test]
fn positions_lie_within_their_error() {
    let mut random = Random(2);
    for _ in 0..300 {
        let transform = random.transform();
        for world in both(&icosphere(1), transform) {
            let (u, v) = (random.unit() * 0.5, random.unit() * 0.5);
            let primitive = (random.unit() * 80.0) as u32;
            let surface = world.surface_at(0, primitive, u, v);
            let [a, b, c] = world.mesh(0).corners(primitive);
            let exact = transform.as_daffine3();
            let [a, b, c] = [a, b, c].map(|p| exact.transform_point3(p.as_dvec3()));
            let normal = (b - a).cross(c - a).normalize();
            let off = (surface.position.as_dvec3() - a).dot(normal).abs();
            // A flattened triangle's corners are rounded, too.
            let room = normal.abs().dot(surface.position_error.as_dvec3()) + 1e-6;
            assert!(off <= room, "{off} {room}");
            let point =
                a * (1.0 - f64::from(u) - f64::from(v)) + b * f64::from(u) + c * f64::from(v);
            assert!(point.distance(surface.position.as_dvec3()) < 2e-6);
        }
    }
}

#[test]
fn triangles_and_areas_are_in_world_space() {
    let world = placed(square(), Affine3A::from_scale(Vec3::new(2.0, -3.0, 1.0)));
    assert!((world.triangle_area(0, 0) - 12.0).abs() < 1e-9);
    assert_eq!(world.triangle(0, 0)[2], Vec3::new(2.0, -3.0, 0.0));
    assert_eq!(world.bounds().max, Vec3::new(2.0, 3.0, 0.0));
}
