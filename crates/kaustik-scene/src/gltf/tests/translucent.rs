//! `KHR_materials_diffuse_transmission`.

use serde_json::{Value, json};

use super::file::{File, png};
use crate::description::{DiffuseTransmission, TextureSlot, UvTransform};

fn leaf(beside: &Value) -> File {
    let mut file = File::empty();
    let mut extensions = json!({ "KHR_materials_diffuse_transmission": {
        "diffuseTransmissionFactor": 0.25, "diffuseTransmissionTexture": { "index": 0 },
        "diffuseTransmissionColorFactor": [0.5, 1, 0.25], "diffuseTransmissionColorTexture": { "index": 1 },
    }});
    let all = extensions.as_object_mut().unwrap();
    all.extend(beside.as_object().unwrap().clone());
    file.json["materials"] = json!([{ "extensions": extensions }]);
    let view = file.view(&png(2, 3));
    file.json["images"] = json!([{ "bufferView": view, "mimeType": "image/png" }]);
    file.json["textures"] = json!([{ "source": 0 }, { "source": 0 }]);
    file.json["extensionsRequired"] = json!(["KHR_materials_diffuse_transmission"]);
    file
}

#[test]
fn a_leaf_is_read_in_full() {
    let slot = |texture| {
        Some(TextureSlot {
            texture,
            uv_set: 0,
            transform: UvTransform::IDENTITY,
        })
    };
    let read = DiffuseTransmission {
        factor: 0.25,
        texture: slot(0),
        color: [0.5, 1.0, 0.25],
        color_texture: slot(1),
    };
    let of = |beside: Value| leaf(&beside).clean().materials[0].diffuse_transmission;
    assert_eq!(of(json!({})), Some(read));
    // Neither makes a solid.
    for beside in [
        json!({ "KHR_materials_volume": { "thicknessFactor": 0 } }),
        json!({ "KHR_materials_transmission": { "transmissionFactor": 0.5 } }),
    ] {
        assert_eq!(of(beside), Some(read));
    }
    let mut bare = File::empty();
    bare.json["materials"] =
        json!([{ "extensions": { "KHR_materials_diffuse_transmission": {} } }]);
    let read = bare.clean().materials[0].diffuse_transmission.unwrap();
    assert_eq!((read.factor, read.color), (0.0, [1.0; 3]));
}

#[test]
fn of_a_solid_no_diffuse_light_goes_through() {
    let solid = json!({
        "KHR_materials_volume": { "thicknessFactor": 1 },
        "KHR_materials_transmission": { "transmissionFactor": 0.5 },
    });
    let (description, warning) = leaf(&solid).warned();
    assert_eq!(description.materials[0].diffuse_transmission, None);
    assert!(
        warning.contains("KHR_materials_diffuse_transmission"),
        "{warning}"
    );
}

/// What scatters within is not shown, nor what would absorb between two surfaces that scatter.
#[test]
fn a_leaf_is_thin() {
    let thick = json!({ "KHR_materials_volume": { "thicknessFactor": 1 } });
    let (description, warning) = leaf(&thick).warned();
    let material = &description.materials[0];
    assert!(material.diffuse_transmission.is_some() && material.volume.is_none());
    assert!(warning.contains("the volume"), "{warning}");
}
