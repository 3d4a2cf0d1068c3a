//! What chains on paths and on primary samples have in common, whatever they step by.

use kaustik_mcmc::Statistics;
use kaustik_path::{Event, trace};
use rayon::prelude::*;

use crate::StepId;
use crate::state::{Reader, StateError};

/// The chain of one ladder.
pub(crate) trait LadderChain {
    /// Which ladder.
    fn ladder(&self) -> u32;

    /// Of its steps so far.
    fn statistics(&self) -> &Statistics<1>;
}

/// All chains' statistics, in the order of the ladders.
pub(crate) fn statistics<C: LadderChain>(chains: &[C]) -> Statistics<1> {
    let mut all = Statistics::new();
    for chain in chains {
        all.merge(chain.statistics());
    }
    all
}

/// Each chain takes as many steps as the plan gives its ladder; how many they took now, and have taken in all.
pub(crate) fn advance<C: LadderChain + Send>(
    chains: &mut [C],
    plan: &[u64],
    drive: impl Fn(&mut C, u64) + Sync,
) -> [u64; 2] {
    let before = statistics(chains).steps;
    chains
        .par_iter_mut()
        .zip(plan)
        .with_max_len(1)
        .for_each(|(chain, &steps)| drive(chain, steps));
    let steps = statistics(chains).steps;
    [steps - before, steps]
}

/// The chain of the place's ladder goes on to the step from where it is, and what happens in that step is told.
/// Nothing where there is no such chain: the pool saw no light, and nothing is tried.
pub(crate) fn replay<C: LadderChain>(
    chains: &mut [C],
    StepId { ladder, step }: StepId,
    drive: impl Fn(&mut C, u64),
) -> Vec<Event> {
    let Some(chain) = chains.iter_mut().find(|chain| chain.ladder() == ladder) else {
        return Vec::new();
    };
    drive(chain, step.saturating_sub(chain.statistics().steps));
    trace(|| drive(chain, 1)).1
}

/// Refuses counts that no chain of this ladder can have written, with so many independent samples.
pub(crate) fn check_counts(
    chain: &impl LadderChain,
    ladder: u32,
    independent: u64,
) -> Result<(), StateError> {
    let statistics = chain.statistics();
    let steps = Reader::count(statistics.steps)?;
    let moves = statistics.moves.iter().map(|kind| kind.proposed);
    let counts = moves.chain([independent, statistics.defects]);
    if chain.ladder() != ladder || counts.max() > Some(steps) {
        return Err(StateError::damaged("a chain does not agree with itself"));
    }
    Ok(())
}
