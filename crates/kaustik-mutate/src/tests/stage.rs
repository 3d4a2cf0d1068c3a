//! Small scenes by code.

mod moving;

use std::sync::Arc;

use glam::{Affine3A, DVec3, Mat3A, Quat, Vec3, Vec3A};
use kaustik_geometry::Mesh;
use kaustik_scene::description::{
    AlphaMode, Blades, CameraDescription, EnvironmentDescription, InstanceDescription, Lens,
    LightDescription, LightKind, Load, MaterialDescription, Projection, Specular, Transmission,
    Volume,
};
use kaustik_scene::{Description, Scene, SceneOptions};
use moving::{QUARTER, STRAIGHT};

/// A description in the making.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stage {
    description: Description,
}

impl Stage {
    /// With a square pinhole camera that looks down on the origin.
    pub(crate) fn new() -> Self {
        let eye = Vec3::new(0.3, 3.0, 2.0);
        let z = eye.normalize();
        let x = Vec3::Y.cross(z).normalize();
        let axes = [x, z.cross(x), z].map(Vec3A::from);
        let camera = CameraDescription {
            name: "camera".to_owned(),
            transform: Affine3A {
                matrix3: Mat3A::from_cols(axes[0], axes[1], axes[2]),
                translation: Vec3A::from(eye),
            },
            projection: Projection::Perspective {
                yfov: 0.9,
                aspect_ratio: None,
            },
            lens: None,
            shutter: None,
        };
        let mut stage = Self::default();
        stage.description.cameras.push(camera);
        stage
    }

    pub(crate) fn lens(mut self, aperture: f32, focus: f32) -> Self {
        self.description.cameras[0].lens = Some(Lens {
            aperture,
            focus,
            blades: None,
        });
        self
    }

    /// With so many blades.
    pub(crate) fn blades(mut self, count: u32) -> Self {
        if let Some(lens) = &mut self.description.cameras[0].lens {
            let rotation = 0.3;
            lens.blades = Some(Blades { count, rotation });
        }
        self
    }

    /// Sees more than a right angle.
    pub(crate) fn wide(mut self) -> Self {
        self.description.cameras[0].projection = Projection::Perspective {
            yfov: 2.0,
            aspect_ratio: None,
        };
        self
    }

    pub(crate) fn orthographic(mut self) -> Self {
        self.description.cameras[0].projection = Projection::Orthographic {
            xmag: 1.5,
            ymag: 1.5,
        };
        self
    }

    /// Adds a mesh of a material of its own.
    pub(crate) fn add(mut self, material: MaterialDescription, mesh: Mesh) -> Self {
        let index = self.description.materials.len();
        self.description.materials.push(material);
        self.description.instances.push(InstanceDescription {
            name: format!("instance {index}"),
            mesh: self.description.meshes.len(),
            material: Some(index),
            transform: Affine3A::IDENTITY,
        });
        self.description.meshes.push(Arc::new(mesh));
        self
    }

    pub(crate) fn light(mut self, kind: LightKind, position: Vec3, axis: Vec3) -> Self {
        let turn = Quat::from_rotation_arc(Vec3::NEG_Z, axis.normalize());
        self.description.lights.push(LightDescription {
            name: String::new(),
            kind,
            color: [1.0, 0.9, 0.6],
            intensity: 3.0,
            range: None,
            transform: Affine3A::from_rotation_translation(turn, position),
        });
        self
    }

    pub(crate) fn sky(mut self, radiance: f32) -> Self {
        self.description.environment = Some(EnvironmentDescription::Constant([radiance; 3]));
        self
    }

    /// The same in another unit of length, as bright as before. Nothing in it may move.
    pub(crate) fn scaled(mut self, factor: f32) -> Self {
        let scale = Affine3A::from_scale(Vec3::splat(factor));
        let description = &mut self.description;
        for instance in &mut description.instances {
            instance.transform = scale * instance.transform;
        }
        for camera in &mut description.cameras {
            camera.transform.translation *= factor;
            if let Some(lens) = &mut camera.lens {
                lens.aperture *= factor;
                lens.focus *= factor;
            }
            if let Projection::Orthographic { xmag, ymag } = &mut camera.projection {
                *xmag *= factor;
                *ymag *= factor;
            }
        }
        for light in &mut description.lights {
            light.transform.translation *= factor;
            if light.kind != LightKind::Directional {
                light.intensity *= factor * factor;
            }
        }
        for volume in description
            .materials
            .iter_mut()
            .filter_map(|m| m.volume.as_mut())
        {
            volume.thickness *= factor;
            volume.attenuation_distance *= factor;
        }
        self
    }

    pub(crate) fn build(&self) -> Scene {
        let options = SceneOptions {
            width: 16,
            height: 16,
            ..SceneOptions::default()
        };
        Scene::new(&self.description, &options).expect("a sound scene")
    }
}

pub(crate) fn diffuse(rgb: [f32; 3]) -> MaterialDescription {
    MaterialDescription {
        base_color: [rgb[0], rgb[1], rgb[2], 1.0],
        metallic: 0.0,
        specular: Specular {
            factor: 0.0,
            texture: None,
            color: [1.0; 3],
            color_texture: None,
        },
        ..MaterialDescription::default()
    }
}

pub(crate) fn lamp(radiance: f32) -> MaterialDescription {
    MaterialDescription {
        emissive: [radiance; 3],
        ..diffuse([0.0; 3])
    }
}

/// A mirror, or blurred metal.
pub(crate) fn metal(roughness: f32) -> MaterialDescription {
    MaterialDescription {
        base_color: [0.9, 0.8, 0.6, 1.0],
        metallic: 1.0,
        roughness,
        ..MaterialDescription::default()
    }
}

/// A smooth coat over a diffuse base.
pub(crate) fn varnish() -> MaterialDescription {
    MaterialDescription {
        base_color: [0.7, 0.4, 0.3, 1.0],
        metallic: 0.0,
        roughness: 0.0,
        ior: 2.2,
        ..MaterialDescription::default()
    }
}

/// A tinted solid.
pub(crate) fn glass(roughness: f32, dispersion: f32) -> MaterialDescription {
    MaterialDescription {
        metallic: 0.0,
        roughness,
        ior: 1.5,
        dispersion,
        transmission: Some(Transmission {
            factor: 1.0,
            texture: None,
        }),
        volume: Some(Volume {
            thickness: 1.0,
            attenuation_distance: 1.0,
            attenuation_color: [0.5, 0.8, 0.6],
        }),
        ..MaterialDescription::default()
    }
}

pub(crate) fn veil(opacity: f32) -> MaterialDescription {
    MaterialDescription {
        base_color: [0.3, 0.6, 0.8, opacity],
        alpha_mode: AlphaMode::Blend,
        ..diffuse([0.5; 3])
    }
}

/// A rectangle around `centre`; its front faces `u` x `v`.
pub(crate) fn rectangle(centre: Vec3, u: Vec3, v: Vec3) -> Mesh {
    Mesh {
        positions: vec![
            centre - u - v,
            centre + u - v,
            centre + u + v,
            centre - u + v,
        ],
        indices: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// A closed box, facing outward.
pub(crate) fn cuboid(min: Vec3, max: Vec3) -> Mesh {
    let (centre, half) = ((min + max) * 0.5, (max - min) * 0.5);
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        let along = |i: usize, sign: f32| {
            let mut v = Vec3::ZERO;
            v[(axis + i) % 3] = half[(axis + i) % 3] * sign;
            v
        };
        for sign in [1.0, -1.0] {
            let face = rectangle(centre + along(0, sign), along(1, 1.0), along(2, sign));
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(face.positions);
            mesh.indices
                .extend(face.indices.iter().map(|t| t.map(|i| i + first)));
        }
    }
    mesh
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
    Stage::new()
        .add(
            diffuse([0.7, 0.6, 0.5]),
            rectangle(Vec3::ZERO, Vec3::Z * 3.0, Vec3::X * 3.0),
        )
        .add(
            diffuse([0.3, 0.7, 0.4]),
            rectangle(Vec3::new(-1.4, 1.5, 0.0), Vec3::Y * 1.5, Vec3::Z * 3.0),
        )
}

fn lit() -> Stage {
    room().add(
        lamp(4.0),
        rectangle(Vec3::new(0.5, 2.4, -0.8), Vec3::X * 0.6, Vec3::Z * 0.6),
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
    let small = |centre| rectangle(centre, Vec3::X * 0.2, Vec3::Z * 0.2);
    room()
        .add(
            solid,
            mesh(cuboid(
                Vec3::new(-2.0, -0.5, -3.5),
                Vec3::new(2.0, 3.4, 3.5),
            )),
        )
        .add(lamp(4.0), small(Vec3::new(0.6, 1.5, -1.0)))
        .add(lamp(60.0), small(Vec3::new(0.0, 3.8, -0.6)))
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
        Some(name) => stage(name).scaled(1024.0).build(),
        None => stage(name).build(),
    }
}

/// The stage of a scene by name.
pub(crate) fn stage(name: &str) -> Stage {
    let down = Vec3::new(-0.4, -1.0, 0.1);
    let above = Vec3::new(1.0, 2.0, 0.5);
    match name {
        "diffuse" => lit(),
        // a lamp that faces a wall that is a mirror
        "gallery" => Stage::new()
            .add(
                diffuse([0.7, 0.6, 0.5]),
                rectangle(Vec3::ZERO, Vec3::Z * 3.0, Vec3::X * 3.0),
            )
            .add(
                metal(0.0),
                rectangle(Vec3::new(-1.4, 1.5, 0.0), Vec3::Y * 1.5, Vec3::Z * 3.0),
            )
            .add(
                lamp(4.0),
                rectangle(Vec3::new(-0.4, 1.4, -0.6), Vec3::Z * 1.2, Vec3::Y * 0.8),
            ),
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
            leaning(rectangle(
                Vec3::new(0.5, 1.4, -0.8),
                Vec3::X * 0.6,
                Vec3::Z * 0.6,
            )),
        ),
        // a lamp and a wall, seen in a floor that is a mirror
        "pond" => Stage::new()
            .wide()
            .add(
                metal(0.0),
                rectangle(Vec3::ZERO, Vec3::Z * 3.0, Vec3::X * 3.0),
            )
            .add(
                diffuse([0.3, 0.7, 0.4]),
                rectangle(Vec3::new(0.0, 3.0, -3.0), Vec3::X * 3.0, Vec3::Y * 3.0),
            )
            .add(
                lamp(4.0),
                rectangle(Vec3::new(-0.15, 1.5, -1.0), Vec3::X * 0.3, Vec3::Z * 0.3),
            )
            .light(LightKind::Point, Vec3::new(0.5, 3.0, -1.5), down),
        // a lamp as wide as the view, seen in a floor that is a mirror
        "ceiling" => Stage::new()
            .wide()
            .add(
                metal(0.0),
                rectangle(Vec3::ZERO, Vec3::Z * 3.0, Vec3::X * 3.0),
            )
            .add(
                lamp(4.0),
                rectangle(Vec3::Y * 6.0, Vec3::X * 6.0, Vec3::Z * 6.0),
            ),
        "moving" => moving(plate(diffuse([0.6, 0.5, 0.7]))),
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
                .light(LightKind::Point, above, down)
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
        "point" => room().light(LightKind::Point, above, down),
        "sun" => room().light(LightKind::Directional, above, down),
        "point-glass" => block(glass(0.0, 0.0)).light(LightKind::Point, above, down),
        "sun-glass" => block(glass(0.0, 0.0)).light(LightKind::Directional, above, down),
        "sky" => plate(metal(0.0)).sky(0.5),
        // a lamp that faces the camera, beside the sky
        "window" => Stage::new()
            .add(
                lamp(0.8),
                rectangle(Vec3::ZERO, Vec3::Z * 1.0, Vec3::X * 1.0),
            )
            .sky(0.5),
        // emitters of all kinds
        "daylight" => block(glass(0.0, 0.0))
            .light(LightKind::Point, above, down)
            .light(LightKind::Directional, above, down)
            .sky(0.5),
        "lens" => plate(metal(0.0)).lens(0.3, 2.5),
        "blades" => plate(metal(0.0)).lens(0.6, 2.5).blades(3),
        "orthographic" => plate(metal(0.0)).orthographic(),
        // parallel rays that pass beside all there is
        "outlook" => Stage::new()
            .add(
                diffuse([0.7, 0.6, 0.5]),
                rectangle(Vec3::ZERO, Vec3::Z * 1.2, Vec3::X * 1.2),
            )
            .add(
                diffuse([0.3, 0.7, 0.4]),
                rectangle(Vec3::new(-1.2, 0.8, 0.0), Vec3::Y * 0.8, Vec3::Z * 1.2),
            )
            .add(metal(0.0), slope())
            .sky(0.5)
            .orthographic(),
        "aquarium" => aquarium(std::convert::identity),
        "leaning-aquarium" => aquarium(leaning),
        "veil-mirror" => plate(metal(0.0)).add(
            veil(0.5),
            rectangle(Vec3::Y * 0.8, Vec3::Z * 0.9, Vec3::X * 0.8),
        ),
        "veil" => lit().add(
            veil(0.5),
            rectangle(Vec3::Y * 0.8, Vec3::Z * 0.9, Vec3::X * 0.8),
        ),
        other => panic!("no scene {other}"),
    }
}
