//! What a coverage-guided run begins with, in a form that is easy to change.

use std::fs;
use std::io;
use std::path::Path;

use crate::kind::Kind;
use crate::model;
use crate::picture;

/// Between the text and the buffer of an [`assembled`] scene.
const BETWEEN: u8 = 0;

/// A scene file from a text and, after a zero byte, its buffer: a GLB whose lengths agree, so that a change
/// of the text is not refused for its length alone. What begins as a GLB already stays as it is.
pub fn assembled(parts: &[u8]) -> Vec<u8> {
    if parts.starts_with(b"glTF") {
        return parts.to_vec();
    }
    let end = parts.iter().position(|&byte| byte == BETWEEN);
    let (text, binary) = match end {
        Some(end) => (&parts[..end], &parts[end + 1..]),
        None => (parts, &[][..]),
    };
    model::joined(text, binary)
}

/// Writes a folder for each kind, with its sound files.
pub(crate) fn write(folder: &Path) -> io::Result<()> {
    for kind in Kind::CAMPAIGN {
        let folder = folder.join(kind.name());
        fs::create_dir_all(&folder)?;
        let files = match kind {
            Kind::Model => parts(),
            _ => picture::all(kind),
        };
        for (number, bytes) in files.iter().enumerate() {
            fs::write(folder.join(number.to_string()), bytes)?;
        }
    }
    Ok(())
}

/// All models, in parts.
fn parts() -> Vec<Vec<u8>> {
    let part = |model: model::Model| {
        let mut bytes = model.complete().to_string().into_bytes();
        bytes.push(BETWEEN);
        bytes.extend(&model.binary);
        bytes
    };
    model::all().into_iter().map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A run that begins with refusals alone would learn slowly.
    #[test]
    fn seeds_become_pictures() {
        let folder = tempfile::tempdir().expect("a folder");
        write(folder.path()).expect("written");
        for kind in Kind::CAMPAIGN {
            let files = fs::read_dir(folder.path().join(kind.name())).expect("a folder");
            let mut count = 0;
            for file in files {
                let path = file.expect("an entry").path();
                if kind == Kind::Model {
                    let bytes = fs::read(&path).expect("bytes");
                    fs::write(&path, assembled(&bytes)).expect("written");
                }
                assert_eq!(crate::verdict(kind, &path), Ok(()), "{}", path.display());
                count += 1;
            }
            assert!(count >= 3, "{kind}: {count}");
        }
    }
}
