//! Words to the user. A closed or full stream ends nothing and panics nothing.

use std::io::{self, Write};

/// A line on standard error.
pub(crate) fn note(line: &str) {
    // Nobody is left to be told if this fails.
    let _ = writeln!(io::stderr().lock(), "{line}");
}

/// Text on standard output.
pub(crate) fn print(text: &str) {
    // A reader that went away has seen enough.
    let _ = io::stdout().lock().write_all(text.as_bytes());
}
