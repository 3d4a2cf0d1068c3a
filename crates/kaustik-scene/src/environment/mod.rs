//! Light from infinitely far away, ready for look-ups and for importance sampling.
//!
//! A picture is read bilinearly, and directions are drawn from (almost) the very same bilinear
//! function: the density is positive wherever the radiance is, a bright texel makes no
//! fireflies at its border, and the map from the unit square is continuous, which a Markov chain in the
//! square needs. Colours are interpolated as linear Rec.709 and uplifted afterwards, once a
//! look-up.

mod cumulative;
mod distribution;
mod hdr;
mod map;

use glam::{DVec3, Quat};
use kaustik_bsdf::warp;
use kaustik_spectrum::{EmissionSpectrum, Spectrum, Wavelengths, uplift_emission};

pub use hdr::{DecodedHdr, MAX_HDR_BYTES, MAX_HDR_PIXELS, clean_radiance, decode_hdr, load_hdr};

use crate::description::EnvironmentDescription;
use crate::texture::TextureError;
use map::Map;

/// The largest radiance that an environment may hold; far from the end of f32, so that sums and
/// products of it stay finite.
pub const MAX_RADIANCE: f32 = 1e30;

/// An environment that cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EnvironmentError {
    /// The image does not hold what its size says.
    #[error(transparent)]
    Image(#[from] TextureError),
    /// Bytes where radiance is needed.
    #[error("environment image '{name}' holds 8-bit colours, expected linear float values")]
    NotFloat {
        /// The image's name.
        name: String,
    },
    /// A radiance that is negative, too large or not a number.
    #[error("environment: radiance {value} is out of range, expected 0 to {MAX_RADIANCE:e}")]
    Radiance {
        /// The value, strength included.
        value: f32,
    },
    /// A rotation that is not a unit quaternion.
    #[error("environment: the rotation {rotation} is not a unit quaternion")]
    Rotation {
        /// The quaternion.
        rotation: Quat,
    },
    /// A picture larger than the limits.
    #[error("{name}: {what} is {found}, the limit is {limit}")]
    TooLarge {
        /// The file's name.
        name: String,
        /// What is counted.
        what: &'static str,
        /// How many there are.
        found: u64,
        /// How many there may be.
        limit: u64,
    },
    /// A file that is not a Radiance picture.
    #[error("{name}: not a readable Radiance HDR picture")]
    Decode {
        /// The file's name.
        name: String,
        /// What the decoder says.
        source: image::ImageError,
    },
    /// A file that cannot be read.
    #[error("{name}: cannot be read")]
    Read {
        /// The file's name.
        name: String,
        /// What the system says.
        source: std::io::Error,
    },
}

/// Light from infinitely far away.
#[derive(Clone, Debug)]
pub struct Environment {
    kind: Kind,
    mean_rgb: [f32; 3],
}

#[derive(Clone, Debug)]
enum Kind {
    Constant(EmissionSpectrum),
    Map(Box<Map>),
}

impl Environment {
    /// Checks the values and, for a picture, sums them up for sampling: 4 bytes a texel on
    /// top of the shared image.
    pub fn new(description: &EnvironmentDescription) -> Result<Self, EnvironmentError> {
        match description {
            EnvironmentDescription::Constant(rgb) => {
                for &value in rgb {
                    check_radiance(value)?;
                }
                Ok(Self {
                    kind: Kind::Constant(uplift_emission(*rgb)),
                    mean_rgb: *rgb,
                })
            }
            EnvironmentDescription::Image {
                image,
                strength,
                rotation,
            } => {
                let map = Map::new(image.clone(), *strength, *rotation)?;
                let mean_rgb = map.mean_rgb();
                Ok(Self {
                    kind: Kind::Map(Box::new(map)),
                    mean_rgb,
                })
            }
        }
    }

    /// Radiance from `direction` (unit, away from the scene).
    #[must_use]
    pub fn radiance(&self, direction: DVec3, wavelengths: &Wavelengths) -> Spectrum {
        match &self.kind {
            Kind::Constant(emission) => emission.eval(wavelengths),
            Kind::Map(map) => uplift_emission(map.rgb(direction)).eval(wavelengths),
        }
    }

    /// Radiance from `direction` (unit) as linear Rec.709.
    #[must_use]
    pub fn rgb(&self, direction: DVec3) -> [f32; 3] {
        match &self.kind {
            Kind::Constant(_) => self.mean_rgb,
            Kind::Map(map) => map.rgb(direction),
        }
    }

    /// A unit direction away from the scene, for `u` in [0,1)^2, and its density per solid
    /// angle, > 0: about in proportion to the mean of red, green and blue. Continuous in `u`. A black
    /// environment is sampled uniformly.
    #[must_use]
    pub fn sample(&self, u: [f64; 2]) -> (DVec3, f64) {
        match &self.kind {
            Kind::Constant(_) => (warp::uniform_sphere(u), UNIFORM),
            Kind::Map(map) => map.sample(u).unwrap_or((warp::uniform_sphere(u), UNIFORM)),
        }
    }

    /// Density per solid angle with which [`sample`](Self::sample) draws `direction` (unit).
    #[must_use]
    pub fn pdf(&self, direction: DVec3) -> f64 {
        match &self.kind {
            Kind::Constant(_) => UNIFORM,
            Kind::Map(map) => map.pdf(direction).unwrap_or(UNIFORM),
        }
    }

    /// Mean radiance over the sphere, linear Rec.709.
    #[must_use]
    pub fn mean_rgb(&self) -> [f32; 3] {
        self.mean_rgb
    }

    /// Mean radiance over the sphere and over red, green and blue: for the choice among
    /// emitters. Times 4 pi^2 R^2 it is the flux through a sphere of radius R.
    #[must_use]
    pub fn mean_radiance(&self) -> f64 {
        self.mean_rgb.iter().map(|&c| f64::from(c)).sum::<f64>() / 3.0
    }
}

/// Density of a uniform direction.
const UNIFORM: f64 = 0.25 * std::f64::consts::FRAC_1_PI;

fn check_radiance(value: f32) -> Result<(), EnvironmentError> {
    if (0.0..=MAX_RADIANCE).contains(&value) {
        Ok(())
    } else {
        Err(EnvironmentError::Radiance { value })
    }
}

#[cfg(test)]
mod tests;
