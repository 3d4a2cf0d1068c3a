//! Everything there is to see: cameras, emitters, materials, textures; glTF files in and
//! out; built-in scenes.
//!
//! A file or a built-in becomes a [`Description`] (plain data), and a description becomes a
//! [`Scene`] (ready for rays).

pub mod builtin;
pub mod camera;
pub mod description;
mod emitter;
pub mod environment;
mod fence;
pub mod gltf;
mod interior;
mod material;
mod matter;
mod passed;
mod scene;
#[cfg(any(test, doc, feature = "testing"))]
pub mod testing;
pub mod texture;
mod vertex;

pub use description::Description;
pub use emitter::{
    AreaSample, DirectSample, EmissionPdf, EmissionSample, EmitterPoint, PunctualView, Reach,
};
pub use fence::is_fenced;
pub use interior::Interior;
pub use passed::Passed;
pub use scene::{Scene, SceneError, SceneOptions, Segment};
pub use vertex::Vertex;
