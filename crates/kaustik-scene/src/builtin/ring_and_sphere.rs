use glam::Vec3;

use super::query::Query;
use super::stage::Stage;
use super::{BuiltinError, BuiltinScene, materials, room, shapes, spheres};
use crate::Description;

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "ring-and-sphere",
    summary: "a mirror ring on the back wall and a glass sphere: cardioid caustics (Batty figures 4 and 5)",
    parameters: &[room::LIGHT],
    build,
};

/// The room is open in front, so the sphere mirrors a black square.
fn build(query: &Query<'_>) -> Result<Description, BuiltinError> {
    let edge = room::light(query)?;
    let mut stage = Stage::new();
    room::walls(&mut stage, 0.0);
    let mirror = stage.material(materials::mirror());
    let glass = stage.material(materials::solid("glass", 1.5, 0.0));
    // one hundredth off the wall and the floor: surfaces that touch have no order
    let depth = 0.7;
    let centre = Vec3::new(3.3, 2.3, room::SIZE.z - depth - 0.01);
    stage.place(
        "ring",
        mirror,
        shapes::ring(centre, [1.28, 1.32], depth, 256),
    );
    let ball = spheres::sphere(Vec3::new(1.55, 1.01, 1.7), 1.0, 64);
    stage.place("sphere", glass, ball);
    room::lamp(&mut stage, edge, room::STRENGTH);
    room::camera(&mut stage);
    Ok(stage.finish())
}
