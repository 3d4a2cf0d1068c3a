use super::warning::Warnings;
use super::{ErrorKind, LoadError};

/// The parts of a scene file: JSON text, and the binary chunk of a GLB.
#[derive(Clone, Copy, Debug)]
pub(super) struct Container<'a> {
    pub(super) json: &'a [u8],
    pub(super) binary: Option<&'a [u8]>,
}

const MAGIC: &[u8] = b"glTF";
const JSON: u32 = u32::from_le_bytes(*b"JSON");
const BIN: u32 = u32::from_le_bytes(*b"BIN\0");

impl<'a> Container<'a> {
    /// Tells a GLB by its first four bytes; everything else is taken as JSON text.
    pub(super) fn split(bytes: &'a [u8], warnings: &mut Warnings) -> Result<Self, LoadError> {
        if !bytes.starts_with(MAGIC) {
            return Ok(Self {
                json: bytes,
                binary: None,
            });
        }
        let version = word(bytes, 4)?;
        if version != 2 {
            let found = format!("version {version}");
            return Err(wrong(4, found, "version 2 of the GLB container"));
        }
        let length = word(bytes, 8)? as usize;
        if length > bytes.len() || length < 12 {
            let expected = format!("at most {} bytes, as the file has no more", bytes.len());
            return Err(wrong(8, format!("a length of {length} bytes"), expected)
                .help("the file may be incomplete"));
        }
        if length < bytes.len() {
            let extra = bytes.len() - length;
            warnings.push("", format!("{extra} bytes after the end are ignored"));
        }
        Self::chunks(&bytes[..length])
    }

    fn chunks(bytes: &'a [u8]) -> Result<Self, LoadError> {
        let (mut at, mut json, mut binary) = (12, None, None);
        while at < bytes.len() {
            let length = word(bytes, at)? as usize;
            let kind = word(bytes, at + 4)?;
            let start = at + 8;
            let end = start.checked_add(length).filter(|&e| e <= bytes.len());
            let Some(end) = end else {
                let expected = format!("at most the {} that are left", bytes.len() - start);
                return Err(wrong(at, format!("a chunk of {length} bytes"), expected));
            };
            match (kind, json) {
                (JSON, None) => json = Some(&bytes[start..end]),
                (_, None) => {
                    let found = format!("a chunk of type {kind:#010x}");
                    return Err(wrong(at + 4, found, "the JSON chunk first"));
                }
                (BIN, Some(_)) if binary.is_none() => binary = Some(&bytes[start..end]),
                _ => {} // unknown chunks are to be ignored (glTF 2.0, 4.4)
            }
            at = end;
        }
        let json = json.ok_or_else(|| wrong(12, "the end of the file", "a JSON chunk"))?;
        Ok(Self { json, binary })
    }
}

/// The little-endian word at byte `at`.
fn word(bytes: &[u8], at: usize) -> Result<u32, LoadError> {
    let word = bytes.get(at..at + 4).and_then(|w| w.try_into().ok());
    let word = word.map(u32::from_le_bytes);
    word.ok_or_else(|| {
        wrong(at, "the end of the file", "4 more bytes").help("the file may be incomplete")
    })
}

fn wrong(at: usize, found: impl Into<String>, expected: impl Into<String>) -> LoadError {
    LoadError::new(ErrorKind::Syntax, format!("byte {at}"), found, expected)
}
