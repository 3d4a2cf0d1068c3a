//! A second try after a rejected large step.
//!
//! A large step looks everywhere and is mostly rejected; then the whole step was for
//! nothing but the estimate. Delayed rejection (Tierney and Mira 1999; Green and Mira 2001;
//! in light transport Rioux-Lavoie, Litalien, Gruson, Hachisuka and Nowrouzezahrai 2020,
//! "Delayed rejection Metropolis light transport") follows the bold proposal, once it was
//! rejected, with a timid one from the same state.
//!
//! # Derivation
//!
//! Let x be the current state, y the first proposal with density q1, accepted with a1; z
//! the second with density q2. For detailed balance between x and z *through y* the way
//! back must count that from z the same y was proposed first, and rejected (Tierney and
//! Mira, section 4):
//!
//! a2 = min(1, \[pi(z) q1(z->y) (1 - a1(z,y)) q2(z,y->x)\] / \[pi(x) q1(x->y) (1 - a1(x,y)) q2(x,y->z)\])
//!
//! Here the first proposal is uniform on the cube, whatever the state: q1(x->y) = q1(z->y)
//! = 1, also in the infinitely many coordinates that are made lazily. The second starts
//! from x, not from y, so that q2 does not depend on y and its ratio is the move's own
//! (1 for small steps). With a1(x,y) = min(1, pi(y)/pi(x)) what is left of pi(x) (1 -
//! a1(x,y)) is pi(x) - pi(y), positive because y was rejected, and of pi(z) (1 - a1(z,y))
//! it is max(0, pi(z) - pi(y)):
//!
//! a2 = min(1, ratio * max(0, pi(z) - pi(y)) / (pi(x) - pi(y)))
//!
//! The normaliser cancels. A z that is no denser than y is never accepted: from there, y
//! would not have been rejected. A first step that is not independent (a wider small
//! step) would leave q1(z->y) / q1(x->y) over all coordinates, read or not; so only
//! independent proposals get a second try.
//!
//! # Weights
//!
//! The expected next state is a1 at y, (1 - a1) a2 at z and (1 - a1) (1 - a2) at x. But z is
//! only known if the first coin, of chance 1 - a1, came up rejection. So y is given a1 in
//! any case; and in that event, z is given a2 and x is given 1 - a2. The coin supplies the
//! factor 1 - a1, and each expectation is right. The weights of one step sum to a1 or 1 + a1,
//! to 1 on average: weights that sum to 1 in every case and leave y its a1 would have to be
//! negative somewhere (if y was accepted they give x 1 - a1; in the other case, x then gets
//! 1 - a2 - a1).
//!
//! # When
//!
//! A step costs up to two evaluations. It pays where large steps are rarely accepted, and
//! at a high probability of them. With few large steps, plain [`Metropolis::step`] is as
//! good, and gives weights that sum to the number of steps.

use crate::decide::acceptance;
use crate::metropolis::Pending;
use crate::{
    Draws, Family, Kernel, Metropolis, Move, Mutation, Point, PointKernel, Recorder, Step, Target,
};

/// A kernel that has a second proposal to make after its independent one was rejected.
#[doc(alias = "delayed rejection")]
pub trait SecondStage<S>: Kernel<S> {
    /// As [`Kernel::propose`], from a state whose independent proposal has just been
    /// rejected and undone. Must not depend on what that proposal was. To be followed by
    /// one acceptance or rejection.
    fn propose_again<D: Draws + ?Sized>(
        &self,
        state: &mut S,
        current: &Self::Value,
        proposed: &mut Self::Value,
        draws: &mut D,
    ) -> Move;
}

/// After a rejected large step, a small one.
impl<T: Target, M: Mutation> SecondStage<Point<M>> for PointKernel<T> {
    fn propose_again<D: Draws + ?Sized>(
        &self,
        point: &mut Point<M>,
        _current: &T::Value,
        proposed: &mut T::Value,
        draws: &mut D,
    ) -> Move {
        let mut proposal = point.propose(Step::Small, draws);
        self.target.evaluate(&mut proposal, proposed);
        proposal.leave_open();
        Move::new(Move::SECOND, 1.0)
    }
}

/// The acceptance probability of a second proposal: a2 of [`Metropolis::step_delayed`].
///
/// `current`, `first` and `second` are densities, finite and at least 0, with `first` below
/// `current` (the first proposal, a uniform one, was rejected); `ratio` is that of the second
/// proposal alone, as for [`acceptance`].
pub fn second_acceptance(current: f64, first: f64, second: f64, ratio: f64) -> f64 {
    acceptance(current - first, (second - first).max(0.0), ratio)
}

impl<S, V, const K: usize> Metropolis<S, V, K> {
    /// One step with delayed rejection: as [`step`](Self::step), but an independent proposal
    /// that is rejected is followed by a second try. Tells whether the state changed.
    ///
    /// With x the state, y the uniform and z the second proposal, z is accepted with
    ///
    /// a2 = min(1, ratio * max(0, pi(z) - pi(y)) / (pi(x) - pi(y)))
    ///
    /// (Tierney and Mira 1999 for an independent first stage). The step keeps the target and
    /// is reversible. Weights of visits: y gets a1; if it is rejected, z gets a2 and x
    /// 1 - a2. They are at least 0 and unbiased, but sum to the number of steps only on
    /// average. A step counts as one in [`Statistics`](crate::Statistics); the second try is
    /// a move of its own kind ([`Move::SECOND`] for points).
    ///
    /// Only first tries that call themselves independent are followed by a second. A kernel may call a proposal independent
    /// only if it is uniform on the cube, with ratio 1.
    pub fn step_delayed<N, F, D, R>(
        &mut self,
        kernel: &N,
        family: &F,
        draws: &mut D,
        recorder: &mut R,
    ) -> bool
    where
        N: SecondStage<S, Value = V>,
        F: Family<V, K> + ?Sized,
        D: Draws + ?Sized,
        R: Recorder<V, K> + ?Sized,
    {
        let proposal = kernel.propose(&mut self.state, &self.value, &mut self.proposed, draws);
        let first = self.decide_on(proposal, family, draws, acceptance);
        let again = proposal.independent;
        if !again {
            self.pending.weight += 1.0 - first.acceptance;
        }
        let visit = Pending {
            weight: first.acceptance,
            independent: f64::from(u8::from(again)),
        };
        self.conclude(kernel, &first, visit, recorder);
        let first_density = first.densities.map_or(0.0, |d| d[self.level]);
        let moved = first.accepted
            || again && self.second_try(first_density, kernel, family, draws, recorder);
        self.statistics.count_step(moved, &mut self.stay);
        moved
    }

    /// The second stage, after an independent proposal of density `first` was rejected.
    fn second_try<N, F, D, R>(
        &mut self,
        first: f64,
        kernel: &N,
        family: &F,
        draws: &mut D,
        recorder: &mut R,
    ) -> bool
    where
        N: SecondStage<S, Value = V>,
        F: Family<V, K> + ?Sized,
        D: Draws + ?Sized,
        R: Recorder<V, K> + ?Sized,
    {
        let proposal =
            kernel.propose_again(&mut self.state, &self.value, &mut self.proposed, draws);
        let second = self.decide_on(proposal, family, draws, |from, to, ratio| {
            second_acceptance(from, first, to, ratio)
        });
        self.pending.weight += 1.0 - second.acceptance;
        let visit = Pending {
            weight: second.acceptance,
            independent: 0.0,
        };
        self.conclude(kernel, &second, visit, recorder);
        second.accepted
    }
}

#[cfg(test)]
mod tests;
