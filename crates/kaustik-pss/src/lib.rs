//! Primary samples: the coordinates of the unit cube that a path is made from.

mod coordinates;
mod stream;

pub use coordinates::Coordinates;
pub use stream::Stream;
