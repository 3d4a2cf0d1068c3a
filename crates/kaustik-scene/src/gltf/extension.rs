use super::json::{Cursor, shorten};
use super::warning::Warnings;
use super::{ErrorKind, LoadError};

/// The extensions that are read, and written where a scene needs them.
pub const EXTENSIONS: [&str; 16] = [
    "EXT_mesh_gpu_instancing",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// Known, but not read yet: a scene that merely uses them loads without what they add.
const LATER: [&str; 4] = [
    "EXT_lights_image_based",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_materials_variants",
];

/// Refuses required extensions that are not read and warns of used ones. Returns whether
/// vertices may be quantised.
pub(super) fn check(root: &Cursor<'_>, warnings: &mut Warnings) -> Result<bool, LoadError> {
    let mut quantized = false;
    for name in root.list("extensionsRequired")? {
        let text = name.string()?;
        quantized |= text == "KHR_mesh_quantization";
        if EXTENSIONS.contains(&text) {
            continue;
        }
        let found = format!("the required extension {}", shorten(text));
        let expected = format!("only extensions that are read: {}", EXTENSIONS.join(", "));
        return Err(name
            .error(ErrorKind::Extension, found, expected)
            .help("export the scene again without it, or with it as optional"));
    }
    for name in root.list("extensionsUsed")? {
        let text = name.string()?;
        quantized |= text == "KHR_mesh_quantization";
        if !EXTENSIONS.contains(&text) {
            let known = if LATER.contains(&text) {
                "not read yet"
            } else {
                "unknown"
            };
            let message = format!("the extension {} is {known} and ignored", shorten(text));
            warnings.push(name.pointer(), message);
        }
    }
    Ok(quantized)
}
