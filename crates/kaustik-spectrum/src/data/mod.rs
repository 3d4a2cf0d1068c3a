//! Measured and standardised numbers; their sources and terms stand in `LICENSES.md`.

pub(crate) mod cie_1931;
pub(crate) mod cornell;
pub(crate) mod glasses;
pub(crate) mod illuminants;
pub(crate) mod metals;
pub(crate) mod water;
