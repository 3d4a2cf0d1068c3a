use glam::{DVec3, Vec2, Vec3, Vec4};
use kaustik_geometry::Mesh;
use kaustik_spectrum::{Glass, Metal};

use super::query::Query;
use super::stage::Stage;
use super::{BuiltinError, BuiltinParameter, BuiltinScene, materials, shapes, spheres};
use crate::Description;
use crate::description::{
    AlphaMode, Anisotropy, Clearcoat, EnvironmentDescription, Iridescence, MaterialDescription,
    Model, Sheen, SpecularGlossiness, Transmission, Volume,
};

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "material-ball",
    summary: "a ball under a lamp and a dim sky, of any kind of material",
    parameters: &[BuiltinParameter {
        key: "material",
        values: NAMES,
        default: "plastic",
        meaning: "what the ball is made of",
    }],
    build,
};

const NAMES: &str = "diffuse, oren-nayar, plastic, coated, phong, mirror, rough-metal, gold, \
    brushed, glass, rough-glass, colored-glass, dispersive-glass, pane, rough-pane, varnished, \
    velvet, soap, glossy-paint, veil, glowing or unlit";

/// The kinds of material, by name.
#[cfg(test)]
pub(super) fn names() -> Vec<String> {
    let words = NAMES.replace(" or ", ", ");
    words
        .split(", ")
        .map(|name| name.trim().to_owned())
        .collect()
}

fn build(query: &Query<'_>) -> Result<Description, BuiltinError> {
    let name = query.text("material");
    let material = material(name).ok_or_else(|| query.refuse("material"))?;
    let mut stage = Stage::new();
    let ball = stage.material(material);
    let light = stage.material(materials::diffuse("light stone", [0.6; 3]));
    let dark = stage.material(materials::diffuse("dark stone", [0.12, 0.14, 0.2]));
    let lamp = stage.material(materials::lamp(14.0));
    stage.place("ball", ball, globe(Vec3::new(0.0, 1.01, 0.0), 1.0));
    let [even, odd] = tiles();
    stage.place("light tiles", light, even);
    stage.place("dark tiles", dark, odd);
    let centre = Vec2::new(-1.5, 1.0);
    stage.place("lamp", lamp, shapes::square_facing_down(centre, 4.5, 1.2));
    stage.camera(DVec3::new(0.0, 2.2, 5.0), DVec3::new(0.0, 0.9, 0.0), 0.6);
    let mut description = stage.finish();
    description.environment = Some(EnvironmentDescription::Constant([0.25, 0.28, 0.35]));
    Ok(description)
}

/// A smooth sphere with tangents along its parallels, for brush marks.
fn globe(centre: Vec3, radius: f32) -> Mesh {
    let mut mesh = spheres::sphere(centre, radius, 48);
    let tangent = |normal: &Vec3| {
        let along = Vec3::new(-normal.z, 0.0, normal.x);
        let along = if along.length() > 1e-3 {
            along.normalize()
        } else {
            Vec3::X
        };
        Vec4::new(along.x, along.y, along.z, 1.0)
    };
    mesh.tangents = mesh.normals.iter().map(tangent).collect();
    mesh
}

/// The squares of a floor, those of one colour and those of the other.
fn tiles() -> [Mesh; 2] {
    let tile = |i: i32, j: i32| {
        let at = |x: i32, z: i32| Vec3::new(x as f32 * 0.8, 0.0, z as f32 * 0.8);
        shapes::quad(
            [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)],
            Vec3::Y * 9.0,
        )
    };
    let places = || (-6..6).flat_map(|i| (-6..4).map(move |j| (i, j)));
    [0, 1].map(|odd| {
        let chosen = places().filter(|&(i, j): &(i32, i32)| (i + j).rem_euclid(2) == odd);
        shapes::join(chosen.map(|(i, j)| tile(i, j)))
    })
}

/// Opaque, not metallic.
fn paint(name: &str, [r, g, b]: [f32; 3], roughness: f32) -> MaterialDescription {
    MaterialDescription {
        name: name.to_owned(),
        base_color: [r, g, b, 1.0],
        metallic: 0.0,
        roughness,
        ..MaterialDescription::default()
    }
}

fn metal(name: &str, [r, g, b]: [f32; 3], roughness: f32) -> MaterialDescription {
    MaterialDescription {
        metallic: 1.0,
        ..paint(name, [r, g, b], roughness)
    }
}

/// A wall too thin to bend light.
fn pane(name: &str, roughness: f32) -> MaterialDescription {
    MaterialDescription {
        transmission: Some(Transmission {
            factor: 1.0,
            texture: None,
        }),
        ..paint(name, [0.8, 0.95, 0.85], roughness)
    }
}

fn material(name: &str) -> Option<MaterialDescription> {
    let red = [0.6, 0.08, 0.05];
    Some(match name {
        "diffuse" => materials::diffuse(name, red),
        "plastic" => paint(name, red, 0.25),
        "rough-metal" => metal(name, [0.9, 0.7, 0.55], 0.4),
        "glass" => materials::solid(name, 1.5, 0.0),
        "rough-glass" => materials::solid(name, 1.5, 0.35),
        "pane" => pane(name, 0.0),
        "rough-pane" => pane(name, 0.4),
        "mirror" => MaterialDescription {
            name: name.to_owned(),
            ..materials::mirror()
        },
        "gold" => MaterialDescription {
            metal: Some(Metal::Au),
            ..metal(name, [1.0, 0.78, 0.34], 0.2)
        },
        "dispersive-glass" => MaterialDescription {
            glass: Glass::named("sf11"),
            ..materials::solid(name, 1.785, 0.0)
        },
        "colored-glass" => MaterialDescription {
            volume: Some(Volume {
                thickness: 1.0,
                attenuation_distance: 1.0,
                attenuation_color: [0.2, 0.7, 0.4],
            }),
            ..materials::solid(name, 1.5, 0.0)
        },
        "oren-nayar" | "coated" | "phong" => MaterialDescription {
            model: Some(match name {
                "oren-nayar" => Model::OrenNayar { sigma: 0.8 },
                "coated" => Model::Coated,
                _ => Model::Phong { exponent: 60.0 },
            }),
            metallic: if name == "phong" { 0.3 } else { 0.0 },
            ..paint(name, red, 1.0)
        },
        _ => return layered(name),
    })
}

/// Materials of glTF's extensions, and those that do more or less than scatter.
fn layered(name: &str) -> Option<MaterialDescription> {
    let red = [0.6, 0.08, 0.05];
    Some(match name {
        "brushed" => MaterialDescription {
            anisotropy: Some(Anisotropy {
                strength: 0.8,
                rotation: 0.0,
                texture: None,
            }),
            ..metal(name, [0.85, 0.85, 0.9], 0.3)
        },
        "varnished" => MaterialDescription {
            clearcoat: Some(Clearcoat {
                factor: 1.0,
                texture: None,
                roughness: 0.05,
                roughness_texture: None,
                normal_texture: None,
                normal_scale: 1.0,
            }),
            ..metal(name, red, 0.5)
        },
        "velvet" => MaterialDescription {
            sheen: Some(Sheen {
                color: [0.8, 0.6, 0.9],
                color_texture: None,
                roughness: 0.4,
                roughness_texture: None,
            }),
            ..paint(name, [0.15, 0.03, 0.2], 1.0)
        },
        "soap" => MaterialDescription {
            iridescence: Some(Iridescence {
                factor: 1.0,
                texture: None,
                ior: 1.33,
                thickness: [100.0, 550.0],
                thickness_texture: None,
            }),
            ..metal(name, [0.6; 3], 0.15)
        },
        "glossy-paint" => MaterialDescription {
            specular_glossiness: Some(SpecularGlossiness {
                specular: [0.5, 0.35, 0.1],
                glossiness: 0.75,
                texture: None,
            }),
            ..paint(name, [0.25, 0.1, 0.05], 1.0)
        },
        "veil" => MaterialDescription {
            alpha_mode: AlphaMode::Blend,
            base_color: [0.3, 0.5, 0.8, 0.4],
            double_sided: true,
            ..paint(name, [0.3, 0.5, 0.8], 0.8)
        },
        "glowing" => MaterialDescription {
            emissive: [1.5, 0.7, 0.2],
            ..paint(name, [0.1; 3], 0.5)
        },
        "unlit" => MaterialDescription {
            unlit: true,
            ..paint(name, [0.2, 0.5, 0.9], 1.0)
        },
        _ => return None,
    })
}
