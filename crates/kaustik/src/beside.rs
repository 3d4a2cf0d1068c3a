//! What samples beside chains have in common, whatever they are made for.

use crate::state::{Reader, StateError};

/// What takes passes beside chains, so many as follow from their steps.
pub(crate) trait Beside {
    /// What it is called.
    const NAME: &'static str;

    /// Passes beside so many steps.
    fn due(&self, steps: u64) -> u64;

    /// Takes the passes that so many steps are due.
    fn keep_up(&mut self, steps: u64);

    /// Takes up what was written. All shares of a render take the same passes, some more of them than others: those
    /// with the most are kept, what the whole is due beyond them is for [`keep_up`](Self::keep_up). Tells how many
    /// passes it has.
    fn take_up(&mut self, from: &mut Reader<'_>) -> Result<u64, StateError>;
}

/// Takes up what was beside the chains of a state, if there is anything; tells how many passes it has there.
pub(crate) fn take_up(
    beside: &mut Option<impl Beside>,
    from: &mut Reader<'_>,
) -> Result<Option<u64>, StateError> {
    beside.as_mut().map(|some| some.take_up(from)).transpose()
}

/// Refuses so many passes of a state beside so many steps of its chains, rounds or ladders.
pub(crate) fn check<B: Beside>(
    beside: Option<&B>,
    passes: Option<u64>,
    steps: u64,
) -> Result<(), StateError> {
    if passes == beside.map(|some| some.due(steps)) {
        return Ok(());
    }
    Err(StateError::damaged(format!(
        "its {} does not keep up with its steps",
        B::NAME
    )))
}

/// Takes the passes that so many steps are due: of several shares together they are more than the most of any.
pub(crate) fn keep_up(beside: &mut Option<impl Beside>, steps: u64) {
    if let Some(some) = beside {
        some.keep_up(steps);
    }
}
