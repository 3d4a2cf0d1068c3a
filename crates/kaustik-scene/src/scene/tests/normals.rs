//! Normal textures: which way they tilt the frame, and what they leave alone.

use glam::{Affine3A, DVec3, Vec3, Vec4};
use kaustik_geometry::Mesh;

use super::{close, look};
use crate::Vertex;
use crate::description::{MaterialDescription, Pixels};
use crate::testing::{Stage, grey, image, rectangle_with_uv};

/// A square that faces +z with its picture upright: u along +x, v along -y.
fn square() -> Mesh {
    rectangle_with_uv(Vec3::ZERO, Vec3::X, Vec3::Y)
}

/// Stores a tangent-space normal as a texture holds it.
fn texel(normal: [f32; 3]) -> Pixels {
    Pixels::RgbF32(normal.map(|c| 0.5 * (c + 1.0)).to_vec())
}

/// What a ray from above meets on a square with a constant normal texture.
fn bent(mesh: Mesh, normal: Option<[f32; 3]>, scale: f32, transform: Affine3A) -> Vertex {
    let mut stage = Stage::new();
    let mut slot = None;
    if let Some(normal) = normal {
        let (with, normals) = stage.texture(image(1, 1, texel(normal)));
        (stage, slot) = (with, Some(normals));
    }
    let material = MaterialDescription {
        normal_texture: slot,
        normal_scale: scale,
        ..grey(0.5)
    };
    let scene = stage.add_at(material, mesh, transform).build();
    look(&scene, Vec3::new(0.1, 0.23, 2.0), Vec3::NEG_Z)
}

fn given(mut mesh: Mesh, tangent: Vec4) -> Mesh {
    mesh.normals = vec![Vec3::Z; mesh.positions.len()];
    mesh.tangents = vec![tangent; mesh.positions.len()];
    mesh
}

#[test]
fn a_flat_texture_changes_nothing() {
    let upright = given(square(), Vec4::new(1.0, 0.0, 0.0, 1.0));
    for mesh in [square(), upright] {
        let turned = Affine3A::from_rotation_x(0.4) * Affine3A::from_rotation_y(-0.3);
        let plain = bent(mesh.clone(), None, 1.0, turned);
        let flat = bent(mesh, Some([0.0, 0.0, 1.0]), 1.0, turned);
        assert!(close(plain.frame.z, flat.frame.z));
        assert!(close(plain.normal, flat.normal));
    }
}

/// Red tilts towards growing u, green towards the top of the picture.
#[test]
fn red_is_along_u_and_green_is_up() {
    let tilt = |normal| {
        bent(square(), Some(normal), 1.0, Affine3A::IDENTITY)
            .frame
            .z
    };
    assert!(close(tilt([0.6, 0.0, 0.8]), DVec3::new(0.6, 0.0, 0.8)));
    assert!(close(tilt([-0.6, 0.0, 0.8]), DVec3::new(-0.6, 0.0, 0.8)));
    assert!(close(tilt([0.0, 0.6, 0.8]), DVec3::new(0.0, 0.6, 0.8)));
    let scaled = bent(square(), Some([0.6, 0.6, 0.8]), 0.5, Affine3A::IDENTITY);
    assert!(close(scaled.frame.z, DVec3::new(0.3, 0.3, 0.8).normalize()));
}

/// A picture laid the other way round turns with its coordinates.
#[test]
fn the_tilt_follows_the_coordinates() {
    let mut mesh = square();
    // u along +y, v along +x: seen from the front not mirrored
    for (uv, p) in mesh.uv[0].iter_mut().zip(&mesh.positions) {
        *uv = glam::Vec2::new(p.y, p.x) * 0.5 + 0.5;
    }
    let tilt = |normal| {
        bent(mesh.clone(), Some(normal), 1.0, Affine3A::IDENTITY)
            .frame
            .z
    };
    assert!(close(tilt([0.6, 0.0, 0.8]), DVec3::new(0.0, 0.6, 0.8)));
    assert!(close(tilt([0.0, 0.6, 0.8]), DVec3::new(-0.6, 0.0, 0.8)));
}

/// A mirrored instance is a mirror image, whether its tangents are given or derived.
#[test]
fn a_mirrored_instance_tilts_as_its_mirror_image() {
    let mirror = Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    let upright = given(square(), Vec4::new(1.0, 0.0, 0.0, 1.0));
    for mesh in [square(), upright] {
        let seen = |normal| bent(mesh.clone(), Some(normal), 1.0, mirror);
        let along_u = seen([0.6, 0.0, 0.8]);
        assert!(close(along_u.normal, DVec3::Z), "the front stays in front");
        assert!(close(along_u.frame.z, DVec3::new(-0.6, 0.0, 0.8)));
        assert!(close(
            seen([0.0, 0.6, 0.8]).frame.z,
            DVec3::new(0.0, 0.6, 0.8)
        ));
    }
}

/// The sign of a given tangent turns green around.
#[test]
fn the_sign_of_the_tangent_counts() {
    let flipped = given(square(), Vec4::new(1.0, 0.0, 0.0, -1.0));
    let tilt = bent(flipped, Some([0.0, 0.6, 0.8]), 1.0, Affine3A::IDENTITY);
    assert!(close(tilt.frame.z, DVec3::new(0.0, -0.6, 0.8)));
}

/// The shading frame stays on the geometry's side, whatever the texture says, and is
/// orthonormal.
#[test]
fn sides_are_kept() {
    let slanted = |normal: Vec3| {
        let mut mesh = square();
        mesh.normals = vec![normal; mesh.positions.len()];
        mesh
    };
    for interpolated in [Vec3::Z, Vec3::new(0.8, 0.0, 0.6), Vec3::new(0.3, 0.0, -1.0)] {
        for x in [-1.0_f32, -0.7, 0.0, 0.7, 1.0] {
            for z in [-1.0_f32, 0.0, 0.5] {
                let mesh = slanted(interpolated);
                let vertex = bent(mesh, Some([x, 0.2, z]), 1.0, Affine3A::IDENTITY);
                let frame = vertex.frame;
                assert!(frame.z.dot(vertex.normal) > 0.0, "{interpolated} {x} {z}");
                assert!(close(frame.x.cross(frame.y), frame.z));
                assert!((frame.x.length() - 1.0).abs() < 1e-9);
                let back = frame.to_world(frame.to_local(DVec3::new(0.1, 0.2, 0.3)));
                assert!(close(back, DVec3::new(0.1, 0.2, 0.3)));
            }
        }
    }
}

/// Without texture coordinates there is no tangent and nothing to tilt along.
#[test]
fn no_coordinates_no_tilt() {
    let mut mesh = square();
    mesh.uv = Default::default();
    let vertex = bent(mesh, Some([0.6, 0.0, 0.8]), 1.0, Affine3A::IDENTITY);
    assert!(close(vertex.frame.z, DVec3::Z));
}
