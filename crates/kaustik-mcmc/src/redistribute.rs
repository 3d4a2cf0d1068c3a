//! Equal-deposition chains: many short chains from Monte Carlo samples.
//!
//! A plain Monte Carlo run finds, now and then, a sample x of large weight e = I(x)/p(x): a
//! speck. Redistribution (Cline, Talbot and Egbert 2005, "Energy redistribution path
//! tracing"; Algorithm 2 of Batty's report) spreads that weight over
//! the neighbourhood. It starts chains at x, a number proportional to e, and each of their
//! m steps deposits the same *unit* of weight where the chain is:
//!
//! n = floor(xi + e / (m unit))
//!
//! so that E\[n\] m unit = e for every unit. Because the step leaves I invariant, and the
//! sum over starts of e h(x) estimates the integral of I h, so does the sum of all deposits,
//! for every h. There is no burn-in, no normalising constant and no start-up bias, and the
//! kernel need not even be ergodic.
//!
//! With a the acceptance probability of a step from y to z, the expected-value form deposits
//! (1 - a) unit at y and a unit at z; the plain form the whole unit where the chain is
//! after the step. Both are exactly unbiased; the first has less noise and more deposits.
//!
//! The numbers of chains of many starts can be rounded together: see [`Redistributor::carry`].
//!
//! # In whose colour
//!
//! What is deposited at y, for an integrand F with several channels and a density I that
//! guides the chain, is weight * F(y) / I(y): the channels *of y*. A report that computed
//! them once, from the start, keeps the total right and smears the channels (measured: up
//! to 99 % per channel). So a [`Deposit`] holds the value on which it falls and its density;
//! it gives no access to the start's.
//!
//! # When
//!
//! Where an ordinary Monte Carlo sampler finds everything, but some of it rarely. Use
//! [`Metropolis`](crate::Metropolis) chains where the interesting places are hard to find at
//! all, or to be unbiased with a single long chain.

mod plan;
mod rounding;

pub use plan::{Redistribution, RedistributionError};

use rounding::Rounding;

use crate::decide::{acceptance, decide};
use crate::family::checked_densities;
use crate::metropolis::Decided;
use crate::{Draws, Family, Kernel, Statistics};

/// What a chain deposits on a value.
///
/// Every proposal of positive density is reported exactly once: if it was rejected at once,
/// otherwise when the chain leaves it or ends. The start is reported as well, if the chain
/// stayed there.
#[derive(Debug)]
pub struct Deposit<'a, V> {
    /// The value that the weight falls on.
    pub value: &'a V,
    /// Its density, positive: what a channel F of the value is divided by.
    pub density: f64,
    /// The weight that it got as a proposal, at least 0.
    pub proposed: f64,
    /// The weight that it got because the chain stayed there, at least 0.
    pub stayed: f64,
    /// The weight for staying that the filter kept back, at least 0: not part of
    /// [`weight`](Self::weight).
    pub held: f64,
    /// What a step of this chain deposits in all.
    pub unit: f64,
    /// Whether it was proposed by this chain: false for the start alone. Counts the
    /// proposals for a filter by proposals (Batty sec. 6), which is up to the listener.
    pub is_proposal: bool,
}

impl<V> Deposit<'_, V> {
    /// The whole weight. A channel F of the integrand gets weight * F(value) / density.
    pub fn weight(&self) -> f64 {
        self.proposed + self.stayed
    }
}

impl<V> Clone for Deposit<'_, V> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<V> Copy for Deposit<'_, V> {}

/// Takes deposits. Closures `FnMut(Deposit<V>)` do.
pub trait Depositor<V> {
    /// Takes one deposit.
    fn deposit(&mut self, deposit: Deposit<'_, V>);

    /// Asked before each step: `false` breaks the start's chains off, and its weight is not all
    /// deposited.
    fn goes_on(&mut self) -> bool {
        true
    }
}

impl<V, F: FnMut(Deposit<'_, V>)> Depositor<V> for F {
    fn deposit(&mut self, deposit: Deposit<'_, V>) {
        self(deposit);
    }
}

/// What redistribution knows about its own course. Plain sums: they merge.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RedistributionStatistics {
    /// Starts of sound weight, zero included.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::count"))]
    pub starts: u64,
    /// Starts whose weight or density was NaN, infinite or negative, or whose density was
    /// zero at a positive weight. They deposit nothing.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::count"))]
    pub bad_starts: u64,
    /// Starts that would have had more chains than allowed.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::count"))]
    pub capped: u64,
    /// Chains.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::serial::count"))]
    pub chains: u64,
    /// Weight that the filter has kept back.
    pub dropped: f64,
    /// Steps, acceptance, defects.
    pub chain: Statistics<1>,
}

impl RedistributionStatistics {
    /// Adds another's.
    pub fn merge(&mut self, other: &Self) {
        self.starts += other.starts;
        self.bad_starts += other.bad_starts;
        self.capped += other.capped;
        self.chains += other.chains;
        self.dropped += other.dropped;
        self.chain.merge(&other.chain);
    }
}

/// Runs chains from starts, in memory of its own: after warm-up a start allocates nothing,
/// if [`clone_from`](Clone::clone_from) of state and value does not.
///
/// (That of a [`Point`](crate::Point) and of a `Vec` does not; a derived one does if a field
/// allocates.)
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Redistributor<S, V> {
    /// Where the chain is; `None` before the first.
    current: Option<(S, V)>,
    #[cfg_attr(feature = "serde", serde(skip))]
    proposed: V,
    statistics: RedistributionStatistics,
    #[cfg_attr(feature = "serde", serde(default))]
    rounding: Rounding,
}

/// The place of a chain within [`Redistributor::run`].
#[derive(Clone, Copy)]
struct Place {
    density: f64,
    proposed: f64,
    stayed: f64,
    held: f64,
    unit: f64,
    is_proposal: bool,
    rejections: u64,
}

impl<S: Clone, V: Clone + Default> Redistributor<S, V> {
    /// One that has run nothing yet.
    pub fn new() -> Self {
        Self {
            current: None,
            proposed: V::default(),
            statistics: RedistributionStatistics::default(),
            rounding: Rounding::default(),
        }
    }

    /// One that goes on from these statistics: between two starts nothing else counts.
    #[must_use]
    pub fn with_statistics(self, statistics: RedistributionStatistics) -> Self {
        Self { statistics, ..self }
    }

    /// What has happened so far.
    pub fn statistics(&self) -> &RedistributionStatistics {
        &self.statistics
    }

    /// Rounds the numbers of chains of the starts that follow together (systematic resampling). The running sum
    /// of their mean numbers begins at this share, in \[0, 1), and a start has a chain for each whole number that
    /// the sum reaches there: many starts together have as many chains as they should, to within one. With
    /// `None`, as it is at first, each start is rounded by a draw of its own.
    ///
    /// If the share is uniform and independent of the starts, the number of each is right in the mean, and all is
    /// as unbiased as before. Starts of several places may take turns, each with a share of its own: see
    /// [`carried`](Self::carried).
    pub fn carry(&mut self, share: Option<f64>) {
        self.rounding.carry(share);
    }

    /// What the starts so far have left over, to be [carried](Self::carry) to the next of the same place.
    pub fn carried(&self) -> Option<f64> {
        self.rounding.carried()
    }

    /// Spreads the weight of one start and tells over how many chains.
    ///
    /// `state` and `value` belong together and describe the start; neither is changed.
    /// `weight` is its Monte Carlo weight e = I(x)/p(x) (or any other unbiased weight of a
    /// sample: with multiple importance sampling, the weighted one), finite and at least 0;
    /// the density must be positive wherever it is. Deposits are not divided by the number
    /// of starts: that is the listener's.
    pub fn run<N, F, D, R>(
        &mut self,
        plan: &Redistribution,
        (state, value, weight): (&S, &V, f64),
        kernel: &N,
        family: &F,
        draws: &mut D,
        depositor: &mut R,
    ) -> u32
    where
        N: Kernel<S, Value = V>,
        F: Family<V, 1> + ?Sized,
        D: Draws + ?Sized,
        R: Depositor<V> + ?Sized,
    {
        let sound = weight.is_finite() && weight >= 0.0;
        let density = checked_densities(family, value).map(|[density]| density);
        let density = match density {
            Some(density) if sound && (density > 0.0 || weight <= 0.0) => density,
            _ => {
                self.statistics.bad_starts += 1;
                return 0;
            }
        };
        self.statistics.starts += 1;
        let (mean, unit) = plan.share(weight);
        self.statistics.capped += u64::from(unit > plan.unit);
        let chains = self.rounding.round(mean, draws);
        for _ in 0..chains {
            self.reset(state, value);
            self.chain(plan, (density, unit), kernel, family, draws, depositor);
        }
        self.statistics.chains += u64::from(chains);
        chains
    }

    /// Brings the chain to the start, in the memory that is there.
    fn reset(&mut self, state: &S, value: &V) {
        match &mut self.current {
            Some((my_state, my_value)) => {
                my_state.clone_from(state);
                my_value.clone_from(value);
            }
            none => *none = Some((state.clone(), value.clone())),
        }
    }

    /// One chain from the current state, of the given density.
    fn chain<N, F, D, R>(
        &mut self,
        plan: &Redistribution,
        (density, unit): (f64, f64),
        kernel: &N,
        family: &F,
        draws: &mut D,
        depositor: &mut R,
    ) where
        N: Kernel<S, Value = V>,
        F: Family<V, 1> + ?Sized,
        D: Draws + ?Sized,
        R: Depositor<V> + ?Sized,
    {
        let Some((state, value)) = &mut self.current else {
            return;
        };
        let mut place = Place::new(density, (0.0, unit), false);
        for _ in 0..plan.steps {
            if !depositor.goes_on() {
                break;
            }
            let proposal = kernel.propose(state, value, &mut self.proposed, draws);
            let statistics = &mut self.statistics.chain;
            let densities = statistics.judge(&proposal, family, &self.proposed);
            let a = densities.map_or(0.0, |[d]| acceptance(place.density, d, proposal.ratio));
            let accepted = decide(a, draws);
            let decided = Decided {
                proposal,
                densities,
                acceptance: a,
                accepted,
            };
            statistics.count(&decided, place.density);

            let (there, here) = plan.split(a, accepted, unit);
            if plan.patience.is_some_and(|most| place.rejections > most) {
                place.held += here;
                self.statistics.dropped += here;
            } else {
                place.stayed += here;
            }
            let next = densities.map(|[density]| Place::new(density, (there, unit), true));
            if let (true, Some(next)) = (accepted, next) {
                std::mem::replace(&mut place, next).leave(value, depositor);
                std::mem::swap(value, &mut self.proposed);
                kernel.accept_move(state, &proposal);
            } else {
                if let Some(next) = next {
                    next.leave(&self.proposed, depositor);
                }
                kernel.reject_move(state, &proposal);
            }
            (self.statistics.chain).count_step(accepted, &mut place.rejections);
        }
        place.leave(value, depositor);
    }
}

impl<S: Clone, V: Clone + Default> Default for Redistributor<S, V> {
    fn default() -> Self {
        Self::new()
    }
}

impl Place {
    fn new(density: f64, (proposed, unit): (f64, f64), is_proposal: bool) -> Self {
        Self {
            density,
            proposed,
            stayed: 0.0,
            held: 0.0,
            unit,
            is_proposal,
            rejections: 0,
        }
    }

    /// Reports what was gathered here.
    fn leave<V, R: Depositor<V> + ?Sized>(self, value: &V, depositor: &mut R) {
        let light = self.proposed + self.stayed + self.held > 0.0 || self.is_proposal;
        if self.density > 0.0 && light {
            depositor.deposit(Deposit {
                value,
                density: self.density,
                proposed: self.proposed,
                stayed: self.stayed,
                held: self.held,
                unit: self.unit,
                is_proposal: self.is_proposal,
            });
        }
    }
}

#[cfg(test)]
mod tests;
