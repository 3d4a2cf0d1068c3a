/// Why a scene could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The format holds no such thing.
    #[error("{place}: found {found}, expected {expected}")]
    Unsupported {
        /// Which part of the description.
        place: String,
        /// What it is.
        found: String,
        /// What glTF can hold.
        expected: String,
    },
    /// Loading the file again would not give the same description.
    #[error("the scene would not come back as it is: {0}")]
    Unfaithful(String),
}
