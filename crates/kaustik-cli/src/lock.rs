//! Two processes do not write one file: each output has a lock beside it.
//!
//! The lock is the system's, on a file `.NAME.lock` that holds the process id: it ends with its process, however that
//! ends, and a file that was left behind is held by nobody. Folders on other machines whose system keeps no locks
//! go without.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::Failure;

/// The locks of one command; given back when it ends.
#[derive(Debug, Default)]
pub(crate) struct Locks(Vec<Lock>);

/// One of them, and the file to be removed.
#[derive(Debug)]
struct Lock {
    path: PathBuf,
    /// Its lock ends when it is closed.
    _file: File,
}

/// Whoever takes a lock writes its id at once; a reader that comes between waits so often, so long.
const LOOKS: u32 = 20;
const BETWEEN: Duration = Duration::from_millis(5);

impl Locks {
    /// Locks all of these outputs, or none.
    pub(crate) fn take<'a>(paths: impl Iterator<Item = &'a PathBuf>) -> Result<Self, Failure> {
        let mut locks = Self::default();
        for path in paths {
            if let Some(beside) = beside(path) {
                if locks.0.iter().any(|lock| lock.path == beside) {
                    return Err(Failure::Input(format!(
                        "{}: two outputs of this command: expected another name for each",
                        path.display()
                    )));
                }
                locks.0.extend(Lock::take(path, beside)?);
            }
        }
        Ok(locks)
    }

    /// What gives them back from elsewhere, for a process that ends right after it.
    pub(crate) fn release(&self) -> impl Fn() + Send + 'static {
        let paths: Vec<PathBuf> = self.0.iter().map(|lock| lock.path.clone()).collect();
        move || {
            for path in &paths {
                let _ = fs::remove_file(path);
            }
        }
    }
}

impl Lock {
    /// The lock of an output, at its place; `None` where the system has no locks.
    fn take(output: &Path, path: PathBuf) -> Result<Option<Self>, Failure> {
        loop {
            let file = OpenOptions::new()
                .read(true)
                .write(true)
                .create(true)
                .truncate(false)
                .open(&path)
                .map_err(|error| Failure::Input(format!("{}: {error}", path.display())))?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(held(output, &path, file)),
                Err(TryLockError::Error(_)) => return Ok(None),
            }
            // Another process may have given it back and removed it since it was opened: then this is the
            // lock of a file that is gone.
            if !is_at(&file, &path) {
                continue;
            }
            let mut lock = Self { path, _file: file };
            lock.sign();
            return Ok(Some(lock));
        }
    }

    /// Writes who holds it. For messages alone: it holds without.
    fn sign(&mut self) {
        let file = &mut self._file;
        let _ = file
            .set_len(0)
            .and_then(|()| file.rewind())
            .and_then(|()| writeln!(file, "{}", std::process::id()));
    }
}

impl Drop for Lock {
    /// Removed while it is still held: nobody else can have taken it.
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.path);
    }
}

/// The refusal, with the name of the process in the way.
fn held(output: &Path, path: &Path, mut file: File) -> Failure {
    let mut holder = None;
    for look in 0..LOOKS {
        if look > 0 {
            std::thread::sleep(BETWEEN);
        }
        let mut text = String::new();
        let _ = file.rewind();
        if file.read_to_string(&mut text).is_ok()
            && let Ok(id) = text.trim().parse::<u32>()
        {
            holder = Some(id);
            break;
        }
    }
    let output = output.display();
    Failure::Input(match holder {
        // Names that differ in their case alone, where that makes no difference.
        Some(id) if id == std::process::id() => {
            format!(
                "{output}: this command writes it already: expected another name for each output"
            )
        }
        Some(id) => format!(
            "{output}: process {id} is writing it (lock: {}); choose another name, or wait until it is done",
            path.display()
        ),
        None => format!(
            "{output}: another process is writing it (lock: {}); choose another name, or wait until it is done",
            path.display()
        ),
    })
}

/// Where the lock of an output is: beside the file that will be replaced, links followed. `None`: not a file.
fn beside(output: &Path) -> Option<PathBuf> {
    let real = match fs::metadata(output) {
        Ok(there) if !there.is_file() => return None,
        Ok(_) => fs::canonicalize(output).ok()?,
        Err(_) => {
            let folder = output
                .parent()
                .filter(|folder| !folder.as_os_str().is_empty());
            let folder = fs::canonicalize(folder.unwrap_or(Path::new("."))).ok()?;
            folder.join(output.file_name()?)
        }
    };
    let mut name = OsString::from(".");
    name.push(real.file_name()?);
    name.push(".lock");
    Some(real.with_file_name(name))
}

/// Is the open file the one that has this name?
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    match (file.metadata(), fs::metadata(path)) {
        (Ok(open), Ok(there)) => (open.dev(), open.ino()) == (there.dev(), there.ino()),
        _ => false,
    }
}

/// Open files cannot be removed here.
#[cfg(not(unix))]
fn is_at(_: &File, _: &Path) -> bool {
    true
}
