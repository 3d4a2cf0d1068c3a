use kaustik_film::{DevelopError, FilmError, ImageError};
use kaustik_mcmc::StartError;

use crate::{Method, StateError};

/// A render that cannot begin or end.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// A film that cannot be made.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// A film that cannot be developed.
    #[error(transparent)]
    Develop(#[from] DevelopError),
    /// A layer that cannot be added.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// A chain that cannot start: evaluation is not a function of its coordinates.
    #[error("a chain cannot start: {0}")]
    Start(#[from] StartError),
    /// No threads.
    #[error("the threads cannot be started: {0}")]
    Threads(String),
    /// A state that cannot be taken up, or is not kept.
    #[error(transparent)]
    State(#[from] StateError),
    /// More pixels than there is memory for.
    #[error(
        "{pixels} pixels by {method} need about {bytes} bytes, which cannot be had: expected fewer, or one crop window at a time"
    )]
    Memory {
        /// The method.
        method: Method,
        /// Pixels of the crop window.
        pixels: u64,
        /// Bytes that they would take.
        bytes: u64,
    },
    /// A setting out of range.
    #[error("{what} is {found}, expected {expected}")]
    Setting {
        /// Which setting.
        what: &'static str,
        /// Its value.
        found: String,
        /// The range in words.
        expected: String,
    },
}
