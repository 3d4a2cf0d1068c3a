use std::io;
use std::path::Path;

use kaustik_film::{WriteError, write_file};

use super::{Header, Keep, Source, State, StateError, Writer};

/// The state of a render at work, to be written down.
pub struct Snapshot<'a> {
    header: Header,
    keep: &'a dyn Keep,
}

impl<'a> Snapshot<'a> {
    pub(crate) fn new(header: Header, keep: &'a dyn Keep) -> Self {
        Self { header, keep }
    }

    /// Writes a state file: all of it or nothing. It is written beside its place, synced and renamed, and the folder is
    /// synced: whatever happens, the file of this name is the last good one.
    ///
    /// # Errors
    /// What stands in the way; an older file is then as it was.
    pub fn write(&self, path: &Path, source: &Source) -> Result<(), WriteError> {
        write_file(path, |mut file| self.encode(&mut file, source))
    }

    /// The bytes of a state file.
    ///
    /// # Errors
    /// What cannot be encoded.
    pub fn bytes(&self, source: &Source) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.encode(&mut bytes, source)?;
        Ok(bytes)
    }

    /// In memory, as if it had been written and read.
    pub(crate) fn state(&self) -> Result<State, StateError> {
        let bytes = self.bytes(&Source::default());
        State::from_bytes(bytes.map_err(|error| StateError::Read(error.to_string()))?)
    }

    fn encode(&self, out: &mut dyn io::Write, source: &Source) -> io::Result<()> {
        let mut writer = Writer::new(out)?;
        writer.value(&self.header.with(source))?;
        self.keep.write(&mut writer)?;
        writer.finish()
    }
}

impl std::fmt::Debug for Snapshot<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Snapshot")
            .field("header", &self.header)
            .finish_non_exhaustive()
    }
}
