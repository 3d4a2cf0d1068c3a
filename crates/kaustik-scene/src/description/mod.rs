//! A scene as plain data: what a file says, checked, before anything is built from it.
//!
//! Loaders and the built-in scenes produce a [`Description`], the exporter writes one, and
//! [`Scene::new`](crate::Scene::new) compiles one for rendering. It is the seam between
//! file formats and light transport: neither side knows the other. Colours are linear
//! Rec.709, lengths the scene's own unit, angles radians.

mod animation;
mod camera;
mod environment;
mod image;
mod layers;
mod light;
mod material;
mod texture;

use std::sync::Arc;

use glam::Affine3A;
use kaustik_geometry::Mesh;

pub use animation::{AnimationDescription, Carried, Channel, Interpolation, Joint, Load, Rest};
pub use camera::{Blades, CameraDescription, Lens, Projection, Shutter};
pub use environment::EnvironmentDescription;
pub use image::{ImageData, Pixels};
pub use layers::{Anisotropy, Clearcoat, Iridescence, Sheen};
pub use light::{LightDescription, LightKind};
pub use material::{
    AlphaMode, DiffuseTransmission, MaterialDescription, Model, SpectralInput, Specular,
    SpecularGlossiness, Transmission, Volume,
};
pub use texture::{Filtering, TextureDescription, TextureSlot, UvTransform, Wrap};

/// One placement of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct InstanceDescription {
    /// Name of the node, for messages.
    pub name: String,
    /// Index into [`Description::meshes`].
    pub mesh: usize,
    /// Index into [`Description::materials`]; `None` is glTF's default material.
    pub material: Option<usize>,
    /// Object to world.
    pub transform: Affine3A,
}

/// A whole scene as plain data. Indices refer to the vectors beside them and are in range
/// when the description comes from this crate's loaders; [`Scene::new`](crate::Scene::new)
/// checks them for everyone else.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Description {
    /// Name of the scene, for metadata.
    pub name: String,
    /// Geometry, one entry a glTF primitive; shared by its instances.
    pub meshes: Vec<Arc<Mesh>>,
    /// Placements of meshes.
    pub instances: Vec<InstanceDescription>,
    /// Materials.
    pub materials: Vec<MaterialDescription>,
    /// Textures: an image with its sampling.
    pub textures: Vec<TextureDescription>,
    /// Decoded images.
    pub images: Vec<Arc<ImageData>>,
    /// Point, spot and directional lights.
    pub lights: Vec<LightDescription>,
    /// Cameras in file order; the first is the default.
    pub cameras: Vec<CameraDescription>,
    /// Light from infinitely far away, if any.
    pub environment: Option<EnvironmentDescription>,
    /// What moves while a camera's shutter is open.
    pub animation: AnimationDescription,
}

impl Description {
    /// The camera of this name or, where none has it, of this index; the first if nothing is
    /// wanted. `None` if there is no such camera.
    #[must_use]
    pub fn camera(&self, wanted: Option<&str>) -> Option<&CameraDescription> {
        let Some(wanted) = wanted else {
            return self.cameras.first();
        };
        let named = self.cameras.iter().find(|camera| camera.name == wanted);
        let index = || wanted.parse::<usize>().ok();
        named.or_else(|| self.cameras.get(index()?))
    }
}
