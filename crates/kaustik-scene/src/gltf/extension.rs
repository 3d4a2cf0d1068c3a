use super::json::{Cursor, shorten};
use super::warning::Warnings;
use super::{ErrorKind, LoadError};

/// The extensions that are read.
pub const EXTENSIONS: [&str; 22] = [
    "EXT_lights_image_based",
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_texture_transform",
];

/// Known and not read, each with what a user can do about it.
const REFUSED: [(&str, &str); 4] = [
    (
        "KHR_draco_mesh_compression",
        "there is no decoder of Draco that is kept and in Rust alone: export without Draco, or with EXT_meshopt_compression",
    ),
    (
        "KHR_texture_basisu",
        "there is no decoder of Basis Universal that is kept and in Rust alone: export textures as PNG, JPEG or WebP",
    ),
    (
        "KHR_meshopt_compression",
        "only EXT_meshopt_compression is read: export with that",
    ),
    (
        "EXT_texture_avif",
        "AVIF is not read: export textures as PNG, JPEG or WebP",
    ),
];

/// Known and not read, even where a file requires them: what they add is no part of a picture, or moves what a
/// scene at rest has anyway.
const HARMLESS: [&str; 3] = ["KHR_animation_pointer", "KHR_xmp", "KHR_xmp_json_ld"];

/// The extensions that a file names in `extensionsUsed` and `extensionsRequired`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Extensions {
    /// Used and read.
    pub read: Vec<String>,
    /// Used and ignored: the scene is shown without what they add.
    pub ignored: Vec<String>,
}

/// Refuses required extensions that are not read and warns of used ones.
pub(super) fn check(root: &Cursor<'_>, warnings: &mut Warnings) -> Result<Extensions, LoadError> {
    let mut extensions = Extensions::default();
    for name in root.list("extensionsRequired")? {
        let text = name.string()?;
        let known = EXTENSIONS.contains(&text);
        if known || HARMLESS.contains(&text) {
            extensions.add(text, known);
            continue;
        }
        let found = format!("the required extension {}", shorten(text));
        let expected = format!("only extensions that are read: {}", EXTENSIONS.join(", "));
        let help =
            reason(text).unwrap_or("export the scene again without it, or with it as optional");
        return Err(name.error(ErrorKind::Extension, found, expected).help(help));
    }
    for name in root.list("extensionsUsed")? {
        let text = name.string()?;
        let known = EXTENSIONS.contains(&text);
        extensions.add(text, known);
        if !known {
            let message = match reason(text) {
                Some(reason) => format!("the extension {text} is ignored: {reason}"),
                None if HARMLESS.contains(&text) => {
                    format!("the extension {text} is ignored: it adds nothing to a scene at rest")
                }
                None => format!("the extension {} is unknown and ignored", shorten(text)),
            };
            warnings.push(name.pointer(), message);
        }
    }
    Ok(extensions)
}

fn reason(name: &str) -> Option<&'static str> {
    let row = REFUSED.iter().find(|row| row.0 == name);
    row.map(|row| row.1)
}

impl Extensions {
    /// More than this many are not listed.
    const MOST: usize = 200;

    fn add(&mut self, name: &str, read: bool) {
        let name = shorten(name);
        let list = if read {
            &mut self.read
        } else {
            &mut self.ignored
        };
        if list.len() < Self::MOST && !list.contains(&name) {
            list.push(name);
        }
    }

    /// Is the extension among those that are read?
    pub(super) fn has(&self, name: &str) -> bool {
        self.read.iter().any(|read| read == name)
    }
}
