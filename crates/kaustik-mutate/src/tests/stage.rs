//! Small scenes by code.

mod moving;
mod scaled;

use glam::{DVec3, Vec3};
use kaustik_geometry::Mesh;
use kaustik_scene::Scene;
use kaustik_scene::description::{
    Blades, Lens, LightDescription, LightKind, Load, MaterialDescription, Transmission,
};
use kaustik_scene::testing::{
    Stage, blended, ceiling, cuboid, dielectric, diffuse, floor, lamp, punctual, rectangle,
};
use moving::{Moving, QUARTER, STRAIGHT};
pub(crate) use scaled::scaled;

/// Looks down on the origin; `yfov` in radians.
fn view(yfov: f32) -> Stage {
    Stage::new().look_at(Vec3::new(0.3, 3.0, 2.0), Vec3::ZERO, yfov)
}

/// A mirror, or blurred metal.
fn metal(roughness: f32) -> MaterialDescription {
    kaustik_scene::testing::metal([0.9, 0.8, 0.6], roughness)
}

/// A smooth coat over a diffuse base.
fn varnish() -> MaterialDescription {
    MaterialDescription {
        base_color: [0.7, 0.4, 0.3, 1.0],
        metallic: 0.0,
        roughness: 0.0,
        ior: 2.2,
        ..MaterialDescription::default()
    }
}

/// A tinted solid.
fn glass(roughness: f32, dispersion: f32) -> MaterialDescription {
    MaterialDescription {
        dispersion,
        ..dielectric(1.5, roughness, [0.5, 0.8, 0.6])
    }
}

fn veil() -> MaterialDescription {
    blended(diffuse([0.3, 0.6, 0.8]), 0.5)
}

/// A smooth pane that scatters some of the light.
fn pane() -> MaterialDescription {
    MaterialDescription {
        transmission: Some(Transmission {
            factor: 0.6,
            texture: None,
        }),
        base_color: [0.8, 0.5, 0.3, 1.0],
        metallic: 0.0,
        roughness: 0.0,
        ior: 2.2,
        ..MaterialDescription::default()
    }
}

/// A yellowish light.
fn light(kind: LightKind, position: Vec3) -> LightDescription {
    LightDescription {
        color: [1.0, 0.9, 0.6],
        ..punctual(kind, 3.0, position, Vec3::new(-0.4, -1.0, 0.1))
    }
}

/// With shading normals that lean away from those of the faces, the same over each face.
fn leaning(mesh: Mesh) -> Mesh {
    let corners = &mesh.positions;
    let normals = corners.chunks(4).flat_map(|c| {
        let normal = (c[1] - c[0]).cross(c[2] - c[0]).normalize();
        [(normal + 0.3 * normal.any_orthonormal_vector()).normalize(); 4]
    });
    let normals = normals.collect();
    mesh.with_normals(normals).expect("a sound mesh")
}

/// A floor, a wall at the left and a wall behind.
fn room() -> Stage {
    view(0.9)
        .add(diffuse([0.7, 0.6, 0.5]), floor(0.0, 3.0))
        .add(
            diffuse([0.3, 0.7, 0.4]),
            rectangle(Vec3::new(-1.4, 1.5, 0.0), Vec3::Y * 1.5, Vec3::Z * 3.0),
        )
}

fn lit() -> Stage {
    room().add(lamp(4.0), ceiling(Vec3::new(0.5, 2.4, -0.8), 0.6))
}

/// A lamp that faces a wall that is a mirror.
fn gallery(yfov: f32) -> Stage {
    view(yfov)
        .add(diffuse([0.7, 0.6, 0.5]), floor(0.0, 3.0))
        .add(
            metal(0.0),
            rectangle(Vec3::new(-1.4, 1.5, 0.0), Vec3::Y * 1.5, Vec3::Z * 3.0),
        )
        .add(
            lamp(4.0),
            rectangle(Vec3::new(-0.4, 1.4, -0.6), Vec3::Z * 1.2, Vec3::Y * 0.8),
        )
}

fn slope() -> Mesh {
    let up = Vec3::new(0.0, 0.5, 0.7);
    rectangle(Vec3::new(0.8, 0.4, -0.3), up, Vec3::X * 0.7)
}

fn plate(material: MaterialDescription) -> Stage {
    lit().add(material, slope())
}

fn slab() -> Mesh {
    cuboid(Vec3::new(-0.4, 0.3, -0.6), Vec3::new(0.7, 0.8, 0.5))
}

/// A slab and a prism's worth of it: two faces that are not parallel come with the box's sides.
fn block(material: MaterialDescription) -> Stage {
    lit().add(material, slab())
}

/// The camera and a small lamp within a solid, and another lamp above it.
fn aquarium(mesh: fn(Mesh) -> Mesh) -> Stage {
    let solid = MaterialDescription {
        ior: 2.2,
        ..glass(0.0, 0.0)
    };
    room()
        .add(
            solid,
            mesh(cuboid(
                Vec3::new(-2.0, -0.5, -3.5),
                Vec3::new(2.0, 3.4, 3.5),
            )),
        )
        .add(lamp(4.0), ceiling(Vec3::new(0.6, 1.5, -1.0), 0.2))
        .add(lamp(60.0), ceiling(Vec3::new(0.0, 3.8, -0.6), 0.2))
}

/// A lamp that grows while it goes aside, something in its light that turns, and a camera that looks about.
fn moving(stage: Stage) -> Stage {
    let grows = [
        ([-0.4, 0.0, 0.0], [0.5, 1.0, 0.7]),
        ([0.3, -0.3, 0.2], [1.5, 1.0, 1.4]),
    ];
    let aside = [([-0.6, 0.0, 0.2], [1.0; 3]), ([0.4, 0.2, 0.0], [1.0; 3])];
    let (lamp, plate) = (DVec3::new(0.5, 2.4, -0.8), DVec3::new(0.8, 0.4, -0.3));
    stage
        .moving(Load::Instance(2), lamp, grows, STRAIGHT)
        .moving(Load::Instance(3), plate, aside, QUARTER)
        .looking()
}

/// A scene by name; after "huge-" in a unit of length in which it is large.
pub(crate) fn scene(name: &str) -> Scene {
    match name.strip_prefix("huge-") {
        Some(name) => scaled(stage(name), 1024.0).build(),
        None => stage(name).build(),
    }
}

/// The stage of a scene by name.
pub(crate) fn stage(name: &str) -> Stage {
    let above = Vec3::new(1.0, 2.0, 0.5);
    match name {
        "diffuse" => lit(),
        "gallery" => gallery(0.9),
        "wide-gallery" => gallery(2.2),
        // normals that lean
        "leaning" => lit().add(metal(0.0), leaning(slope())),
        "leaning-glossy" => lit().add(metal(0.4), leaning(slope())),
        "leaning-glass" => lit().add(glass(0.0, 0.0), leaning(slab())),
        // a lamp that scatters as well
        "glow" => room().add(
            MaterialDescription {
                emissive: [4.0; 3],
                ..metal(0.5)
            },
            leaning(ceiling(Vec3::new(0.5, 1.4, -0.8), 0.6)),
        ),
        // a lamp and a wall, seen in a floor that is a mirror
        "pond" => view(2.0)
            .add(metal(0.0), floor(0.0, 3.0))
            .add(
                diffuse([0.3, 0.7, 0.4]),
                rectangle(Vec3::new(0.0, 3.0, -3.0), Vec3::X * 3.0, Vec3::Y * 3.0),
            )
            .add(lamp(4.0), ceiling(Vec3::new(-0.15, 1.5, -1.0), 0.3))
            .light(light(LightKind::Point, Vec3::new(0.5, 3.0, -1.5))),
        // a lamp as wide as the view, seen in a floor that is a mirror
        "ceiling" => view(2.0)
            .add(metal(0.0), floor(0.0, 3.0))
            .add(lamp(4.0), ceiling(Vec3::Y * 6.0, 6.0)),
        "moving" => moving(plate(diffuse([0.6, 0.5, 0.7]))),
        // what moves is lit through a veil at some times only
        "moving-veil" => moving(plate(diffuse([0.6, 0.5, 0.7]))).add(
            veil(),
            rectangle(Vec3::new(0.5, 1.2, -0.5), Vec3::Z * 0.5, Vec3::X * 0.4),
        ),
        "moving-pane" => moving(plate(pane())),
        "moving-mirror" => moving(plate(metal(0.0)).lens(0.3, 2.5)),
        "moving-glass" => {
            let sinks = [([0.0, 0.1, 0.0], [1.0; 3]), ([0.0, -0.6, 0.3], [1.0; 3])];
            block(glass(0.0, 2.0)).moving(
                Load::Instance(3),
                DVec3::new(0.1, 0.5, 0.0),
                sinks,
                QUARTER,
            )
        }
        "moving-point" => {
            let goes = [([-1.0, 0.0, 0.3], [1.0; 3]), ([0.6, -0.4, 0.0], [1.0; 3])];
            let at = DVec3::new(1.0, 2.0, 0.5);
            room()
                .light(light(LightKind::Point, above))
                .moving(Load::Light(0), at, goes, STRAIGHT)
                .looking()
        }
        "glossy" => plate(metal(0.4)),
        "mirror" => plate(metal(0.0)),
        "varnish" => plate(varnish()),
        "glass" => block(glass(0.0, 0.0)),
        // a plate within the glass
        "inlay" => block(glass(0.0, 0.0)).add(
            diffuse([0.8, 0.5, 0.3]),
            rectangle(Vec3::new(0.15, 0.5, 0.0), Vec3::Z * 0.4, Vec3::X * 0.4),
        ),
        "frosted" => block(glass(0.5, 0.0)),
        "rainbow" => block(glass(0.0, 2.0)),
        // small lamps here and there, and a sun: each place is lit by others
        "lamps" => [(-1.2, 0.6), (-0.3, -1.0), (0.9, 0.2), (1.3, -1.6)]
            .iter()
            .fold(plate(metal(0.4)), |stage, &(x, z)| {
                stage.add(lamp(40.0), ceiling(Vec3::new(x, 0.5, z), 0.1))
            })
            .light(light(LightKind::Point, Vec3::new(-0.9, 0.5, -0.6)))
            .light(light(LightKind::Directional, above)),
        // of which one goes out of its own reach, and another turns over
        "moving-lamps" => {
            let mut lamps = stage("lamps");
            lamps.description.lights[0].range = Some(1.2);
            let goes = [([-0.6, 0.0, 0.3], [1.0; 3]), ([1.6, 0.4, 0.6], [1.0; 3])];
            let turns = [([0.0, -0.2, 0.0], [1.0; 3]), ([0.2, 0.3, 0.4], [1.0; 3])];
            let (point, square) = (DVec3::new(-0.9, 0.5, -0.6), DVec3::new(-0.3, 0.9, -1.0));
            lamps
                .moving(Load::Light(0), point, goes, STRAIGHT)
                .moving(Load::Instance(5), square, turns, QUARTER)
                .looking()
        }
        "point" => room().light(light(LightKind::Point, above)),
        "sun" => room().light(light(LightKind::Directional, above)),
        "point-glass" => block(glass(0.0, 0.0)).light(light(LightKind::Point, above)),
        "sun-glass" => block(glass(0.0, 0.0)).light(light(LightKind::Directional, above)),
        "sky" => plate(metal(0.0)).sky(0.5),
        // a lamp that faces the camera, beside the sky
        "window" => view(0.9).add(lamp(0.8), floor(0.0, 1.0)).sky(0.5),
        // emitters of all kinds
        "daylight" => block(glass(0.0, 0.0))
            .light(light(LightKind::Point, above))
            .light(light(LightKind::Directional, above))
            .sky(0.5),
        "lens" => plate(metal(0.0)).lens(0.3, 2.5),
        "blades" => {
            let mut stage = plate(metal(0.0));
            stage.description.cameras[0].lens = Some(Lens {
                aperture: 0.6,
                focus: 2.5,
                blades: Some(Blades {
                    count: 3,
                    rotation: 0.3,
                }),
            });
            stage
        }
        "orthographic" => plate(metal(0.0)).orthographic(1.5),
        // parallel rays that pass beside all there is
        "outlook" => view(0.9)
            .add(diffuse([0.7, 0.6, 0.5]), floor(0.0, 1.2))
            .add(
                diffuse([0.3, 0.7, 0.4]),
                rectangle(Vec3::new(-1.2, 0.8, 0.0), Vec3::Y * 0.8, Vec3::Z * 1.2),
            )
            .add(metal(0.0), slope())
            .sky(0.5)
            .orthographic(1.5),
        "aquarium" => aquarium(std::convert::identity),
        "leaning-aquarium" => aquarium(leaning),
        "veil-mirror" => plate(metal(0.0)).add(
            veil(),
            rectangle(Vec3::Y * 0.8, Vec3::Z * 0.9, Vec3::X * 0.8),
        ),
        "veil" => lit().add(
            veil(),
            rectangle(Vec3::Y * 0.8, Vec3::Z * 0.9, Vec3::X * 0.8),
        ),
        "pane" => plate(pane()).add(
            pane(),
            rectangle(Vec3::Y * 0.8, Vec3::Z * 0.9, Vec3::X * 0.8),
        ),
        other => panic!("no scene {other}"),
    }
}
