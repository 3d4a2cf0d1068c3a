use std::ops::Range;

use kaustik_film::{Counters, Film, Quantum};
use serde::de::DeserializeOwned;

use super::packed::Packed;
use super::{FILM, NUMBERS, SECTION, StateError, VALUE};

/// No ladder takes so many steps: sums over ladders stay far from the end of 64 bits.
const MOST_STEPS: u64 = 1 << 46;

/// Reads the sections of a state in the order in which they were written. Lengths are compared with what is there
/// before anything is made of them.
pub(crate) struct Reader<'a> {
    rest: &'a [u8],
    ladders: Range<u32>,
    first: bool,
}

impl<'a> Reader<'a> {
    pub(super) fn new(rest: &'a [u8], ladders: Range<u32>, first: bool) -> Self {
        Self {
            rest,
            ladders,
            first,
        }
    }

    /// The ladders whose state this is; an engine may have more.
    pub(crate) fn ladders(&self) -> Range<u32> {
        self.ladders.clone()
    }

    /// Is this the first state that is taken up, or the only one?
    pub(crate) fn is_first(&self) -> bool {
        self.first
    }

    fn take(&mut self, length: usize) -> Result<&'a [u8], StateError> {
        let (taken, rest) = self
            .rest
            .split_at_checked(length)
            .ok_or_else(|| StateError::damaged("a part is longer than what is left of it"))?;
        self.rest = rest;
        Ok(taken)
    }

    /// The length of a section of this kind, whose elements have so many bytes.
    fn section(&mut self, kind: u8, each: usize) -> Result<usize, StateError> {
        let (head, length) = self.take(SECTION)?.split_at(1);
        if head != [kind] {
            return Err(StateError::damaged("its parts are not in order"));
        }
        let length = length
            .try_into()
            .map(u64::from_le_bytes)
            .unwrap_or(u64::MAX);
        usize::try_from(length)
            .ok()
            .filter(|length| length.saturating_mul(each) <= self.rest.len())
            .ok_or_else(|| StateError::damaged("a part is longer than what is left of it"))
    }

    /// A value, all of its bytes.
    pub(crate) fn value<T: DeserializeOwned>(&mut self) -> Result<T, StateError> {
        let length = self.section(VALUE, 1)?;
        let bytes = self.take(length)?;
        match postcard::take_from_bytes(bytes) {
            Ok((value, [])) => Ok(value),
            Ok(_) => Err(StateError::damaged("a value ends before its part does")),
            Err(error) => Err(StateError::damaged(format!(
                "a value makes no sense: {error}"
            ))),
        }
    }

    /// As many numbers as there is room for.
    pub(crate) fn numbers(&mut self, room: &mut [f64]) -> Result<(), StateError> {
        let length = self.section(NUMBERS, 8)?;
        let bytes = self.take(length * 8)?;
        if length != room.len() {
            return Err(StateError::damaged(
                "a list of numbers is of another length",
            ));
        }
        for (number, bytes) in room.iter_mut().zip(bytes.chunks_exact(8)) {
            let mut word = [0; 8];
            word.copy_from_slice(bytes);
            *number = f64::from_le_bytes(word);
        }
        Ok(())
    }

    /// Fills a film: of the first state it has these sums alone, those of others are added.
    pub(crate) fn film(&mut self, film: &mut Film) -> Result<(), StateError> {
        let first = self.first;
        self.film_if(film, true, first)
    }

    /// Fills a film with these sums alone, or passes them over.
    pub(crate) fn film_instead(&mut self, film: &mut Film, wanted: bool) -> Result<(), StateError> {
        self.film_if(film, wanted, true)
    }

    fn film_if(&mut self, film: &mut Film, wanted: bool, clear: bool) -> Result<(), StateError> {
        let (quantum, counters): (Quantum, Counters) = self.value()?;
        let length = self.section(FILM, 0)?;
        if length > film.sums().len() {
            return Err(StateError::damaged("a film is of another size"));
        }
        let (sums, rest) = Packed::split(self.rest, length)
            .ok_or_else(|| StateError::damaged("the sums of a film are not packed"))?;
        self.rest = rest;
        // The pilot decides it.
        if quantum != film.quantum() {
            return Err(StateError::Other(format!(
                "the unit of a film is 2^{} in the state, 2^{} here: this program computes other numbers",
                quantum.exponent(),
                film.quantum().exponent()
            )));
        }
        if length != film.sums().len() {
            return Err(StateError::damaged("a film is of another size"));
        }
        for count in [counters.non_finite, counters.too_large, counters.overflowed] {
            Self::count(count)?;
        }
        if !wanted {
            return Ok(());
        }
        if clear {
            film.clear();
        }
        film.add_sums(sums, &counters)
            .map_err(|error| StateError::damaged(error.to_string()))
    }

    /// A number of steps, passes or faults that a render may have.
    pub(crate) fn count(count: u64) -> Result<u64, StateError> {
        if count <= MOST_STEPS {
            Ok(count)
        } else {
            Err(StateError::damaged("a count is beyond sense"))
        }
    }

    /// Bytes that have not been read.
    pub(super) fn left(&self) -> usize {
        self.rest.len()
    }

    /// Refuses what is left over.
    pub(super) fn end(&self) -> Result<(), StateError> {
        if self.rest.is_empty() {
            Ok(())
        } else {
            Err(StateError::damaged("it is longer than its parts"))
        }
    }
}
