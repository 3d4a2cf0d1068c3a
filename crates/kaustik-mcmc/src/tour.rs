//! Steps of a chain by tours: many steps under a cheaper target.

use kaustik_pss::Stream;

use crate::decide::acceptance;
use crate::metropolis::Pending;
use crate::{
    Draws, Family, Ignore, Metropolis, Move, Mutation, Point, PointKernel, Recorder, Target, Visit,
};

/// What a tour goes by: a surrogate for the chain's own target, which is cheap to evaluate and whose density is nearly
/// the chain's where it is not zero.
#[doc(alias = "surrogate transition")]
#[derive(Debug)]
pub struct Touring<'a, T, C, Q> {
    /// The target of the chain.
    pub target: &'a T,
    /// The surrogate. It reads no coordinates that the target does not read, and none that stand still.
    pub surrogate: &'a C,
    /// The surrogate's density, of its values and of the target's: the same at the same point.
    pub density: &'a Q,
    /// Streams whose coordinates stand still on a tour.
    pub still: &'a [Stream],
    /// How many steps a tour takes.
    pub steps: u32,
}

/// Takes the visits of tours.
pub trait TourRecorder<V> {
    /// A tour was here, under the surrogate alone: what `visit` tells of densities is the surrogate's.
    ///
    /// Over all tours, those included that were not made, the sum of `weight * h(value)` over the number of their steps
    /// estimates the integral of h times the surrogate's density over the normaliser of the chain's own density.
    fn record_tour(&mut self, visit: Visit<'_, V, 1>);
}

impl<V> TourRecorder<V> for Ignore {
    fn record_tour(&mut self, _: Visit<'_, V, 1>) {}
}

/// Gives the visits of one tour the weight of its start.
struct Weighted<'r, R: ?Sized> {
    recorder: &'r mut R,
    weight: f64,
}

impl<V, R: TourRecorder<V> + ?Sized> Recorder<V, 1> for Weighted<'_, R> {
    #[inline]
    fn record(&mut self, visit: Visit<'_, V, 1>) {
        self.recorder.record_tour(Visit {
            weight: visit.weight * self.weight,
            ..visit
        });
    }
}

impl<M: Mutation + Clone, V, const K: usize> Metropolis<Point<M>, V, K> {
    /// One step whose proposal is where a tour has ended; tells whether it moved.
    ///
    /// The tour begins where the chain is and takes small steps under the surrogate's density s, which leave s as it is
    /// and are reversible. So a move from u to v keeps the chain's density q if it is accepted with
    /// min(1, q(v) s(u) / (q(u) s(v))), and where s is nearly q this is nearly 1 (the surrogate transition of Liu, Monte
    /// Carlo Strategies in Scientific Computing, 2001, sec. 9.4.3). The target itself is evaluated once, however
    /// long the tour was. From where s is zero there is no tour, and the chain stays: what lies there is other steps'
    /// affair.
    ///
    /// The states on the way are of use too. The start has the density q; with the weight s / q it stands for s, which the
    /// tour's steps leave as it is. So every state of the tour with that weight is a sample of s, and the recorder is
    /// told of all of them.
    ///
    /// Coordinates that the value of the current state does not use are forgotten ([`Point::refresh`]).
    /// `tour` is any chain, such as the last tour's: its state, value and pending visits are overwritten, its
    /// statistics go on.
    pub fn step_by_tour<T, C, Q, F, D, R>(
        &mut self,
        touring: &Touring<'_, T, C, Q>,
        tour: &mut Metropolis<Point<M>, V, 1>,
        family: &F,
        draws: &mut D,
        recorder: &mut R,
    ) -> bool
    where
        T: Target<Value = V>,
        C: Target<Value = V>,
        Q: Family<V, 1>,
        F: Family<V, K> + ?Sized,
        D: Draws + ?Sized,
        R: Recorder<V, K> + TourRecorder<V> + ?Sized,
    {
        let ended = self.tour(touring, tour, draws, recorder);
        self.conclude_tour(ended, touring.target, tour, family, draws, recorder)
    }

    /// Walks, and proposes nothing yet. Tells the surrogate's density where the tour began over that where it ended;
    /// `None` if there was no tour, or it ended where it had begun.
    pub(crate) fn tour<T, C, Q, D, R>(
        &mut self,
        touring: &Touring<'_, T, C, Q>,
        tour: &mut Metropolis<Point<M>, V, 1>,
        draws: &mut D,
        recorder: &mut R,
    ) -> Option<f64>
    where
        C: Target<Value = V>,
        Q: Family<V, 1>,
        D: Draws + ?Sized,
        R: TourRecorder<V> + ?Sized,
    {
        let density = self.density();
        if density <= 0.0 || touring.density.densities(&self.value)[0] <= 0.0 {
            return None;
        }
        // What the value does not use is uniform and owes nothing: of both chains it is drawn when it is needed.
        self.state.refresh();
        tour.state.clone_from(&self.state);
        (tour.pending, tour.stay) = (Pending::default(), 0);
        touring
            .surrogate
            .evaluate(&mut tour.state.current(draws), &mut tour.value);
        tour.read_densities(touring.density);
        let start = tour.density();
        if start <= 0.0 {
            return None;
        }
        let mut weighted = Weighted {
            recorder,
            weight: start / density,
        };
        let kernel = PointKernel::new(touring.surrogate, 0.0);
        let before = tour.state.time();
        for _ in 0..touring.steps {
            tour.step(&kernel, touring.density, draws, &mut weighted);
        }
        tour.flush(&mut weighted);
        let moved = tour.state.time() - before;
        tour.state.excuse(touring.still, moved);
        (moved > 0).then(|| start / tour.density())
    }

    /// Proposes where a tour has ended, and decides.
    pub(crate) fn conclude_tour<T, F, D, R>(
        &mut self,
        ended: Option<f64>,
        target: &T,
        tour: &mut Metropolis<Point<M>, V, 1>,
        family: &F,
        draws: &mut D,
        recorder: &mut R,
    ) -> bool
    where
        T: Target<Value = V>,
        F: Family<V, K> + ?Sized,
        D: Draws + ?Sized,
        R: Recorder<V, K> + ?Sized,
    {
        let Some(ratio) = ended else {
            self.pending.weight += 1.0;
            self.statistics.count_step(false, &mut self.stay);
            return false;
        };
        target.evaluate(&mut tour.state.evaluated_anew(draws), &mut self.proposed);
        let proposal = Move::new(Move::NONE, ratio);
        let decided = self.decide_on(proposal, family, draws, acceptance);
        self.statistics.count_step(decided.accepted, &mut self.stay);
        self.pending.weight += 1.0 - decided.acceptance;
        let visit = Pending {
            weight: decided.acceptance,
            independent: 0.0,
        };
        match decided.densities {
            Some(densities) if decided.accepted => {
                self.flush(recorder);
                std::mem::swap(&mut self.value, &mut self.proposed);
                std::mem::swap(&mut self.state, &mut tour.state);
                self.densities = densities;
                self.pending = visit;
                // As before the tour, and so whether it moved or not: what was forgotten there stays so.
                self.state.refresh();
            }
            Some(densities) => visit.report(self.level, &self.proposed, &densities, recorder),
            None => {}
        }
        decided.accepted
    }
}

#[cfg(test)]
mod tests;
