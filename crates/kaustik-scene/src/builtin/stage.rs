use std::sync::Arc;

use glam::{Affine3A, DVec3, Mat3A, Vec3A};
use kaustik_geometry::Mesh;

use crate::Description;
use crate::description::{CameraDescription, InstanceDescription, MaterialDescription, Projection};

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
        let z = (eye - target).normalize();
        let x = DVec3::Y.cross(z).normalize();
        let axes = [x, z.cross(x), z].map(|axis| Vec3A::from(axis.as_vec3()));
        self.description.cameras.push(CameraDescription {
            name: "camera".to_owned(),
            transform: Affine3A {
                matrix3: Mat3A::from_cols(axes[0], axes[1], axes[2]),
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
