use std::path::{Path, PathBuf};

use serde_json::Value;

use super::budget::Budget;
use super::buffer::Buffers;
use super::container::Container;
use super::extension::Extensions;
use super::folder::{Folder, read_file};
use super::json::Cursor;
use super::mesh::Meshes;
use super::placement::{self, Parts};
use super::reader::Reader;
use super::texture::Textures;
use super::variant::Variants;
use super::warning::{Warning, Warnings};
use super::{ErrorKind, LoadError, LoadOptions};
use super::{
    animation, camera, environment, extension, image, image_light, light, material, node, skin,
    syntax,
};
use crate::description::Description;

/// A scene file's contents, and what could not be taken from it as it stands.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The scene. Its indices are in range, its numbers finite.
    pub description: Description,
    /// What was replaced, left out or ignored, in the order of the reading.
    pub warnings: Vec<Warning>,
    /// Bytes that loading counted at the end: about what the description takes.
    pub memory: u64,
    /// The file's material variants (`KHR_materials_variants`), by name.
    pub variants: Vec<String>,
    /// The extensions that the file names.
    pub extensions: Extensions,
    /// The other files that were read, without links, in alphabetical order.
    pub files: Vec<PathBuf>,
}

/// Loads a `.gltf` or `.glb` file; which of them it is, its first bytes tell.
///
/// # Errors
/// Whatever the bytes are, the answer is a scene or an error; see [`LoadError`].
pub fn load(path: &Path, options: &LoadOptions) -> Result<Loaded, LoadError> {
    let load = || {
        let mut budget = Budget::new(options);
        let failed = |e| LoadError::io("", "a readable glTF file", e);
        let bytes = read_file(path, "", &mut budget, failed)?;
        let folder = Folder::of(path)?;
        read(&bytes, folder, budget, options)
    };
    load().map_err(|e: LoadError| e.in_file(path))
}

/// Loads a scene from the bytes of a `.gltf` or `.glb` file that refers to no other file;
/// `name` stands in for the file's name in messages.
///
/// # Errors
/// As [`load`]; any uri but a data uri is one as well.
pub fn load_bytes(bytes: &[u8], name: &str, options: &LoadOptions) -> Result<Loaded, LoadError> {
    let load = || {
        let mut budget = Budget::new(options);
        budget.file("", bytes.len() as u64)?;
        read(bytes, Folder::none(), budget, options)
    };
    load().map_err(|e: LoadError| e.in_file(Path::new(name)))
}

fn read(
    bytes: &[u8],
    folder: Folder,
    mut budget: Budget,
    options: &LoadOptions,
) -> Result<Loaded, LoadError> {
    let mut warnings = Warnings::default();
    let container = Container::split(bytes, &mut warnings)?;
    let tree = syntax::parse(container.json, &mut budget)?;
    document(&tree, container.binary, folder, budget, warnings, options)
}

fn document<'a>(
    tree: &'a Value,
    binary: Option<&'a [u8]>,
    mut folder: Folder,
    mut budget: Budget,
    mut warnings: Warnings,
    options: &LoadOptions,
) -> Result<Loaded, LoadError> {
    let root = Cursor::root(tree);
    check_version(&root)?;
    let extensions = extension::check(&root, &mut warnings)?;
    let buffers = Buffers::load(&root, binary, &mut folder, &mut budget)?;
    let mut reader = Reader {
        root,
        buffers,
        folder,
        budget,
        warnings,
        options: options.clone(),
        quantized: extensions.has("KHR_mesh_quantization"),
    };
    let variants = Variants::load(&reader)?;
    let description = describe(&mut reader, &variants)?;
    Ok(Loaded {
        description,
        memory: reader.budget.used(),
        warnings: reader.warnings.into_list(),
        variants: variants.names,
        extensions,
        files: reader.folder.files(),
    })
}

fn describe(reader: &mut Reader<'_>, variants: &Variants) -> Result<Description, LoadError> {
    let mut description = Description::default();
    let root = reader.root.clone();
    // the cheap checks first, so that a file with broken nodes is refused at once
    let scene = node::scene(&root)?;
    let nodes = node::flatten(reader, scene.as_ref())?;
    let cameras = camera::load(reader)?;
    let lights = light::load(reader)?;
    let meshes = Meshes::load(reader, variants)?;
    let seen = cameras.iter().any(|camera| camera.shutter.is_some());
    let rig = animation::load(reader, &nodes, seen)?;
    let parts = Parts {
        skins: skin::load(reader, &nodes, &rig)?,
        meshes,
        cameras,
        lights,
    };
    placement::place(reader, &nodes, parts, &rig, &mut description)?;
    if !description.animation.carried.is_empty() {
        description.animation.joints = rig.joints;
    }
    let images = image::load(reader)?;
    let textures = Textures::load(reader, &images)?;
    description.materials = material::load(reader, &textures)?;
    description.textures = textures.list;
    if let Some(scene) = &scene {
        description.name = scene.text("name")?.to_owned();
        description.environment = match environment::load(reader, scene)? {
            Some(ours) => Some(ours),
            None => image_light::load(reader, scene, &images)?,
        };
    }
    description.images = images.list;
    Ok(description)
}

/// glTF 2.x that needs no later reader than one of 2.0.
fn check_version(root: &Cursor<'_>) -> Result<(), LoadError> {
    let asset = root.need("asset")?;
    let version = asset.need("version")?;
    if !version.string()?.starts_with("2.") {
        return Err(version.mismatch("glTF version 2.0"));
    }
    match asset.get("minVersion")? {
        Some(least) if least.string()? != "2.0" => Err(least.error(
            ErrorKind::Value,
            least.string()?,
            "a file for readers of glTF 2.0",
        )),
        _ => Ok(()),
    }
}
