//! What both targets do with an input.

use std::cell::RefCell;
use std::fs;

use kaustik_fuzz::Kind;
use tempfile::NamedTempFile;

thread_local! {
    /// One file for all inputs.
    static FILE: RefCell<Option<NamedTempFile>> = const { RefCell::new(None) };
}

/// Loads and renders; a refusal is as good as a picture.
pub fn judge(kind: Kind, bytes: &[u8]) {
    FILE.with_borrow_mut(|file| {
        let file = file.get_or_insert_with(|| NamedTempFile::new().expect("a file to write to"));
        fs::write(file.path(), bytes).expect("written");
        let _ = kaustik_fuzz::verdict(kind, file.path());
    });
}
