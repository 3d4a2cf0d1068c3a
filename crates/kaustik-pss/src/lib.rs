//! What a primary sample is.
//!
//! A path builder turns random numbers into light paths. If it takes those numbers from
//! a point of the unit cube instead of a generator, a path becomes a *function* of that
//! point, and anything that can walk on a unit cube can walk on light paths: plain Monte
//! Carlo, Metropolis sampling, replica exchange. This crate is that seam and nothing
//! else. Builders read [`Coordinates`]; chains and generators implement them; neither
//! needs to know the other.
//!
//! ```
//! use kaustik_pss::{Coordinates, Cursor, Recorded, Stream};
//!
//! // A "path": a random walk whose length is decided by its own coordinates.
//! fn build(u: &mut dyn Coordinates) -> f64 {
//!     let wavelength = u.get(Stream::Wavelength, 0);
//!     let mut walk = Cursor::new(u, Stream::Camera);
//!     let mut distance = wavelength;
//!     while walk.next() < 0.5 {
//!         let [x, y] = walk.next2();
//!         distance += x * y;
//!     }
//!     distance
//! }
//!
//! let mut point: Recorded = [
//!     (Stream::Wavelength, 0, 0.25),
//!     (Stream::Camera, 0, 0.3), // go on
//!     (Stream::Camera, 1, 0.5),
//!     (Stream::Camera, 2, 0.5),
//!     (Stream::Camera, 3, 0.9), // stop
//! ]
//! .into_iter()
//! .collect();
//! assert_eq!(build(&mut point), 0.5);
//! assert!(point.missing().is_none());
//! ```
//!
//! # Why random access
//!
//! A chain perturbs a point and hopes that the path changes little. If coordinates were
//! handed out in the order of the asks, a walk that became one bounce longer would give
//! all later choices other numbers, and a small step would be a leap. So a coordinate
//! has an address: a [`Stream`], which says what it is for, and an index within it.
//! What is skipped shifts nothing (Kelemen et al. 2002, section 2). Builders keep a
//! fixed stride of indices per bounce and never loop over coordinates until one fits.
//!
//! # Contract of a builder
//!
//! * Everything random about the path comes from the coordinates.
//! * Coordinates are asked for by address; the same address means the same decision.
//! * Each address is asked for at most once an evaluation, so that plain Monte Carlo
//!   can hand out fresh numbers without remembering any.
//! * Indices stay small (a stride times a depth): chains keep them in dense arrays.

mod coordinates;
mod cursor;
mod recorded;
mod stream;

pub use coordinates::Coordinates;
pub use cursor::Cursor;
pub use recorded::{Recorded, Recording};
pub use stream::Stream;
