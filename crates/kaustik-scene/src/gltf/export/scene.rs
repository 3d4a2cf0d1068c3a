use serde_json::{Value, json};

use super::geometry::{MeshIndex, matrix};
use super::writer::{Object, Writer, extras, number, numbers};
use super::{ExportError, image};
use crate::Description;
use crate::description::{CameraDescription, LightDescription, LightKind, Projection};

/// Writes one root node for each instance, camera and light, in this order, and the scene
/// that holds them.
pub(super) fn scene(
    writer: &mut Writer,
    description: &Description,
    meshes: &MeshIndex,
) -> Result<(), ExportError> {
    let mut nodes: Vec<Value> = Vec::new();
    for (i, instance) in description.instances.iter().enumerate() {
        let mesh = meshes.get(&(instance.mesh, instance.material));
        let mesh = *mesh.ok_or_else(|| ExportError::Unsupported {
            place: format!("instances[{i}] (\"{}\")", instance.name),
            found: format!("mesh {}", instance.mesh),
            expected: format!("one of the {} meshes", description.meshes.len()),
        })?;
        let node = Object::default()
            .named(&instance.name)
            .with("mesh", mesh)
            .maybe("matrix", matrix(&instance.transform));
        nodes.push(node.into());
    }
    cameras(writer, &description.cameras, &mut nodes);
    lights(writer, &description.lights, &mut nodes);
    let mut ours = Object::default();
    if let Some(environment) = &description.environment {
        ours = ours.with("environment", image::environment(writer, environment)?);
    }
    let indices: Vec<usize> = (0..nodes.len()).collect();
    let scene = Object::default()
        .named(&description.name)
        .maybe("nodes", (!nodes.is_empty()).then_some(indices))
        .maybe("extras", extras(ours));
    writer.set("nodes", nodes);
    writer.set("scenes", vec![scene.into()]);
    writer.set_value("scene", 0.into());
    Ok(())
}

fn cameras(writer: &mut Writer, cameras: &[CameraDescription], nodes: &mut Vec<Value>) {
    let mut list = Vec::new();
    for camera in cameras {
        let node = Object::default()
            .named(&camera.name)
            .with("camera", list.len())
            .maybe("matrix", matrix(&camera.transform));
        nodes.push(node.into());
        list.push(kind(camera));
    }
    writer.set("cameras", list);
}

/// glTF wants clipping planes; nothing here uses them.
fn kind(camera: &CameraDescription) -> Value {
    let (kind, members) = match camera.projection {
        Projection::Perspective { yfov, aspect_ratio } => (
            "perspective",
            Object::default()
                .with("yfov", number(yfov))
                .with("znear", 0.01)
                .maybe("aspectRatio", aspect_ratio.map(number)),
        ),
        Projection::Orthographic { xmag, ymag } => (
            "orthographic",
            Object::default()
                .with("xmag", number(xmag))
                .with("ymag", number(ymag))
                .with("znear", 0.0)
                .with("zfar", 1e6),
        ),
    };
    let shutter = camera.shutter.map(|s| numbers(&[s.open, s.close]));
    let blades = camera.lens.and_then(|lens| lens.blades);
    let ours = Object::default()
        .maybe("aperture", camera.lens.map(|lens| number(lens.aperture)))
        .maybe("focus", camera.lens.map(|lens| number(lens.focus)))
        .maybe("blades", blades.map(|blades| blades.count))
        .maybe("rotation", blades.map(|blades| number(blades.rotation)))
        .maybe("shutter", shutter);
    Object::default()
        .named(&camera.name)
        .with("type", kind)
        .with(kind, members)
        .maybe("extras", extras(ours))
        .into()
}

fn lights(writer: &mut Writer, lights: &[LightDescription], nodes: &mut Vec<Value>) {
    if lights.is_empty() {
        return;
    }
    const NAME: &str = "KHR_lights_punctual";
    let mut list = Vec::new();
    for light in lights {
        let node = Object::default()
            .named(&light.name)
            .with("extensions", json!({ NAME: { "light": list.len() } }))
            .maybe("matrix", matrix(&light.transform));
        nodes.push(node.into());
        list.push(punctual(light));
    }
    writer.uses(NAME);
    writer.set_value("extensions", json!({ NAME: { "lights": list } }));
}

fn punctual(light: &LightDescription) -> Value {
    let (kind, spot) = match light.kind {
        LightKind::Point => ("point", None),
        LightKind::Directional => ("directional", None),
        LightKind::Spot { inner, outer } => (
            "spot",
            Some(json!({
                "innerConeAngle": number(inner),
                "outerConeAngle": number(outer),
            })),
        ),
    };
    Object::default()
        .named(&light.name)
        .with("type", kind)
        .with("color", numbers(&light.color))
        .with("intensity", number(light.intensity))
        .maybe("range", light.range.map(number))
        .maybe("spot", spot)
        .into()
}
