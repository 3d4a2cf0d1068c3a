//! Everything there is to see: cameras, emitters, materials, textures; glTF files in and
//! out; built-in scenes.
//!
//! A file or a built-in becomes a [`Description`] (plain data), and a description becomes a
//! [`Scene`] (ready for rays).

pub mod camera;
pub mod description;
pub mod texture;
#[cfg(test)]
mod testing;

pub use description::Description;
