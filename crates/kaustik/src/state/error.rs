/// A state file that cannot be read, or must not be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StateError {
    /// The system says no.
    #[error("it cannot be read: {0}")]
    Read(String),
    /// Another kind of file.
    #[error("this is no state file: it does not begin as one")]
    Foreign,
    /// A format of another version of the program.
    #[error("the state file has format {found}, this program reads only format {expected}")]
    Version {
        /// The file's.
        found: u32,
        /// This program's.
        expected: u32,
    },
    /// Numbers are stored the other way round.
    #[error("the numbers of the state file are in another byte order")]
    ByteOrder,
    /// What stands there is not what was written.
    #[error("the state file is damaged: {0}")]
    Damaged(String),
    /// The state of another picture: what differs, with both values.
    #[error("the state is that of another render: {0}")]
    Other(String),
    /// States that are no shares of one render.
    #[error("the states do not add up: {0}")]
    Shares(String),
}

impl StateError {
    pub(crate) fn damaged(what: impl Into<String>) -> Self {
        Self::Damaged(what.into())
    }

    /// Bands of an image whose samples cannot be weighed against each other.
    pub(crate) fn passes() -> Self {
        let what = "their ladders have taken different numbers of passes over the image";
        Self::Shares(what.to_owned())
    }

    /// A pilot that found another number than it did for the state.
    pub(crate) fn pilot(state: f64, here: f64) -> Self {
        Self::Other(format!(
            "the pilot found {state:e} for the state, {here:e} here: this program computes other numbers"
        ))
    }
}
