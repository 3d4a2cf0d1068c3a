//! `kaustik info`: what a scene holds.

use std::fmt::Write;
use std::process::ExitCode;

use kaustik::scene::description::{CameraDescription, EnvironmentDescription, Projection};
use kaustik::scene::{Description, Scene, SceneOptions};

use crate::arguments::InfoWords;
use crate::{Failure, input, output};

pub(crate) fn run(words: &InfoWords) -> Result<ExitCode, Failure> {
    let input = input::load(&words.scene, words.max_memory, None)?;
    let mut text = contents(&input.description);
    let mut line = |what: &str, value: &str| {
        let _ = writeln!(text, "{what:<11} {value}");
    };
    line("variants", &names(input.variants.iter()));
    line("extensions", &names(input.extensions.read.iter()));
    if !input.extensions.ignored.is_empty() {
        line("ignored", &names(input.extensions.ignored.iter()));
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
    line(
        "memory",
        &format!(
            "{:.1} MB once loaded, and {:.1} MB for tracing rays",
            megabytes(input.memory),
            megabytes(trees)
        ),
    );
    for notice in scene.notices() {
        line("note", notice);
    }
    for warning in &input.warnings {
        line("warning", warning);
    }
    output::print(&text)?;
    Ok(ExitCode::SUCCESS)
}

fn contents(scene: &Description) -> String {
    let mut text = String::new();
    let stored: usize = scene.meshes.iter().map(|mesh| mesh.indices.len()).sum();
    let placed: usize = scene
        .instances
        .iter()
        .filter_map(|instance| scene.meshes.get(instance.mesh))
        .map(|mesh| mesh.indices.len())
        .sum();
    let mut line = |what: &str, value: String| {
        let _ = writeln!(text, "{what:<11} {value}");
    };
    line(
        "scene",
        if scene.name.is_empty() {
            "(no name)".into()
        } else {
            scene.name.clone()
        },
    );
    line(
        "meshes",
        format!("{}, {stored} triangles", scene.meshes.len()),
    );
    line(
        "instances",
        format!("{}, {placed} triangles placed", scene.instances.len()),
    );
    line(
        "materials",
        names(scene.materials.iter().map(|material| &material.name)),
    );
    let images: Vec<String> = scene
        .images
        .iter()
        .map(|image| format!("{} ({} x {})", image.name, image.width, image.height))
        .collect();
    line("images", names(images.iter()));
    let emissive = (scene.materials.iter())
        .filter(|material| material.emissive.iter().any(|&channel| channel > 0.0))
        .count();
    line(
        "lights",
        format!(
            "{} points, spots and suns; {emissive} emissive materials",
            names(scene.lights.iter().map(|light| &light.name))
        ),
    );
    let cameras: Vec<String> = scene.cameras.iter().enumerate().map(camera).collect();
    line("cameras", names(cameras.iter()));
    let environment = match &scene.environment {
        None => "none".to_owned(),
        Some(EnvironmentDescription::Constant(color)) => format!("constant, {color:?}"),
        Some(EnvironmentDescription::Image { image, .. }) => {
            format!("{} ({} x {})", image.name, image.width, image.height)
        }
    };
    line("environment", environment);
    let animation = &scene.animation;
    if !animation.is_empty() {
        let shutters = scene.cameras.iter().filter(|c| c.shutter.is_some()).count();
        line(
            "motion",
            format!(
                "{} moving nodes carry {} instances, lights and cameras; {shutters} cameras have a shutter interval",
                animation.joints.len(),
                animation.carried.len()
            ),
        );
    }
    text
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
