use std::io;

use super::{Reader, State, StateError, Writer};
use crate::engine::Engine;

/// A method whose state can be written down and taken up again: the whole of what checkpoints, resumed renders and
/// merged shares need.
pub(crate) trait Keep: Send + Sync {
    /// Steps of its plan that each ladder of this process has behind it.
    fn taken(&self) -> Vec<u64>;

    /// Steps that were taken in all.
    fn steps(&self) -> u64 {
        self.taken().iter().sum()
    }

    /// Writes what does not follow from scene and settings: films, chains, generators, counters; what chains hold back
    /// stays held back.
    fn write(&self, out: &mut Writer<'_>) -> io::Result<()>;

    /// Takes up what was written, beside what other ladders have. Films are filled by [`Reader::film`], ladders
    /// found by [`Reader::ladders`].
    fn take_up(&mut self, from: &mut Reader<'_>) -> Result<(), StateError>;
}

/// Fills an engine that was made for the same scene and settings; `first` forgets what is in its films, the states
/// after the first add to them.
pub(crate) fn take_up(
    engine: &mut (dyn Engine + '_),
    state: &State,
    first: bool,
) -> Result<(), StateError> {
    let mut reader = state.reader(first);
    engine.take_up(&mut reader)?;
    reader.end()
}
