mod on_points;

use crate::decide::{acceptance, decide};
use crate::family::checked_densities;
use crate::{Draws, Family, Kernel, Move, Recorder, Statistics, Visit};

/// A Metropolis-Hastings chain at one level of a family of targets.
///
/// `S` is what the [`Kernel`] remembers, `V` the value of an evaluation, `K` the number of
/// densities that are read off each value. The chain holds two values and swaps them: what
/// is proposed is written over what was last rejected or left, and nothing is copied.
///
/// Every visit is reported exactly once, as [`Visit`] says; at the end (and before anything
/// that changes the level, the densities or the state from outside)
/// [`flush`](Self::flush) reports the state that is still alive.
#[doc(alias = "Metropolis-Hastings")]
#[doc(alias = "MCMC")]
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Metropolis<S, V, const K: usize> {
    #[cfg_attr(
        feature = "serde",
        serde(deserialize_with = "crate::serial::level::<_, K>")
    )]
    pub(crate) level: usize,
    pub(crate) state: S,
    pub(crate) value: V,
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::densities"))]
    pub(crate) densities: [f64; K],
    pub(crate) pending: Pending,
    /// The value of the next proposal.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) proposed: V,
    pub(crate) statistics: Statistics<K>,
    /// Steps since the state was entered.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::count"))]
    pub(crate) stay: u64,
    /// Absent in files that were written before it was there.
    #[cfg(feature = "serde")]
    #[serde(default)]
    exact: crate::serial::ExactNumbers,
}

/// What the current state has to report when it dies.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Pending {
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::sound"))]
    pub(crate) weight: f64,
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::sound"))]
    pub(crate) independent: f64,
}

/// A proposal and what was decided.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Decided<const K: usize> {
    pub(crate) proposal: Move,
    /// `None` if the proposal must not be used.
    pub(crate) densities: Option<[f64; K]>,
    pub(crate) acceptance: f64,
    pub(crate) accepted: bool,
}

impl<S, V: Default, const K: usize> Metropolis<S, V, K> {
    /// A chain that starts at a known state.
    ///
    /// `state` and `value` describe the same place; `level` is below K. If the densities
    /// are defective, the chain starts at density zero and accepts its first sound proposal.
    ///
    /// # Panics
    ///
    /// If `level` is K or more.
    pub fn at(state: S, value: V, family: &(impl Family<V, K> + ?Sized), level: usize) -> Self {
        assert!(level < K, "level {level} of a family of {K}");
        let mut chain = Self {
            level,
            state,
            value,
            densities: [0.0; K],
            pending: Pending::default(),
            proposed: V::default(),
            statistics: Statistics::new(),
            stay: 0,
            #[cfg(feature = "serde")]
            exact: Default::default(),
        };
        chain.read_densities(family);
        chain
    }
}

impl<S, V, const K: usize> Metropolis<S, V, K> {
    /// One step: propose, decide, report. Tells whether the proposal was accepted.
    pub fn step<N, F, D, R>(
        &mut self,
        kernel: &N,
        family: &F,
        draws: &mut D,
        recorder: &mut R,
    ) -> bool
    where
        N: Kernel<S, Value = V>,
        F: Family<V, K> + ?Sized,
        D: Draws + ?Sized,
        R: Recorder<V, K> + ?Sized,
    {
        let proposal = kernel.propose(&mut self.state, &self.value, &mut self.proposed, draws);
        let decided = self.decide_on(proposal, family, draws, acceptance);
        self.statistics.count_step(decided.accepted, &mut self.stay);

        self.pending.weight += 1.0 - decided.acceptance; // Kelemen sec. 1.2
        let visit = Pending {
            weight: decided.acceptance,
            independent: f64::from(u8::from(proposal.independent)),
        };
        self.conclude(kernel, &decided, visit, recorder);
        decided.accepted
    }

    /// Judges the value that was proposed, decides and counts. `chance` is the acceptance probability, of the
    /// densities here and there and the move's ratio.
    #[inline]
    pub(crate) fn decide_on<F, D>(
        &mut self,
        proposal: Move,
        family: &F,
        draws: &mut D,
        chance: impl FnOnce(f64, f64, f64) -> f64,
    ) -> Decided<K>
    where
        F: Family<V, K> + ?Sized,
        D: Draws + ?Sized,
    {
        let densities = self.statistics.judge(&proposal, family, &self.proposed);
        let from = self.density();
        let acceptance = densities.map_or(0.0, |d| chance(from, d[self.level], proposal.ratio));
        let accepted = decide(acceptance, draws);
        let decided = Decided {
            proposal,
            densities,
            acceptance,
            accepted,
        };
        self.statistics.count(&decided, from);
        decided
    }

    /// Carries out what was decided: the proposal becomes the state, or is reported with
    /// its share at once and undone.
    #[inline]
    pub(crate) fn conclude<N, R>(
        &mut self,
        kernel: &N,
        decided: &Decided<K>,
        visit: Pending,
        recorder: &mut R,
    ) where
        N: Kernel<S, Value = V>,
        R: Recorder<V, K> + ?Sized,
    {
        if let (true, Some(densities)) = (decided.accepted, decided.densities) {
            self.flush(recorder);
            std::mem::swap(&mut self.value, &mut self.proposed);
            self.densities = densities;
            self.pending = visit;
            kernel.accept_move(&mut self.state, &decided.proposal);
        } else {
            if let Some(densities) = &decided.densities {
                visit.report(self.level, &self.proposed, densities, recorder);
            }
            kernel.reject_move(&mut self.state, &decided.proposal);
        }
    }

    /// Reports what the current state has gathered so far, and begins to gather anew.
    pub fn flush<R: Recorder<V, K> + ?Sized>(&mut self, recorder: &mut R) {
        let pending = std::mem::take(&mut self.pending);
        pending.report(self.level, &self.value, &self.densities, recorder);
    }

    /// Reads the densities of the current value off a changed family. Flush before.
    pub fn read_densities<F: Family<V, K> + ?Sized>(&mut self, family: &F) {
        self.densities = checked_densities(family, &self.value).unwrap_or([0.0; K]);
    }

    /// Changes states with a chain at another level: what both have gathered is reported at
    /// the level where it was gathered, debts are paid by [`Kernel::exchange`], values and
    /// densities are swapped, not copied.
    ///
    /// This is what is done, not whether: see
    /// [`exchange_acceptance`](crate::exchange_acceptance) and [`Ladder`](crate::Ladder).
    pub fn exchange<N, D, R>(
        &mut self,
        other: &mut Self,
        kernel: &N,
        draws: &mut D,
        recorder: &mut R,
    ) where
        N: Kernel<S, Value = V>,
        D: Draws + ?Sized,
        R: Recorder<V, K> + ?Sized,
    {
        self.flush(recorder); // told at its own level
        other.flush(recorder);
        kernel.exchange(&mut self.state, &mut other.state, draws);
        std::mem::swap(&mut self.value, &mut other.value);
        std::mem::swap(&mut self.densities, &mut other.densities);
        (self.stay, other.stay) = (0, 0);
    }

    /// Takes over where another chain is, in the memory that is there. What was gathered
    /// here is forgotten, statistics go on.
    pub(crate) fn copy_from(&mut self, other: &Self)
    where
        S: Clone,
        V: Clone,
    {
        self.state.clone_from(&other.state);
        self.value.clone_from(&other.value);
        self.densities = other.densities;
        self.pending = Pending::default();
        self.stay = 0;
    }

    /// The same chain with another form of its value, densities as they are: for values whose stored form is
    /// not the one in memory.
    pub fn with_value<W: Default>(&self, value: W) -> Metropolis<S, W, K>
    where
        S: Clone,
    {
        Metropolis {
            level: self.level,
            state: self.state.clone(),
            value,
            densities: self.densities,
            pending: self.pending,
            proposed: W::default(),
            statistics: self.statistics.clone(),
            stay: self.stay,
            #[cfg(feature = "serde")]
            exact: self.exact,
        }
    }

    /// Brings the chain to another level and under its kernel. What was gathered and not
    /// flushed is forgotten: it belongs to the level that is left.
    pub(crate) fn enter<N, D>(&mut self, level: usize, kernel: &N, draws: &mut D)
    where
        N: Kernel<S, Value = V>,
        D: Draws + ?Sized,
    {
        kernel.enter(&mut self.state, draws);
        self.pending = Pending::default();
        self.set_level(level);
    }

    /// Moves the chain to another target of the family. Flush before; for a lazy point
    /// see [`crate::Point`] on what must be settled if its mutation changes as well.
    ///
    /// # Panics
    ///
    /// If `level` is K or more.
    pub fn set_level(&mut self, level: usize) {
        assert!(level < K, "level {level} of a family of {K}");
        self.level = level;
    }

    /// The level: which of the K densities is the target.
    pub fn level(&self) -> usize {
        self.level
    }

    /// The value of the current state.
    pub fn value(&self) -> &V {
        &self.value
    }

    /// All densities of the current state.
    pub fn densities(&self) -> &[f64; K] {
        &self.densities
    }

    /// The density of the current state at the chain's level.
    pub fn density(&self) -> f64 {
        self.densities[self.level]
    }

    /// What the kernel remembers of the current state.
    pub fn state(&self) -> &S {
        &self.state
    }

    /// The statistics so far.
    pub fn statistics(&self) -> &Statistics<K> {
        &self.statistics
    }

    /// The statistics so far, and begins anew: after burn-in, say. Not while an
    /// [`AcceptanceAdaptation`](crate::AcceptanceAdaptation) goes by them, which wants totals from the beginning.
    pub fn take_statistics(&mut self) -> Statistics<K> {
        std::mem::take(&mut self.statistics)
    }
}

impl Pending {
    pub(crate) fn report<V, R: Recorder<V, K> + ?Sized, const K: usize>(
        self,
        level: usize,
        value: &V,
        densities: &[f64; K],
        recorder: &mut R,
    ) {
        // time at density zero (a bad start) stands for nothing
        let weight = if densities[level] > 0.0 {
            self.weight
        } else {
            0.0
        };
        let dark = densities.iter().all(|density| *density <= 0.0);
        if weight > 0.0 || (self.independent > 0.0 && !dark) {
            recorder.record(Visit {
                level,
                value,
                densities,
                weight,
                independent: self.independent,
            });
        }
    }
}
