use std::f64::consts::TAU;

use glam::{DVec3, Vec3};
use kaustik_geometry::Mesh;

use super::query::Query;
use super::stage::Stage;
use super::{BuiltinError, BuiltinScene, materials, room, shapes, spheres};
use crate::Description;
use crate::description::MaterialDescription;

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "disco",
    summary: "a ball of 80 clear facets, each reflecting and refracting, under eight coloured lamps (Kelemen figure 7)",
    parameters: &[],
    build,
};

/// The ball's middle, which all lamps face, and its radius.
const MIDDLE: Vec3 = Vec3::new(2.764, 2.5, 2.8);
const RADIUS: f32 = 1.25;

/// The lamps' circle above the ball, and their edge.
const CIRCLE: f32 = 2.2;
const HEIGHT: f32 = 4.9;
const EDGE: f32 = 0.3;

/// Linear Rec.709, of about the same luminance.
const COLOURS: [[f32; 3]; 8] = [
    [2.8, 0.15, 0.1],
    [1.6, 0.7, 0.05],
    [1.0, 0.95, 0.05],
    [0.2, 1.3, 0.1],
    [0.05, 1.2, 0.8],
    [0.15, 0.9, 3.0],
    [0.6, 0.3, 5.5],
    [2.4, 0.2, 2.4],
];

fn build(_: &Query<'_>) -> Result<Description, BuiltinError> {
    let mut stage = Stage::new();
    room::walls(&mut stage, 0.0);
    let glass = stage.material(materials::solid("glass", 1.5, 0.0));
    let mut ball = spheres::polyhedron(RADIUS, 1, false);
    for position in &mut ball.positions {
        *position += MIDDLE;
    }
    stage.place("ball", glass, ball);
    let radiance = room::STRENGTH / (COLOURS.len() as f32 * EDGE * EDGE);
    for (i, colour) in COLOURS.iter().enumerate() {
        let material = stage.material(MaterialDescription {
            name: format!("lamp {i}"),
            emissive: colour.map(|c| c * radiance),
            ..materials::lamp(radiance)
        });
        stage.place(&format!("lamp {i}"), material, lamp(i));
    }
    room::camera(&mut stage);
    Ok(stage.finish())
}

/// A square whose front faces the ball.
fn lamp(index: usize) -> Mesh {
    let angle = TAU * (index as f64 + 0.5) / COLOURS.len() as f64;
    let out = DVec3::new(libm::cos(angle), 0.0, libm::sin(angle)).as_vec3();
    let centre = Vec3::new(MIDDLE.x, HEIGHT, MIDDLE.z) + out * CIRCLE;
    let side = Vec3::Y.cross(out);
    let up = (MIDDLE - centre).normalize().cross(side);
    let corner = |a: f32, b: f32| centre + (side * a + up * b) * (0.5 * EDGE);
    let corners = [
        corner(-1.0, -1.0),
        corner(1.0, -1.0),
        corner(1.0, 1.0),
        corner(-1.0, 1.0),
    ];
    shapes::quad(corners, MIDDLE)
}
