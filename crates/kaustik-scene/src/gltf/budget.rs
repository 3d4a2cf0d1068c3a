use super::json::Cursor;
use super::{ErrorKind, LoadError, LoadOptions};

/// Granted to any file, however small.
const BASE: u64 = 1 << 30;
/// Granted for each byte that is read from disk: decoded images and indexed geometry are
/// larger than what they are stored as. A large JPEG has half a bit a pixel or more, and
/// a pixel takes four bytes.
const PER_BYTE: u64 = 64;
/// Bytes that may be worked through more than once: some seconds, and as much again for each byte of the files as a hundred
/// shapes of one mesh take.
const BASE_WORK: u64 = 4 << 30;
const WORK_PER_BYTE: u64 = 256;
/// Bytes of work that stand for a look at a number, a primitive or a morph target.
pub(super) const VISIT: usize = 64;

/// Counts the bytes that a file asks for *before* they are allocated: a failed allocation
/// aborts the process and cannot be caught, and a successful one of 100 GB is no better.
#[derive(Debug)]
pub(super) struct Budget {
    limit: u64,
    used: u64,
    grows: bool,
    max_file: u64,
    work: u64,
    most_work: u64,
}

impl Budget {
    pub(super) fn new(options: &LoadOptions) -> Self {
        Self {
            limit: options.max_memory.unwrap_or(BASE),
            used: 0,
            grows: options.max_memory.is_none(),
            max_file: options.max_file,
            work: 0,
            most_work: BASE_WORK,
        }
    }

    /// Takes the bytes of a file that is about to be read, and raises the default limit by
    /// what they may grow to. A file has a limit of its own: a sparse one takes no disk.
    pub(super) fn file(&mut self, place: &str, bytes: u64) -> Result<(), LoadError> {
        if bytes > self.max_file {
            let found = format!("a file of {}", size(bytes));
            let expected = format!("at most {}", size(self.max_file));
            return Err(LoadError::new(ErrorKind::Budget, place, found, expected));
        }
        let more = bytes.saturating_mul(WORK_PER_BYTE);
        self.most_work = self.most_work.saturating_add(more);
        if self.grows {
            let more = bytes.saturating_mul(PER_BYTE);
            self.limit = self.limit.saturating_add(more);
        }
        self.take(place, bytes)
    }

    /// Takes `bytes` for what stands at `place`, or refuses.
    pub(super) fn take(&mut self, place: &str, bytes: u64) -> Result<(), LoadError> {
        let used = self.used.saturating_add(bytes);
        if used > self.limit {
            return Err(LoadError::new(
                ErrorKind::Budget,
                place,
                format!("a need of at least {}", size(used)),
                format!("at most {}", size(self.limit)),
            )
            .help("if the file is to be trusted, allow more memory (--max-memory)"));
        }
        self.used = used;
        Ok(())
    }

    /// `count` things of `each` bytes.
    pub(super) fn take_many(
        &mut self,
        place: &str,
        count: usize,
        each: usize,
    ) -> Result<(), LoadError> {
        self.take(place, (count as u64).saturating_mul(each as u64))
    }

    /// Counts bytes that are worked through and given back again: small files can name the same data
    /// again and again.
    pub(super) fn work(&mut self, place: &Cursor<'_>, bytes: usize) -> Result<(), LoadError> {
        self.work = self.work.saturating_add(bytes as u64);
        if self.work > self.most_work {
            let found = format!("work on {} of data", size(self.work));
            let expected = format!("at most {} for files of this size", size(self.most_work));
            return Err(place.error(ErrorKind::Budget, found, expected));
        }
        Ok(())
    }

    /// Gives back what was temporary.
    pub(super) fn give(&mut self, bytes: u64) {
        self.used = self.used.saturating_sub(bytes);
    }

    /// What is counted at the moment.
    pub(super) fn used(&self) -> u64 {
        self.used
    }

    /// What is left.
    pub(super) fn left(&self) -> u64 {
        self.limit - self.used
    }
}

/// A size for people: 3 digits and a unit.
pub(super) fn size(bytes: u64) -> String {
    const UNITS: [&str; 5] = ["B", "KiB", "MiB", "GiB", "TiB"];
    let mut value = bytes as f64;
    let mut unit = 0;
    while value >= 1024.0 && unit + 1 < UNITS.len() {
        value /= 1024.0;
        unit += 1;
    }
    if unit == 0 {
        return format!("{bytes} B");
    }
    format!("{value:.1} {}", UNITS[unit])
}

#[cfg(test)]
mod tests {
    use super::Budget;
    use crate::gltf::LoadOptions;

    const MIB: u64 = 1 << 20;

    /// Ten materials of three pictures of 4096 x 4096, at most; as many from files of a kilobyte are refused.
    #[test]
    fn rooms_of_large_pictures_fit_and_lies_do_not() {
        let loads = |file: u64| {
            let mut budget = Budget::new(&LoadOptions::default());
            (0..30).all(|_| {
                let fits = budget.file("/images", file).is_ok();
                fits && budget.take("/images", 4 * 4096 * 4096 + 3 * file).is_ok()
            })
        };
        for (file, fits) in [(3 * MIB / 2, true), (MIB, true), (MIB / 1024, false)] {
            assert_eq!(loads(file), fits, "{file} bytes each");
        }
    }
}
