//! OpenEXR files.
//!
//! Written: one part whose channels are `R`, `G`, `B` and `layer.channel` (the convention that most
//! programs understand as layers), scan lines in increasing order, ZIP compression (lossless), 32-bit
//! floats. All of our description stands in one attribute, `kaustik`, as JSON: the order in which several
//! attributes are written depends on a hash, and files would differ from run to run.
//!
//! Read: headers and chunks are walked by our own code, which compares every size with a budget and with
//! the file's length before anything is allocated; only the decompression of one block at a time is left
//! to the `exr` crate. That crate's own reader lets a hostile file abort the process with an allocation
//! that cannot be caught.

mod attributes;
mod blocks;
mod bytes;
mod header;
mod read;
mod write;

pub use read::decode;
pub use write::{encode, write};
