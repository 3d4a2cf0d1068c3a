use std::collections::BTreeMap;

use super::Enumerator;
use super::enumerator::each_run;
use crate::Point;

/// A probability law on finitely many objects: chains, say, with all that they remember.
///
/// Objects need no order; a key tells which of them are the same for ever after, and those
/// are merged, so that laws stay small over several steps.
#[derive(Clone, Debug)]
pub struct Law<S> {
    atoms: Vec<(S, f64)>,
}

impl<S> Law<S> {
    /// The law of one certain object.
    pub fn certain(object: S) -> Self {
        Self {
            atoms: vec![(object, 1.0)],
        }
    }

    /// The law of what `step` makes of an object of this law, under all its draws. Objects
    /// of equal keys are merged. `cells` is the grid of [`Enumerator`].
    pub fn then<T, K: Ord>(
        &self,
        cells: usize,
        mut step: impl FnMut(&S, &mut Enumerator) -> T,
        mut key: impl FnMut(&T) -> K,
    ) -> Law<T> {
        let mut merged: BTreeMap<K, (T, f64)> = BTreeMap::new();
        for (object, weight) in &self.atoms {
            each_run(
                cells,
                &mut |draws: &mut Enumerator| step(object, draws),
                |next, p| {
                    merged.entry(key(&next)).or_insert((next, 0.0)).1 += weight * p;
                },
            );
        }
        Law {
            atoms: merged.into_values().collect(),
        }
    }

    /// This law weighted by a function of the object, at least 0, and normalised again.
    pub fn weighted(mut self, weight: impl Fn(&S) -> f64) -> Self {
        for (object, p) in &mut self.atoms {
            *p *= weight(object);
        }
        self.atoms.retain(|atom| atom.1 > 0.0);
        let total: f64 = self.atoms.iter().map(|atom| atom.1).sum();
        for atom in &mut self.atoms {
            atom.1 /= total;
        }
        self
    }

    /// The objects with their probabilities.
    pub fn iter(&self) -> impl Iterator<Item = (&S, f64)> {
        self.atoms.iter().map(|(object, p)| (object, *p))
    }

    /// The expectation of a function of the object.
    pub fn mean(&self, mut function: impl FnMut(&S) -> f64) -> f64 {
        self.iter().map(|(object, p)| p * function(object)).sum()
    }
}

/// See [`point_key`]: stream, index, bits of the value, steps owed, read by the state.
pub type PointKey = Vec<(u8, u32, u64, i64, bool)>;

/// A key under which two points of one mutation are equal if and only if they have the same
/// future: for each coordinate that is not stale its address, its value, how many steps it
/// owes and whether the current state has read it.
pub fn point_key<M>(point: &Point<M>) -> PointKey {
    let clock = &point.clock;
    let mut key = Vec::new();
    for (stream, stored) in point.streams.iter().enumerate() {
        for (index, coordinate) in stored.iter().enumerate() {
            if coordinate.modify >= clock.large_time.max(0) {
                key.push((
                    stream as u8,
                    index as u32,
                    coordinate.value.to_bits(),
                    clock.time - 1 - coordinate.modify,
                    coordinate.seen == clock.time - 1,
                ));
            }
        }
    }
    key
}
