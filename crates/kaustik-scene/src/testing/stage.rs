use std::sync::Arc;

use glam::{Affine3A, Mat3A, Quat, Vec3, Vec3A};
use kaustik_geometry::Mesh;

use crate::description::{
    CameraDescription, EnvironmentDescription, Filtering, ImageData, InstanceDescription, Lens,
    LightDescription, LightKind, MaterialDescription, Pixels, Projection, TextureDescription,
    TextureSlot, UvTransform, Wrap,
};
use crate::{Description, Scene, SceneOptions};

/// A description in the making, with one camera.
#[derive(Clone, Debug)]
#[must_use]
pub struct Stage {
    /// What there is so far; whatever has no method of its own is put here.
    pub description: Description,
}

impl Default for Stage {
    fn default() -> Self {
        Self::new()
    }
}

impl Stage {
    /// With nothing but a pinhole camera at the origin that looks along -z.
    pub fn new() -> Self {
        let camera = CameraDescription {
            name: "camera".to_owned(),
            transform: Affine3A::IDENTITY,
            projection: perspective(1.0),
            lens: None,
            shutter: None,
        };
        Self {
            description: Description {
                cameras: vec![camera],
                ..Description::default()
            },
        }
    }

    fn camera(&mut self) -> &mut CameraDescription {
        &mut self.description.cameras[0]
    }

    /// Puts the camera elsewhere, in the direction that it has.
    pub fn eye(mut self, eye: Vec3) -> Self {
        self.camera().transform.translation = Vec3A::from(eye);
        self
    }

    /// The camera at `eye`, which looks at `target`, +y up, not along it; `yfov` in radians.
    pub fn look_at(mut self, eye: Vec3, target: Vec3, yfov: f32) -> Self {
        let z = (eye - target).normalize();
        let x = Vec3::Y.cross(z).normalize();
        let axes = [x, z.cross(x), z].map(Vec3A::from);
        let camera = self.camera();
        camera.transform = Affine3A {
            matrix3: Mat3A::from_cols(axes[0], axes[1], axes[2]),
            translation: Vec3A::from(eye),
        };
        camera.projection = perspective(yfov);
        self
    }

    /// Gives the camera parallel rays, from `-half` to `half` both ways.
    pub fn orthographic(mut self, half: f32) -> Self {
        self.camera().projection = Projection::Orthographic {
            xmag: half,
            ymag: half,
        };
        self
    }

    /// Gives the camera a thin lens with a round aperture.
    pub fn lens(mut self, aperture: f32, focus: f32) -> Self {
        self.camera().lens = Some(Lens {
            aperture,
            focus,
            blades: None,
        });
        self
    }

    /// Adds a mesh of a material of its own.
    pub fn add(self, material: MaterialDescription, mesh: Mesh) -> Self {
        self.add_at(material, mesh, Affine3A::IDENTITY)
    }

    /// The same, placed.
    pub fn add_at(
        mut self,
        material: MaterialDescription,
        mesh: Mesh,
        transform: Affine3A,
    ) -> Self {
        let index = self.description.materials.len();
        self.description.materials.push(material);
        self.description.instances.push(InstanceDescription {
            name: format!("instance {index}"),
            mesh: self.description.meshes.len(),
            material: Some(index),
            transform,
        });
        self.description.meshes.push(Arc::new(mesh));
        self
    }

    /// Adds another mesh of the material that came last, placed as the last mesh is.
    ///
    /// # Panics
    ///
    /// If there is none.
    pub fn and(mut self, mesh: Mesh) -> Self {
        let last = self.description.instances.last().expect("a mesh before it");
        let another = InstanceDescription {
            mesh: self.description.meshes.len(),
            ..last.clone()
        };
        self.description.instances.push(another);
        self.description.meshes.push(Arc::new(mesh));
        self
    }

    /// Adds a light, such as a [`punctual`] one.
    pub fn light(mut self, light: LightDescription) -> Self {
        self.description.lights.push(light);
        self
    }

    /// The same white radiance from everywhere.
    pub fn sky(mut self, radiance: f32) -> Self {
        self.description.environment = Some(EnvironmentDescription::Constant([radiance; 3]));
        self
    }

    /// A picture around the scene.
    pub fn environment_map(mut self, image: ImageData, rotation: Quat) -> Self {
        self.description.environment = Some(EnvironmentDescription::Image {
            image: Arc::new(image),
            strength: 1.0,
            rotation,
        });
        self
    }

    /// Adds a picture for materials, read without interpolation over the first texture coordinates.
    pub fn texture(mut self, image: ImageData) -> (Self, TextureSlot) {
        self.description.images.push(Arc::new(image));
        self.description.textures.push(TextureDescription {
            image: self.description.images.len() - 1,
            wrap_s: Wrap::Clamp,
            wrap_t: Wrap::Clamp,
            filtering: Filtering::Nearest,
        });
        let slot = TextureSlot {
            texture: self.description.textures.len() - 1,
            uv_set: 0,
            transform: UvTransform::IDENTITY,
        };
        (self, slot)
    }

    /// The scene, for a small square image.
    ///
    /// # Panics
    ///
    /// If it is unsound.
    pub fn build(&self) -> Scene {
        compile(&self.description)
    }
}

fn perspective(yfov: f32) -> Projection {
    Projection::Perspective {
        yfov,
        aspect_ratio: None,
    }
}

/// The scene of a description, for an image of 16 x 16 pixels.
///
/// # Panics
///
/// If it is unsound.
pub fn compile(description: &Description) -> Scene {
    let options = SceneOptions {
        width: 16,
        height: 16,
        ..SceneOptions::default()
    };
    Scene::new(description, &options).expect("a sound scene")
}

/// A white punctual light at `position`, which shines along `axis`; it has no range.
pub fn punctual(kind: LightKind, intensity: f32, position: Vec3, axis: Vec3) -> LightDescription {
    let turn = Quat::from_rotation_arc(Vec3::NEG_Z, axis.normalize());
    LightDescription {
        name: String::new(),
        kind,
        color: [1.0; 3],
        intensity,
        range: None,
        transform: Affine3A::from_rotation_translation(turn, position),
    }
}

/// A picture that no file holds.
pub fn image(width: u32, height: u32, pixels: Pixels) -> ImageData {
    ImageData {
        name: "image".to_owned(),
        width,
        height,
        pixels,
        encoded: Vec::new(),
    }
}
