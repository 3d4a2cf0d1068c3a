//! Ladders on the unit cube.

use super::Ladder;
use crate::{
    Both, Draws, Family, Metropolis, Mutation, Point, Recorder, Region, Scouted, Scouting, Target,
    TourRecorder, Touring,
};

impl<M: Mutation, V: Default, const K: usize> Ladder<Point<M>, V, K> {
    /// A ladder on the unit cube: each replica starts at an independent sample of its own,
    /// with the mutation of its level.
    ///
    /// Uniform is the right law for level 0 alone, so the others burn in;
    /// [`anneal`](crate::anneal) gives better starts.
    pub fn start<T, F, D>(target: &T, family: &F, mutations: [M; K], draws: &mut D) -> Self
    where
        T: Target<Value = V> + ?Sized,
        F: Family<V, K> + ?Sized,
        D: Draws + ?Sized,
    {
        let mut level = 0..;
        Self::of(mutations.map(|mutation| {
            let level = level.next().unwrap_or_default();
            Metropolis::start(target, family, level, mutation, draws)
        }))
    }

    /// Evaluates all states under a target that has changed: see [`Metropolis::evaluate_anew`].
    pub fn evaluate_anew<T, F, D>(&mut self, target: &T, family: &F, draws: &mut D)
    where
        T: Target<Value = V> + ?Sized,
        F: Family<V, K> + ?Sized,
        D: Draws + ?Sized,
    {
        for replica in &mut self.replicas {
            replica.evaluate_anew(target, family, draws);
        }
    }

    /// Puts the chain of a level where another chain is; it keeps the sizes of its own steps. For chains whose
    /// density has become zero because the target has changed. What was gathered and not flushed is
    /// forgotten, statistics go on.
    ///
    /// # Panics
    ///
    /// If `level` is K or more.
    pub fn restart_from<D: Draws + ?Sized>(
        &mut self,
        level: usize,
        other: &Metropolis<Point<M>, V, K>,
        draws: &mut D,
    ) where
        M: Clone,
        V: Clone,
    {
        let chain = &mut self.replicas[level];
        let mutation = chain.state().mutation().clone();
        chain.copy_from(other);
        chain.set_mutation(mutation, draws);
    }

    /// Changes the sizes of small steps at a level, after paying what is owed to the old ones.
    ///
    /// # Panics
    ///
    /// If `level` is K or more.
    pub fn set_mutation<D: Draws + ?Sized>(&mut self, level: usize, mutation: M, draws: &mut D) {
        self.replicas[level].set_mutation(mutation, draws);
    }
}

impl<M: Mutation, V, const K: usize> Ladder<Point<M>, V, K> {
    /// Sends a scout for the replica of a level: [`Metropolis::scout`].
    ///
    /// # Panics
    ///
    /// If `level` is K or more.
    #[inline]
    pub fn scout<T, G, F, D, R>(
        &mut self,
        level: usize,
        scouting: &Scouting<'_, T, G>,
        spare: &mut Point<M>,
        family: &F,
        draws: &mut D,
        recorder: &mut R,
    ) -> Scouted
    where
        T: Target<Value = V>,
        G: Region<V>,
        F: Family<V, K> + ?Sized,
        D: Draws + ?Sized,
        R: Recorder<V, K> + ?Sized,
    {
        let mut both = Both(&mut self.stepping_stone, recorder);
        self.replicas[level].scout(scouting, spare, family, draws, &mut both)
    }

    /// A step of the replica of a level by a tour: [`Metropolis::step_by_tour`].
    ///
    /// # Panics
    ///
    /// If `level` is K or more.
    #[inline]
    pub fn step_by_tour<T, C, Q, F, D, R>(
        &mut self,
        level: usize,
        touring: &Touring<'_, T, C, Q>,
        tour: &mut Metropolis<Point<M>, V, 1>,
        family: &F,
        draws: &mut D,
        recorder: &mut R,
    ) -> bool
    where
        M: Clone,
        T: Target<Value = V>,
        C: Target<Value = V>,
        Q: Family<V, 1>,
        F: Family<V, K> + ?Sized,
        D: Draws + ?Sized,
        R: Recorder<V, K> + TourRecorder<V> + ?Sized,
    {
        let replica = &mut self.replicas[level];
        let ended = replica.tour(touring, tour, draws, recorder);
        let mut both = Both(&mut self.stepping_stone, recorder);
        replica.conclude_tour(ended, touring.target, tour, family, draws, &mut both)
    }
}
