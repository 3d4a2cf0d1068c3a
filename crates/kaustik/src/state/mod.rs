//! State files: all that a render needs to go on, or to be added to others.
//!
//! ```text
//! magic, format version, byte order      16 bytes
//! header                                 what was rendered: see `header`
//! sections                               values by postcard, films as packed little-endian sums
//! checksum                               BLAKE3 of all before it, 32 bytes
//! ```
//!
//! What follows from scene and settings alone (pilots, pools, builders) is not kept: it is made again, to the same
//! bits, and compared where that is cheap. A method takes part by implementing [`Keep`].

mod error;
mod header;
mod keep;
pub(crate) mod packed;
mod reader;
mod snapshot;
mod stored;
mod writer;

pub use error::StateError;
pub use header::Source;
pub use snapshot::Snapshot;
pub use stored::State;

pub(crate) use header::Header;
pub(crate) use keep::{Keep, take_up};
pub(crate) use reader::Reader;
pub(crate) use writer::Writer;

/// How a state file begins: a name, and a byte that ends a text on some systems.
const MAGIC: [u8; 8] = *b"kaustik\x1a";
/// Of what follows. Any change of the format or of what a method keeps raises it.
const VERSION: u32 = 37;
/// Reads as itself in little-endian order alone.
const BYTE_ORDER: u32 = 0x0102_0304;
/// Bytes before the header.
const PREFIX: usize = 16;
/// Bytes of the checksum.
const CHECKSUM: usize = 32;
/// What a section begins with: what it is, and its length in bytes or numbers.
const SECTION: usize = 9;

/// Kind of a section.
const VALUE: u8 = 1;
const FILM: u8 = 2;
const NUMBERS: u8 = 3;

#[cfg(test)]
mod tests;
