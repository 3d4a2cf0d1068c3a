use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};

/// Tells two writers in one process apart.
static NEXT: AtomicU32 = AtomicU32::new(0);

/// Writes a file whole or not at all: beside its place, to the disk, then renamed.
pub(super) fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let name = path
        .file_name()
        .ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "no name of a file"))?;
    let number = NEXT.fetch_add(1, Ordering::Relaxed);
    let mut hidden = std::ffi::OsString::from(".");
    hidden.push(name);
    hidden.push(format!(".{}-{number}.tmp", std::process::id()));
    let beside = path.with_file_name(hidden);
    let result = fill(&beside, bytes).and_then(|()| fs::rename(&beside, path));
    match result {
        Ok(()) => sync_folder(path),
        Err(_) => {
            // the first error is the one to tell
            let _ = fs::remove_file(&beside);
        }
    }
    result
}

fn fill(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = File::create_new(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

/// Asks that the new name survives a power cut. Not all systems let a folder be opened; the
/// file itself is safe by now.
fn sync_folder(path: &Path) {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
    if let Ok(folder) = File::open(folder.unwrap_or(Path::new("."))) {
        let _ = folder.sync_all();
    }
}
