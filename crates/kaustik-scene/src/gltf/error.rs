use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// What went wrong while loading, for callers that decide by it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A file could not be opened or read.
    Io,
    /// The bytes are not a glTF container or not JSON.
    Syntax,
    /// A value is missing, or of the wrong type or range.
    Value,
    /// Something refers to what is not there: an index, a byte range.
    Reference,
    /// The node hierarchy is no forest, or too deep.
    Hierarchy,
    /// A number that must be finite is not.
    NotFinite,
    /// A path would leave the scene's folder or is no plain file.
    Forbidden,
    /// More memory or more instances than the options allow.
    Budget,
    /// An image did not decode.
    Image,
    /// A compressed buffer view did not decode.
    Compressed,
    /// A required extension that this loader lacks.
    Extension,
    /// Something of ours (`extras.kaustik`) that this renderer cannot show, and that must not be left out in silence.
    Unsupported,
    /// The options ask for a material variant that the file has not.
    Variant,
}

/// Why a file was refused: which file, where in it, what was found, what was expected, and
/// where it helps, what to do.
///
/// All loading errors have this one shape, so that every message reads alike:
/// `scene.glb: /accessors/3/count: found -1, expected a non-negative integer`. The place is a
/// JSON pointer (RFC 6901) wherever the JSON has parsed, `line 3, column 7` where it has not,
/// and `byte 12` within the binary container.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub struct LoadError(Box<Report>);

#[derive(Debug)]
struct Report {
    kind: ErrorKind,
    file: PathBuf,
    place: String,
    found: String,
    expected: String,
    help: Option<String>,
    source: Option<io::Error>,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.file.display())?;
        if !self.place.is_empty() {
            write!(f, "{}: ", self.place)?;
        }
        write!(f, "found {}, expected {}", self.found, self.expected)?;
        if let Some(help) = &self.help {
            write!(f, "; {help}")?;
        }
        Ok(())
    }
}

impl std::error::Error for Report {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.source.as_ref().map(|e| e as _)
    }
}

impl LoadError {
    pub(super) fn new(
        kind: ErrorKind,
        place: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self(Box::new(Report {
            kind,
            file: PathBuf::new(),
            place: place.into(),
            found: found.into(),
            expected: expected.into(),
            help: None,
            source: None,
        }))
    }

    /// A file that could not be read.
    pub(super) fn io(place: impl Into<String>, expected: &str, source: io::Error) -> Self {
        let mut error = Self::new(ErrorKind::Io, place, source.to_string(), expected);
        error.0.source = Some(source);
        error
    }

    pub(super) fn help(mut self, help: impl Into<String>) -> Self {
        self.0.help = Some(help.into());
        self
    }

    /// Names the file; the first name given stays.
    pub(super) fn in_file(mut self, file: &Path) -> Self {
        if self.0.file.as_os_str().is_empty() {
            self.0.file = file.to_owned();
        }
        self
    }

    /// What went wrong.
    pub fn kind(&self) -> ErrorKind {
        self.0.kind
    }

    /// The scene file as it was named by the caller.
    pub fn file(&self) -> &Path {
        &self.0.file
    }

    /// Where in the file: a JSON pointer, a line and column, or a byte; empty for the whole.
    pub fn place(&self) -> &str {
        &self.0.place
    }

    /// What stands there, shortened.
    pub fn found(&self) -> &str {
        &self.0.found
    }

    /// What should stand there.
    pub fn expected(&self) -> &str {
        &self.0.expected
    }
}
