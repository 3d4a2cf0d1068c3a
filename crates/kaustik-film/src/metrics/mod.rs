//! How far one picture is from another.
//!
//! A reference is itself rendered and has noise of its own. Given as two independent halves A and B, that
//! noise cancels: the expectation of (x - A)(x - B) is the squared error of x alone, because the errors
//! of A and B are independent and have mean zero; (x - r)^2 with r = (A + B)/2 would add the variance of
//! r. All measures take either one reference or two halves.
//!
//! Against fireflies, every measure is given twice: over all pixels, and without the 0.1 % of them whose
//! relative squared error is largest.
//!
//! Pixels that are not finite in the image or in the reference are counted and left out of everything.

mod colour;
mod compare;
mod difference;
mod errors;
mod matched;
mod nsd;
mod reference;
mod spread;
mod tiles;

pub use compare::{CompareError, ImageReport, Report, compare};
pub use difference::difference;
pub use errors::{Errors, Measured, PixelShares, measure};
pub use matched::{brightness_factor, matched};
pub use nsd::{Nsd, nsd, nsd_beside, nsd_map};
pub use reference::Reference;
pub use spread::Spread;
pub use tiles::{Tile, tiles};
