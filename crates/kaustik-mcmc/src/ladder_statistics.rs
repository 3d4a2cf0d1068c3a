use crate::Acceptance;

/// How exchanges of a [`Ladder`](crate::Ladder) went. Plain sums: ladders' statistics
/// merge.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LadderStatistics<const K: usize> {
    /// Rounds of exchanges.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::count"))]
    pub rounds: u64,
    /// Exchanges of levels a < b at `[a][b]`; other entries stay empty. (A proposal is an
    /// attempt.)
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::table"))]
    pub swaps: [[Acceptance; K]; K],
    /// Draws of a whole [permutation](crate::Schedule::Permutation); an accepted one is any
    /// but the identity.
    pub permutations: Acceptance,
    /// How often a lineage that was at level 0 has come to level K-1: tempered restarts.
    /// If level 0 draws independent states, each brings a new one to the top.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::count"))]
    pub restarts: u64,
    /// How often a lineage has come from level 0 to level K-1 and back to level 0.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::count"))]
    pub round_trips: u64,
}

impl<const K: usize> LadderStatistics<K> {
    /// Of a ladder that has not moved.
    pub fn new() -> Self {
        Self {
            rounds: 0,
            swaps: [[Acceptance::default(); K]; K],
            permutations: Acceptance::default(),
            restarts: 0,
            round_trips: 0,
        }
    }

    /// Exchanges between two levels, in either order.
    ///
    /// # Panics
    ///
    /// If a level is K or more.
    pub fn swap(&self, a: usize, b: usize) -> &Acceptance {
        &self.swaps[a.min(b)][a.max(b)]
    }

    /// The local barriers: mean rejection probability r of the exchange of levels k and
    /// k + 1 at `[k]`, in [0, 1]; `None` for a pair that was never tried, and at `[K-1]`.
    pub fn local_barriers(&self) -> [Option<f64>; K] {
        std::array::from_fn(|k| {
            let swap = self.swaps[k].get(k + 1)?;
            (swap.proposed > 0).then(|| 1.0 - swap.rate())
        })
    }

    /// The communication barrier Λ: the sum of the rejection rates along the line of
    /// levels. It hardly depends on how many levels there are (Syed et al. 2021, sec. 4):
    /// K - 1 at most, and near it where there are too few levels: about 2 Λ of them are best.
    /// `None` where a pair of neighbours was never tried: not yet, or because schedule or graph do not try
    /// them by themselves ([`Off`](crate::Schedule::Off), [`Permutation`](crate::Schedule::Permutation)).
    pub fn barrier(&self) -> Option<f64> {
        self.along_the_line(|r| r)
    }

    fn along_the_line(&self, of: impl Fn(f64) -> f64) -> Option<f64> {
        let pairs = &self.local_barriers()[..K - 1];
        pairs.iter().map(|r| r.map(&of)).sum()
    }

    /// Round trips a round of exchanges.
    pub fn round_trip_rate(&self) -> f64 {
        match self.rounds {
            0 => 0.0,
            n => self.round_trips as f64 / n as f64,
        }
    }

    /// The round-trip rate 1 / (2 + 2 sum r / (1 - r)) that
    /// [alternating](crate::Schedule::Alternating) exchanges along a line would have with
    /// these rejection rates, if steps made states independent of their past (Syed et al.
    /// 2021, sec. 3). A measured rate far below it says that steps mix badly; a low ideal,
    /// that levels are too far apart. `None` as of [`barrier`](Self::barrier).
    pub fn ideal_round_trip_rate(&self) -> Option<f64> {
        let odds = self.along_the_line(|r| r / (1.0 - r))?;
        Some(1.0 / (2.0 + 2.0 * odds))
    }

    /// Adds another ladder's statistics.
    pub fn merge(&mut self, other: &Self) {
        self.rounds += other.rounds;
        let theirs = other.swaps.iter().flatten();
        for (mine, theirs) in self.swaps.iter_mut().flatten().zip(theirs) {
            mine.merge(theirs);
        }
        self.permutations.merge(&other.permutations);
        self.restarts += other.restarts;
        self.round_trips += other.round_trips;
    }
}

impl<const K: usize> Default for LadderStatistics<K> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn barriers_add_up_and_merge() {
        let mut statistics = LadderStatistics::<3>::new();
        statistics.rounds = 10;
        statistics.round_trips = 2;
        statistics.swaps[0][1].push(0.75, true);
        statistics.swaps[1][2].push(0.5, false);
        statistics.swaps[0][2].push(0.1, false); // no neighbours: not along the line
        let mut both = statistics.clone();
        both.merge(&statistics);
        for s in [&statistics, &both] {
            let (barrier, ideal) = (s.barrier().unwrap(), s.ideal_round_trip_rate().unwrap());
            assert!((barrier - 0.75).abs() < 1e-15);
            assert!((ideal - 1.0 / (2.0 + 2.0 * (1.0 / 3.0 + 1.0))).abs() < 1e-15);
            assert!((s.round_trip_rate() - 0.2).abs() < 1e-15);
        }
        assert_eq!(both.swap(2, 0).proposed, 2);
        let untried = LadderStatistics::<3>::new();
        assert_eq!(
            (untried.barrier(), untried.ideal_round_trip_rate()),
            (None, None)
        );
    }
}
