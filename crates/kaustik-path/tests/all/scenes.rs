use glam::{Quat, Vec3};
use kaustik_scene::description::{LightDescription, LightKind, MaterialDescription, Pixels};
use kaustik_scene::testing::{
    Stage, blended, ceiling, cuboid, dielectric, diffuse, double_sided, floor, image, lamp, metal,
    punctual, rectangle, sphere,
};

const GREY: [f32; 3] = [0.6, 0.5, 0.4];
const CLEAR: [f32; 3] = [1.0; 3];
const TINTED: [f32; 3] = [0.5, 0.8, 0.6];

/// Looks down on a floor that fills the view.
fn above() -> Stage {
    Stage::new()
        .look_at(Vec3::new(0.3, 3.0, 2.0), Vec3::ZERO, 0.8)
        .add(diffuse(GREY), floor(0.0, 6.0))
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
        dielectric(1.5, 0.6, TINTED),
        cuboid(Vec3::new(-1.0, 0.4, -1.0), Vec3::new(1.0, 0.7, 1.0)),
    )
}

/// The camera is under water, the lamp in the air.
fn under_water() -> Stage {
    Stage::new()
        .look_at(Vec3::new(0.2, 1.0, 0.3), Vec3::new(0.0, 0.0, 0.0), 0.9)
        .add(diffuse(GREY), floor(0.0, 1.5))
        .add(
            dielectric(1.33, 0.0, TINTED),
            cuboid(Vec3::new(-1.6, -0.1, -1.6), Vec3::new(1.6, 1.4, 1.6)),
        )
        .add(lamp(3.0), ceiling(Vec3::Y * 2.0, 2.5))
}

/// An upright lamp within water that shines to both sides; its back is seen, from within.
fn lamp_under_water() -> Stage {
    Stage::new()
        .look_at(Vec3::new(-0.8, 1.2, 1.0), Vec3::new(0.0, 0.2, 0.0), 0.8)
        .add(diffuse(GREY), floor(0.0, 4.0))
        .add(
            dielectric(1.33, 0.0, TINTED),
            cuboid(Vec3::new(-4.1, -0.1, -4.1), Vec3::new(4.1, 1.6, 4.1)),
        )
        .add(
            double_sided(lamp(2.0)),
            rectangle(Vec3::new(0.1, 0.6, 0.0), Vec3::Y * 0.3, Vec3::Z * 0.3),
        )
}

/// Light through a smooth ball of glass that is not seen itself.
fn caustic() -> Stage {
    let (material, mesh) = (lamp(4.0), ceiling(Vec3::new(0.0, 3.5, -1.0), 1.5));
    Stage::new()
        .look_at(Vec3::new(0.0, 1.2, 1.6), Vec3::new(0.0, 0.0, 0.4), 0.6)
        .add(diffuse(GREY), floor(0.0, 6.0))
        .add(material, mesh)
        .add(
            dielectric(1.5, 0.0, TINTED),
            sphere(Vec3::new(0.0, 2.0, -0.4), 0.6),
        )
}

fn smooth_ball() -> Stage {
    plate_under_lamp().add(
        diffuse([0.7, 0.3, 0.3]),
        sphere(Vec3::new(-0.2, 0.6, 0.2), 0.6),
    )
}

fn glossy_ball() -> Stage {
    plate_under_lamp().add(
        metal([0.9, 0.7, 0.4], 0.5),
        sphere(Vec3::new(-0.2, 0.6, 0.2), 0.6),
    )
}

/// A yellowish light at `position`, which shines along `axis` and not far.
fn yellow(kind: LightKind, intensity: f32, position: Vec3, axis: Vec3) -> LightDescription {
    LightDescription {
        color: [1.0, 0.9, 0.6],
        range: Some(9.0),
        ..punctual(kind, intensity, position, axis)
    }
}

fn lit_by(kind: LightKind) -> Stage {
    let position = Vec3::new(1.0, 2.0, 0.5);
    above()
        .add(
            diffuse([0.7, 0.3, 0.3]),
            sphere(Vec3::new(-0.2, 0.6, 0.2), 0.6),
        )
        .light(yellow(kind, 3.0, position, Vec3::new(-0.4, -1.0, 0.1)))
}

/// A sky of four rows and eight columns, brighter and bluer above, with a lamp in it.
fn painted_sky() -> Stage {
    let texel = |i: usize| match i {
        10 => [9.0, 8.0, 6.0],
        _ => [1.0, 1.1, 1.3].map(|c: f32| c * (4.0 - (i / 8) as f32) * 0.3),
    };
    let sky = image(8, 4, Pixels::RgbF32((0..32).flat_map(texel).collect()));
    above()
        .add(
            diffuse([0.7, 0.3, 0.3]),
            sphere(Vec3::new(-0.2, 0.6, 0.2), 0.6),
        )
        .environment_map(sky, Quat::from_rotation_y(0.5))
}

fn everything() -> Stage {
    let (material, mesh) = overhead(2.0);
    let second = yellow(LightKind::Point, 2.0, Vec3::new(-1.0, 1.5, 0.5), Vec3::X);
    lit_by(LightKind::Directional)
        .add(material, mesh)
        .light(second)
        .sky(0.3)
}

fn orthographic() -> Stage {
    smooth_ball().orthographic(1.5)
}

fn veil(opacity: f32) -> MaterialDescription {
    blended(diffuse([0.3, 0.6, 0.8]), opacity)
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
        ..dielectric(1.4, 0.5, TINTED)
    };
    plate_under_lamp()
        .add(
            first,
            cuboid(Vec3::new(-1.0, 0.2, -1.0), Vec3::new(0.5, 0.9, 1.0)),
        )
        .add(
            dielectric(1.7, 0.6, CLEAR),
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
            dielectric(1.4, 0.5, TINTED),
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
        ..dielectric(1.6, roughness, TINTED)
    }
}

/// The caustic of a ball that bends each wavelength otherwise.
fn rainbow() -> Stage {
    let (material, mesh) = (lamp(4.0), ceiling(Vec3::new(0.0, 3.5, -1.0), 1.5));
    Stage::new()
        .look_at(Vec3::new(0.0, 1.2, 1.6), Vec3::new(0.0, 0.0, 0.4), 0.6)
        .add(diffuse(GREY), floor(0.0, 6.0))
        .add(material, mesh)
        .add(dispersive(0.0), sphere(Vec3::new(0.0, 2.0, -0.4), 0.6))
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
    ("point", || lit_by(LightKind::Point)),
    ("spot", || {
        lit_by(LightKind::Spot {
            inner: 0.3,
            outer: 0.7,
        })
    }),
    ("directional", || lit_by(LightKind::Directional)),
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
