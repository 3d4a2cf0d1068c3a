//! Photon maps: measurement points seen from the camera, photons from the lights, and what brings them together.
//!
//! A camera walk goes on through mirrors, glass and narrow lobes to the first surface that scatters widely, and
//! leaves a [`MeasurementPoint`] there. Light walks leave [`Photon`]s wherever they scatter. A photon that lands
//! within a point's radius contributes to it (Gruson et al. 2016, "G", Eq. 2). Light that meets no such surface on its
//! way to the camera is the [`Remainder`].
//!
//! Both walks must carry the same wavelengths, so that these are given and not drawn.

mod camera;
mod crowd;
mod light;
mod lookup;
mod manner;
mod narrow;
mod nearby;
mod outline;
mod point;
mod points;
mod remainder;
mod sheet;

#[cfg(test)]
mod tests;

pub use camera::MeasurementWalk;
pub use light::{Photon, PhotonPath, PhotonTracing};
pub use lookup::Lookup;
pub use point::{Disc, MeasurementPoint};
pub use points::MeasurementPoints;
pub use remainder::Remainder;
pub use sheet::Sheet;
