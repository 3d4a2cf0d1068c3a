use glam::{DVec3, Vec2, Vec3};
use kaustik_geometry::Mesh;
use kaustik_spectrum::Metal;

use super::query::Query;
use super::stage::Stage;
use super::{BuiltinError, BuiltinScene, materials, room, shapes, statue};
use crate::Description;
use crate::description::MaterialDescription;

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "mirror-statue",
    summary: "a shining statue of 300,000 triangles, its back lit and seen through a curved mirror of flat panes (Kelemen figures 6, 8, 9)",
    parameters: &[],
    build,
};

/// The root mean square slope of the facets that Kelemen (7.1) gives. The paper's distribution is
/// Cook and Torrance's (Beckmann); here it is GGX of alpha equal to that slope, whose tails are
/// longer.
const SLOPE: f32 = 0.05;

/// Where the statue stands.
const FOOT: Vec3 = Vec3::new(2.1, 0.06, 1.9);

/// Panes of the mirror, and its half width, height and sagitta.
const PANES: u32 = 8;
const HALF: f32 = 2.45;
const TOP: f32 = 4.3;
const DEPTH: f32 = 0.5;

fn build(_: &Query<'_>) -> Result<Description, BuiltinError> {
    let mut stage = Stage::new();
    room::walls(&mut stage, 0.0);
    let gold = stage.material(gold());
    let mirror = stage.material(materials::mirror());
    stage.place("statue", gold, statue::statue(FOOT, 0.35));
    stage.place("mirror", mirror, panes());
    // Between statue and mirror: the back is lit, directly and by way of the mirror.
    let lamp = stage.material(materials::lamp(room::STRENGTH / (0.6 * 0.6)));
    let above = Vec2::new(2.764, 3.3);
    let mesh = shapes::square_facing_down(above, room::SIZE.y - 0.01, 0.6);
    stage.place("lamp", lamp, mesh);
    let eye = DVec3::new(3.4, 3.2, -7.8);
    stage.camera(eye, DVec3::new(2.764, 2.2, 2.8), 0.6);
    Ok(stage.finish())
}

fn gold() -> MaterialDescription {
    MaterialDescription {
        name: "gold".to_owned(),
        // for viewers that know no spectra
        base_color: [1.0, 0.77, 0.34, 1.0],
        metallic: 1.0,
        roughness: SLOPE.sqrt(),
        metal: Some(Metal::Au),
        ..MaterialDescription::default()
    }
}

/// Upright panes on a parabola that is hollow toward the statue.
fn panes() -> Mesh {
    let edge = |i: u32| {
        let t = 2.0 * i as f32 / PANES as f32 - 1.0;
        let x = 0.5 * room::SIZE.x + HALF * t;
        let z = room::SIZE.z - 0.1 - DEPTH * t * t;
        (x, z)
    };
    let middle = room::SIZE * 0.5;
    shapes::join((0..PANES).map(|i| {
        let ((x0, z0), (x1, z1)) = (edge(i), edge(i + 1));
        let corners = [
            Vec3::new(x0, 0.1, z0),
            Vec3::new(x1, 0.1, z1),
            Vec3::new(x1, TOP, z1),
            Vec3::new(x0, TOP, z0),
        ];
        shapes::quad(corners, middle)
    }))
}
