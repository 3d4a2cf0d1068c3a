//! Small scenes by code, for tests of what a scene answers.

use std::sync::Arc;

use glam::{Affine3A, Quat, Vec2, Vec3};
use kaustik_geometry::Mesh;
use kaustik_spectrum::{WavelengthSampling, Wavelengths};

use crate::description::{
    CameraDescription, EnvironmentDescription, Filtering, ImageData, InstanceDescription,
    LightDescription, LightKind, MaterialDescription, Pixels, Projection, Specular,
    TextureDescription, TextureSlot, Transmission, UvTransform, Volume, Wrap,
};
use crate::{Description, Scene, SceneOptions};

/// A description in the making, with a camera at the origin that looks along -z.
#[derive(Clone, Debug)]
pub(crate) struct Stage {
    pub(crate) description: Description,
}

impl Stage {
    pub(crate) fn new() -> Self {
        let mut stage = Self {
            description: Description::default(),
        };
        stage.camera(Vec3::ZERO);
        stage
    }

    /// Puts the only camera elsewhere.
    pub(crate) fn camera(&mut self, eye: Vec3) {
        self.description.cameras = vec![CameraDescription {
            name: "camera".to_owned(),
            transform: Affine3A::from_translation(eye),
            projection: Projection::Perspective {
                yfov: 1.0,
                aspect_ratio: None,
            },
            lens: None,
            shutter: None,
        }];
    }

    /// Adds a mesh of a material of its own; returns the material's index.
    pub(crate) fn add(&mut self, material: MaterialDescription, mesh: Mesh) -> u32 {
        self.add_at(material, mesh, Affine3A::IDENTITY)
    }

    /// The same, placed.
    pub(crate) fn add_at(
        &mut self,
        material: MaterialDescription,
        mesh: Mesh,
        transform: Affine3A,
    ) -> u32 {
        let index = self.description.materials.len();
        self.description.materials.push(material);
        self.description.instances.push(InstanceDescription {
            name: format!("instance {index}"),
            mesh: self.description.meshes.len(),
            material: Some(index),
            transform,
        });
        self.description.meshes.push(Arc::new(mesh));
        index as u32
    }

    /// A white punctual light at `position`, which shines along `axis`.
    pub(crate) fn light(&mut self, kind: LightKind, intensity: f32, position: Vec3, axis: Vec3) {
        let turn = Quat::from_rotation_arc(Vec3::NEG_Z, axis.normalize());
        self.description.lights.push(LightDescription {
            name: String::new(),
            kind,
            color: [1.0; 3],
            intensity,
            range: None,
            transform: Affine3A::from_rotation_translation(turn, position),
        });
    }

    /// A picture of linear colours, read without interpolation.
    pub(crate) fn texture(&mut self, width: u32, texels: &[[f32; 3]]) -> TextureSlot {
        let pixels = Pixels::RgbF32(texels.iter().flatten().copied().collect());
        self.image(width, texels.len() as u32 / width, pixels)
    }

    /// A picture, read without interpolation.
    pub(crate) fn image(&mut self, width: u32, height: u32, pixels: Pixels) -> TextureSlot {
        let image = picture(width, height, pixels);
        self.description.images.push(Arc::new(image));
        self.description.textures.push(TextureDescription {
            image: self.description.images.len() - 1,
            wrap_s: Wrap::Clamp,
            wrap_t: Wrap::Clamp,
            filtering: Filtering::Nearest,
        });
        TextureSlot {
            texture: self.description.textures.len() - 1,
            uv_set: 0,
            transform: UvTransform::IDENTITY,
        }
    }

    /// Grey radiance around the scene, `width` texels a row.
    pub(crate) fn sky(&mut self, width: u32, texels: &[f32]) {
        let pixels = Pixels::RgbF32(texels.iter().flat_map(|&v| [v; 3]).collect());
        let image = picture(width, texels.len() as u32 / width, pixels);
        self.description.environment = Some(EnvironmentDescription::Image {
            image: Arc::new(image),
            strength: 1.0,
            rotation: Quat::from_rotation_x(0.7),
        });
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

fn picture(width: u32, height: u32, pixels: Pixels) -> ImageData {
    ImageData {
        name: "picture".to_owned(),
        width,
        height,
        pixels,
        encoded: Vec::new(),
    }
}

/// Some four wavelengths.
pub(crate) fn wavelengths() -> Wavelengths {
    Wavelengths::sample(0.37, WavelengthSampling::Hero)
}

/// A Lambertian surface.
pub(crate) fn diffuse(albedo: f32) -> MaterialDescription {
    MaterialDescription {
        base_color: [albedo, albedo, albedo, 1.0],
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
pub(crate) fn lamp(radiance: f32, double_sided: bool) -> MaterialDescription {
    MaterialDescription {
        emissive: [radiance; 3],
        double_sided,
        ..diffuse(0.0)
    }
}

/// A smooth transparent solid; light is `color` after the distance 1.
pub(crate) fn solid(ior: f32, priority: i32, color: [f32; 3]) -> MaterialDescription {
    MaterialDescription {
        metallic: 0.0,
        roughness: 0.0,
        ior,
        priority,
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

/// A rectangle around `centre`; its front faces `u` x `v`. Texture coordinates run along `u`
/// and against `v`, as a picture lies.
pub(crate) fn rectangle(centre: Vec3, u: Vec3, v: Vec3) -> Mesh {
    Mesh {
        positions: vec![
            centre - u - v,
            centre + u - v,
            centre + u + v,
            centre - u + v,
        ],
        indices: vec![[0, 1, 2], [0, 2, 3]],
        uv: [
            vec![Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::X, Vec2::ZERO],
            Vec::new(),
        ],
        ..Mesh::default()
    }
}

/// A closed box, facing outward.
pub(crate) fn cuboid(min: Vec3, max: Vec3) -> Mesh {
    let (centre, half) = ((min + max) * 0.5, (max - min) * 0.5);
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        let mut normal = Vec3::ZERO;
        let mut u = Vec3::ZERO;
        normal[axis] = half[axis];
        u[(axis + 1) % 3] = half[(axis + 1) % 3];
        for sign in [1.0, -1.0] {
            let mut v = Vec3::ZERO;
            v[(axis + 2) % 3] = half[(axis + 2) % 3] * sign;
            let face = rectangle(centre + normal * sign, u, v);
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(face.positions);
            let shifted = face.indices.iter().map(|t| t.map(|i| i + first));
            mesh.indices.extend(shifted);
        }
    }
    mesh
}
