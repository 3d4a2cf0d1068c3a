use glam::Vec3;
use kaustik_scene::description::{AlphaMode, LightKind, MaterialDescription, Projection};

use crate::stage::{Stage, ball, ceiling, cuboid, diffuse, floor, lamp, rectangle, solid};

const GREY: [f32; 3] = [0.6, 0.5, 0.4];
const CLEAR: [f32; 3] = [1.0; 3];
const TINTED: [f32; 3] = [0.5, 0.8, 0.6];

/// Looks down on a floor that fills the view.
fn above() -> Stage {
    Stage::new(Vec3::new(0.3, 3.0, 2.0), Vec3::ZERO, 0.8).add(diffuse(GREY), floor(0.0, 6.0))
}

fn overhead(radiance: f32) -> (MaterialDescription, kaustik_geometry::Mesh) {
    (lamp(radiance), ceiling(Vec3::new(0.5, 2.5, -1.0), 0.7))
}

fn plate_under_lamp() -> Stage {
    let (material, mesh) = overhead(4.0);
    above().add(material, mesh)
}

/// A lamp that is seen, whose light comes over a second wall as well.
fn lamp_in_view() -> Stage {
    above()
        .add(
            lamp(2.0),
            rectangle(Vec3::new(0.0, 1.0, -1.0), Vec3::X, Vec3::Y),
        )
        .add(
            diffuse([0.2, 0.7, 0.3]),
            rectangle(Vec3::new(-1.5, 1.0, 0.0), Vec3::NEG_Z, Vec3::Y),
        )
}

fn rough_slab() -> Stage {
    plate_under_lamp().add(
        solid(1.5, 0.6, TINTED),
        cuboid(Vec3::new(-1.0, 0.4, -1.0), Vec3::new(1.0, 0.7, 1.0)),
    )
}

/// The camera is under water, the lamp in the air.
fn under_water() -> Stage {
    Stage::new(Vec3::new(0.2, 1.0, 0.3), Vec3::new(0.0, 0.0, 0.0), 0.9)
        .add(diffuse(GREY), floor(0.0, 1.5))
        .add(
            solid(1.33, 0.0, TINTED),
            cuboid(Vec3::new(-1.6, -0.1, -1.6), Vec3::new(1.6, 1.4, 1.6)),
        )
        .add(lamp(3.0), ceiling(Vec3::Y * 2.0, 2.5))
}

/// An upright lamp within water that shines to both sides; its back is seen, from within.
fn lamp_under_water() -> Stage {
    let both = MaterialDescription {
        double_sided: true,
        ..lamp(2.0)
    };
    Stage::new(Vec3::new(-0.8, 1.2, 1.0), Vec3::new(0.0, 0.2, 0.0), 0.8)
        .add(diffuse(GREY), floor(0.0, 4.0))
        .add(
            solid(1.33, 0.0, TINTED),
            cuboid(Vec3::new(-4.1, -0.1, -4.1), Vec3::new(4.1, 1.6, 4.1)),
        )
        .add(
            both,
            rectangle(Vec3::new(0.1, 0.6, 0.0), Vec3::Y * 0.3, Vec3::Z * 0.3),
        )
}

/// Light through a smooth ball of glass that is not seen itself.
fn caustic() -> Stage {
    let (material, mesh) = (lamp(4.0), ceiling(Vec3::new(0.0, 3.5, -1.0), 1.5));
    Stage::new(Vec3::new(0.0, 1.2, 1.6), Vec3::new(0.0, 0.0, 0.4), 0.6)
        .add(diffuse(GREY), floor(0.0, 6.0))
        .add(material, mesh)
        .add(
            solid(1.5, 0.0, TINTED),
            ball(Vec3::new(0.0, 2.0, -0.4), 0.6),
        )
}

fn smooth_ball() -> Stage {
    plate_under_lamp().add(
        diffuse([0.7, 0.3, 0.3]),
        ball(Vec3::new(-0.2, 0.6, 0.2), 0.6),
    )
}

fn glossy_ball() -> Stage {
    let metal = MaterialDescription {
        base_color: [0.9, 0.7, 0.4, 1.0],
        roughness: 0.5,
        ..MaterialDescription::default()
    };
    plate_under_lamp().add(metal, ball(Vec3::new(-0.2, 0.6, 0.2), 0.6))
}

fn punctual(kind: LightKind) -> Stage {
    above()
        .add(
            diffuse([0.7, 0.3, 0.3]),
            ball(Vec3::new(-0.2, 0.6, 0.2), 0.6),
        )
        .light(
            kind,
            3.0,
            Vec3::new(1.0, 2.0, 0.5),
            Vec3::new(-0.4, -1.0, 0.1),
        )
}

fn painted_sky() -> Stage {
    above()
        .add(
            diffuse([0.7, 0.3, 0.3]),
            ball(Vec3::new(-0.2, 0.6, 0.2), 0.6),
        )
        .painted_sky()
}

fn everything() -> Stage {
    let (material, mesh) = overhead(2.0);
    punctual(LightKind::Directional)
        .add(material, mesh)
        .light(LightKind::Point, 2.0, Vec3::new(-1.0, 1.5, 0.5), Vec3::X)
        .sky(0.3)
}

fn orthographic() -> Stage {
    let mut stage = smooth_ball();
    stage.description.cameras[0].projection = Projection::Orthographic {
        xmag: 1.5,
        ymag: 1.5,
    };
    stage
}

fn veil(opacity: f32) -> MaterialDescription {
    MaterialDescription {
        base_color: [0.3, 0.6, 0.8, opacity],
        alpha_mode: AlphaMode::Blend,
        ..diffuse(GREY)
    }
}

/// Veils over each other, two of them in one place, between floor, lamp and camera.
fn veils() -> Stage {
    let at = |y: f32| rectangle(Vec3::Y * y, Vec3::Z * 0.9, Vec3::X * 0.8);
    plate_under_lamp()
        .add(veil(0.5), at(0.6))
        .add(veil(0.3), at(0.6))
        .add(veil(0.7), at(1.1))
}

/// A veil that shines.
fn shining_veil() -> Stage {
    let shining = MaterialDescription {
        emissive: [2.0; 3],
        ..veil(0.4)
    };
    above().add(
        shining,
        rectangle(Vec3::new(0.0, 1.0, -0.6), Vec3::X, Vec3::Y * 0.8),
    )
}

/// Two solids overlap, and a veil lies within one of them behind an interface of the other that
/// is hidden.
fn overlapping_solids() -> Stage {
    let first = MaterialDescription {
        priority: 1,
        ..solid(1.4, 0.5, TINTED)
    };
    plate_under_lamp()
        .add(
            first,
            cuboid(Vec3::new(-1.0, 0.2, -1.0), Vec3::new(0.5, 0.9, 1.0)),
        )
        .add(
            solid(1.7, 0.6, CLEAR),
            cuboid(Vec3::new(-0.2, 0.3, -0.8), Vec3::new(1.1, 0.7, 0.8)),
        )
        .add(
            veil(0.5),
            rectangle(Vec3::new(0.0, 0.5, 0.0), Vec3::Z * 0.7, Vec3::X * 0.45),
        )
}

/// Two objects of one material overlap, and a plate stands where both are: it is joined to across an
/// interface that is not there.
fn objects_of_one_material() -> Stage {
    plate_under_lamp()
        .add(
            solid(1.4, 0.5, TINTED),
            cuboid(Vec3::new(-1.0, 0.2, -1.0), Vec3::new(0.5, 0.9, 1.0)),
        )
        .and(cuboid(Vec3::new(-0.2, 0.3, -0.8), Vec3::new(1.1, 0.7, 0.8)))
        .add(
            diffuse(GREY),
            rectangle(Vec3::new(0.15, 0.5, 0.0), Vec3::Z * 0.6, Vec3::X * 0.3),
        )
}

fn dispersive(roughness: f32) -> MaterialDescription {
    MaterialDescription {
        dispersion: 2.0,
        ..solid(1.6, roughness, TINTED)
    }
}

/// The caustic of a ball that bends each wavelength otherwise.
fn rainbow() -> Stage {
    let (material, mesh) = (lamp(4.0), ceiling(Vec3::new(0.0, 3.5, -1.0), 1.5));
    Stage::new(Vec3::new(0.0, 1.2, 1.6), Vec3::new(0.0, 0.0, 0.4), 0.6)
        .add(diffuse(GREY), floor(0.0, 6.0))
        .add(material, mesh)
        .add(dispersive(0.0), ball(Vec3::new(0.0, 2.0, -0.4), 0.6))
}

/// Joined through a rough interface that bends each wavelength otherwise.
fn rough_rainbow() -> Stage {
    plate_under_lamp().add(
        dispersive(0.6),
        cuboid(Vec3::new(-1.0, 0.4, -1.0), Vec3::new(1.0, 0.7, 1.0)),
    )
}

/// The lens is a large part of what light runs into.
fn wide_lens() -> Stage {
    glossy_ball().lens(0.8, 3.0)
}

/// A scene by name.
pub(crate) type Case = (&'static str, fn() -> Stage);

/// What a light walk shows in full: nothing in view is Dirac, nor the sky.
pub(crate) const SCENES: [Case; 22] = [
    ("plate under lamp", plate_under_lamp),
    ("lamp in view", lamp_in_view),
    ("rough slab", rough_slab),
    ("under water", under_water),
    ("lamp under water", lamp_under_water),
    ("caustic", caustic),
    ("smooth ball", smooth_ball),
    ("glossy ball", glossy_ball),
    ("point", || punctual(LightKind::Point)),
    ("spot", || {
        punctual(LightKind::Spot {
            inner: 0.3,
            outer: 0.7,
        })
    }),
    ("directional", || punctual(LightKind::Directional)),
    ("painted sky", painted_sky),
    ("everything", everything),
    ("thin lens", || smooth_ball().lens(0.2, 2.5)),
    ("wide lens", wide_lens),
    ("rainbow", rainbow),
    ("rough rainbow", rough_rainbow),
    ("orthographic", orthographic),
    ("veils", veils),
    ("shining veil", shining_veil),
    ("overlapping solids", overlapping_solids),
    ("objects of one material", objects_of_one_material),
];
