use std::sync::Arc;

use glam::{Affine3A, DVec3, Mat3A, Vec3A};
use kaustik_geometry::Mesh;

use crate::Description;
use crate::description::{
    CameraDescription, EnvironmentDescription, Filtering, ImageData, InstanceDescription,
    LightDescription, LightKind, MaterialDescription, Projection, TextureDescription, TextureSlot,
    UvTransform, Wrap,
};

/// A description in the making.
#[derive(Debug, Default)]
pub(super) struct Stage {
    description: Description,
}

impl Stage {
    pub(super) fn new() -> Self {
        Self::default()
    }

    /// Adds a material for [`place`](Self::place).
    pub(super) fn material(&mut self, material: MaterialDescription) -> usize {
        self.description.materials.push(material);
        self.description.materials.len() - 1
    }

    /// A material in the colours of a picture, over the first texture coordinates.
    pub(super) fn painted(
        &mut self,
        material: MaterialDescription,
        picture: Arc<ImageData>,
    ) -> usize {
        let description = &mut self.description;
        description.textures.push(TextureDescription {
            image: description.images.len(),
            wrap_s: Wrap::Repeat,
            wrap_t: Wrap::Repeat,
            filtering: Filtering::Linear,
        });
        description.images.push(picture);
        let slot = TextureSlot {
            texture: description.textures.len() - 1,
            uv_set: 0,
            transform: UvTransform::IDENTITY,
        };
        self.material(MaterialDescription {
            base_color: [1.0; 4],
            base_color_texture: Some(slot),
            ..material
        })
    }

    /// A sun: parallel light that travels along `direction`, of so much irradiance on what faces it.
    pub(super) fn sun(&mut self, direction: DVec3, irradiance: f32) {
        self.description.lights.push(LightDescription {
            name: "sun".to_owned(),
            kind: LightKind::Directional,
            color: [1.0, 0.95, 0.88],
            intensity: irradiance,
            range: None,
            transform: Affine3A {
                matrix3: looking(direction),
                translation: Vec3A::ZERO,
            },
        });
    }

    /// A sky of even radiance.
    pub(super) fn sky(&mut self, radiance: [f32; 3]) {
        self.description.environment = Some(EnvironmentDescription::Constant(radiance));
    }

    /// Adds a mesh, already in world coordinates.
    pub(super) fn place(&mut self, name: &str, material: usize, mesh: Mesh) {
        self.description.instances.push(InstanceDescription {
            name: name.to_owned(),
            mesh: self.description.meshes.len(),
            material: Some(material),
            transform: Affine3A::IDENTITY,
        });
        self.description.meshes.push(Arc::new(mesh));
    }

    /// Adds a square pinhole camera with +y up; `yfov` in radians.
    pub(super) fn camera(&mut self, eye: DVec3, target: DVec3, yfov: f32) {
        self.description.cameras.push(CameraDescription {
            name: "camera".to_owned(),
            transform: Affine3A {
                matrix3: looking(target - eye),
                translation: Vec3A::from(eye.as_vec3()),
            },
            projection: Projection::Perspective {
                yfov,
                aspect_ratio: Some(1.0),
            },
            lens: None,
            shutter: None,
        });
    }

    /// The finished description, for what is not shared by several scenes.
    pub(super) fn finish(self) -> Description {
        self.description
    }
}

/// A frame that looks along `direction` by its -z, +y up.
fn looking(direction: DVec3) -> Mat3A {
    let z = -direction.normalize();
    let x = DVec3::Y.cross(z).normalize();
    let axes = [x, z.cross(x), z].map(|axis| Vec3A::from(axis.as_vec3()));
    Mat3A::from_cols(axes[0], axes[1], axes[2])
}
