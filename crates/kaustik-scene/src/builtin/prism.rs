use glam::{DVec3, Vec2, Vec3};
use kaustik_geometry::Mesh;
use kaustik_spectrum::Glass;

use super::query::Query;
use super::stage::Stage;
use super::{BuiltinError, BuiltinParameter, BuiltinScene, materials, shapes};
use crate::Description;
use crate::description::{EnvironmentDescription, MaterialDescription};

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "prism",
    summary: "white light through a slit and a prism of flint glass: a spectrum on a screen",
    parameters: &[
        BuiltinParameter {
            key: "light",
            values: "a number from 0.005 to 0.4",
            default: "0.02",
            meaning: "width of the lamp behind the slit; its flux stays the same",
        },
        BuiltinParameter {
            key: "glass",
            values: "a glass as in extras.kaustik that lets yellow light out again (an index up to 1.88), for instance n-bk7, sf11, water_20c",
            default: "sf11",
            meaning: "what the prism is made of",
        },
    ],
    build,
};

/// Yellow light, in nm.
const YELLOW: f32 = 587.6;
/// Of a glass of higher index only light that grazes the first face leaves by the second.
const LARGEST_INDEX: f32 = 1.88;

/// Half the deviation of light by 60 degrees of a glass of this index, when light inside runs parallel to
/// the base: asin(n / 2) - 30 degrees.
pub(super) fn half_deviation(index: f32) -> f64 {
    libm::asin(0.5 * f64::from(index)) - std::f64::consts::FRAC_PI_6
}

/// From the prism's middle to the lamp, to the slit and to the screen.
const LAMP: f32 = 3.0;
const SLIT: f32 = 1.2;
const SCREEN: f32 = 3.2;

/// Width of the slit.
const GAP: f32 = 0.03;

/// Radiance times width of the lamp.
const STRENGTH: f32 = 500.0;

fn build(query: &Query<'_>) -> Result<Description, BuiltinError> {
    let width = query.number("light", 0.005, 0.4)?;
    let glass = Glass::named(query.text("glass"))
        .filter(|glass| glass.at(YELLOW) <= LARGEST_INDEX)
        .ok_or_else(|| query.refuse("glass"))?;
    let half_deviation = half_deviation(glass.at(YELLOW));
    let mut stage = Stage::new();
    let white = stage.material(materials::diffuse("white", [0.8; 3]));
    let black = stage.material(materials::diffuse("black", [0.02; 3]));
    let lamp = stage.material(materials::lamp(STRENGTH / width));
    let flint = stage.material(MaterialDescription {
        glass: Some(glass),
        ..materials::solid("prism", 1.785, 0.0)
    });
    let (sin, cos) = (libm::sin(half_deviation), libm::cos(half_deviation));
    let (sin, cos) = (sin as f32, cos as f32);
    let floor = [(-5.0, -5.0), (5.0, -5.0), (5.0, 5.0), (-5.0, 5.0)];
    let floor = floor.map(|(x, z)| Vec3::new(x, 0.0, z));
    stage.place("floor", white, shapes::quad(floor, Vec3::Y));
    stage.place("prism", flint, prism());
    // light comes along (cos, sin) in the plane of x and z, and leaves along (cos, -sin)
    let (along, across) = (Vec2::new(cos, sin), Vec2::new(-sin, cos));
    let at = |back: f32, aside: f32, y: f32| {
        let place = across * aside - along * back;
        Vec3::new(place.x, y, place.y)
    };
    let wall = |from: Vec3, to: Vec3, low: f32, high: f32, toward: Vec3| {
        let corner = |p: Vec3, y: f32| Vec3::new(p.x, y, p.z);
        let corners = [
            corner(from, low),
            corner(to, low),
            corner(to, high),
            corner(from, high),
        ];
        shapes::quad(corners, toward)
    };
    let half = 0.5 * width;
    let strip = wall(
        at(LAMP, -half, 0.0),
        at(LAMP, half, 0.0),
        0.2,
        0.8,
        at(0.0, 0.0, 0.5),
    );
    stage.place("lamp", lamp, strip);
    // a dark box around the lamp, open by the slit alone
    let inside = at(2.0, 0.0, 0.5);
    let (wide, deep, top) = (0.4, LAMP + 0.2, 1.0);
    for (name, from, to) in [
        ("left side", at(deep, wide, 0.0), at(SLIT, wide, 0.0)),
        ("right side", at(deep, -wide, 0.0), at(SLIT, -wide, 0.0)),
        ("rear", at(deep, -wide, 0.0), at(deep, wide, 0.0)),
        (
            "left of the slit",
            at(SLIT, 0.5 * GAP, 0.0),
            at(SLIT, wide, 0.0),
        ),
        (
            "right of the slit",
            at(SLIT, -wide, 0.0),
            at(SLIT, -0.5 * GAP, 0.0),
        ),
    ] {
        stage.place(name, black, wall(from, to, 0.0, top, inside));
    }
    let lid = [(deep, -wide), (SLIT, -wide), (SLIT, wide), (deep, wide)];
    let lid = lid.map(|(back, aside)| at(back, aside, top));
    stage.place("lid", black, shapes::quad(lid, inside));
    // the screen stands across the light that leaves
    let on_screen =
        |aside: f32| Vec3::new(SCREEN * cos + aside * sin, 0.0, -SCREEN * sin + aside * cos);
    let screen = wall(on_screen(-1.6), on_screen(1.6), 0.0, 1.6, Vec3::Y * 0.5);
    stage.place("screen", white, screen);
    stage.camera(
        DVec3::new(-1.3, 3.6, 4.2),
        DVec3::new(0.75, 0.35, -0.75),
        0.75,
    );
    let mut description = stage.finish();
    description.environment = Some(EnvironmentDescription::Constant([0.02; 3]));
    Ok(description)
}

/// Equilateral, upright, a little above the floor; its base faces -z.
fn prism() -> Mesh {
    let edge = 1.2_f32;
    let height = edge * 0.866_025_4;
    let corners = [
        Vec2::new(0.0, 2.0 / 3.0 * height),
        Vec2::new(-0.5 * edge, -height / 3.0),
        Vec2::new(0.5 * edge, -height / 3.0),
    ];
    shapes::column(&corners, 0.01, 1.0)
}
