//! Which coordinate means what (streams as in Kelemen sec. 2).
//!
//! Each stream has a fixed stride a bounce, so that what is skipped shifts nothing. Vertices are
//! counted by the edge that leads to them, from 1.
//!
//! The stream of time has one coordinate, index 0: when, while the shutter is open, the path is there. It is asked for
//! only where the scene moves.

/// Camera stream: raster x, y, lens (two), then [`BOUNCE`] a vertex.
pub const CAMERA_HEAD: u32 = 4;
/// Light stream: choice, position (two), direction (two), then [`BOUNCE`] a vertex.
pub const LIGHT_HEAD: u32 = 5;
/// A vertex's own: lobe, direction (two), roulette.
pub const BOUNCE: u32 = 4;
/// Among these, that of roulette.
pub const ROULETTE: u32 = 3;
/// Connection stream: [`NEXT_EVENT`] for a vertex of a camera walk, then [`LENS`] for the vertex that
/// a light walk reaches one edge earlier (the emitter itself is its vertex 0).
pub const CONNECTION: u32 = NEXT_EVENT + LENS;
/// Next event at a vertex: choice, position (two).
pub const NEXT_EVENT: u32 = 3;
/// Lens point for a vertex of a light walk.
pub const LENS: u32 = 2;
/// Technique stream: whether a walk of the simple bidirectional form ends where it begins.
pub const STOP_AT_LENS: u32 = 0;
/// The same at the emitter.
pub const STOP_AT_EMITTER: u32 = 1;
/// The length of a multiplexed path.
pub const LENGTH: u32 = 2;
/// Its strategy.
pub const STRATEGY: u32 = 3;

/// Technique stream: the first of one number a vertex of a camera walk, which part of its surface is taken.
pub const PARTS: u32 = 8;

/// Which part is taken of the surface that this edge leads to.
#[inline]
pub(crate) fn part(edge: u32) -> u32 {
    PARTS + edge
}

/// First of a vertex's [`BOUNCE`] coordinates in a stream with this head.
#[inline]
pub(crate) fn bounce(head: u32, edge: u32) -> u32 {
    head + BOUNCE * (edge - 1)
}

/// First of the [`NEXT_EVENT`] coordinates of the vertex that a camera walk reaches by this edge.
#[inline]
pub(crate) fn connection(edge: u32) -> u32 {
    CONNECTION * (edge - 1)
}

/// First of the [`LENS`] coordinates of the vertex that a light walk reaches by this edge; 0 is the
/// emitter.
#[inline]
pub(crate) fn lens(edge: u32) -> u32 {
    CONNECTION * edge + NEXT_EVENT
}
