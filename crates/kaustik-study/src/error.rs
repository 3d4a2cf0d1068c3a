use std::path::PathBuf;

/// A study that cannot be read, rendered or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// The description is wrong: where, and what was expected.
    #[error("{place}: {message}")]
    Words {
        /// The file with line and column, or the part of the study.
        place: String,
        /// What is wrong.
        message: String,
    },
    /// A file that the system does not give or take.
    #[error("{}: {source}", .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A scene that cannot be loaded.
    #[error("scene {name}: {message}")]
    Scene {
        /// Its name in the study.
        name: String,
        /// What is wrong with it.
        message: String,
    },
    /// A render that failed.
    #[error("{what}: {source}")]
    Render {
        /// Which.
        what: String,
        /// Why.
        source: kaustik::RenderError,
    },
    /// A picture file that cannot be written.
    #[error(transparent)]
    Write(#[from] kaustik::film::WriteError),
    /// A picture that does not hold together.
    #[error(transparent)]
    Image(#[from] kaustik::film::ImageError),
    /// A chart or a page that cannot be made.
    #[error("{what}: {message}")]
    Page {
        /// Which.
        what: String,
        /// Why.
        message: String,
    },
    /// Stopped from outside: what is finished is kept.
    #[error("stopped; finished renders are kept, and the same command goes on from there")]
    Stopped,
}

impl StudyError {
    pub(crate) fn words(place: impl Into<String>, message: impl std::fmt::Display) -> Self {
        Self::Words {
            place: place.into(),
            message: message.to_string(),
        }
    }

    pub(crate) fn io(path: impl Into<PathBuf>, source: std::io::Error) -> Self {
        Self::Io {
            path: path.into(),
            source,
        }
    }

    pub(crate) fn page(what: &str, message: impl std::fmt::Display) -> Self {
        Self::Page {
            what: what.to_owned(),
            message: message.to_string(),
        }
    }
}
