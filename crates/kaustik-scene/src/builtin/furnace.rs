use glam::{DVec3, Vec3};

use super::query::Query;
use super::stage::Stage;
use super::{BuiltinError, BuiltinParameter, BuiltinScene, materials, shapes, spheres};
use crate::Description;
use crate::description::{EnvironmentDescription, MaterialDescription};

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "furnace",
    summary: "scenes whose every pixel is exactly 1: what is lost or gained is an error",
    parameters: &[BuiltinParameter {
        key: "kind",
        values: "diffuse, glass, rough or plate",
        default: "diffuse",
        meaning: "a closed diffuse sphere from inside; smooth or rough glass, or a white plate under glass, in uniform light",
    }],
    build,
};

fn build(query: &Query<'_>) -> Result<Description, BuiltinError> {
    match query.text("kind") {
        "diffuse" => Ok(inside()),
        "glass" => Ok(glass(0.0)),
        "rough" => Ok(glass(0.5)),
        "plate" => Ok(plate()),
        _ => Err(query.refuse("kind")),
    }
}

/// Emission e and albedo a everywhere give e / (1 - a): here 0.5 / 0.5.
fn inside() -> Description {
    let mut stage = Stage::new();
    let wall = stage.material(MaterialDescription {
        emissive: [0.5; 3],
        double_sided: false,
        ..materials::diffuse("wall", [0.5; 3])
    });
    stage.place("sphere", wall, spheres::polyhedron(1.0, 3, true));
    stage.camera(DVec3::new(0.2, 0.1, 0.4), DVec3::new(-0.1, -0.2, -1.0), 1.2);
    stage.finish()
}

/// Clear matter changes no uniform light. Flat facets: with interpolated normals this would
/// hold only nearly.
fn glass(roughness: f32) -> Description {
    let mut stage = Stage::new();
    let glass = stage.material(materials::solid("glass", 1.5, roughness));
    stage.place("sphere", glass, spheres::polyhedron(1.0, 5, false));
    stage.camera(DVec3::new(0.0, 0.0, 4.0), DVec3::ZERO, 0.7);
    uniform(stage)
}

/// A white plate under a glass sphere.
fn plate() -> Description {
    let mut stage = Stage::new();
    let white = stage.material(materials::diffuse("white", [1.0; 3]));
    let corner = |x, y| Vec3::new(x, y, 0.0);
    let corners = [
        corner(-1.0, -1.0),
        corner(1.0, -1.0),
        corner(1.0, 1.0),
        corner(-1.0, 1.0),
    ];
    stage.place("plate", white, shapes::quad(corners, Vec3::Z));
    // Light tracing must bring to the plate, through the glass, just what it takes away.
    let glass = stage.material(materials::solid("glass", 1.5, 0.0));
    let mut sphere = spheres::polyhedron(0.4, 5, false);
    for position in &mut sphere.positions {
        position.z += 0.6;
    }
    stage.place("sphere", glass, sphere);
    stage.camera(DVec3::new(1.0, 0.7, 3.5), DVec3::ZERO, 0.7);
    uniform(stage)
}

fn uniform(stage: Stage) -> Description {
    let mut description = stage.finish();
    description.environment = Some(EnvironmentDescription::Constant([1.0; 3]));
    description
}
