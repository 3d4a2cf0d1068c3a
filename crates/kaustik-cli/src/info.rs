//! `kaustik info`: what a scene holds.

use std::fmt::Write;
use std::process::ExitCode;

use kaustik::scene::Description;

use crate::arguments::InfoWords;
use crate::{Failure, input, output};

pub(crate) fn run(words: &InfoWords) -> Result<ExitCode, Failure> {
    let input = input::load(&words.scene, None)?;
    let mut text = contents(&input.description);
    if input.memory > 0 {
        let _ = writeln!(
            text,
            "memory      {:.1} MB once loaded",
            input.memory as f64 * 1e-6
        );
    }
    for warning in &input.warnings {
        let _ = writeln!(text, "warning     {warning}");
    }
    output::print(&text);
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
    line(
        "lights",
        names(scene.lights.iter().map(|light| &light.name)),
    );
    line(
        "cameras",
        names(scene.cameras.iter().map(|camera| &camera.name)),
    );
    let environment = if scene.environment.is_some() {
        "yes"
    } else {
        "none"
    };
    line("environment", environment.into());
    text
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
