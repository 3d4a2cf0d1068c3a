//! Hero wavelengths, colour matching, illuminants, uplift, metals and glasses for
//! spectral rendering.
//!
//! A path carries [`Wavelengths`] (four, spread over the visible range by one random number) and
//! a [`Spectrum`] of values at them. Everything that has a colour answers `eval(&Wavelengths)`:
//! reflectances uplifted from RGB ([`Sigmoid`]), emission uplifted against D65
//! ([`EmissionSpectrum`]), tables ([`Tabulated`]), [`Illuminant`]s, [`Metal`]s and [`Glass`]es. At
//! the end of a path [`Wavelengths::to_xyz`] turns values into an unbiased estimate of [`Xyz`].
//!
//! One normalisation holds throughout: the spectrum that is 1 everywhere has Y = 1, and D65
//! scaled to Y = 1 is linear Rec.709 white, `Rgb([1.0; 3])`.
//!
//! ```
//! use kaustik_spectrum::{Rgb, WavelengthSampling, Wavelengths, Xyz, uplift_emission, uplift_reflectance};
//!
//! let lamp = uplift_emission([1.0, 1.0, 1.0]);
//! let paint = uplift_reflectance([0.6, 0.3, 0.1]);
//! let mut sum = Xyz::default();
//! for i in 0..1000 {
//!     let w = Wavelengths::sample((f64::from(i) + 0.5) / 1000.0, WavelengthSampling::Hero);
//!     sum += w.to_xyz(lamp.eval(&w) * paint.eval(&w)) * 1e-3;
//! }
//! let Rgb([r, g, b]) = sum.into();
//! assert!((r - 0.6).abs() < 2e-3 && (g - 0.3).abs() < 2e-3 && (b - 0.1).abs() < 2e-3);
//! ```

mod cmf;
mod data;
mod emission;
mod error;
mod glass;
mod guide;
mod illuminant;
mod metal;
mod rgb;
mod sigmoid;
mod spectrum;
mod tabulated;
mod uplift;
mod water;
mod wavelengths;
mod xyz;

pub use cmf::{NM_MAX, NM_MIN, Y_INTEGRAL, cie_1931, integrate_xyz};
pub use emission::{EmissionSpectrum, uplift_emission};
pub use error::SpectrumError;
pub use glass::Glass;
pub use illuminant::Illuminant;
pub use metal::Metal;
pub use rgb::{Rgb, linear_to_srgb, srgb_to_linear};
pub use sigmoid::Sigmoid;
pub use spectrum::Spectrum;
pub use tabulated::Tabulated;
pub use uplift::{solve_reflectance, uplift_reflectance};
pub use water::water_absorption;
pub use wavelengths::{WavelengthSampling, Wavelengths};
pub use xyz::Xyz;
