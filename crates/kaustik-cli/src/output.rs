//! Words to the user. A closed stream ends nothing, and neither kind panics.

use std::io::{self, Write};

use crate::Failure;

/// A line on standard error.
pub(crate) fn note(line: &str) {
    // Nobody is left to be told if this fails.
    let _ = writeln!(io::stderr().lock(), "{line}");
}

/// Text on standard output. A reader that went away has seen enough; a full disk is told.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    match written {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::Other(format!("standard output: {error}")))
        }
        _ => Ok(()),
    }
}
