use glam::Vec3;

use super::query::Query;
use super::stage::Stage;
use super::{BuiltinError, BuiltinScene, materials, room, shapes};
use crate::Description;
use crate::description::{MaterialDescription, SpectralInput};

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "cornell",
    summary: "the Cornell box as measured: geometry, paints and lamp of the physical model",
    parameters: &[],
    build,
};

/// Corners in hundreds of millimetres, as the Cornell University Program of Computer Graphics
/// measured them; the walls are not quite square, and stay so.
type Quad = [[f32; 3]; 4];

const FLOOR: Quad = [
    [5.528, 0.0, 0.0],
    [0.0, 0.0, 0.0],
    [0.0, 0.0, 5.592],
    [5.496, 0.0, 5.592],
];
const CEILING: Quad = [
    [5.56, 5.488, 0.0],
    [5.56, 5.488, 5.592],
    [0.0, 5.488, 5.592],
    [0.0, 5.488, 0.0],
];
const BACK: Quad = [
    [5.496, 0.0, 5.592],
    [0.0, 0.0, 5.592],
    [0.0, 5.488, 5.592],
    [5.56, 5.488, 5.592],
];
const RIGHT: Quad = [
    [0.0, 0.0, 5.592],
    [0.0, 0.0, 0.0],
    [0.0, 5.488, 0.0],
    [0.0, 5.488, 5.592],
];
const LEFT: Quad = [
    [5.528, 0.0, 0.0],
    [5.496, 0.0, 5.592],
    [5.56, 5.488, 5.592],
    [5.56, 5.488, 0.0],
];
/// In the same order around as the ceiling, in whose hole it lies.
const LAMP: Quad = [
    [3.43, 5.488, 2.27],
    [3.43, 5.488, 3.32],
    [2.13, 5.488, 3.32],
    [2.13, 5.488, 2.27],
];
const SHORT_BLOCK: Quad = [
    [1.3, 1.65, 0.65],
    [0.82, 1.65, 2.25],
    [2.4, 1.65, 2.72],
    [2.9, 1.65, 1.14],
];
#[expect(clippy::approx_constant, reason = "a measured length")]
const TALL_BLOCK: Quad = [
    [4.23, 3.3, 2.47],
    [2.65, 3.3, 2.96],
    [3.14, 3.3, 4.56],
    [4.72, 3.3, 4.06],
];

/// The lamp's spectrum was measured in relative units; this brings the picture to a good
/// brightness.
const EXPOSURE: f32 = 3.5;

fn build(_: &Query<'_>) -> Result<Description, BuiltinError> {
    let mut stage = Stage::new();
    let white = stage.material(materials::white());
    let red = stage.material(materials::red());
    let green = stage.material(materials::green());
    let lamp = stage.material(lamp());
    let middle = Vec3::new(2.78, 2.73, 2.8);
    let wall = |corners: Quad| shapes::quad(corners.map(Vec3::from), middle);
    stage.place("floor", white, wall(FLOOR));
    stage.place("ceiling", white, shapes::join(frame().map(wall)));
    stage.place("back", white, wall(BACK));
    stage.place("right", green, wall(RIGHT));
    stage.place("left", red, wall(LEFT));
    stage.place("short block", white, block(SHORT_BLOCK));
    stage.place("tall block", white, block(TALL_BLOCK));
    stage.place("lamp", lamp, wall(LAMP));
    room::camera(&mut stage);
    Ok(stage.finish())
}

fn lamp() -> MaterialDescription {
    let knots = [(400.0, 0.0), (500.0, 8.0), (600.0, 15.6), (700.0, 18.4)];
    let scaled = knots.map(|(nm, power)| (nm, power * EXPOSURE));
    MaterialDescription {
        emission: Some(SpectralInput::Knots(scaled.to_vec())),
        // for viewers that know no spectra: about the same luminance
        ..materials::lamp(11.5 * EXPOSURE)
    }
}

/// The ceiling around the lamp: four trapezoids without gaps.
fn frame() -> [Quad; 4] {
    std::array::from_fn(|i| {
        let j = (i + 1) % 4;
        [CEILING[i], CEILING[j], LAMP[j], LAMP[i]]
    })
}

/// The block that stands on the floor under its top.
fn block(top: Quad) -> kaustik_geometry::Mesh {
    let top = top.map(Vec3::from);
    shapes::block(top.map(|corner| corner.with_y(0.0)), top)
}
