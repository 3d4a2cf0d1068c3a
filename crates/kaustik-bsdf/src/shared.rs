//! A list of values of which many are equal.

/// So many of the last values are looked through before one is added.
const RECENT: usize = 4;

/// Values by number; one that was among the last few is not stored again.
#[derive(Clone, Debug)]
pub(crate) struct Shared<T>(Vec<T>);

impl<T> Default for Shared<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<T: Copy + PartialEq> Shared<T> {
    /// The number of a value, which is added if it is none of the last few.
    pub(crate) fn number(&mut self, value: &T) -> u32 {
        let mut recent = (0..self.0.len()).rev().take(RECENT);
        let known = recent.find(|&at| self.0[at] == *value);
        known.unwrap_or_else(|| {
            self.0.push(*value);
            self.0.len() - 1
        }) as u32
    }

    #[inline]
    pub(crate) fn get(&self, number: u32) -> T {
        self.0[number as usize]
    }

    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    /// Takes another list's values after its own; what their numbers grow by.
    pub(crate) fn append(&mut self, other: &Self) -> u32 {
        self.append_as(other, |value| *value)
    }

    /// The same, of what they are turned into.
    pub(crate) fn append_as(&mut self, other: &Self, turn: impl FnMut(&T) -> T) -> u32 {
        let first = self.0.len() as u32;
        self.0.extend(other.0.iter().map(turn));
        first
    }

    /// Forgets everything but the memory.
    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }

    /// Bytes of the values.
    pub(crate) fn bytes(&self) -> usize {
        self.0.len() * size_of::<T>()
    }
}
