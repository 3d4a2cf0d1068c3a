use std::fmt;

/// Why the command cannot do what was asked.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The input or the words are wrong: status 2.
    Input(String),
    /// Anything else: status 1.
    Other(String),
}

impl Failure {
    /// Wrong input or words.
    pub(crate) fn input(error: impl fmt::Display) -> Self {
        Self::Input(error.to_string())
    }

    /// As [`input`](Self::input), with what is behind it: the reason why a file cannot be read.
    pub(crate) fn input_by(error: &dyn std::error::Error) -> Self {
        let causes = std::iter::successors(error.source(), |cause| cause.source());
        let causes: String = causes.map(|cause| format!(": {cause}")).collect();
        Self::Input(format!("{error}{causes}"))
    }

    /// Anything else.
    pub(crate) fn other(error: impl fmt::Display) -> Self {
        Self::Other(error.to_string())
    }

    /// The same, told of a part of the work.
    pub(crate) fn within(self, what: &str) -> Self {
        match self {
            Self::Input(message) => Self::Input(format!("{what}: {message}")),
            Self::Other(message) => Self::Other(format!("{what}: {message}")),
        }
    }

    pub(crate) fn status(&self) -> u8 {
        match self {
            Self::Input(_) => 2,
            Self::Other(_) => 1,
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(message) | Self::Other(message) => f.write_str(message),
        }
    }
}
