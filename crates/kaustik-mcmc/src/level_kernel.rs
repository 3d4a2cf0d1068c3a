use crate::{Draws, Kernel, Move, Mutation, Point, PointKernel, Target};

/// A [`PointKernel`] together with the mutation of its level.
///
/// A point owns its mutation, so a ladder's replicas bring their step sizes with them. A
/// particle of an annealing climbs from level to level and needs the sizes of each: this
/// kernel gives them to it when it [enters](Kernel::enter), after what it owes to the old
/// ones is paid. The same kernels then serve the [`Ladder`](crate::Ladder) that starts where
/// the annealing ends.
///
/// Steps themselves go by the point's own mutation: `mutation` says nothing until a point enters. A chain that has not
/// come from another level is to be started with the same one; and of several of these in one
/// [`Mixture`](crate::Mixture) over the same points, the last to be entered decides the sizes of all:
/// take [`SizedKernel`](crate::SizedKernel)s there.
#[derive(Clone, Debug)]
pub struct LevelKernel<T, M> {
    /// How points propose.
    pub kernel: PointKernel<T>,
    /// Small steps at this level.
    pub mutation: M,
}

impl<T: Target, M: Mutation> LevelKernel<T, M> {
    /// Large steps with probability `p_large`, small ones by `mutation`.
    pub fn new(target: T, p_large: f64, mutation: M) -> Self {
        Self {
            kernel: PointKernel::new(target, p_large),
            mutation,
        }
    }
}

#[deny(clippy::missing_trait_methods)]
impl<T: Target, M: Mutation + Clone> Kernel<Point<M>> for LevelKernel<T, M> {
    type Value = T::Value;

    fn propose<D: Draws + ?Sized>(
        &self,
        point: &mut Point<M>,
        current: &T::Value,
        proposed: &mut T::Value,
        draws: &mut D,
    ) -> Move {
        self.kernel.propose(point, current, proposed, draws)
    }

    fn accept(&self, point: &mut Point<M>) {
        self.kernel.accept(point);
    }

    fn reject(&self, point: &mut Point<M>) {
        self.kernel.reject(point);
    }

    fn enter<D: Draws + ?Sized>(&self, point: &mut Point<M>, draws: &mut D) {
        point.set_mutation(self.mutation.clone(), draws);
    }

    fn exchange<D: Draws + ?Sized>(&self, a: &mut Point<M>, b: &mut Point<M>, draws: &mut D) {
        self.kernel.exchange(a, b, draws);
    }

    fn accept_move(&self, point: &mut Point<M>, proposal: &Move) {
        self.kernel.accept_move(point, proposal);
    }

    fn reject_move(&self, point: &mut Point<M>, proposal: &Move) {
        self.kernel.reject_move(point, proposal);
    }
}
