use glam::Vec3;

use super::query::Query;
use super::stage::Stage;
use super::{BuiltinError, BuiltinScene, cornell_direct, materials, room, shapes};
use crate::Description;
use crate::description::{MaterialDescription, Model};

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "glossy-cornell",
    summary: "a box whose back wall is a glossy mirror (Phong, exponent 50) and whose paints shine (Kelemen figure 5)",
    parameters: &[],
    build,
};

/// The exponent that Kelemen (sec. 7) gives for the back wall; the paper says of the other surfaces
/// only that their specularity is high.
const EXPONENT: f32 = 50.0;

/// Share of the other surfaces' albedo that is in the lobe.
const SHINE: f32 = 0.3;

fn build(_: &Query<'_>) -> Result<Description, BuiltinError> {
    let mut stage = Stage::new();
    let [white, red, green] = [materials::white(), materials::red(), materials::green()]
        .map(|paint| stage.material(glossy(paint, SHINE)));
    let wall = materials::diffuse("glossy mirror", [0.9; 3]);
    let mirror = stage.material(glossy(wall, 1.0));
    let Vec3 { x: w, y: h, z: d } = room::SIZE;
    let p = Vec3::new;
    let mut side = |name, paint, corners| {
        stage.place(name, paint, shapes::quad(corners, room::SIZE * 0.5));
    };
    for (name, y) in [("floor", 0.0), ("ceiling", h)] {
        side(
            name,
            white,
            [p(0.0, y, 0.0), p(w, y, 0.0), p(w, y, d), p(0.0, y, d)],
        );
    }
    for (name, paint, x) in [("left", red, w), ("right", green, 0.0)] {
        side(
            name,
            paint,
            [p(x, 0.0, 0.0), p(x, h, 0.0), p(x, h, d), p(x, 0.0, d)],
        );
    }
    side(
        "back",
        mirror,
        [p(0.0, 0.0, d), p(w, 0.0, d), p(w, h, d), p(0.0, h, d)],
    );
    cornell_direct::blocks(&mut stage, white);
    room::lamp(&mut stage, 1.0, room::STRENGTH);
    room::camera(&mut stage);
    Ok(stage.finish())
}

/// A paint of which this share of the albedo is in a Phong lobe.
fn glossy(paint: MaterialDescription, share: f32) -> MaterialDescription {
    MaterialDescription {
        metallic: share,
        model: Some(Model::Phong { exponent: EXPONENT }),
        ..paint
    }
}
