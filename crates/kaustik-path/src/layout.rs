//! Which coordinate means what (spec: pss-and-pssmlt.md 6).
//!
//! Each stream has a fixed stride a bounce, so that what is skipped shifts nothing. Vertices are
//! counted by the edge that leads to them, from 1.

/// Camera stream: raster x, y, lens (two), then [`BOUNCE`] a vertex.
pub const CAMERA_HEAD: u32 = 4;
/// Light stream: choice, position (two), direction (two), then [`BOUNCE`] a vertex.
pub const LIGHT_HEAD: u32 = 5;
/// A vertex's own: lobe, direction (two), roulette.
pub const BOUNCE: u32 = 4;
/// Connection stream, next event at a vertex: choice, position (two).
pub const NEXT_EVENT: u32 = 3;
/// Connection stream, lens point for a vertex of a light walk.
pub const LENS: u32 = 2;

/// First of a vertex's [`BOUNCE`] coordinates in a stream with this head.
#[inline]
pub(crate) fn bounce(head: u32, edge: u32) -> u32 {
    head + BOUNCE * (edge - 1)
}
