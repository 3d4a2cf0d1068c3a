use std::fs::File;
use std::io::{self, Read};
use std::ops::Range;
use std::path::Path;

use kaustik_scene::Scene;

use super::{BYTE_ORDER, CHECKSUM, Header, MAGIC, PREFIX, Reader, Source, StateError, VERSION};
use crate::RenderSettings;

/// Opens a file, and says how long it is.
fn open(path: &Path) -> io::Result<(File, u64)> {
    // Asked before it is opened: opening a pipe would wait for its other end.
    let metadata = std::fs::metadata(path)?;
    if !metadata.is_file() {
        return Err(io::Error::other("it is no regular file"));
    }
    Ok((File::open(path)?, metadata.len()))
}

/// The first bytes, which only a state has.
fn read_magic(file: &mut File) -> Result<[u8; MAGIC.len()], StateError> {
    let mut magic = [0; MAGIC.len()];
    let read = file.read_exact(&mut magic);
    match read {
        Ok(()) if magic == MAGIC => Ok(magic),
        Err(error) if error.kind() != io::ErrorKind::UnexpectedEof => Err(failed(&error)),
        _ => Err(StateError::Foreign),
    }
}

/// All of a file that begins as a state does; nothing else is read to its end.
fn read_state(path: &Path) -> Result<Vec<u8>, StateError> {
    let (mut file, length) = open(path).map_err(|error| failed(&error))?;
    let magic = read_magic(&mut file)?;
    let mut bytes = Vec::new();
    let room = usize::try_from(length).is_ok_and(|length| bytes.try_reserve_exact(length).is_ok());
    if !room {
        return Err(failed(&io::ErrorKind::OutOfMemory.into()));
    }
    bytes.extend(magic);
    file.take(length.saturating_sub(magic.len() as u64))
        .read_to_end(&mut bytes)
        .map_err(|error| failed(&error))?;
    Ok(bytes)
}

fn failed(error: &io::Error) -> StateError {
    StateError::Read(error.to_string())
}

/// A state file that was read and found whole. What is in it is understood when a render takes it up.
#[derive(Clone, PartialEq)]
pub struct State {
    header: Header,
    /// All sections after the header.
    body: Vec<u8>,
}

impl State {
    /// Does this file begin as a state does? `false` also where it cannot be read.
    pub fn is_at(path: &Path) -> bool {
        open(path).is_ok_and(|(mut file, _)| read_magic(&mut file).is_ok())
    }

    /// Reads a state file.
    ///
    /// # Errors
    /// A file that cannot be read, of another format, or damaged.
    pub fn read(path: &Path) -> Result<Self, StateError> {
        Self::from_bytes(read_state(path)?)
    }

    /// As [`read`](Self::read), of bytes.
    ///
    /// # Errors
    /// Bytes of another format, or damaged ones.
    pub fn from_bytes(mut bytes: Vec<u8>) -> Result<Self, StateError> {
        if !bytes.starts_with(&MAGIC) {
            return Err(StateError::Foreign);
        }
        let short = || StateError::damaged("it ends too early");
        let word = |at: usize| -> Result<[u8; 4], StateError> {
            let word = bytes.get(at..at + 4).ok_or_else(short)?;
            word.try_into().map_err(|_| short())
        };
        let (version, order) = (word(8)?, word(12)?);
        if u32::from_be_bytes(order) == BYTE_ORDER {
            return Err(StateError::ByteOrder);
        }
        let found = u32::from_le_bytes(version);
        if found != VERSION {
            return Err(StateError::Version {
                found,
                expected: VERSION,
            });
        }
        let end = bytes.len().checked_sub(CHECKSUM).ok_or_else(short)?;
        if end < PREFIX {
            return Err(short());
        }
        if blake3::hash(&bytes[..end]) != bytes[end..] {
            return Err(StateError::damaged(
                "its checksum is not that of its content",
            ));
        }
        if order != BYTE_ORDER.to_le_bytes() {
            return Err(StateError::ByteOrder);
        }
        let mut reader = Reader::new(&bytes[PREFIX..end], 0..0, true);
        let header: Header = reader.value()?;
        header.fits(bytes.len())?;
        let left = reader.left();
        bytes.truncate(end);
        bytes.drain(..end - left);
        Ok(Self {
            header,
            body: bytes,
        })
    }

    /// Where its scene came from.
    pub fn source(&self) -> &Source {
        &self.header.source
    }

    /// The settings that it was made with, but for the budget, the threads and the layers.
    ///
    /// # Errors
    /// Settings that this program does not have.
    pub fn settings(&self) -> Result<RenderSettings, StateError> {
        self.header.settings()
    }

    /// The seed that it was made with.
    pub fn seed(&self) -> u64 {
        self.header.seed()
    }

    /// The ladders that are in it.
    pub fn ladders(&self) -> Range<u32> {
        self.header.ladders()
    }

    /// Time that sampling took, in seconds.
    pub fn seconds(&self) -> f64 {
        self.header.seconds()
    }

    pub(crate) fn header(&self) -> &Header {
        &self.header
    }

    /// Refuses a state that this render cannot go on from.
    pub(crate) fn check(&self, scene: &Scene, settings: &RenderSettings) -> Result<(), StateError> {
        self.header.same_share(&Header::new(scene, settings, 0.0))
    }

    pub(super) fn reader(&self, first: bool) -> Reader<'_> {
        Reader::new(&self.body, self.ladders(), first)
    }
}

impl std::fmt::Debug for State {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("State")
            .field("header", &self.header)
            .field("bytes", &self.body.len())
            .finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_state_file_is_not_read() {
        let kept = tempfile::NamedTempFile::new().expect("a file");
        for (bytes, expected) in [
            (&b"kau"[..], StateError::Foreign),
            (&[b'x'; 64], StateError::Foreign),
        ] {
            std::fs::write(kept.path(), bytes).expect("a file");
            assert_eq!(State::read(kept.path()).err(), Some(expected));
        }
        std::fs::write(kept.path(), MAGIC).expect("a file");
        assert!(State::is_at(kept.path()));
        assert!(matches!(
            State::read(kept.path()),
            Err(StateError::Damaged(_))
        ));
        let folder = kept.path().parent().expect("a folder");
        for path in [folder, Path::new("/dev/zero")] {
            assert!(!State::is_at(path));
            assert!(matches!(State::read(path), Err(StateError::Read(_))));
        }
    }
}
