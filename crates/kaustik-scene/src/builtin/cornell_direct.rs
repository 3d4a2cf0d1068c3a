use glam::Vec3;

use super::query::Query;
use super::stage::Stage;
use super::{BuiltinError, BuiltinScene, room, shapes};
use crate::Description;

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "cornell-direct",
    summary: "diffuse box under a large lamp: mostly direct light (RELT figure 4)",
    parameters: &[],
    build,
};

fn build(_: &Query<'_>) -> Result<Description, BuiltinError> {
    let mut stage = Stage::new();
    let paints = room::walls(&mut stage, 0.0);
    blocks(&mut stage, paints.white);
    room::lamp(&mut stage, 1.6, room::STRENGTH);
    room::camera(&mut stage);
    Ok(stage.finish())
}

/// The two blocks of the Cornell box, made square.
pub(super) fn blocks(stage: &mut Stage, paint: usize) {
    let short = shapes::cuboid(
        Vec3::new(1.86, 0.825, 1.69),
        Vec3::new(0.83, 0.825, 0.83),
        0.29,
    );
    let tall = shapes::cuboid(
        Vec3::new(3.69, 1.65, 3.51),
        Vec3::new(0.83, 1.65, 0.83),
        -0.3,
    );
    stage.place("short block", paint, short);
    stage.place("tall block", paint, tall);
}
