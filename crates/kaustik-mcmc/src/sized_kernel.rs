use crate::{Draws, Kernel, Move, Mutation, Point};

/// A kernel on points with small steps of its own sizes, for several in one chain.
///
/// A point owns its mutation, since coordinates that sleep owe steps of it. So kernels with
/// different sizes in one [`Mixture`](crate::Mixture) each give the point theirs before they propose, after what
/// it owes to the last one is paid: exact, at the price of settling where the sizes change. (A
/// [`LevelKernel`](crate::LevelKernel) gives its sizes only when a state enters its level.)
///
/// ```
/// use kaustik_mcmc::{
///     Exponential, Ignore, Metropolis, Mixture, PointKernel, SizedKernel, generator, target,
/// };
/// use kaustik_pss::{Coordinates, Stream};
///
/// let target = target(|u: &mut dyn Coordinates| u.get(Stream::Camera, 0));
/// let family = |x: &f64| [*x];
/// let sized = |size: f64| SizedKernel {
///     kernel: PointKernel::new(&target, 0.1),
///     mutation: Exponential::new(size / 16.0, size),
/// };
/// let kernel = Mixture::new([sized(0.25), sized(0.01)], [0.5, 0.5]);
/// let mut rng = generator(1, 0);
/// let mut chain = Metropolis::start(&target, &family, 0, Exponential::default(), &mut rng);
/// for _ in 0..100 {
///     chain.step(&kernel, &family, &mut rng, &mut Ignore);
/// }
/// ```
#[derive(Clone, Debug)]
pub struct SizedKernel<N, M> {
    /// How points propose.
    pub kernel: N,
    /// Its small steps.
    pub mutation: M,
}

#[deny(clippy::missing_trait_methods)]
impl<N, M> Kernel<Point<M>> for SizedKernel<N, M>
where
    N: Kernel<Point<M>>,
    M: Mutation + Clone + PartialEq,
{
    type Value = N::Value;

    fn propose<D: Draws + ?Sized>(
        &self,
        point: &mut Point<M>,
        current: &Self::Value,
        proposed: &mut Self::Value,
        draws: &mut D,
    ) -> Move {
        if *point.mutation() != self.mutation {
            point.set_mutation(self.mutation.clone(), draws);
        }
        self.kernel.propose(point, current, proposed, draws)
    }

    fn accept(&self, point: &mut Point<M>) {
        self.kernel.accept(point);
    }

    fn reject(&self, point: &mut Point<M>) {
        self.kernel.reject(point);
    }

    fn enter<D: Draws + ?Sized>(&self, point: &mut Point<M>, draws: &mut D) {
        self.kernel.enter(point, draws);
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
