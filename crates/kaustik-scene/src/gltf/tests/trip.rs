//! Out and in again.

use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};
use kaustik_geometry::Mesh;

use super::any::description;
use crate::Description;
use crate::description::*;
use crate::gltf::{LoadOptions, export_bytes, export_text, load_bytes};

#[test]
fn what_is_written_comes_back() {
    let options = LoadOptions::default();
    for seed in 0..200 {
        let d = description(seed);
        let bytes = export_bytes(&d).unwrap_or_else(|e| panic!("seed {seed}: {e}"));
        let loaded = load_bytes(&bytes, "trip", &options).unwrap();
        assert_eq!(loaded.warnings, []);
        assert!(loaded.description == d, "seed {seed}");
        for (a, b) in loaded.description.instances.iter().zip(&d.instances) {
            let bits = |t: Affine3A| t.to_cols_array().map(f32::to_bits);
            assert_eq!(bits(a.transform), bits(b.transform));
        }
        assert_eq!(export_bytes(&loaded.description).unwrap(), bytes);
    }
    let empty = Description::default();
    let bytes = export_bytes(&empty).unwrap();
    assert_eq!(
        load_bytes(&bytes, "empty", &options).unwrap().description,
        empty
    );
}

/// Another reader, with its validation on, finds nothing wrong with our files.
#[test]
fn others_read_it_too() {
    for seed in 0..100 {
        let d = description(seed);
        if d.instances.is_empty() && d.cameras.is_empty() && d.lights.is_empty() {
            continue; // that reader wants nodes in a scene, where the format does not
        }
        let bytes = export_bytes(&d).unwrap();
        let read = gltf::Gltf::from_slice(&bytes).unwrap_or_else(|e| panic!("seed {seed}: {e}"));
        assert_eq!(read.materials().len(), d.materials.len());
        assert_eq!(read.cameras().len(), d.cameras.len());
        let nodes = d.instances.len() + d.cameras.len() + d.lights.len();
        assert_eq!(read.nodes().len(), nodes);
        for (read, ours) in read.materials().zip(&d.materials) {
            assert_eq!(read.ior().unwrap_or(1.5), ours.ior);
            assert_eq!(read.unlit(), ours.unlit);
        }
    }
}

#[test]
fn meshes_are_written_once() {
    let mut d = Description::default();
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    d.meshes = vec![Arc::new(
        Mesh::new(positions, vec![[0, 1, 2]; 1000]).unwrap(),
    )];
    d.materials = vec![MaterialDescription::default(); 3];
    for i in 0..100 {
        d.instances.push(InstanceDescription {
            name: String::new(),
            mesh: 0,
            material: [None, Some(0), Some(2)][i % 3],
            transform: Affine3A::from_translation(Vec3::splat(i as f32)),
        });
    }
    let bytes = export_bytes(&d).unwrap();
    assert!(bytes.len() < 2 * 12_000 + 100 * 150, "{}", bytes.len());
}

#[test]
fn text_comes_back_as_bytes_do() {
    for seed in 0..50 {
        let d = description(seed);
        let text = export_text(&d).unwrap();
        assert!(text.starts_with(b"{"));
        let loaded = load_bytes(&text, "text", &LoadOptions::default()).unwrap();
        assert!(loaded.description == d, "seed {seed}");
    }
}

/// The comparison at the end of an export is what keeps it honest: each of these would
/// come back as something else.
#[test]
fn what_would_not_come_back_is_refused() {
    type Spoil = fn(&mut Description);
    let spoils: [(Spoil, &str); 14] = [
        (
            |d| d.materials[0].base_color[1] = 1.5,
            "/materials/0/pbrMetallicRoughness/baseColorFactor: 1.5",
        ),
        (
            |d| d.materials[0].roughness = f32::NAN,
            "roughnessFactor: found null",
        ),
        (
            |d| d.materials[0].emissive[2] = -1.0,
            "/materials/0/emissiveFactor",
        ),
        (|d| d.materials[0].ior = 0.5, "KHR_materials_ior/ior"),
        (
            |d| d.materials[0].reflectance = Some(SpectralInput::Named("x".into())),
            "cornell-white",
        ),
        (|d| d.textures[0].image = 99, "/textures/0/source: found 99"),
        (|d| d.instances[0].mesh = 99, "instances[0]"),
        (|d| d.instances[0].material = Some(99), "found 99"),
        (|d| d.instances[0].transform = Affine3A::ZERO, "scale is 0"),
        (
            |d| Arc::make_mut(&mut d.meshes[0]).positions[0].x = f32::NAN,
            "attributes/POSITION: found vertex 0",
        ),
        (
            |d| Arc::make_mut(&mut d.meshes[0]).indices[0] = [99; 3],
            "index 99",
        ),
        (|d| Arc::make_mut(&mut d.images[0]).width += 1, "images[0]"),
        (
            |d| Arc::make_mut(&mut d.images[3]).width += 1,
            "as many pixels",
        ),
        (
            |d| Arc::make_mut(&mut d.images[0]).pixels = Pixels::RgbF32(Vec::new()),
            "an image of floats",
        ),
    ];
    let seed = (0..)
        .find(|&seed| !description(seed).instances.is_empty())
        .unwrap();
    for (i, (spoil, words)) in spoils.into_iter().enumerate() {
        let mut d = description(seed);
        spoil(&mut d);
        let message = export_bytes(&d).expect_err("spoiled").to_string();
        assert!(
            message.contains(words),
            "{i}: \"{message}\" lacks \"{words}\""
        );
    }
}

#[test]
fn floats_that_no_file_holds_are_refused() {
    let image = ImageData {
        name: "sky".into(),
        width: 1,
        height: 1,
        pixels: Pixels::RgbF32(vec![0.1, 1.0, 1.1]),
        encoded: Vec::new(),
    };
    let d = Description {
        environment: Some(EnvironmentDescription::Image {
            image: Arc::new(image),
            strength: 1.0,
            rotation: Quat::IDENTITY,
        }),
        ..Description::default()
    };
    let message = export_bytes(&d).unwrap_err().to_string();
    assert!(message.contains("Radiance HDR"), "{message}");
}

#[test]
fn built_in_scenes_come_back() {
    for scene in crate::builtin::list() {
        let d = crate::builtin::load(scene.name).unwrap();
        let bytes = export_bytes(&d).unwrap_or_else(|e| panic!("{}: {e}", scene.name));
        let loaded = load_bytes(&bytes, scene.name, &LoadOptions::default()).unwrap();
        assert!(loaded.description == d, "{}", scene.name);
    }
}
