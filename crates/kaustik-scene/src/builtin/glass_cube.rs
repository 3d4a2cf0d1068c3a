use glam::Vec3;

use super::query::Query;
use super::stage::Stage;
use super::{BuiltinError, BuiltinScene, materials, room, shapes};
use crate::Description;

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "glass-cube",
    summary: "a yellow cube cast in glass, a mirror block, a small lamp: caustics seen through glass (RELT figure 6)",
    parameters: &[room::LIGHT],
    build,
};

/// The yellow cube is lit through the glass and seen through the glass: without a lamp that
/// a path can hit by chance, only caustics light it.
fn build(query: &Query<'_>) -> Result<Description, BuiltinError> {
    let edge = room::light(query)?;
    let mut stage = Stage::new();
    room::walls(&mut stage, 0.0);
    let glass = stage.material(materials::solid("glass", 1.5, 0.0));
    let yellow = stage.material(materials::diffuse("yellow", [0.8, 0.7, 0.05]));
    let mirror = stage.material(materials::mirror());
    let (centre, turn) = (Vec3::new(2.1, 1.11, 1.95), 0.35);
    stage.place(
        "glass cube",
        glass,
        shapes::cuboid(centre, Vec3::splat(1.1), turn),
    );
    stage.place(
        "yellow cube",
        yellow,
        shapes::cuboid(centre, Vec3::splat(0.55), turn),
    );
    let block = shapes::cuboid(Vec3::new(4.1, 1.7, 4.1), Vec3::new(0.7, 1.69, 0.7), -0.4);
    stage.place("mirror block", mirror, block);
    room::lamp(&mut stage, edge, room::STRENGTH);
    room::camera(&mut stage);
    Ok(stage.finish())
}
