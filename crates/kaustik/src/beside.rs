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

/// What has been taken up with so many passes, beside chains that took so many steps in the state, keeps up with the
/// steps of all states so far: what several shares are due together is more than the most of any.
pub(crate) fn keep_up<B: Beside>(
    beside: &mut Option<B>,
    passes: Option<u64>,
    (taken, steps): (u64, u64),
) -> Result<(), StateError> {
    if passes != beside.as_ref().map(|some| some.due(taken)) {
        return Err(StateError::damaged(format!(
            "its {} does not keep up with its chains",
            B::NAME
        )));
    }
    if let Some(some) = beside {
        some.keep_up(steps);
    }
    Ok(())
}
