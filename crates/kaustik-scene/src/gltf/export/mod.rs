//! Writing glTF such that what is read back equals what was written.
//!
//! Every export is loaded again before it is handed out and compared: what the loader would
//! warn of, refuse or change is an error here, with the loader's own words. So a file that
//! was written is known to be good, and the rules of validity stand in one place. Only where something moves
//! its place is compared but nearly: matrices of a file have single precision.

mod animation;
mod error;
mod geometry;
mod image;
mod layers;
mod material;
mod nodes;
mod scene;
mod writer;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::{LoadOptions, load_bytes};
use crate::Description;
pub use error::ExportError;
use writer::Writer;

/// A scene as the bytes of a GLB file. Equal descriptions give equal bytes.
///
/// # Errors
/// What glTF and `extras.kaustik` cannot hold exactly.
pub fn export_bytes(description: &Description) -> Result<Vec<u8>, ExportError> {
    let (json, mut binary) = document(description)?.finish(|_| None);
    let mut json = json.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &binary)] {
        if !chunk.is_empty() {
            bytes.extend(length(chunk.len())?);
            bytes.extend(kind);
            bytes.extend(chunk);
        }
    }
    let total = length(bytes.len())?;
    bytes[8..12].copy_from_slice(&total);
    check(description, &bytes)?;
    Ok(bytes)
}

/// A scene as JSON text with its buffer as a data uri: what a `.gltf` file holds.
///
/// # Errors
/// What glTF and `extras.kaustik` cannot hold exactly.
pub fn export_text(description: &Description) -> Result<Vec<u8>, ExportError> {
    let uri = |bytes: &[u8]| {
        let payload = STANDARD.encode(bytes);
        Some(format!("data:application/octet-stream;base64,{payload}"))
    };
    let (json, _) = document(description)?.finish(uri);
    let bytes = format!("{json:#}\n").into_bytes();
    check(description, &bytes)?;
    Ok(bytes)
}

fn document(description: &Description) -> Result<Writer, ExportError> {
    let mut writer = Writer::default();
    let meshes = geometry::meshes(&mut writer, description);
    let materials = description.materials.iter();
    let materials = materials
        .map(|m| material::material(&mut writer, m))
        .collect();
    writer.set("materials", materials);
    image::images(&mut writer, description)?;
    image::textures(&mut writer, description);
    scene::scene(&mut writer, description, &meshes)?;
    Ok(writer)
}

/// The lengths of a GLB have 32 bits.
fn length(bytes: usize) -> Result<[u8; 4], ExportError> {
    let length = u32::try_from(bytes).map_err(|_| ExportError::Unsupported {
        place: "the whole scene".into(),
        found: format!("{bytes} bytes"),
        expected: "less than 4 GiB, the most that a GLB file can hold".into(),
    })?;
    Ok(length.to_le_bytes())
}

/// Loads what was written and compares.
fn check(description: &Description, bytes: &[u8]) -> Result<(), ExportError> {
    let unfaithful = |why: String| Err(ExportError::Unfaithful(why));
    let options = LoadOptions {
        max_instances: usize::MAX,
        max_file: u64::MAX,
        ..LoadOptions::default().with_max_memory(u64::MAX)
    };
    let loaded = match load_bytes(bytes, "the exported file", &options) {
        Ok(loaded) => loaded,
        Err(e) => return unfaithful(e.to_string()),
    };
    if let Some(warning) = loaded.warnings.first() {
        return unfaithful(warning.to_string());
    }
    let read = animation::reconciled(description, loaded.description);
    match difference(description, &read) {
        Some(part) => unfaithful(format!("{part} would differ")),
        None => Ok(()),
    }
}

/// The first part in which two descriptions differ.
fn difference(a: &Description, b: &Description) -> Option<String> {
    if a == b {
        return None;
    }
    let rest = || {
        let part = if a.environment == b.environment {
            "the number of its parts"
        } else {
            "the environment (more than a Radiance HDR file holds?)"
        };
        part.to_owned()
    };
    let part = unequal("meshes", &a.meshes, &b.meshes)
        .or_else(|| unequal("instances", &a.instances, &b.instances))
        .or_else(|| unequal("materials", &a.materials, &b.materials))
        .or_else(|| unequal("textures", &a.textures, &b.textures))
        .or_else(|| unequal("images", &a.images, &b.images))
        .or_else(|| unequal("lights", &a.lights, &b.lights))
        .or_else(|| unequal("cameras", &a.cameras, &b.cameras))
        .or_else(|| unequal("animation.joints", &a.animation.joints, &b.animation.joints))
        .or_else(|| {
            unequal(
                "animation.carried",
                &a.animation.carried,
                &b.animation.carried,
            )
        });
    Some(part.unwrap_or_else(rest))
}

fn unequal<T: PartialEq>(name: &str, a: &[T], b: &[T]) -> Option<String> {
    let at = a.iter().zip(b).position(|(a, b)| a != b)?;
    Some(format!("{name}[{at}]"))
}
