//! `kaustik info`: what a scene holds.

use std::fmt::Write;
use std::process::ExitCode;

use kaustik::scene::description::{
    CameraDescription, EnvironmentDescription, ImageData, Projection,
};
use kaustik::scene::{Description, Scene, SceneOptions};

use crate::arguments::InfoWords;
use crate::output::without_controls;
use crate::{Failure, input, output};

pub(crate) fn run(words: &InfoWords) -> Result<ExitCode, Failure> {
    let input = input::load(&words.scene, words.max_memory, None)?;
    let mut lines = contents(&input.description);
    lines.add("variants", &names(input.variants.iter()));
    lines.add("extensions", &names(input.extensions.read.iter()));
    if !input.extensions.ignored.is_empty() {
        lines.add("ignored", &names(input.extensions.ignored.iter()));
    }
    let options = SceneOptions {
        width: 16,
        height: 16,
        ..SceneOptions::default()
    };
    // what the file says is one thing, whether it is a scene another: both before a render
    let scene = Scene::new(&input.description, &options)
        .map_err(|error| Failure::Input(format!("{}: {error}", words.scene)))?;
    let megabytes = |bytes: u64| bytes as f64 * 1e-6;
    let trees = scene.world().memory() as u64;
    lines.add(
        "memory",
        &format!(
            "{:.1} MB once loaded, and {:.1} MB for tracing rays",
            megabytes(input.memory),
            megabytes(trees)
        ),
    );
    for notice in scene.notices() {
        lines.add("note", notice);
    }
    for warning in &input.warnings {
        lines.add("warning", warning);
    }
    output::print(&lines.0)?;
    Ok(ExitCode::SUCCESS)
}

/// Lines of a word and what there is to say of it.
struct Lines(String);

impl Lines {
    /// Names come from the file: what they have of line ends and terminal's commands is shown as such.
    fn add(&mut self, what: &str, value: &str) {
        let value = without_controls(value);
        let _ = writeln!(self.0, "{what:<11} {value}");
    }
}

fn contents(scene: &Description) -> Lines {
    let mut lines = Lines(String::new());
    let name = match scene.name.as_str() {
        "" => "(no name)",
        name => name,
    };
    lines.add("scene", name);
    let stored: usize = scene.meshes.iter().map(|mesh| mesh.indices.len()).sum();
    let meshes = format!("{}, {stored} triangles", scene.meshes.len());
    lines.add("meshes", &meshes);
    let placed: usize = scene
        .instances
        .iter()
        .filter_map(|instance| scene.meshes.get(instance.mesh))
        .map(|mesh| mesh.indices.len())
        .sum();
    let instances = format!("{}, {placed} triangles placed", scene.instances.len());
    lines.add("instances", &instances);
    let materials = scene.materials.iter().map(|material| &material.name);
    lines.add("materials", &names(materials));
    let images: Vec<String> = scene.images.iter().map(|image| sized(image)).collect();
    lines.add("images", &names(images.iter()));
    let emissive = (scene.materials.iter())
        .filter(|material| {
            let glows = material.emissive.iter().any(|&channel| channel > 0.0);
            glows || material.emission.is_some() || material.unlit
        })
        .count();
    let lights = names(scene.lights.iter().map(|light| &light.name));
    let lights = format!("points, spots and suns {lights}; {emissive} emissive materials");
    lines.add("lights", &lights);
    let cameras: Vec<String> = scene.cameras.iter().enumerate().map(camera).collect();
    lines.add("cameras", &names(cameras.iter()));
    let environment = match &scene.environment {
        None => "none".to_owned(),
        Some(EnvironmentDescription::Constant(color)) => format!("constant, {color:?}"),
        Some(EnvironmentDescription::Image { image, .. }) => sized(image),
    };
    lines.add("environment", &environment);
    if !scene.animation.is_empty() {
        lines.add("motion", &motion(scene));
    }
    lines
}

/// Name, columns and rows.
fn sized(image: &ImageData) -> String {
    format!("{} ({} x {})", image.name, image.width, image.height)
}

fn motion(scene: &Description) -> String {
    let shutters = scene.cameras.iter().filter(|c| c.shutter.is_some()).count();
    format!(
        "{} moving nodes carry {} instances, lights and cameras; {shutters} cameras have a shutter interval",
        scene.animation.joints.len(),
        scene.animation.carried.len()
    )
}

/// Index, name and kind.
fn camera((index, camera): (usize, &CameraDescription)) -> String {
    let kind = match (camera.projection, camera.lens) {
        (Projection::Orthographic { .. }, _) => "orthographic",
        (Projection::Perspective { .. }, None) => "pinhole",
        (Projection::Perspective { .. }, Some(_)) => "thin lens",
    };
    let name = if camera.name.is_empty() {
        String::new()
    } else {
        format!("{} ", camera.name)
    };
    format!("{index} {name}({kind})")
}

/// `3: a, b, c`.
fn names<'a>(names: impl ExactSizeIterator<Item = &'a String>) -> String {
    let count = names.len();
    let list: Vec<&str> = names
        .map(String::as_str)
        .filter(|name| !name.is_empty())
        .collect();
    if list.is_empty() {
        count.to_string()
    } else {
        format!("{count}: {}", list.join(", "))
    }
}
