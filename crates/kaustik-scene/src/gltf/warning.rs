use std::collections::HashSet;
use std::fmt;

/// Something in a file that was replaced, left out or ignored; the scene loads without it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Warning {
    /// JSON pointer of what it concerns; empty for the whole file.
    pub place: String,
    /// What was done, and why.
    pub message: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.place.is_empty() {
            return f.write_str(&self.message);
        }
        write!(f, "{}: {}", self.place, self.message)
    }
}

/// More than this many warnings are counted, not kept: a hostile file must not flood the
/// user, or the memory.
const MOST: usize = 200;

/// Collects warnings, each once.
#[derive(Debug, Default)]
pub(super) struct Warnings {
    seen: HashSet<Warning>,
    list: Vec<Warning>,
    dropped: usize,
}

impl Warnings {
    pub(super) fn push(&mut self, place: impl Into<String>, message: impl Into<String>) {
        let warning = Warning {
            place: place.into(),
            message: message.into(),
        };
        if self.seen.contains(&warning) {
            return;
        }
        if self.list.len() >= MOST {
            self.dropped += 1;
            return;
        }
        self.seen.insert(warning.clone());
        self.list.push(warning);
    }

    pub(super) fn into_list(mut self) -> Vec<Warning> {
        if self.dropped > 0 {
            self.list.push(Warning {
                place: String::new(),
                message: format!("{} more warnings are not shown", self.dropped),
            });
        }
        self.list
    }
}
