//! Materials, textures, images, extensions.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use kaustik_spectrum::{Glass, Metal};
use serde_json::{Value, json};

use super::file::{File, jpeg, png};
use crate::description::{
    AlphaMode, Anisotropy, Clearcoat, Filtering, Iridescence, MaterialDescription, Model, Pixels,
    Sheen, SpectralInput, Specular, TextureSlot, Transmission, UvTransform, Volume, Wrap,
};
use crate::gltf::ErrorKind;

fn with_material(material: Value) -> File {
    let mut file = File::empty();
    file.json["materials"] = json!([material]);
    file
}

fn material(value: Value) -> MaterialDescription {
    with_material(value).clean().materials[0].clone()
}

fn slot(texture: usize) -> TextureSlot {
    TextureSlot {
        texture,
        uv_set: 0,
        transform: UvTransform::IDENTITY,
    }
}

#[test]
fn defaults_are_gltfs() {
    assert_eq!(material(json!({})), MaterialDescription::default());
    let empty = json!({ "pbrMetallicRoughness": {}, "extensions": {
        "KHR_materials_ior": {}, "KHR_materials_specular": {}, "KHR_materials_dispersion": {},
        "KHR_materials_emissive_strength": {},
    }});
    assert_eq!(material(empty), MaterialDescription::default());
}

#[test]
fn a_material_with_all_extensions_is_read_in_full() {
    let mut file = with_material(json!({
        "name": "all",
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.1, 0.2, 0.3, 0.4],
            "baseColorTexture": { "index": 0, "texCoord": 1 },
            "metallicFactor": 0.5, "roughnessFactor": 0.25,
            "metallicRoughnessTexture": { "index": 1, "extensions": { "KHR_texture_transform": {
                "offset": [1, 2], "rotation": 3, "scale": [4, 5], "texCoord": 1 } } },
        },
        "normalTexture": { "index": 0, "scale": 0.5 },
        "emissiveFactor": [0.5, 1, 0], "emissiveTexture": { "index": 0 },
        "alphaMode": "MASK", "alphaCutoff": 0.75, "doubleSided": true,
        "extensions": {
            "KHR_materials_emissive_strength": { "emissiveStrength": 30 },
            "KHR_materials_transmission": { "transmissionFactor": 0.75, "transmissionTexture": { "index": 1 } },
            "KHR_materials_ior": { "ior": 1.25 },
            "KHR_materials_volume": { "thicknessFactor": 2, "attenuationDistance": 3, "attenuationColor": [0.5, 0.25, 1] },
            "KHR_materials_dispersion": { "dispersion": 0.5 },
            "KHR_materials_specular": { "specularFactor": 0.5, "specularTexture": { "index": 1 },
                "specularColorFactor": [2, 0.5, 0], "specularColorTexture": { "index": 0 } },
            "KHR_materials_unlit": {},
            "KHR_materials_clearcoat": { "clearcoatFactor": 0.5, "clearcoatTexture": { "index": 0 },
                "clearcoatRoughnessFactor": 0.25, "clearcoatRoughnessTexture": { "index": 1 },
                "clearcoatNormalTexture": { "index": 0, "scale": 0.5 } },
            "KHR_materials_sheen": { "sheenColorFactor": [0.5, 0.25, 1], "sheenColorTexture": { "index": 1 },
                "sheenRoughnessFactor": 0.75, "sheenRoughnessTexture": { "index": 0 } },
            "KHR_materials_anisotropy": { "anisotropyStrength": 0.5, "anisotropyRotation": 2,
                "anisotropyTexture": { "index": 1 } },
            "KHR_materials_iridescence": { "iridescenceFactor": 0.5, "iridescenceTexture": { "index": 0 },
                "iridescenceIor": 1.5, "iridescenceThicknessMaximum": 800,
                "iridescenceThicknessTexture": { "index": 1 } },
        },
    }));
    let view = file.view(&png(2, 3));
    file.json["images"] = json!([{ "bufferView": view, "mimeType": "image/png" }]);
    file.json["samplers"] = json!([{ "magFilter": 9728, "wrapS": 33071, "wrapT": 33648 }]);
    file.json["textures"] = json!([{ "source": 0 }, { "source": 0, "sampler": 0 }]);
    let d = file.clean();
    let m = &d.materials[0];
    assert_eq!(m.base_color, [0.1, 0.2, 0.3, 0.4]);
    assert_eq!(
        m.base_color_texture,
        Some(TextureSlot {
            uv_set: 1,
            ..slot(0)
        })
    );
    let transform = UvTransform {
        offset: [1.0, 2.0],
        rotation: 3.0,
        scale: [4.0, 5.0],
    };
    let moved = TextureSlot {
        texture: 1,
        uv_set: 1,
        transform,
    };
    assert_eq!(m.metallic_roughness_texture, Some(moved));
    assert_eq!((m.metallic, m.roughness, m.normal_scale), (0.5, 0.25, 0.5));
    assert_eq!(m.emissive, [15.0, 30.0, 0.0]);
    assert_eq!(m.alpha_mode, AlphaMode::Mask(0.75));
    assert!(m.double_sided && m.unlit);
    assert_eq!((m.ior, m.dispersion), (1.25, 0.5));
    let specular = Specular {
        factor: 0.5,
        texture: Some(slot(1)),
        color: [2.0, 0.5, 0.0],
        color_texture: Some(slot(0)),
    };
    assert_eq!(m.specular, specular);
    let transmission = Transmission {
        factor: 0.75,
        texture: Some(slot(1)),
    };
    assert_eq!(m.transmission, Some(transmission));
    let volume = Volume {
        thickness: 2.0,
        attenuation_distance: 3.0,
        attenuation_color: [0.5, 0.25, 1.0],
    };
    assert_eq!(m.volume, Some(volume));
    let clearcoat = Clearcoat {
        factor: 0.5,
        texture: Some(slot(0)),
        roughness: 0.25,
        roughness_texture: Some(slot(1)),
        normal_texture: Some(slot(0)),
        normal_scale: 0.5,
    };
    assert_eq!(m.clearcoat, Some(clearcoat));
    let sheen = Sheen {
        color: [0.5, 0.25, 1.0],
        color_texture: Some(slot(1)),
        roughness: 0.75,
        roughness_texture: Some(slot(0)),
    };
    assert_eq!(m.sheen, Some(sheen));
    let anisotropy = Anisotropy {
        strength: 0.5,
        rotation: 2.0,
        texture: Some(slot(1)),
    };
    assert_eq!(m.anisotropy, Some(anisotropy));
    let iridescence = Iridescence {
        factor: 0.5,
        texture: Some(slot(0)),
        ior: 1.5,
        thickness: [100.0, 800.0],
        thickness_texture: Some(slot(1)),
    };
    assert_eq!(m.iridescence, Some(iridescence));
    assert_eq!((d.textures.len(), d.images.len()), (2, 1));
    assert_eq!(d.textures[0].filtering, Filtering::Linear);
    assert_eq!(
        (d.textures[1].wrap_s, d.textures[1].wrap_t),
        (Wrap::Clamp, Wrap::Mirror)
    );
    assert_eq!(d.textures[1].filtering, Filtering::Nearest);
}

#[test]
fn odd_numbers_are_brought_into_range() {
    for (value, pointer) in [
        (
            json!({ "pbrMetallicRoughness": { "roughnessFactor": 2 } }),
            "/materials/0/pbrMetallicRoughness/roughnessFactor",
        ),
        (
            json!({ "extensions": { "KHR_materials_ior": { "ior": 0.5 } } }),
            "/materials/0/extensions/KHR_materials_ior/ior",
        ),
        (
            json!({ "extensions": { "KHR_materials_volume": { "attenuationDistance": 0 } } }),
            "/materials/0/extensions/KHR_materials_volume/attenuationDistance",
        ),
        (
            json!({ "emissiveFactor": [20, 0, 0] }),
            "/materials/0/emissiveFactor",
        ),
        (
            json!({ "extensions": { "KHR_materials_dispersion": { "dispersion": 1e30 } } }),
            "/materials/0/extensions/KHR_materials_dispersion",
        ),
    ] {
        let warning = with_material(value).warned().1;
        assert!(warning.starts_with(pointer), "{warning}");
    }
    let radiance = with_material(json!({ "emissiveFactor": [20, 0, 0] }))
        .warned()
        .0;
    assert_eq!(radiance.materials[0].emissive, [20.0, 0.0, 0.0]);
    let mirror = material(json!({ "extensions": { "KHR_materials_ior": { "ior": 0 } } }));
    assert_eq!(mirror.ior, 0.0);
}

#[test]
fn wrong_types_are_refused_with_their_place() {
    for (value, words) in [
        (json!([]), ["/materials/0:", "an empty array", "an object"]),
        (
            json!({ "name": 3 }),
            ["/materials/0/name", "found 3", "a string"],
        ),
        (
            json!({ "doubleSided": 1 }),
            ["/materials/0/doubleSided", "found 1", "true or false"],
        ),
        (
            json!({ "alphaMode": "GLASS" }),
            [
                "/materials/0/alphaMode",
                "\"GLASS\"",
                "OPAQUE, MASK or BLEND",
            ],
        ),
        (
            json!({ "emissiveFactor": [1, 1] }),
            ["/materials/0/emissiveFactor", "2 values", "3 numbers"],
        ),
        (
            json!({ "emissiveFactor": [1, 1, null] }),
            ["/materials/0/emissiveFactor/2", "null", "a number"],
        ),
        (
            json!({ "emissiveTexture": {} }),
            [
                "/materials/0/emissiveTexture",
                "no \"index\"",
                "a member \"index\"",
            ],
        ),
        (
            json!({ "emissiveTexture": { "index": 0 } }),
            [
                "/materials/0/emissiveTexture/index",
                "found 0",
                "no /textures",
            ],
        ),
        (
            json!({ "extensions": 1 }),
            ["/materials/0/extensions", "found 1", "an object"],
        ),
    ] {
        with_material(value).refused(&words);
    }
}

#[test]
fn our_own_keys_are_read_or_refused() {
    let ours = |value: Value| with_material(json!({ "extras": { "kaustik": value } }));
    let m = |value: Value| ours(value).clean().materials[0].clone();
    let named = |name: &str| Some(SpectralInput::Named(name.into()));
    assert_eq!(
        m(json!({ "reflectance": "cornell-red" })).reflectance,
        named("cornell-red")
    );
    assert_eq!(m(json!({ "emission": "D65" })).emission, named("D65"));
    let knots = SpectralInput::Knots(vec![(400.0, 0.5), (700.0, 3.0)]);
    assert_eq!(
        m(json!({ "emission": [[400, 0.5], [700, 3]] })).emission,
        Some(knots)
    );
    assert_eq!(m(json!({ "metal": "au" })).metal, Some(Metal::Au));
    assert_eq!(m(json!({ "glass": "sf11" })).glass, Glass::named("sf11"));
    let sellmeier = json!({ "glass": { "B": [1.0, 0.25], "C": [0.01, 0.02] } });
    assert_eq!(
        m(sellmeier).glass,
        Glass::sellmeier(&[1.0, 0.25], &[0.01, 0.02]).ok()
    );
    let abbe = json!({ "glass": { "nd": 1.5, "abbe": 40 } });
    assert_eq!(m(abbe).glass, Glass::abbe(1.5, 40.0).ok());
    assert_eq!(m(json!({ "model": "coated" })).model, Some(Model::Coated));
    let phong = m(json!({ "model": "phong", "exponent": 20, "priority": -3 }));
    assert_eq!(phong.model, Some(Model::Phong { exponent: 20.0 }));
    assert_eq!(phong.priority, -3);
    for (value, key, words) in [
        (
            json!({ "reflectance": "cornell-blue" }),
            "reflectance",
            "cornell-white",
        ),
        (
            json!({ "reflectance": [[400, 2]] }),
            "reflectance",
            "0 to 1",
        ),
        (
            json!({ "reflectance": [[400, 1], [300, 1]] }),
            "reflectance",
            "ascending",
        ),
        (json!({ "emission": 1 }), "emission", "[[nm, value], ...]"),
        (json!({ "emission": [] }), "emission", "ascending"),
        (json!({ "metal": "Fe" }), "metal", "ag, au, cu, al"),
        (json!({ "glass": "window" }), "glass", "n-bk7"),
        (
            json!({ "glass": { "B": [1], "C": [0.2] } }),
            "glass",
            "found",
        ),
        (
            json!({ "glass": { "cauchy": [-1, 0] } }),
            "glass",
            "index of refraction",
        ),
        (
            json!({ "model": "toon" }),
            "model",
            "coated, phong or oren-nayar",
        ),
        (json!({ "model": "phong" }), "", "\"exponent\""),
        (
            json!({ "model": "phong", "exponent": -1 }),
            "exponent",
            "0 or more",
        ),
        (json!({ "priority": 0.5 }), "priority", "an integer"),
    ] {
        ours(value).refused(&["/materials/0/extras/kaustik", key, words]);
    }
    for value in [
        json!({ "colour": 1 }),
        json!({ "sigma": 1 }),
        json!({ "exponent": 1 }),
    ] {
        assert!(ours(value).warned().1.contains("ignored"));
    }
    let d = with_material(json!({ "extras": "free text" })).clean();
    assert_eq!(d.materials[0], MaterialDescription::default());
}

#[test]
fn images_from_views_and_data_uris() {
    let mut file = File::empty();
    let view = file.view(&jpeg(8, 4));
    let data = format!("data:image/png;base64,{}", STANDARD.encode(png(3, 2)));
    file.json["images"] = json!([
        { "bufferView": view, "mimeType": "image/jpeg", "name": "photo" },
        { "uri": data },
    ]);
    let d = file.clean();
    assert_eq!((d.images[0].width, d.images[0].height), (8, 4));
    assert_eq!(d.images[0].name, "photo");
    assert_eq!(d.images[0].encoded, jpeg(8, 4));
    let Pixels::Rgba8(pixels) = &d.images[1].pixels else {
        panic!("bytes expected");
    };
    assert_eq!(pixels.len(), 24);
    assert_eq!(pixels[20..], [2, 1, 7, 200]);
    assert_eq!(d.images[1].name, "");
}

#[test]
fn broken_images_are_refused() {
    let with = |bytes: &[u8]| {
        let mut file = File::empty();
        let view = file.view(bytes);
        file.json["images"] = json!([{ "bufferView": view }]);
        file.json["textures"] = json!([{ "source": 0 }]);
        file
    };
    let whole = png(64, 64);
    let error = with(&whole[..whole.len() / 2]).error();
    assert_eq!(
        (error.kind(), error.place()),
        (ErrorKind::Image, "/images/0")
    );
    let whole = jpeg(64, 64);
    assert_eq!(with(&whole[..30]).error().kind(), ErrorKind::Image);
    // a header that promises 30,000 x 30,000 pixels
    let mut lie = png(4, 4);
    lie[16..20].copy_from_slice(&30_000_u32.to_be_bytes());
    lie[20..24].copy_from_slice(&30_000_u32.to_be_bytes());
    let length = lie.len();
    let crc = crc32(&lie[12..29]);
    lie[29..33].copy_from_slice(&crc.to_be_bytes());
    let message = with(&lie).error().to_string();
    assert!(
        message.contains(&format!("30000 x 30000 in {length} bytes")),
        "{message}"
    );
    // not read at all
    with(b"\xabKTX 20\xbb").refused(&["/textures/0/source", "PNG, JPEG or WebP"]);
}

pub(super) fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = !0_u32;
    for &byte in bytes {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ (0xedb8_8320 & 0_u32.wrapping_sub(crc & 1));
        }
    }
    !crc
}

#[test]
fn textures_of_optional_formats_are_left_out() {
    let mut file = with_material(json!({ "emissiveTexture": { "index": 0 } }));
    let view = file.view(b"\xabKTX 20\xbb\r\n\x1a\n");
    file.json["images"] = json!([{ "bufferView": view, "mimeType": "image/ktx2" }]);
    file.json["textures"] = json!([{ "extensions": { "KHR_texture_basisu": { "source": 0 } } }]);
    file.json["extensionsUsed"] = json!(["KHR_texture_basisu"]);
    let loaded = file.load();
    assert_eq!(loaded.description.materials[0].emissive_texture, None);
    assert!(loaded.description.textures.is_empty() && loaded.description.images.is_empty());
    assert_eq!(loaded.warnings.len(), 4, "{:?}", loaded.warnings);
}

#[test]
fn uv_sets_past_the_second_are_left_out() {
    let mut file = with_material(json!({ "emissiveTexture": { "index": 0, "texCoord": 2 } }));
    let view = file.view(&png(1, 1));
    file.json["images"] = json!([{ "bufferView": view }]);
    file.json["textures"] = json!([{ "source": 0 }]);
    assert!(file.warned().1.contains("TEXCOORD_2"));
}

#[test]
fn what_adds_nothing_to_a_picture_may_be_required() {
    let mut file = File::triangle();
    let harmless = json!(["KHR_xmp_json_ld", "KHR_animation_pointer"]);
    file.json["extensionsRequired"] = harmless.clone();
    file.json["extensionsUsed"] = harmless;
    let loaded = file.load();
    assert_eq!(loaded.extensions.ignored.len(), 2);
    assert_eq!(loaded.warnings.len(), 2);
    assert!(loaded.warnings[0].message.contains("adds nothing"));
}

#[test]
fn extensions_are_refused_if_required_and_told_if_used() {
    let mut file = File::triangle();
    file.json["extensionsUsed"] = json!(["KHR_texture_basisu", "ACME_soap", "KHR_materials_ior"]);
    let loaded = file.load();
    let warnings = loaded.warnings;
    assert!(
        warnings[0]
            .message
            .contains("KHR_texture_basisu is ignored")
    );
    assert!(warnings[0].message.contains("PNG, JPEG or WebP"));
    assert!(warnings[1].message.contains("ACME_soap is unknown"));
    assert_eq!(warnings.len(), 2);
    assert_eq!(loaded.extensions.read, ["KHR_materials_ior"]);
    assert_eq!(
        loaded.extensions.ignored,
        ["KHR_texture_basisu", "ACME_soap"]
    );
    for (name, help) in [
        ("ACME_soap", "export the scene again"),
        ("KHR_draco_mesh_compression", "EXT_meshopt_compression"),
        ("KHR_texture_basisu", "PNG, JPEG or WebP"),
    ] {
        file.json["extensionsRequired"] = json!(["KHR_texture_transform", name]);
        file.refused(&[
            "/extensionsRequired/1",
            name,
            "KHR_materials_volume",
            "EXT_mesh_gpu_instancing",
            help,
        ]);
    }
}
