//! Words to the user. A closed stream ends nothing, and neither kind panics.

use std::io::{self, Write};

use crate::Failure;

/// A line on standard error.
pub(crate) fn note(line: &str) {
    // Nobody is left to be told if this fails.
    let _ = writeln!(io::stderr().lock(), "{}", clean(line));
}

/// Lines [without controls](without_controls) in them.
pub(crate) fn clean(text: &str) -> String {
    let lines: Vec<String> = text.split('\n').map(without_controls).collect();
    lines.join("\n")
}

/// A line without characters that a terminal takes for commands: names in it may be those of a stranger's file.
pub(crate) fn without_controls(line: &str) -> String {
    let shown = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    line.chars().map(shown).collect()
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
