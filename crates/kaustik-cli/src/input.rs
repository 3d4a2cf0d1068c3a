//! From the word SCENE to a description.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use kaustik::film::{self, Keep, Limits};
use kaustik::scene::description::{EnvironmentDescription, ImageData, Pixels, Projection};
use kaustik::scene::environment::{clean_radiance, load_hdr};
use kaustik::scene::{Description, builtin, gltf};

use crate::Failure;
use crate::picture::ending;

/// A scene as the user named it.
pub(crate) struct Input {
    pub(crate) description: Description,
    /// What could not be taken as it stands.
    pub(crate) warnings: Vec<String>,
    /// Bytes that the description takes.
    pub(crate) memory: u64,
    /// Material variants, by name.
    pub(crate) variants: Vec<String>,
    /// The extensions that the file names.
    pub(crate) extensions: gltf::Extensions,
    /// The other files that it is made from.
    pub(crate) files: Vec<PathBuf>,
}

/// Loads `builtin:NAME` or a glTF file.
pub(crate) fn load(
    scene: &str,
    max_memory: Option<u64>,
    variant: Option<&str>,
) -> Result<Input, Failure> {
    if let Some(name) = scene.strip_prefix("builtin:") {
        return built_in(scene, name, max_memory, variant);
    }
    let mut options = gltf::LoadOptions::default();
    options.variant = variant.map(str::to_owned);
    if let Some(bytes) = max_memory {
        options = options.with_max_memory(bytes);
    }
    let loaded =
        gltf::load(Path::new(scene), &options).map_err(|error| not_loaded(scene, &error))?;
    Ok(Input {
        description: loaded.description,
        warnings: loaded
            .warnings
            .iter()
            .map(|warning| format!("{scene}: {warning}"))
            .collect(),
        memory: loaded.memory,
        variants: loaded.variants,
        extensions: loaded.extensions,
        files: loaded.files,
    })
}

/// Names the built-in scene that may have been meant.
fn not_loaded(scene: &str, error: &gltf::LoadError) -> Failure {
    let name = scene.split('?').next().unwrap_or_default();
    let known = builtin::list().iter().any(|scene| scene.name == name);
    match known && !Path::new(scene).exists() {
        true => Failure::Input(format!("{error}; did you mean builtin:{scene}?")),
        false => Failure::input(error),
    }
}

fn built_in(
    scene: &str,
    name: &str,
    max_memory: Option<u64>,
    variant: Option<&str>,
) -> Result<Input, Failure> {
    if let Some(variant) = variant {
        return Err(Failure::Input(format!(
            "{scene}: --variant \"{variant}\": built-in scenes have none"
        )));
    }
    let description = builtin::load(name).map_err(Failure::input)?;
    let meshes = description.meshes.iter();
    let memory = meshes.map(|mesh| mesh.memory() as u64).sum();
    if let Some(most) = max_memory.filter(|&most| memory > most) {
        return Err(Failure::Input(format!(
            "{scene}: needs {memory} bytes, but --max-memory allows {most}"
        )));
    }
    Ok(Input {
        description,
        warnings: Vec::new(),
        memory,
        variants: Vec::new(),
        extensions: gltf::Extensions::default(),
        files: Vec::new(),
    })
}

/// `--environment`: one number, `R,G,B`, or a file; and how many values of the file had to be mended.
pub(crate) fn environment(text: &str) -> Result<(EnvironmentDescription, u64), Failure> {
    let numbers: Option<Vec<f32>> = text
        .split(',')
        .map(|part| part.trim().parse().ok())
        .collect();
    let sound = |c: &[f32]| c.iter().all(|c| c.is_finite() && *c >= 0.0);
    match numbers.as_deref() {
        Some(&[grey]) if sound(&[grey]) => Ok((EnvironmentDescription::Constant([grey; 3]), 0)),
        Some(&[r, g, b]) if sound(&[r, g, b]) => {
            Ok((EnvironmentDescription::Constant([r, g, b]), 0))
        }
        Some(_) => Err(Failure::Input(format!(
            "--environment {text}: expected one number, R,G,B (each >= 0), or a .hdr or .exr file"
        ))),
        None => {
            let (image, mended) = environment_image(Path::new(text))?;
            let environment = EnvironmentDescription::Image {
                image: Arc::new(image),
                strength: 1.0,
                rotation: glam::Quat::IDENTITY,
            };
            Ok((environment, mended))
        }
    }
}

fn environment_image(path: &Path) -> Result<(ImageData, u64), Failure> {
    if ending(path).as_deref() != Some("exr") {
        return load_hdr(path)
            .map(|decoded| (decoded.image, decoded.cleaned))
            .map_err(|error| Failure::input_by(&error));
    }
    let image = film::read(path, &Limits::default(), Keep::Main).map_err(Failure::input)?;
    let size = [image.width(), image.height()];
    if image.full_size() != size {
        let [width, height] = image.full_size();
        return Err(Failure::Input(format!(
            "{}: a part of {width} x {height} pixels: expected a whole panorama",
            path.display()
        )));
    }
    let [r, g, b] = image.rgb();
    let texels = r.iter().zip(g).zip(b);
    let mut values: Vec<f32> = texels.flat_map(|((r, g), b)| [*r, *g, *b]).collect();
    let mended = clean_radiance(&mut values);
    let image = ImageData {
        name: path.display().to_string(),
        width: image.width(),
        height: image.height(),
        pixels: Pixels::RgbF32(values),
        encoded: Vec::new(),
    };
    Ok((image, mended))
}

/// Width over height of the camera that will be used, if the file says.
fn aspect(description: &Description, camera: Option<&str>) -> Option<f64> {
    let camera = description.camera(camera)?;
    let aspect = match camera.projection {
        Projection::Perspective { aspect_ratio, .. } => f64::from(aspect_ratio?),
        Projection::Orthographic { xmag, ymag } => f64::from(xmag) / f64::from(ymag),
    };
    (aspect.is_finite() && aspect > 0.0).then_some(aspect)
}

/// Size of the image: what is not given follows from the camera's aspect ratio (4:3 if the file
/// says nothing). Where neither side is given, a tall picture has the height that a wide one has as its width: a file
/// must not choose a picture that no memory holds.
pub(crate) fn image_size(
    description: &Description,
    camera: Option<&str>,
    size: (Option<u32>, Option<u32>),
) -> (u32, u32) {
    const LONGER: u32 = 1024;
    const LARGEST: f64 = 65_536.0;
    let aspect = aspect(description, camera).unwrap_or(4.0 / 3.0);
    let side = |length: f64| length.round().clamp(1.0, LARGEST) as u32;
    match size {
        (Some(width), Some(height)) => (width, height),
        (None, Some(height)) => (side(f64::from(height) * aspect), height),
        (Some(width), None) => (width, side(f64::from(width) / aspect)),
        (None, None) if aspect < 1.0 => (side(f64::from(LONGER) * aspect), LONGER),
        (None, None) => (LONGER, side(f64::from(LONGER) / aspect)),
    }
}
