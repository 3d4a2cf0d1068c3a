use glam::{DVec3, Vec2, Vec3};

use super::query::Query;
use super::stage::Stage;
use super::{BuiltinError, BuiltinScene, materials, patterns, shapes, spheres};
use crate::Description;
use crate::description::MaterialDescription;

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "tea-time",
    summary: "a silver pot, cups and a tray, all glossy (GGX alpha 0.04 to 0.2), by the light of a window (STF figure 11)",
    parameters: &[],
    build,
};

/// Cells around each piece.
const AROUND: u32 = 96;

fn build(_: &Query<'_>) -> Result<Description, BuiltinError> {
    let mut stage = Stage::new();
    let plaster = stage.material(materials::diffuse("plaster", [0.7, 0.66, 0.6]));
    let wood = stage.painted(lacquer("wood", 0.45), patterns::boards());
    let silver = stage.material(metal("silver", [0.95, 0.93, 0.88], 0.25));
    let brass = stage.material(metal("brass", [0.9, 0.72, 0.4], 0.4));
    let china = stage.material(MaterialDescription {
        base_color: [0.8, 0.8, 0.77, 1.0],
        ..lacquer("china", 0.2)
    });
    room(&mut stage, plaster);
    let table = shapes::slab([-1.2, -0.05, -0.7], [1.2, 0.0, 0.9]);
    stage.place("table", wood, patterns::draped(table, 0.8));
    stage.place(
        "tray",
        brass,
        shapes::revolved(Vec3::new(0.0, 0.002, 0.1), &tray(), AROUND),
    );
    let foot = Vec3::new(-0.05, 0.012, 0.15);
    stage.place("pot", silver, shapes::revolved(foot, &pot(), AROUND));
    stage.place("spout", silver, spout(foot));
    let knob = spheres::sphere(foot + Vec3::Y * 0.252, 0.018, 24);
    stage.place("knob", silver, knob);
    let cups = [[0.24, -0.1], [-0.3, -0.12], [0.28, 0.3]];
    let cups = cups.map(|[x, z]| shapes::revolved(Vec3::new(x, 0.012, z), &cup(), AROUND));
    stage.place("cups", china, shapes::join(cups));
    let lamp = stage.material(materials::lamp(18.0));
    let p = Vec3::new;
    let window = [
        p(-1.49, 0.7, -0.4),
        p(-1.49, 0.7, 0.6),
        p(-1.49, 1.5, 0.6),
        p(-1.49, 1.5, -0.4),
    ];
    stage.place("window", lamp, shapes::quad(window, p(0.0, 0.8, 0.0)));
    stage.camera(
        DVec3::new(0.35, 0.55, -1.05),
        DVec3::new(0.0, 0.08, 0.1),
        0.6,
    );
    Ok(stage.finish())
}

/// A metal of this perceptual roughness.
fn metal(name: &str, [r, g, b]: [f32; 3], roughness: f32) -> MaterialDescription {
    MaterialDescription {
        name: name.to_owned(),
        base_color: [r, g, b, 1.0],
        metallic: 1.0,
        roughness,
        double_sided: true,
        ..MaterialDescription::default()
    }
}

/// A coloured base under a surface of this perceptual roughness.
fn lacquer(name: &str, roughness: f32) -> MaterialDescription {
    MaterialDescription {
        name: name.to_owned(),
        metallic: 0.0,
        roughness,
        double_sided: true,
        ..MaterialDescription::default()
    }
}

fn room(stage: &mut Stage, plaster: usize) {
    let s = shapes::slab;
    let walls = [
        s([-1.6, -0.9, -1.6], [1.6, -0.8, 1.6]),
        s([-1.6, 1.8, -1.6], [1.6, 1.9, 1.6]),
        s([-1.6, -0.8, -1.6], [-1.5, 1.8, 1.6]),
        s([1.5, -0.8, -1.6], [1.6, 1.8, 1.6]),
        s([-1.5, -0.8, 1.5], [1.5, 1.8, 1.6]),
        s([-1.5, -0.8, -1.6], [1.5, 1.8, -1.5]),
    ];
    stage.place("room", plaster, shapes::join(walls));
}

/// From the axis outward and up: the upper face is the front.
fn tray() -> Vec<Vec2> {
    let rim = |k: u32| {
        let t = k as f32 / 12.0;
        Vec2::new(0.44 + 0.03 * t, 0.03 * t * t)
    };
    let flat = (0..=12).map(|k| Vec2::new(0.44 * k as f32 / 12.5, 0.0));
    // from the rim inward, so that the front looks up
    flat.chain((0..=12).map(rim)).rev().collect()
}

/// The body and lid of the pot, from below.
fn pot() -> Vec<Vec2> {
    let at = |k: u32| {
        let t = k as f32 / 48.0;
        let along = 1.9 * t - 0.9;
        let radius = 0.15 * (1.0 - along * along).max(0.0).sqrt();
        Vec2::new(if k == 48 { 0.0 } else { radius }, 0.24 * t)
    };
    (0..=48).map(at).collect()
}

/// A bent and narrowing pipe.
fn spout(foot: Vec3) -> kaustik_geometry::Mesh {
    let outline: Vec<Vec2> = (0..=24)
        .map(|k| {
            let t = k as f32 / 24.0;
            Vec2::new(0.035 - 0.02 * t, 0.16 * t)
        })
        .collect();
    let mut pipe = shapes::revolved(Vec3::ZERO, &outline, 48);
    // Sheared, so that it leans outward more and more.
    for (p, n) in pipe.positions.iter_mut().zip(&mut pipe.normals) {
        let slope = 0.3 + 4.0 * p.y;
        *n = Vec3::new(n.x, n.y - slope * n.x, n.z).normalize();
        p.x += p.y * (0.3 + 2.0 * p.y);
        *p += foot + Vec3::new(0.11, 0.07, 0.0);
    }
    pipe
}

/// Outside from below, over the rim, and the inside down again.
fn cup() -> Vec<Vec2> {
    let wall = |t: f32| 0.03 + 0.04 * t.sqrt();
    let outer = (0..=24).map(|k| {
        let t = k as f32 / 24.0;
        Vec2::new(wall(t), 0.07 * t)
    });
    let inner = (0..=24).map(|k| {
        let t = 1.0 - k as f32 / 24.0;
        Vec2::new((wall(t) - 0.003) * t.sqrt().min(1.0), 0.004 + 0.066 * t)
    });
    outer.chain(inner).collect()
}
