//! Measured and standardised numbers; their sources and terms stand in `LICENSES.md`.

pub(crate) mod cie_1931;
pub(crate) mod cornell;
#[expect(
    clippy::excessive_precision,
    reason = "digits as published, rounded by the compiler"
)]
pub(crate) mod glasses;
pub(crate) mod illuminants;
pub(crate) mod metals;
pub(crate) mod water;
