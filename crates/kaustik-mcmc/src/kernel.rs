use crate::{Draws, Mutation, Point, Step, Target};

/// How a chain proposes, for any kind of state `S`.
///
/// A kernel owns the way from a state to a proposal and back; the chain
/// ([`Metropolis`](crate::Metropolis)) owns the decision, the values and the book-keeping.
/// `S` is what must be remembered of where the chain is beside the value: a [`Point`] of
/// the unit cube for [`PointKernel`]; `()` for a kernel that moves the values themselves,
/// as mutations of light paths do (Veach and Guibas 1997).
///
/// States that take proposals back, or have something that belongs to a level, need more than [`propose`](Self::propose):
/// on [`Point`]s, [`accept`](Self::accept) commits, [`reject`](Self::reject) rolls back and [`exchange`](Self::exchange)
/// leaves each level its step sizes ([`Proposal::leave_open`](crate::Proposal::leave_open) names the calls).
///
/// Each [`propose`](Self::propose) is followed by exactly one of [`accept_move`](Self::accept_move)
/// and [`reject_move`](Self::reject_move), which call [`accept`](Self::accept) and [`reject`](Self::reject)
/// unless a kernel says otherwise, as a [`Mixture`](crate::Mixture) does. So a kernel that wraps another
/// forwards every method that it does not change: these two, `enter` and `exchange` as well. With
/// `#[deny(clippy::missing_trait_methods)]` on its implementation, clippy names what is not forwarded.
///
/// ```
/// use kaustik_mcmc::{Draws, Kernel, Metropolis, Move, Visit, generator};
///
/// /// Gas on a ring of 16 places, a bit each: some place gets its atom or loses it.
/// struct Flip;
///
/// impl Kernel<()> for Flip {
///     type Value = u16;
///
///     fn propose<D: Draws + ?Sized>(
///         &self, (): &mut (), &gas: &u16, proposed: &mut u16, draws: &mut D,
///     ) -> Move {
///         *proposed = gas ^ (1 << draws.index(&[1.0; 16]));
///         Move::new(Move::OWN, 1.0) // the way back is as likely
///     }
/// }
///
/// // Neighbours exclude each other; what is allowed has density 2^atoms.
/// let density = |gas: &u16| {
///     let apart = gas & gas.rotate_left(1) == 0;
///     [if apart { f64::from(1 << gas.count_ones()) } else { 0.0 }]
/// };
/// let mut chain = Metropolis::at((), 0, &density, 0);
/// let (steps, mut atoms) = (100_000, 0.0);
/// let mut count = |visit: Visit<'_, u16, 1>| {
///     atoms += visit.weight * f64::from(visit.value.count_ones());
/// };
/// let mut rng = generator(7, 0);
/// for _ in 0..steps {
///     chain.step(&Flip, &density, &mut rng, &mut count);
/// }
/// chain.flush(&mut count);
///
/// // The partition function is 2^16 + (-1)^16: eigenvalues of the transfer matrix are 2 and -1.
/// let mean = atoms / f64::from(steps);
/// # let all = (0..=u16::MAX).map(|gas| (density(&gas)[0], gas.count_ones()));
/// # let (z, n) = all.fold((0.0, 0.0), |(z, n), (d, c)| (z + d, n + d * f64::from(c)));
/// # assert_eq!(z, 65537.0);
/// # let expected = n / z;
/// assert!((mean - expected).abs() < 0.05, "{mean} for {expected}");
/// ```
pub trait Kernel<S> {
    /// What an evaluation yields.
    type Value;

    /// Evaluates a proposal into `proposed`, which holds an older value, and says how it
    /// came about. `state` and `current` belong together and describe where the chain is.
    fn propose<D: Draws + ?Sized>(
        &self,
        state: &mut S,
        current: &Self::Value,
        proposed: &mut Self::Value,
        draws: &mut D,
    ) -> Move;

    /// The proposal is the state now.
    fn accept(&self, state: &mut S) {
        let _ = state;
    }

    /// The proposal never was: `state` must describe the current value again, exactly. (What a state
    /// has beside that, such as the direction of a lifted walk, may change, if the joint law is kept:
    /// [`assert_stationary`](crate::testing::assert_stationary) on the whole state tells.)
    fn reject(&self, state: &mut S) {
        let _ = state;
    }

    /// The state comes to this kernel from another one: that of another level of an
    /// annealing, or with other step sizes.
    ///
    /// What the state still owes to the kernel it comes from is paid here (a lazy [`Point`]
    /// does: see "The debt belongs to a mutation" there). States that owe nothing need
    /// nothing, which is the default.
    fn enter<D: Draws + ?Sized>(&self, state: &mut S, draws: &mut D) {
        let _ = (state, draws);
    }

    /// Two states change places: `a` goes to the level of `b` and the other way round.
    ///
    /// Each pays first what it owes at the level that it leaves; what belongs to a level
    /// (step sizes) stays. Asked of the kernel of the level of `a`. The default swaps, which
    /// is right for states that owe nothing.
    fn exchange<D: Draws + ?Sized>(&self, a: &mut S, b: &mut S, draws: &mut D) {
        let _ = draws;
        std::mem::swap(a, b);
    }

    /// What chains call to accept: [`accept`](Self::accept), told which move it was. A
    /// kernel made of several, such as a [`Mixture`](crate::Mixture), finds the one by the
    /// move's kind.
    #[inline]
    fn accept_move(&self, state: &mut S, proposal: &Move) {
        let _ = proposal;
        self.accept(state);
    }

    /// What chains call to reject: [`reject`](Self::reject), told which move it was.
    #[inline]
    fn reject_move(&self, state: &mut S, proposal: &Move) {
        let _ = proposal;
        self.reject(state);
    }
}

/// A reference to a kernel is one: K levels may share it. (Families and recorders have no such
/// rule, as closures are families and recorders: pass these by reference.)
#[deny(clippy::missing_trait_methods)]
impl<S, N: Kernel<S>> Kernel<S> for &N {
    type Value = N::Value;

    fn propose<D: Draws + ?Sized>(
        &self,
        state: &mut S,
        current: &Self::Value,
        proposed: &mut Self::Value,
        draws: &mut D,
    ) -> Move {
        (**self).propose(state, current, proposed, draws)
    }

    fn accept(&self, state: &mut S) {
        (**self).accept(state);
    }

    fn reject(&self, state: &mut S) {
        (**self).reject(state);
    }

    fn enter<D: Draws + ?Sized>(&self, state: &mut S, draws: &mut D) {
        (**self).enter(state, draws);
    }

    fn exchange<D: Draws + ?Sized>(&self, a: &mut S, b: &mut S, draws: &mut D) {
        (**self).exchange(a, b, draws);
    }

    fn accept_move(&self, state: &mut S, proposal: &Move) {
        (**self).accept_move(state, proposal);
    }

    fn reject_move(&self, state: &mut S, proposal: &Move) {
        (**self).reject_move(state, proposal);
    }
}

/// How a proposal came about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// What sort of move it was, for the statistics: below [`Move::KINDS`], or it counts as
    /// the last; [`Move::NONE`] counts as none. [`Move::SMALL`], [`Move::LARGE`] and [`Move::SECOND`] are taken.
    pub kind: usize,
    /// T(v -> u) / T(u -> v), the chance of proposing the way back over that of the way
    /// there: finite, at least 0; 1 for symmetric proposals, 0 if the proposal is
    /// impossible (its value is then ignored).
    ///
    /// Of continuous states these are densities, both in the measure of the family's own density, and with
    /// the probability of choosing this kind of move. A map y = g(x) without a random number of its own
    /// contributes its Jacobian, |det dy/dx|.
    pub ratio: f64,
    /// Whether the proposal is a sample of the uniform law on the cube, independent of the current state.
    /// Such samples estimate the normaliser, those of ratio 0 as zeros: an independent proposal that comes to
    /// nothing must say so here too.
    pub independent: bool,
}

impl Move {
    /// The kind of no move at all: where none of several kernels suits a state.
    pub const NONE: usize = usize::MAX;
    /// How many kinds of moves are told apart.
    pub const KINDS: usize = 32;
    /// The kind of a small step.
    pub const SMALL: usize = 0;
    /// The kind of a large step.
    pub const LARGE: usize = 1;
    /// The kind of a second try, after a rejected large step: see
    /// [`SecondStage`](crate::SecondStage).
    pub const SECOND: usize = 2;
    /// The first kind that is free for a kernel of your own.
    pub const OWN: usize = 3;

    /// A symmetric small step.
    pub const fn small() -> Self {
        Self::new(Self::SMALL, 1.0)
    }

    /// An independent uniform proposal.
    pub const fn large() -> Self {
        Self {
            kind: Self::LARGE,
            ratio: 1.0,
            independent: true,
        }
    }

    /// A move that depends on the current state.
    pub const fn new(kind: usize, ratio: f64) -> Self {
        Self {
            kind,
            ratio,
            independent: false,
        }
    }

    /// A move that leads nowhere: certain to be rejected. One that was to be independent is
    /// `Move { ratio: 0.0, ..Move::large() }`.
    pub const fn impossible(kind: usize) -> Self {
        Self::new(kind, 0.0)
    }
}

/// Kelemen's mixture on lazy points: a large step with probability `p_large`, otherwise a
/// small one by the point's own mutation. Symmetric as a whole.
#[derive(Clone, Debug)]
pub struct PointKernel<T> {
    /// What is evaluated. References to targets are targets.
    pub target: T,
    /// Probability of a large step, in [0, 1]; Kelemen reports about 0.5 as best. 0 needs
    /// another source of large jumps, such as an exchange with a uniform replica. Below 0, or NaN, is 0; above 1 is 1.
    pub p_large: f64,
}

impl<T: Target> PointKernel<T> {
    /// The mixture with the given probability of large steps.
    pub fn new(target: T, p_large: f64) -> Self {
        Self { target, p_large }
    }
}

impl<T: Target, M: Mutation> Kernel<Point<M>> for PointKernel<T> {
    type Value = T::Value;

    fn propose<D: Draws + ?Sized>(
        &self,
        point: &mut Point<M>,
        _current: &T::Value,
        proposed: &mut T::Value,
        draws: &mut D,
    ) -> Move {
        let large = draws.bernoulli(self.p_large);
        let step = if large { Step::Large } else { Step::Small };
        let mut proposal = point.propose(step, draws);
        self.target.evaluate(&mut proposal, proposed);
        proposal.leave_open();
        if large { Move::large() } else { Move::small() }
    }

    fn accept(&self, point: &mut Point<M>) {
        point.commit();
    }

    fn reject(&self, point: &mut Point<M>) {
        point.roll_back();
    }

    fn enter<D: Draws + ?Sized>(&self, point: &mut Point<M>, draws: &mut D) {
        point.settle(draws);
    }

    fn exchange<D: Draws + ?Sized>(&self, a: &mut Point<M>, b: &mut Point<M>, draws: &mut D) {
        a.exchange(b, draws);
    }
}
