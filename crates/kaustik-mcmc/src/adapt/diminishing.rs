use crate::{Acceptance, Power};

/// Hachisuka and Jensen's adaptation of the size m of [`Power`] steps (2011).
///
/// After round n, m = max(10^-4, m + (A - target) / n), where A is the share of *all*
/// small steps so far that were accepted. The size begins at 1, the target is 0.234.
///
/// As printed, a round is one mutation: call [`end_round`](Self::end_round) after each small
/// step to reproduce it, at the price of a chain that is not reversible while m changes (its
/// changes vanish as 1/n, so it is consistent). With longer rounds the size is frozen in
/// between. Gains of 1/n move the size only logarithmically: it may need a very long time
/// from a bad start (in 8 dimensions with modes of width 1/2, 0.285 instead of 0.234 after
/// 400,000 steps); [`AcceptanceAdaptation`](crate::AcceptanceAdaptation) on the same steps
/// does better.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DiminishingAdaptation {
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::finite"))]
    size: f64,
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::finite"))]
    target: f64,
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::count"))]
    rounds: u64,
    seen: u64,
}

impl DiminishingAdaptation {
    /// Begins at size 1.
    pub fn new() -> Self {
        Self {
            size: 1.0,
            target: 0.234,
            rounds: 0,
            seen: 0,
        }
    }

    /// Another target, in (0, 1).
    #[must_use]
    pub fn with_target(self, target: f64) -> Self {
        Self { target, ..self }
    }

    /// Ends a round and gives the mutation of the next. `total` is the counter of small
    /// steps since the chain began; if it has not grown nothing changes.
    #[must_use = "the new mutation is to be set"]
    pub fn end_round(&mut self, total: &Acceptance) -> Power {
        if total.proposed > self.seen {
            self.seen = total.proposed;
            self.rounds += 1;
            let accepted = total.accepted as f64 / total.proposed as f64;
            let size = self.size + (accepted - self.target) / self.rounds as f64;
            self.size = size.max(Power::SMALLEST);
        }
        self.mutation()
    }

    /// The mutation of the current round.
    pub fn mutation(&self) -> Power {
        Power::new(self.size)
    }

    /// The size m of the current round.
    pub fn size(&self) -> f64 {
        self.size
    }
}

impl Default for DiminishingAdaptation {
    fn default() -> Self {
        Self::new()
    }
}
