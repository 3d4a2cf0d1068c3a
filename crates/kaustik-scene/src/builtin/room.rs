//! The room that most scenes stand in: a Cornell box with straight walls, open in front.

use glam::{DVec3, Vec2, Vec3};

use super::query::Query;
use super::stage::Stage;
use super::{BuiltinError, BuiltinParameter, materials, shapes};

/// Width (x), height (y) and depth (z) of the room; a corner is the origin, z = 0 the open front.
pub(super) const SIZE: Vec3 = Vec3::new(5.528, 5.488, 5.592);

/// The middle of the ceiling, (x, z): where lamps hang.
pub(super) const LAMP_CENTRE: Vec2 = Vec2::new(2.764, 2.796);

/// Half the Cornell camera's film over its focal length: 2 atan(12.5 / 35).
pub(super) const YFOV: f32 = 0.686_048_8;

/// Radiance times area of a lamp that lights the room well: the mean radiance of a picture is
/// about 0.4.
pub(super) const STRENGTH: f32 = 56.0;

/// How far lamps hang below the ceiling.
const GAP: f32 = 0.01;

/// The edge of the lamp.
pub(super) const LIGHT: BuiltinParameter = BuiltinParameter {
    key: "light",
    values: "a number from 0.01 to 4",
    default: "0.2",
    meaning: "edge of the square lamp; its flux stays the same",
};

/// The value of [`LIGHT`].
pub(super) fn light(query: &Query<'_>) -> Result<f32, BuiltinError> {
    query.number(LIGHT.key, 0.01, 4.0)
}

/// The indices of the room's paints.
#[derive(Clone, Copy, Debug)]
pub(super) struct Paints {
    pub(super) white: usize,
}

/// Floor, ceiling, back and side walls: white, red to the left, green to the right (as the
/// camera sees it: the red wall is at x = width). `lip` makes the walls reach forward of z = 0.
pub(super) fn walls(stage: &mut Stage, lip: f32) -> Paints {
    let white = stage.material(materials::white());
    let red = stage.material(materials::red());
    let green = stage.material(materials::green());
    let Vec3 { x: w, y: h, z: d } = SIZE;
    let f = -lip;
    let p = Vec3::new;
    let middle = SIZE * 0.5;
    let mut wall = |name, paint, corners| stage.place(name, paint, shapes::quad(corners, middle));
    wall(
        "floor",
        white,
        [p(0.0, 0.0, f), p(w, 0.0, f), p(w, 0.0, d), p(0.0, 0.0, d)],
    );
    wall(
        "ceiling",
        white,
        [p(0.0, h, f), p(w, h, f), p(w, h, d), p(0.0, h, d)],
    );
    wall(
        "back",
        white,
        [p(0.0, 0.0, d), p(w, 0.0, d), p(w, h, d), p(0.0, h, d)],
    );
    wall(
        "left",
        red,
        [p(w, 0.0, f), p(w, h, f), p(w, h, d), p(w, 0.0, d)],
    );
    wall(
        "right",
        green,
        [p(0.0, 0.0, f), p(0.0, h, f), p(0.0, h, d), p(0.0, 0.0, d)],
    );
    Paints { white }
}

/// The square lamp at the ceiling; its radiance times its area is `strength`.
pub(super) fn lamp(stage: &mut Stage, edge: f32, strength: f32) {
    let lamp = stage.material(materials::lamp(strength / (edge * edge)));
    let mesh = shapes::square_facing_down(LAMP_CENTRE, SIZE.y - GAP, edge);
    stage.place("lamp", lamp, mesh);
}

/// The Cornell box's own camera, straight into the room.
pub(super) fn camera(stage: &mut Stage) {
    let eye = DVec3::new(2.78, 2.73, -8.0);
    stage.camera(eye, eye + DVec3::Z, YFOV);
}
