use serde_json::{Value, json};

use super::geometry::MeshIndex;
use super::nodes::Nodes;
use super::writer::{Object, Writer, extras, number, numbers};
use super::{ExportError, animation, image};
use crate::Description;
use crate::description::{CameraDescription, LightDescription, LightKind, Load, Projection};

/// Writes a node for each instance, camera and light, below those that move them, and the scene that holds them.
pub(super) fn scene(
    writer: &mut Writer,
    description: &Description,
    meshes: &MeshIndex,
) -> Result<(), ExportError> {
    let nodes = Nodes::new(description, |load| leaf(description, meshes, load))?;
    let cameras = description.cameras.iter().map(camera);
    writer.set("cameras", cameras.collect());
    lights(writer, &description.lights);
    animation::animation(writer, &description.animation, nodes.joints());
    let mut ours = Object::default();
    if let Some(environment) = &description.environment {
        ours = ours.with("environment", image::environment(writer, environment)?);
    }
    let roots = nodes.roots();
    let scene = Object::default()
        .named(&description.name)
        .maybe("nodes", (!roots.is_empty()).then_some(roots))
        .maybe("extras", extras(ours));
    writer.set("nodes", nodes.finish());
    writer.set("scenes", vec![scene.into()]);
    writer.set_value("scene", 0.into());
    Ok(())
}

/// The node of something, but for its place.
fn leaf(d: &Description, meshes: &MeshIndex, load: Load) -> Result<Object, ExportError> {
    let node = Object::default();
    Ok(match load {
        Load::Instance(i) => {
            let instance = &d.instances[i];
            let mesh = meshes.get(&(instance.mesh, instance.material));
            let mesh = *mesh.ok_or_else(|| ExportError::Unsupported {
                place: format!("instances[{i}] (\"{}\")", instance.name),
                found: format!("mesh {}", instance.mesh),
                expected: format!("one of the {} meshes", d.meshes.len()),
            })?;
            node.named(&instance.name).with("mesh", mesh)
        }
        Load::Camera(i) => node.named(&d.cameras[i].name).with("camera", i),
        Load::Light(i) => node
            .named(&d.lights[i].name)
            .with("extensions", json!({ LIGHTS: { "light": i } })),
    })
}

/// glTF wants clipping planes; nothing here uses them.
fn camera(camera: &CameraDescription) -> Value {
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

const LIGHTS: &str = "KHR_lights_punctual";

fn lights(writer: &mut Writer, lights: &[LightDescription]) {
    if lights.is_empty() {
        return;
    }
    let list: Vec<Value> = lights.iter().map(punctual).collect();
    writer.uses(LIGHTS);
    writer.set_value("extensions", json!({ LIGHTS: { "lights": list } }));
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
