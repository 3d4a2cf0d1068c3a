//! Chains on the unit cube: how they start, and what else needs the coordinates of a point.

use kaustik_pss::{Coordinates, Recording};

use super::{Metropolis, Pending};
use crate::{Draws, Family, Mutation, Point, Start, StartError, Step, Target};

impl<M: Mutation, V: Default, const K: usize> Metropolis<Point<M>, V, K> {
    /// A chain on the unit cube that starts at an independent sample made from `draws`.
    ///
    /// Its weighted visits estimate means under the target only after burn-in; to be
    /// unbiased from the first step, choose the sample from a [`Pool`](crate::Pool).
    pub fn start<T, F, D>(target: &T, family: &F, level: usize, mutation: M, draws: &mut D) -> Self
    where
        T: Target<Value = V> + ?Sized,
        F: Family<V, K> + ?Sized,
        D: Draws + ?Sized,
    {
        let mut point = Point::new(mutation);
        let mut value = V::default();
        evaluate_independent(target, &mut point, &mut value, draws);
        Self::at(point, value, family, level)
    }

    /// As [`start`](Self::start), for a sample whose density is known already: rebuilds it
    /// and checks that it is the same, to the bit.
    ///
    /// # Errors
    ///
    /// If the density differs (the target is not a function of its coordinates, or the
    /// generator is another) or is zero.
    pub fn rebuild<T, F, D>(
        target: &T,
        family: &F,
        level: usize,
        mutation: M,
        start: &Start,
        draws: &mut D,
    ) -> Result<Self, StartError>
    where
        T: Target<Value = V> + ?Sized,
        F: Family<V, K> + ?Sized,
        D: Draws + ?Sized,
    {
        let chain = Self::start(target, family, level, mutation, draws);
        start.check(chain.density())?;
        Ok(chain)
    }

    /// As [`rebuild`](Self::rebuild), from any source of coordinates: a
    /// [`Recorded`](kaustik_pss::Recorded) sample, or one whose coordinates were not drawn
    /// in the order of the asks, such as a [`Stratified`](crate::Stratified) one.
    ///
    /// # Errors
    ///
    /// As for [`rebuild`](Self::rebuild).
    pub fn rebuild_from<T, F>(
        target: &T,
        family: &F,
        level: usize,
        mutation: M,
        start: &Start,
        source: &mut dyn Coordinates,
    ) -> Result<Self, StartError>
    where
        T: Target<Value = V> + ?Sized,
        F: Family<V, K> + ?Sized,
    {
        let mut recording = Recording::new(source);
        let mut value = V::default();
        target.evaluate(&mut recording, &mut value);
        let point = Point::from_recorded(mutation, recording.record());
        let chain = Self::at(point, value, family, level);
        start.check(chain.density())?;
        Ok(chain)
    }

    /// Begins anew at an independent sample made from `draws`, in the memory that is there.
    /// Statistics go on. Flush before.
    pub fn restart<T, F, D>(&mut self, target: &T, family: &F, draws: &mut D)
    where
        T: Target<Value = V> + ?Sized,
        F: Family<V, K> + ?Sized,
        D: Draws + ?Sized,
    {
        self.state.clear();
        evaluate_independent(target, &mut self.state, &mut self.value, draws);
        self.pending = Pending::default();
        self.stay = 0;
        self.read_densities(family);
    }

    /// Changes the sizes of small steps; what sleeping coordinates owe to the old ones is
    /// paid first.
    pub fn set_mutation<D: Draws + ?Sized>(&mut self, mutation: M, draws: &mut D) {
        self.state.set_mutation(mutation, draws);
    }

    /// Pays what sleeping coordinates owe: see [`Point::settle`].
    pub fn settle<D: Draws + ?Sized>(&mut self, draws: &mut D) {
        self.state.settle(draws);
    }

    /// Forgets the coordinates that the current value does not use: see [`Point::refresh`],
    /// also on when it may be called.
    pub fn refresh(&mut self) {
        self.state.refresh();
    }

    /// Evaluates the current state under a target that has changed, and reads its densities. What was
    /// gathered and not [flushed](Self::flush) before is forgotten. Coordinates that the new target reads and
    /// the old did not are brought up to date or drawn.
    pub fn evaluate_anew<T, F, D>(&mut self, target: &T, family: &F, draws: &mut D)
    where
        T: Target<Value = V> + ?Sized,
        F: Family<V, K> + ?Sized,
        D: Draws + ?Sized,
    {
        target.evaluate(&mut self.state.evaluated_anew(draws), &mut self.value);
        self.pending = Pending::default();
        self.stay = 0;
        self.read_densities(family);
    }

    /// Evaluates the current state again, into `value`: a target that is a function of its
    /// coordinates gives what it gave before.
    pub fn evaluate_again<T, D>(&mut self, target: &T, value: &mut V, draws: &mut D)
    where
        T: Target<Value = V> + ?Sized,
        D: Draws + ?Sized,
    {
        target.evaluate(&mut self.state.current(draws), value);
    }
}

/// Moves a fresh point to an independent sample.
fn evaluate_independent<T: Target + ?Sized, M: Mutation, D: Draws + ?Sized>(
    target: &T,
    point: &mut Point<M>,
    value: &mut T::Value,
    draws: &mut D,
) {
    let mut proposal = point.propose(Step::Large, draws);
    target.evaluate(&mut proposal, value);
    proposal.leave_open();
    point.commit();
}
