use crate::family::checked_densities;
use crate::metropolis::Decided;
use crate::{Family, Mean, Move};

/// Proposals of one kind: how many were made and what became of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Acceptance {
    /// Proposals made.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::count"))]
    pub proposed: u64,
    /// Proposals accepted.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::count"))]
    pub accepted: u64,
    /// Sum of the acceptance probabilities: less noisy than the count.
    pub expected: f64,
}

impl Acceptance {
    /// The mean acceptance probability; 0 if nothing was proposed.
    pub fn rate(&self) -> f64 {
        match self.proposed {
            0 => 0.0,
            n => self.expected / n as f64,
        }
    }

    /// Takes one proposal that was to be accepted with the given probability.
    pub(crate) fn push(&mut self, acceptance: f64, accepted: bool) {
        self.proposed += 1;
        self.accepted += u64::from(accepted);
        self.expected += acceptance;
    }

    /// What has been counted since an earlier look at the same counter.
    #[must_use]
    pub fn since(&self, earlier: &Self) -> Self {
        Self {
            proposed: self.proposed.saturating_sub(earlier.proposed),
            accepted: self.accepted.saturating_sub(earlier.accepted),
            expected: self.expected - earlier.expected,
        }
    }

    /// Adds another counter.
    pub fn merge(&mut self, other: &Self) {
        self.proposed += other.proposed;
        self.accepted += other.accepted;
        self.expected += other.expected;
    }
}

/// What a chain knows about its own course. Plain sums: chains' statistics merge.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Statistics<const K: usize> {
    /// Steps taken.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::count"))]
    pub steps: u64,
    /// Acceptance by kind of move: [`Move::SMALL`], [`Move::LARGE`], the kernel's own.
    pub moves: [Acceptance; Move::KINDS],
    /// Each level's density over all independent proposals, defective ones counting as
    /// zero: unbiased estimates of the K normalising constants.
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::array"))]
    pub independent: [Mean; K],
    /// Proposals with a density or ratio that was NaN, infinite or negative. Each is a
    /// defect of the target or the kernel; none has entered a state or a recorder. (A chain that is put where the density is
    /// none stands at density 0 and leaves with its first proposal; it is not counted.)
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::count"))]
    pub defects: u64,
    /// The step (counted from 0) of the first defect.
    pub first_defect: Option<u64>,
    /// The largest number of successive steps that a chain stayed in one state.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::count"))]
    pub longest_stay: u64,
}

impl<const K: usize> Statistics<K> {
    /// Of a chain that has not moved.
    pub fn new() -> Self {
        Self {
            steps: 0,
            moves: [Acceptance::default(); Move::KINDS],
            independent: [Mean::new(); K],
            defects: 0,
            first_defect: None,
            longest_stay: 0,
        }
    }

    /// Small steps, from where the density was not zero. Of a [`Mixture`](crate::Mixture): those of its first
    /// component.
    pub fn small(&self) -> &Acceptance {
        &self.moves[Move::SMALL]
    }

    /// Large steps, likewise; of a [`Mixture`](crate::Mixture) kind 1 is a move of its second component
    /// ([`Mixture::kind`](crate::Mixture::kind)).
    pub fn large(&self) -> &Acceptance {
        &self.moves[Move::LARGE]
    }

    /// The densities of a proposal, or `None` if it must not be used: then it either leads
    /// nowhere, and says so, or is counted as a defect.
    pub(crate) fn judge<V, F: Family<V, K> + ?Sized>(
        &mut self,
        proposal: &Move,
        family: &F,
        value: &V,
    ) -> Option<[f64; K]> {
        let possible = proposal.ratio.is_finite() && proposal.ratio >= 0.0;
        if possible && proposal.ratio <= 0.0 {
            return None;
        }
        let densities = possible.then(|| checked_densities(family, value)).flatten();
        if densities.is_none() {
            self.count_defect();
        }
        densities
    }

    /// Counts a proposal that must not be used, at the present step.
    pub(crate) fn count_defect(&mut self) {
        self.defects += 1;
        self.first_defect.get_or_insert(self.steps);
    }

    /// Counts a decided proposal from where the density is `from`. From
    /// density 0 all is accepted: that tells nothing of a kind of moves, and is not counted as one.
    pub(crate) fn count(&mut self, decided: &Decided<K>, from: f64) {
        let proposal = &decided.proposal;
        if from > 0.0 && proposal.kind != Move::NONE {
            let kind = &mut self.moves[proposal.kind.min(Move::KINDS - 1)];
            kind.push(decided.acceptance, decided.accepted);
        }
        if proposal.independent {
            let densities = decided.densities.unwrap_or([0.0; K]);
            for (mean, density) in self.independent.iter_mut().zip(densities) {
                mean.push(density);
            }
        }
    }

    /// Counts a step; `stay` counts those since the state was entered.
    pub(crate) fn count_step(&mut self, moved: bool, stay: &mut u64) {
        self.steps += 1;
        *stay = if moved { 0 } else { *stay + 1 };
        self.longest_stay = self.longest_stay.max(*stay);
    }

    /// Adds another chain's statistics. The step of a first defect keeps its meaning only
    /// within one chain; the earlier is kept.
    pub fn merge(&mut self, other: &Self) {
        self.steps += other.steps;
        for (mine, theirs) in self.moves.iter_mut().zip(&other.moves) {
            mine.merge(theirs);
        }
        for (mine, theirs) in self.independent.iter_mut().zip(&other.independent) {
            mine.merge(theirs);
        }
        self.defects += other.defects;
        self.first_defect = match (self.first_defect, other.first_defect) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        self.longest_stay = self.longest_stay.max(other.longest_stay);
    }
}

impl<const K: usize> Default for Statistics<K> {
    fn default() -> Self {
        Self::new()
    }
}
