use std::sync::Arc;

use glam::{Affine3A, Mat3A, Quat, Vec3, Vec3A};
use kaustik_geometry::Mesh;
use kaustik_scene::description::{
    CameraDescription, EnvironmentDescription, ImageData, InstanceDescription, Lens,
    LightDescription, LightKind, MaterialDescription, Pixels, Projection, Specular, Transmission,
    Volume,
};
use kaustik_scene::{Description, Scene, SceneOptions};

/// A description in the making.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stage {
    pub(crate) description: Description,
}

impl Stage {
    /// With a square pinhole camera; `yfov` in radians.
    pub(crate) fn new(eye: Vec3, target: Vec3, yfov: f32) -> Self {
        let z = (eye - target).normalize();
        let x = Vec3::Y.cross(z).normalize();
        let axes = [x, z.cross(x), z].map(Vec3A::from);
        let camera = CameraDescription {
            name: "camera".to_owned(),
            transform: Affine3A {
                matrix3: Mat3A::from_cols(axes[0], axes[1], axes[2]),
                translation: Vec3A::from(eye),
            },
            projection: Projection::Perspective {
                yfov,
                aspect_ratio: None,
            },
            lens: None,
            shutter: None,
        };
        let mut stage = Self::default();
        stage.description.cameras.push(camera);
        stage
    }

    /// Gives the camera a lens.
    pub(crate) fn lens(mut self, aperture: f32, focus: f32) -> Self {
        self.description.cameras[0].lens = Some(Lens {
            aperture,
            focus,
            blades: None,
        });
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

    /// Another object of the material that came last.
    pub(crate) fn and(mut self, mesh: Mesh) -> Self {
        let last = self.description.instances.last().cloned();
        self.description
            .instances
            .extend(last.map(|last| InstanceDescription {
                mesh: self.description.meshes.len(),
                ..last
            }));
        self.description.meshes.push(Arc::new(mesh));
        self
    }

    /// A yellowish punctual light at `position`, which shines along `axis`.
    pub(crate) fn light(
        mut self,
        kind: LightKind,
        intensity: f32,
        position: Vec3,
        axis: Vec3,
    ) -> Self {
        let turn = Quat::from_rotation_arc(Vec3::NEG_Z, axis.normalize());
        self.description.lights.push(LightDescription {
            name: String::new(),
            kind,
            color: [1.0, 0.9, 0.6],
            intensity,
            range: Some(9.0),
            transform: Affine3A::from_rotation_translation(turn, position),
        });
        self
    }

    /// The same radiance from everywhere.
    pub(crate) fn sky(mut self, radiance: f32) -> Self {
        self.description.environment = Some(EnvironmentDescription::Constant([radiance; 3]));
        self
    }

    /// A sky of four rows and eight columns, brighter and bluer above, with a lamp in it.
    pub(crate) fn painted_sky(mut self) -> Self {
        let texel = |i: usize| match i {
            10 => [9.0, 8.0, 6.0],
            _ => [1.0, 1.1, 1.3].map(|c: f32| c * (4.0 - (i / 8) as f32) * 0.3),
        };
        let image = ImageData {
            name: "sky".to_owned(),
            width: 8,
            height: 4,
            pixels: Pixels::RgbF32((0..32).flat_map(texel).collect()),
            encoded: Vec::new(),
        };
        self.description.environment = Some(EnvironmentDescription::Image {
            image: Arc::new(image),
            strength: 1.0,
            rotation: Quat::from_rotation_y(0.5),
        });
        self
    }

    pub(crate) fn build(&self) -> Scene {
        compile(&self.description)
    }
}

/// The scene of a description, for a small square image.
pub(crate) fn compile(description: &Description) -> Scene {
    let options = SceneOptions {
        width: 16,
        height: 16,
        ..SceneOptions::default()
    };
    Scene::new(description, &options).expect("a sound scene")
}

/// A Lambertian surface.
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

/// A black surface of a white radiance.
pub(crate) fn lamp(radiance: f32) -> MaterialDescription {
    MaterialDescription {
        emissive: [radiance; 3],
        ..diffuse([0.0; 3])
    }
}

/// A transparent solid; light is `color` after the distance 1.
pub(crate) fn solid(ior: f32, roughness: f32, color: [f32; 3]) -> MaterialDescription {
    MaterialDescription {
        metallic: 0.0,
        roughness,
        ior,
        transmission: Some(Transmission {
            factor: 1.0,
            texture: None,
        }),
        volume: Some(Volume {
            thickness: 1.0,
            attenuation_distance: 1.0,
            attenuation_color: color,
        }),
        ..MaterialDescription::default()
    }
}

/// A rectangle around `centre`; its front faces `u` x `v`.
pub(crate) fn rectangle(centre: Vec3, u: Vec3, v: Vec3) -> Mesh {
    let corners = [
        centre - u - v,
        centre + u - v,
        centre + u + v,
        centre - u + v,
    ];
    Mesh {
        positions: corners.to_vec(),
        indices: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// A level square that faces up.
pub(crate) fn floor(y: f32, half: f32) -> Mesh {
    rectangle(Vec3::Y * y, Vec3::Z * half, Vec3::X * half)
}

/// A level square that faces down.
pub(crate) fn ceiling(centre: Vec3, half: f32) -> Mesh {
    rectangle(centre, Vec3::X * half, Vec3::Z * half)
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

/// A coarse ball with interpolated normals.
pub(crate) fn ball(centre: Vec3, radius: f32) -> Mesh {
    const RINGS: u32 = 6;
    let mut mesh = Mesh::default();
    let normal = |ring: u32, spoke: u32| {
        let theta = std::f32::consts::PI * ring as f32 / RINGS as f32;
        let phi = std::f32::consts::PI * (spoke % (2 * RINGS)) as f32 / RINGS as f32;
        let (y, across) = (theta.cos(), theta.sin());
        Vec3::new(across * phi.cos(), y, across * phi.sin())
    };
    for ring in 0..RINGS {
        for spoke in 0..2 * RINGS {
            let first = mesh.positions.len() as u32;
            let corners = [(0, 0), (0, 1), (1, 1), (1, 0)];
            let normals = corners.map(|(r, s)| normal(ring + r, spoke + s));
            mesh.positions.extend(normals.map(|n| centre + n * radius));
            mesh.normals.extend(normals);
            if ring + 1 < RINGS {
                mesh.indices.push([first, first + 2, first + 3]);
            }
            if ring > 0 {
                mesh.indices.push([first, first + 1, first + 2]);
            }
        }
    }
    mesh
}
