//! Hero wavelengths, colour matching, illuminants, uplift, metals and glasses for
//! spectral rendering.

mod spectrum;

pub use spectrum::Spectrum;
