//! What can be wrong with a spectrum that somebody else wrote.

/// Why a table or a formula from outside was not accepted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpectrumError {
    /// A table without knots.
    #[error("a spectrum needs at least one knot [nm, value]")]
    NoKnots,
    /// More knots than a table may have.
    #[error("a spectrum may have at most {most} knots, not {given}")]
    TooManyKnots {
        /// Knots given.
        given: usize,
        /// Knots allowed.
        most: usize,
    },
    /// A wavelength or a value that is infinite or not a number.
    #[error("knot {index} of the spectrum is not finite: [{nm}, {value}]")]
    NotFinite {
        /// Position of the knot, from 0.
        index: usize,
        /// Its wavelength.
        nm: f32,
        /// Its value.
        value: f32,
    },
    /// A wavelength that does not exceed the one before.
    #[error(
        "knot {index} of the spectrum, {nm} nm, must lie above {before} nm, the knot before it"
    )]
    NotSorted {
        /// Position of the knot, from 0.
        index: usize,
        /// Its wavelength.
        nm: f32,
        /// The wavelength before.
        before: f32,
    },
    /// A value below zero.
    #[error("knot {index} of the spectrum is negative: {value} at {nm} nm")]
    Negative {
        /// Position of the knot, from 0.
        index: usize,
        /// Its wavelength.
        nm: f32,
        /// Its value.
        value: f32,
    },
    /// A dispersion formula with more or fewer terms than allowed, or unequal numbers of B and C.
    #[error("a Sellmeier formula takes 1 to {most} pairs, not {b} B and {c} C")]
    SellmeierTerms {
        /// Numbers of B given.
        b: usize,
        /// Numbers of C given.
        c: usize,
        /// Pairs allowed.
        most: usize,
    },
    /// An index of refraction that is not a finite number of at least 0.1 in the visible range.
    #[error("the index of refraction is {ior} at {nm} nm; it must be finite and at least 0.1")]
    Ior {
        /// The offending index.
        ior: f32,
        /// Where.
        nm: f32,
    },
    /// An Abbe number that is not positive.
    #[error("the Abbe number must be positive, not {0}")]
    Abbe(f32),
}
