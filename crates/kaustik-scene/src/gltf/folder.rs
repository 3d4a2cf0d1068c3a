use std::collections::HashMap;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::budget::Budget;
use super::json::{Cursor, shorten};
use super::uri::Uri;
use super::{ErrorKind, LoadError};

/// The folder of a scene file: the only place that the file's uris may name.
#[derive(Debug)]
pub(super) struct Folder {
    /// Without symbolic links; `None` for a scene that came from memory.
    root: Option<PathBuf>,
    /// Each file is read once, however often it is named.
    read: HashMap<PathBuf, Arc<Vec<u8>>>,
}

impl Folder {
    /// The folder that holds the file `scene`.
    pub(super) fn of(scene: &Path) -> Result<Self, LoadError> {
        let parent = match scene.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        let root = parent.canonicalize();
        let root = root.map_err(|e| LoadError::io("", "the folder of a scene file", e))?;
        Ok(Self {
            root: Some(root),
            read: HashMap::new(),
        })
    }

    /// No folder: only data uris can be read.
    pub(super) fn none() -> Self {
        Self {
            root: None,
            read: HashMap::new(),
        }
    }

    /// The files that were read so far, in alphabetical order.
    pub(super) fn files(&self) -> Vec<PathBuf> {
        let mut files: Vec<PathBuf> = self.read.keys().cloned().collect();
        files.sort();
        files
    }

    /// The bytes that the uri at `place` stands for.
    pub(super) fn fetch(
        &mut self,
        place: &Cursor<'_>,
        budget: &mut Budget,
    ) -> Result<Arc<Vec<u8>>, LoadError> {
        budget.take(&place.pointer(), place.string()?.len() as u64)?;
        match Uri::read(place)? {
            Uri::Data(bytes) => Ok(Arc::new(bytes)),
            Uri::Relative(path) => self.open(place, &path, budget),
        }
    }

    fn open(
        &mut self,
        place: &Cursor<'_>,
        relative: &str,
        budget: &mut Budget,
    ) -> Result<Arc<Vec<u8>>, LoadError> {
        let Some(root) = &self.root else {
            return Err(place
                .mismatch("a data uri or a buffer view")
                .help("a scene that is read from memory has no folder to look into"));
        };
        let expected = "a readable file in the folder of the scene";
        let failed = |e: io::Error| {
            let found = format!("\"{}\": {e}", shorten(relative));
            LoadError::io(place.pointer(), expected, io::Error::new(e.kind(), found))
        };
        let path = find(root, relative).map_err(failed)?;
        if !path.starts_with(root) {
            let found = format!("\"{}\", a link out of the folder", shorten(relative));
            let expected = "a file inside the folder of the scene file";
            return Err(place.error(ErrorKind::Forbidden, found, expected));
        }
        if let Some(bytes) = self.read.get(&path) {
            return Ok(Arc::clone(bytes));
        }
        let bytes = Arc::new(read_file(&path, &place.pointer(), budget, failed)?);
        self.read.insert(path, Arc::clone(&bytes));
        Ok(bytes)
    }
}

/// The file that a relative path leads to. Some exporters part folders by a backslash, which is part of a name elsewhere than on
/// Windows: that is tried where there is no such name.
fn find(root: &Path, relative: &str) -> io::Result<PathBuf> {
    let found = root.join(relative).canonicalize();
    match found {
        Err(_) if relative.contains('\\') => {
            let parted = relative.replace('\\', "/");
            root.join(parted).canonicalize().or(found)
        }
        found => found,
    }
}

/// Reads a regular file whole. Devices and pipes, which may never end, are refused before
/// they are opened.
pub(super) fn read_file(
    path: &Path,
    place: &str,
    budget: &mut Budget,
    failed: impl Fn(io::Error) -> LoadError,
) -> Result<Vec<u8>, LoadError> {
    let metadata = fs::metadata(path).map_err(&failed)?;
    if !metadata.is_file() {
        let found = if metadata.is_dir() {
            "a folder"
        } else {
            "a device, pipe or socket"
        };
        return Err(LoadError::new(
            ErrorKind::Forbidden,
            place,
            found,
            "a regular file",
        ));
    }
    let length = metadata.len();
    budget.file(place, length)?;
    let mut bytes = Vec::with_capacity(length as usize);
    let file = File::open(path).map_err(&failed)?;
    // a file that grows while it is read must not outgrow the budget
    let got = file.take(length).read_to_end(&mut bytes).map_err(&failed)?;
    if got as u64 != length {
        let found = format!("{got} bytes");
        let expected = format!("{length} bytes, as the folder says");
        return Err(LoadError::new(ErrorKind::Io, place, found, expected));
    }
    Ok(bytes)
}
