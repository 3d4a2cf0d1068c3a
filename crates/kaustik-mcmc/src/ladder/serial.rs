//! Ladders to be written, and what must hold of those that are read (feature `serde`).

use serde::{Deserialize, Deserializer};

use crate::serial::{array, check};
use crate::{Ladder, Metropolis, Schedule};

impl<S, V, const K: usize> Ladder<S, V, K> {
    /// The same ladder with another form of its values: see [`Metropolis::with_value`].
    pub fn with_values<W: Default>(&self, values: [W; K]) -> Ladder<S, W, K>
    where
        S: Clone,
    {
        let mut replicas = self.replicas.iter();
        Ladder {
            // as many values as replicas
            replicas: values.map(|value| {
                let replica = replicas.next().unwrap_or(&self.replicas[0]);
                replica.with_value(value)
            }),
            graph: self.graph.clone(),
            schedule: self.schedule,
            turn: self.turn,
            indices: self.indices.clone(),
            statistics: self.statistics.clone(),
            stepping_stone: self.stepping_stone.clone(),
        }
    }
}

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
