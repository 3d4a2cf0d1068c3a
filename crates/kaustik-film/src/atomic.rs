//! Files that appear whole or not at all.
//!
//! A render of hours must not be lost to a full disk half way through writing, nor an older picture be
//! destroyed by a failing newer one. So every file is written beside its destination, synced, and renamed
//! over it. What is not a regular file (a pipe, `/dev/null`) cannot be renamed over, and what the caller has open
//! (`/dev/stdout`) is not to be: it is written to directly, from memory.

use std::fs::{self, File, Metadata};
use std::io::{self, BufWriter, Cursor, ErrorKind, Seek, Write};
use std::path::{Path, PathBuf};

/// What an encoder writes into.
pub trait Sink: Write + Seek {}

impl<T: Write + Seek> Sink for T {}

/// A file that cannot be written. Each message says which file, what is wrong and what was expected.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The folder to write into is not there.
    #[error("{}: the folder {} does not exist: expected an existing folder", .path.display(), .folder.display())]
    NoFolder {
        /// The file asked for.
        path: PathBuf,
        /// Its folder.
        folder: PathBuf,
    },
    /// The path names a folder, or nothing.
    #[error("{}: not the name of a file: expected a path that ends in a file name", .0.display())]
    NotAFile(PathBuf),
    /// The folder does not let us create files, or the file stands and is read-only.
    #[error("{}: cannot be written ({reason}): expected a writable {kind}", .path.display())]
    NotWritable {
        /// The file or folder that refused.
        path: PathBuf,
        /// Whether it is a file or a folder.
        kind: &'static str,
        /// What the system says.
        reason: io::Error,
    },
    /// All was written, but could not take its name: it stays under another.
    #[error("{}: it could not take the place of what stands there ({source}): all of it is in {}", .path.display(), .kept.display())]
    NotRenamed {
        /// The file asked for.
        path: PathBuf,
        /// Where it is.
        kept: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Writing or syncing failed.
    #[error("{}: writing failed: {source}", .path.display())]
    Io {
        /// The file asked for.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The picture has no such file form.
    #[error("{}: {message}", .path.display())]
    Encode {
        /// The file asked for.
        path: PathBuf,
        /// What the encoder says.
        message: String,
    },
}

/// Finds out, before a long render, whether a file of this name could be written: the folder exists and
/// lets us create files, and the name is not taken by a folder or a read-only file. Nothing is left
/// behind and an existing file is not touched.
///
/// # Errors
/// What stands in the way.
pub fn check_writable(path: &Path) -> Result<(), WriteError> {
    let target = Target::find(path)?;
    if target.special {
        // Not opened: with a pipe that would wait for its reader.
        return Ok(());
    }
    temporary(&target).map(drop)
}

/// Writes a file by calling `write` with a buffered sink: all of it or nothing. The file is synced before
/// it takes its name, and the folder after it. A link is followed: the file that it names is replaced.
/// A new file gets the usual permissions (the umask applies), a replaced one keeps its own.
///
/// # Errors
/// What stands in the way (see [`check_writable`]), what the system says, or what `write` says; an
/// existing file is then as it was. Where no more than the name was refused, the new file stays under another.
pub fn write_file(
    path: &Path,
    write: impl FnOnce(&mut dyn Sink) -> io::Result<()>,
) -> Result<(), WriteError> {
    let target = Target::find(path)?;
    let failed = |source| WriteError::Io {
        path: path.to_owned(),
        source,
    };
    if target.special {
        let mut bytes = Cursor::new(Vec::new());
        write(&mut bytes).map_err(failed)?;
        return write_directly(&target.path, bytes.get_ref()).map_err(failed);
    }
    let mut temporary = temporary(&target)?;
    let mut buffer = BufWriter::with_capacity(1 << 16, temporary.as_file_mut());
    write(&mut buffer)
        .and_then(|()| buffer.flush())
        .map_err(failed)?;
    drop(buffer);
    if let Some(old) = &target.old {
        temporary
            .as_file()
            .set_permissions(old.permissions())
            .map_err(failed)?;
    }
    temporary.as_file().sync_all().map_err(failed)?;
    temporary.persist(&target.path).map_err(|error| {
        let source = error.error;
        match error.file.keep() {
            Ok((_, kept)) => WriteError::NotRenamed {
                path: path.to_owned(),
                kept,
                source,
            },
            Err(_) => failed(source),
        }
    })?;
    sync_folder(&target.folder).map_err(failed)
}

/// Writes after what is there: what the caller has open may be a file that others write to as well.
fn write_directly(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let is_one_of = |names: [&str; 3]| names.iter().any(|name| path == Path::new(name));
    // Where these stand now: this process writes there as well.
    if is_one_of(["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"]) {
        let mut out = io::stdout().lock();
        out.write_all(bytes)?;
        return out.flush();
    }
    if is_one_of(["/dev/stderr", "/dev/fd/2", "/proc/self/fd/2"]) {
        return io::stderr().lock().write_all(bytes);
    }
    let mut file = fs::OpenOptions::new().append(true).open(path)?;
    file.write_all(bytes)
}

/// Is it a name for something that the caller has open?
fn is_descriptor(path: &Path) -> bool {
    let Some(folder) = path.parent() else {
        return false;
    };
    let is_standard = ["/dev/stdout", "/dev/stderr"]
        .map(Path::new)
        .contains(&path);
    let of_process = folder.starts_with("/proc") && folder.ends_with("fd");
    cfg!(unix) && (is_standard || folder == Path::new("/dev/fd") || of_process)
}

/// Where a path leads.
struct Target {
    /// The file itself, links followed.
    path: PathBuf,
    folder: PathBuf,
    /// The regular file that stands there now.
    old: Option<Metadata>,
    /// Whether it is to be written to directly: neither a regular file nor free, or what the caller has open.
    special: bool,
}

impl Target {
    /// What is there and is no file that may be renamed over.
    fn special(path: &Path) -> Option<Self> {
        let there = fs::metadata(path).ok().filter(|there| !there.is_dir())?;
        let writable = !there.permissions().readonly();
        (writable && (!there.is_file() || is_descriptor(path))).then(|| Self {
            path: path.to_owned(),
            folder: PathBuf::new(),
            old: Some(there),
            special: true,
        })
    }

    fn find(path: &Path) -> Result<Self, WriteError> {
        let path = follow(path)?;
        if let Some(special) = Self::special(&path) {
            return Ok(special);
        }
        let ends_in_separator = path.as_os_str().as_encoded_bytes().ends_with(b"/");
        if path.file_name().is_none() || ends_in_separator {
            return Err(WriteError::NotAFile(path));
        }
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
            _ => PathBuf::from("."),
        };
        if !folder.is_dir() {
            return Err(WriteError::NoFolder { path, folder });
        }
        Ok(Self {
            old: replaceable(&path)?,
            path,
            folder,
            special: false,
        })
    }
}

/// What stands at a path and may be written over; `None` if nothing does.
fn replaceable(path: &Path) -> Result<Option<Metadata>, WriteError> {
    let not_writable = |reason| WriteError::NotWritable {
        path: path.to_owned(),
        kind: "file",
        reason,
    };
    let old = match fs::metadata(path) {
        Ok(old) => old,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(reason) => return Err(not_writable(reason)),
    };
    if old.is_dir() {
        return Err(WriteError::NotAFile(path.to_owned()));
    }
    if old.permissions().readonly() {
        let reason = io::Error::new(ErrorKind::PermissionDenied, "it is read-only");
        return Err(not_writable(reason));
    }
    Ok(Some(old))
}

/// The path that a chain of symbolic links ends at, whether or not a file stands there; what the caller has open is an end.
fn follow(path: &Path) -> Result<PathBuf, WriteError> {
    let mut path = path.to_owned();
    for _ in 0..40 {
        let next = fs::read_link(&path).ok().filter(|_| !is_descriptor(&path));
        let Some(next) = next else {
            return Ok(path);
        };
        path = match path.parent() {
            Some(folder) => folder.join(next),
            None => next,
        };
    }
    let reason = io::Error::other("too many links");
    Err(WriteError::NotWritable {
        path,
        kind: "file",
        reason,
    })
}

/// A file of a short name of its own in the target's folder; gone when dropped.
fn temporary(target: &Target) -> Result<tempfile::NamedTempFile, WriteError> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".kaustik-").suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        builder.permissions(fs::Permissions::from_mode(0o666)); // the umask takes from it
    }
    builder
        .tempfile_in(&target.folder)
        .map_err(|reason| WriteError::NotWritable {
            path: target.folder.clone(),
            kind: "folder",
            reason,
        })
}

/// Makes a rename in this folder last through a crash, where the folder may be read and its file system knows how: the file
/// has its name already.
fn sync_folder(folder: &Path) -> io::Result<()> {
    let Some(folder) = File::open(folder).ok().filter(|_| cfg!(unix)) else {
        return Ok(());
    };
    match folder.sync_all() {
        Err(error)
            if matches!(
                error.kind(),
                ErrorKind::InvalidInput | ErrorKind::Unsupported
            ) =>
        {
            Ok(())
        }
        synced => synced,
    }
}
