//! Variants, WebP, compressed views, image-based lights, the older material model.

use glam::{DVec3, Vec3};
use meshoptimizer_rs::{Workspace, codec};
use serde_json::{Value, json};

use super::file::{File, TRIANGLE, floats, webp};
use crate::description::{EnvironmentDescription, Pixels, SpecularGlossiness};
use crate::environment::Environment;
use crate::gltf::{ErrorKind, LoadOptions, export_bytes, load_bytes};

/// A triangle in one of three materials.
fn with_variants() -> File {
    let mut file = File::triangle();
    let paint = |red: f32| json!({ "pbrMetallicRoughness": { "baseColorFactor": [red, 0, 0, 1] } });
    file.json["materials"] = json!([paint(0.25), paint(0.5), paint(0.75)]);
    file.json["extensionsUsed"] = json!(["KHR_materials_variants"]);
    file.json["extensions"] = json!({ "KHR_materials_variants": {
        "variants": [{ "name": "beach" }, { "name": "street" }, { "name": "moon" }],
    }});
    file.primitive()["material"] = json!(0);
    file.primitive()["extensions"] = json!({ "KHR_materials_variants": { "mappings": [
        { "material": 1, "variants": [0] }, { "material": 2, "variants": [1] },
    ]}});
    file
}

#[test]
fn a_variant_chooses_materials() {
    let file = with_variants();
    let material = |name: Option<&str>| {
        let options = LoadOptions {
            variant: name.map(str::to_owned),
            ..LoadOptions::default()
        };
        let loaded = file.load_with(&options).unwrap();
        assert_eq!(loaded.warnings, []);
        assert_eq!(loaded.variants, ["beach", "street", "moon"]);
        loaded.description.instances[0].material
    };
    assert_eq!(material(None), Some(0));
    assert_eq!(material(Some("beach")), Some(1));
    assert_eq!(material(Some("street")), Some(2));
    // no mapping: its own
    assert_eq!(material(Some("moon")), Some(0));
}

#[test]
fn an_unknown_variant_is_told_what_there_is() {
    let options = LoadOptions::default().with_variant("forest");
    let error = with_variants().load_with(&options).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Variant);
    assert_eq!(error.place(), "/extensions/KHR_materials_variants/variants");
    let message = error.to_string();
    assert!(message.contains("\"forest\"") && message.contains("one of beach, street, moon"));
    let error = File::triangle().load_with(&options).unwrap_err();
    assert_eq!((error.kind(), error.place()), (ErrorKind::Variant, ""));
    assert!(error.to_string().contains("the file has none"), "{error}");
    let mut file = with_variants();
    let mapping = "/extensions/KHR_materials_variants/mappings/0";
    for (key, wrong) in [("variants/0", json!(3)), ("material", json!(3))] {
        let pointer = format!("{mapping}/{key}");
        let old = file.primitive().pointer(&pointer).unwrap().clone();
        *file.primitive().pointer_mut(&pointer).unwrap() = wrong;
        let error = file.error();
        assert_eq!(error.kind(), ErrorKind::Reference, "{error}");
        assert!(error.place().ends_with(&pointer), "{error}");
        *file.primitive().pointer_mut(&pointer).unwrap() = old;
    }
}

/// A material with a texture of this image.
fn with_texture(image: &[u8], texture: Value) -> File {
    let mut file = File::triangle();
    file.json["materials"] =
        json!([{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }]);
    let view = file.view(image);
    file.json["images"] = json!([{ "bufferView": view }]);
    file.json["textures"] = json!([texture]);
    file
}

#[test]
fn webp_textures_are_read_and_written() {
    let texture = json!({ "extensions": { "EXT_texture_webp": { "source": 0 } } });
    let file = with_texture(&webp(6, 3), texture);
    let description = file.clean();
    let image = &description.images[0];
    assert_eq!((image.width, image.height), (6, 3));
    let Pixels::Rgba8(pixels) = &image.pixels else {
        panic!("bytes expected");
    };
    // x = 5, y = 2
    assert_eq!(pixels[4 * 17..], [45, 10, 7, 205]);
    let written = export_bytes(&description).unwrap();
    let back = load_bytes(&written, "test.glb", &LoadOptions::default()).unwrap();
    assert_eq!(back.description, description);
    assert_eq!(back.extensions.read, ["EXT_texture_webp"]);
}

#[test]
fn webp_that_lies_is_refused() {
    let texture = json!({ "extensions": { "EXT_texture_webp": { "source": 0 } } });
    let whole = webp(6, 3);
    // the last bytes may be padding
    for length in 12..whole.len() - 8 {
        let file = with_texture(&whole[..length], texture.clone());
        let error = file.error();
        assert_eq!(error.kind(), ErrorKind::Image, "{length}: {error}");
    }
    // VP8L: 14 bits of width - 1, 14 of height - 1 after the signature byte
    let mut large = whole.clone();
    let at = large.windows(4).position(|w| w == b"VP8L").unwrap() + 9;
    large[at..at + 4].copy_from_slice(&0x0fff_ffff_u32.to_le_bytes());
    let error = with_texture(&large, texture).error();
    assert_eq!(error.kind(), ErrorKind::Image, "{error}");
}

/// A triangle whose buffer views are stored compressed, in a buffer of their own.
fn compressed() -> File {
    let mut file = File::triangle();
    let mut work = Workspace::default();
    let positions = floats(&TRIANGLE);
    let vertices = codec::encode_vertex_buffer(
        &positions,
        3,
        12,
        codec::VertexEncoding::new(0, 0).unwrap(),
        &mut work,
    )
    .unwrap();
    let indices =
        codec::encode_index_buffer(&[0, 1, 2], codec::IndexEncoding::DEFAULT, &mut work).unwrap();
    let mut binary = vertices.clone();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let start = binary.len();
    binary.extend(&indices);
    file.binary = binary;
    let view = |offset: usize, length: usize, stride: usize, mode: &str| {
        json!({ "EXT_meshopt_compression": {
            "buffer": 0, "byteOffset": offset, "byteLength": length, "byteStride": stride,
            "count": 3, "mode": mode,
        }})
    };
    file.json["bufferViews"] = json!([
        { "buffer": 1, "byteLength": 36, "byteStride": 12,
          "extensions": view(0, vertices.len(), 12, "ATTRIBUTES") },
        { "buffer": 1, "byteOffset": 36, "byteLength": 6,
          "extensions": view(start, indices.len(), 2, "TRIANGLES") },
    ]);
    file.json["buffers"] = json!([
        { "byteLength": file.binary.len() },
        { "byteLength": 42, "uri": "not-there.bin",
          "extensions": { "EXT_meshopt_compression": { "fallback": true } } },
    ]);
    file.json["extensionsRequired"] = json!(["EXT_meshopt_compression"]);
    file
}

#[test]
fn compressed_views_are_decoded() {
    let description = compressed().clean();
    let mesh = &description.meshes[0];
    let expected = [Vec3::ZERO, Vec3::X, Vec3::Y];
    assert_eq!(mesh.positions, expected);
    // the codec may turn a triangle around, not over
    let mut triangle = mesh.indices[0];
    let first = triangle.iter().position(|&i| i == 0).unwrap();
    triangle.rotate_left(first);
    assert_eq!(triangle, [0, 1, 2]);
}

#[test]
fn compressed_views_that_lie_are_refused() {
    let place = "/bufferViews/0/extensions/EXT_meshopt_compression";
    for (key, wrong, kind, at) in [
        ("count", json!(4), ErrorKind::Value, "/bufferViews/0"),
        ("count", json!(0), ErrorKind::Value, place),
        ("count", json!(u64::MAX), ErrorKind::Value, place),
        ("byteStride", json!(13), ErrorKind::Value, place),
        ("byteStride", json!(1024), ErrorKind::Value, place),
        ("byteLength", json!(5), ErrorKind::Compressed, place),
        (
            "byteLength",
            json!(1_u64 << 40),
            ErrorKind::Reference,
            place,
        ),
        (
            "byteOffset",
            json!(u64::MAX - 7),
            ErrorKind::Reference,
            place,
        ),
        ("buffer", json!(2), ErrorKind::Reference, "buffer"),
        ("mode", json!("POINTS"), ErrorKind::Value, "mode"),
        ("mode", json!("INDICES"), ErrorKind::Value, place),
        ("filter", json!("QUATERNION"), ErrorKind::Value, place),
        ("filter", json!("SHARPEN"), ErrorKind::Value, "filter"),
    ] {
        let mut file = compressed();
        file.json.pointer_mut(place).unwrap()[key] = wrong.clone();
        let error = file.error();
        assert_eq!(error.kind(), kind, "{key} {wrong}: {error}");
        assert!(error.place().ends_with(at), "{key} {wrong}: {error}");
    }
    // a few bytes that claim to be many
    let mut file = compressed();
    let count = 1_000_000;
    file.json.pointer_mut(place).unwrap()["count"] = json!(count);
    file.json["bufferViews"][0]["byteLength"] = json!(12 * count);
    assert_eq!(file.error().kind(), ErrorKind::Compressed);
    // streams with any one byte changed: a scene or an error, never more
    let whole = compressed();
    let (mut loaded, mut refused) = (0, 0);
    for at in 0..whole.binary.len() {
        for flip in [0x01, 0x80, 0xff] {
            let mut file = whole.clone();
            file.binary[at] ^= flip;
            match file.load_with(&LoadOptions::default()) {
                Ok(_) => loaded += 1,
                Err(_) => refused += 1,
            }
        }
    }
    assert!(loaded > 10 && refused > 10, "{loaded} {refused}");
}

#[test]
fn the_older_material_model_by_texel() {
    let mut file = with_texture(&super::file::png(2, 2), json!({ "source": 0 }));
    file.json["materials"] = json!([{ "extensions": { "KHR_materials_pbrSpecularGlossiness": {
        "diffuseFactor": [0.5, 0.25, 0.125, 1], "specularFactor": [0.04, 0.08, 0],
        "glossinessFactor": 0.75, "specularGlossinessTexture": { "index": 0 },
    }}}]);
    let description = file.clean();
    let m = &description.materials[0];
    assert_eq!(m.base_color, [0.5, 0.25, 0.125, 1.0]);
    let older = m.specular_glossiness.unwrap();
    assert_eq!(
        older,
        SpecularGlossiness {
            specular: [0.04, 0.08, 0.0],
            glossiness: 0.75,
            texture: older.texture
        }
    );
    assert_eq!(older.texture.unwrap().texture, 0);
    let written = export_bytes(&description).unwrap();
    let back = load_bytes(&written, "test.glb", &LoadOptions::default()).unwrap();
    assert_eq!(back.description, description);
}

/// A scene in a cube map of 16 x 16 faces, each with a colour of its own and a brighter upper left
/// quarter.
fn in_a_cube() -> File {
    let mut file = File::triangle();
    let mut faces = Vec::new();
    for face in 0..6_u8 {
        let pixel = |x: u32, y: u32| {
            let bright = if x < 8 && y < 8 { 250 } else { 120 };
            image::Rgba([bright, 40 * face, 0, 255])
        };
        let picture = image::RgbaImage::from_fn(16, 16, pixel);
        let mut bytes = std::io::Cursor::new(Vec::new());
        picture
            .write_to(&mut bytes, image::ImageFormat::Png)
            .unwrap();
        let view = file.view(&bytes.into_inner());
        faces.push(file.push("images", json!({ "bufferView": view })));
    }
    file.json["extensions"] = json!({ "EXT_lights_image_based": { "lights": [{
        "intensity": 2.0, "rotation": [0.0, 0.0, 0.0, 1.0], "specularImageSize": 16,
        "specularImages": [faces],
        "irradianceCoefficients": vec![[0.0; 3]; 9],
    }]}});
    file.json["scenes"][0]["extensions"] = json!({ "EXT_lights_image_based": { "light": 0 } });
    file.json["extensionsUsed"] = json!(["EXT_lights_image_based"]);
    file
}

#[test]
fn a_cube_map_is_an_environment() {
    let mut file = in_a_cube();
    let description = file.clean();
    let environment = Environment::new(description.environment.as_ref().unwrap()).unwrap();
    let linear = |c: u8| kaustik_spectrum::srgb_to_linear(f32::from(c) / 255.0);
    let axes = [
        DVec3::X,
        DVec3::NEG_X,
        DVec3::Y,
        DVec3::NEG_Y,
        DVec3::Z,
        DVec3::NEG_Z,
    ];
    for (face, axis) in axes.into_iter().enumerate() {
        let [_, green, _] = environment.rgb(axis);
        let expected = 2.0 * linear(40 * face as u8);
        assert!(
            (green - expected).abs() < 0.03 * (1.0 + expected),
            "face {face}: {green} for {expected}"
        );
    }
    // the upper left of each side face, as seen from inside: to the left of the axis, above it
    for axis in [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z] {
        let left = -axis.cross(DVec3::Y);
        let at = |d: DVec3| environment.rgb(d.normalize())[0];
        let bright = at(axis + 0.6 * left + 0.6 * DVec3::Y);
        let dim = at(axis - 0.6 * left + 0.6 * DVec3::Y);
        assert!(bright > 3.0 * dim, "{axis}: {bright} {dim}");
        assert!((bright / (2.0 * linear(250)) - 1.0).abs() < 0.02);
    }
    // it survives an export, and turns
    let written = export_bytes(&description).unwrap();
    let back = load_bytes(&written, "test.glb", &LoadOptions::default()).unwrap();
    assert_eq!(back.description, description);
    file.json["extensions"]["EXT_lights_image_based"]["lights"][0]["rotation"] =
        json!([0.0, 0.5_f32.sqrt(), 0.0, 0.5_f32.sqrt()]);
    let turned = Environment::new(file.clean().environment.as_ref().unwrap()).unwrap();
    // a quarter turn about +y brings what was at +z to +x
    let green = turned.rgb(DVec3::X)[1];
    assert!((green - 2.0 * linear(160)).abs() < 0.04, "{green}");
    let Some(EnvironmentDescription::Image { image, .. }) = description.environment else {
        panic!("a picture expected");
    };
    assert_eq!((image.width, image.height), (64, 32));
}

#[test]
fn cube_maps_that_are_none_are_refused() {
    let light = "/extensions/EXT_lights_image_based/lights/0";
    let change = |pointer: &str, value: Value| {
        let mut file = in_a_cube();
        *file.json.pointer_mut(pointer).unwrap() = value;
        file.error()
    };
    let images = format!("{light}/specularImages");
    let error = change(&images, json!([]));
    assert_eq!((error.kind(), error.place()), (ErrorKind::Value, &*images));
    let error = change(&images, json!([[0, 1, 2, 3, 4]]));
    assert_eq!(error.found(), "5 images");
    let error = change(&format!("{images}/0/3"), json!(6));
    assert_eq!(error.kind(), ErrorKind::Reference, "{error}");
    let error = change(
        "/scenes/0/extensions/EXT_lights_image_based/light",
        json!(1),
    );
    assert_eq!(error.kind(), ErrorKind::Reference, "{error}");
    let error = change(&format!("{light}/rotation"), json!([0, 0, 0, 2]));
    assert_eq!(error.kind(), ErrorKind::Value, "{error}");
}
