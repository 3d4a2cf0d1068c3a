//! glTF 2.0 files in and out, from sources that need not be trusted.
//!
//! [`load`] turns a `.gltf` or `.glb` file into a [`Description`](crate::Description);
//! [`export_bytes`] and [`export_text`] make one, such that loading it again gives an equal
//! description. Whatever the bytes are, loading ends soon with a scene or with an error that names the file, the place
//! in it, what stands there and what should.
//!
//! The JSON is read as a plain tree through cursors that know their own JSON pointer, not
//! through a typed model of glTF: a typed model loses the place of an error, keeps
//! extensions and extras as raw JSON all the same, and refuses a whole file for a fault in a
//! part that no renderer needs. Everything below it is checked by ourselves: containers,
//! uris (nothing outside the scene's folder is ever opened), byte ranges, accessors, the node
//! forest, and, before each allocation, a budget of memory. Nothing here recurses, and
//! nothing is allocated by a number in the file alone.
//!
//! What is read, and how, stands in `docs/scene-files.md`; [`EXTENSIONS`] lists the
//! extensions. Kaustik's own keys travel in `extras.kaustik` of materials, cameras, images
//! and scenes.

mod accessor;
mod animation;
mod budget;
mod buffer;
mod camera;
mod compressed;
mod container;
mod environment;
mod error;
mod export;
mod extension;
mod extras;
mod folder;
mod idle;
mod image;
mod image_light;
mod json;
mod layers;
mod light;
mod lines;
mod load;
mod material;
mod mesh;
mod node;
mod options;
mod placement;
mod reader;
mod shape;
mod shaped;
mod skin;
mod syntax;
#[cfg(test)]
mod tests;
mod texture;
mod transform;
mod triangles;
mod uri;
mod variant;
mod vertices;
mod warning;

pub use error::{ErrorKind, LoadError};
pub use export::{ExportError, export_bytes, export_text};
pub use extension::{EXTENSIONS, Extensions};
pub use lines::{Line, lines};
pub use load::{Loaded, load, load_bytes};
pub use options::LoadOptions;
pub use warning::Warning;
