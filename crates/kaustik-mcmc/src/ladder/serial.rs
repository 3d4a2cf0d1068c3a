//! What must hold of a ladder that is read (feature `serde`).

use serde::{Deserialize, Deserializer};

use crate::serial::{array, check};
use crate::{Metropolis, Schedule};

/// Replica k stands at level k.
pub(super) fn replicas<'de, S, V, D, const K: usize>(
    deserializer: D,
) -> Result<[Metropolis<S, V, K>; K], D::Error>
where
    S: Deserialize<'de>,
    V: Deserialize<'de> + Default,
    D: Deserializer<'de>,
{
    const { assert!(K > 0, "a ladder has a level") };
    let replicas: [Metropolis<S, V, K>; K] = array::deserialize(deserializer)?;
    let in_order = replicas.iter().enumerate().all(|(k, r)| r.level() == k);
    check(in_order, "a replica is not at its level")?;
    Ok(replicas)
}

/// No permutations of too many.
pub(super) fn schedule<'de, D: Deserializer<'de>, const K: usize>(
    deserializer: D,
) -> Result<Schedule, D::Error> {
    let schedule = Schedule::deserialize(deserializer)?;
    let possible = schedule != Schedule::Permutation || K <= Schedule::MOST_PERMUTED;
    check(possible, "permutations of too many levels")?;
    Ok(schedule)
}
