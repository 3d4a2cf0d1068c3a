//! What becomes of a splat, what a film counts, and why a film cannot be had.

use serde::{Deserialize, Serialize};

/// What became of a splat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Added {
    /// It was added to one or more pixels.
    Yes,
    /// No pixel of its support is one of the film's: rightly dropped.
    Outside,
    /// The value or the raster point was NaN or infinite: counted and left out.
    NonFinite,
    /// Too many quanta for one splat: counted and left out.
    TooLarge,
}

/// What a film left out or could not hold. All zero in a sound render.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Splats that were NaN or infinite.
    pub non_finite: u64,
    /// Splats of 2^61 quanta (2^29 pilot means) or more.
    pub too_large: u64,
    /// Adds after which a sum stood at or past 2^62 quanta. Zero or not is what matters: the number may
    /// depend on the order of adds.
    pub overflowed: u64,
}

/// A film that cannot be made, filled or merged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FilmError {
    /// No pixels.
    #[error(
        "a film of {width} x {height} pixels with crop {crop} holds nothing: expected a crop window with x0 < x1 <= {width} and y0 < y1 <= {height}"
    )]
    Empty {
        /// Columns of the full image.
        width: u32,
        /// Rows of the full image.
        height: u32,
        /// The crop window.
        crop: crate::Window,
    },
    /// The sums do not fit in memory.
    #[error("a film of {pixels} pixels needs {bytes} bytes, which cannot be had")]
    Memory {
        /// Pixels asked for.
        pixels: u64,
        /// Bytes asked for.
        bytes: u64,
    },
    /// Raw sums of another number of pixels.
    #[error("{found} sums given: expected {expected} (three a pixel)")]
    Length {
        /// Sums given.
        found: usize,
        /// Sums of this film.
        expected: usize,
    },
    /// Two films that do not lie on each other.
    #[error("films differ in {0}: they cannot be merged")]
    Mismatch(&'static str),
}
