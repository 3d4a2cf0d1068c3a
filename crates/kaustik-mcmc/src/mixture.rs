//! Several kernels in one.

use crate::{Draws, Kernel, Move};

/// A kernel that chooses one of `N` at each step.
///
/// `kernels` are a tuple of up to eight kernels over the same state and value, or an array
/// of equal ones. `weights` say how the choice is made:
///
/// * an array `[f64; N]`: with fixed probabilities. Nothing of the choice is left in the
///   acceptance;
/// * a function of the current value, `Fn(&V) -> [f64; N]` (a [`Suitability`]): each
///   kernel is chosen as it suits the state. The chance p_i of choosing kernel i then
///   differs there and back, and the ratio of the move is multiplied by p_i(v) / p_i(u)
///   (Tierney 1994).
///
/// Either way each component keeps the target by itself, so that the mixture does; if all
/// are reversible, so is the mixture. The mixture moves everywhere if together they do.
///
/// With chances by suitability the probability of an independent proposal depends on the state. Then
/// no proposal counts as independent, and Kelemen's combination, which needs a constant
/// probability, cannot be used; the estimator by expected values can.
///
/// Over points, all components move by the point's one mutation, unless they are
/// [`SizedKernel`](crate::SizedKernel)s.
///
/// Weights need not sum to one; a weight of zero forbids. Where no kernel suits, the step
/// leads nowhere; weights that are NaN, infinite or negative count as a defect.
///
/// # Kinds
///
/// In the statistics, move `kind` of component i has the kind [`Mixture::kind`]`(i, kind)`
/// = i + N * kind: all moves of all components are told apart, as far as
/// [`Move::KINDS`] reaches.
///
/// ```
/// use kaustik_mcmc::{Exponential, Ignore, Metropolis, Mixture, Move, PointKernel, generator, target};
/// use kaustik_pss::{Coordinates, Stream};
///
/// let target = target(|u: &mut dyn Coordinates| u.get(Stream::Camera, 0));
/// let family = |x: &f64| [1.0 - x];
/// // large steps where the density is low, small ones where it is high
/// let suits = |x: &f64| [1.0 - x, *x];
/// let kernel = Mixture::new(
///     (PointKernel::new(&target, 0.0), PointKernel::new(&target, 1.0)),
///     suits,
/// );
/// let mut rng = generator(1, 0);
/// let mut chain = Metropolis::start(&target, &family, 0, Exponential::default(), &mut rng);
/// for _ in 0..100 {
///     chain.step(&kernel, &family, &mut rng, &mut Ignore);
/// }
/// let large = kernel.kind(1, Move::LARGE);
/// assert!(chain.statistics().moves[large].proposed > 0);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Mixture<C, W, const N: usize> {
    kernels: C,
    weights: W,
}

impl<C, W, const N: usize> Mixture<C, W, N> {
    /// Of kernels and the way to choose among them.
    pub fn new(kernels: C, weights: W) -> Self {
        Self { kernels, weights }
    }

    /// The components.
    pub fn kernels(&self) -> &C {
        &self.kernels
    }

    /// What a component's own kind of move is called by the mixture. Kinds too large to be told apart are one.
    pub const fn kind(&self, component: usize, kind: usize) -> usize {
        let most = usize::MAX / N - 1;
        component + N * if kind < most { kind } else { most }
    }
}

/// How well each of `N` kernels suits a state: relative probabilities of choosing it.
///
/// Finite and at least 0, and a function of the value alone.
pub trait Suitability<V, const N: usize> {
    /// Are they the same everywhere? If not, no move of a mixture counts as independent: a uniform proposal is
    /// chosen more often in some places than in others, or cannot be chosen back.
    const FIXED: bool = false;

    /// The relative probabilities at `value`.
    fn weights(&self, value: &V) -> [f64; N];
}

/// Fixed probabilities.
impl<V, const N: usize> Suitability<V, N> for [f64; N] {
    const FIXED: bool = true;

    #[inline]
    fn weights(&self, _: &V) -> [f64; N] {
        *self
    }
}

impl<V, F: Fn(&V) -> [f64; N], const N: usize> Suitability<V, N> for F {
    fn weights(&self, value: &V) -> [f64; N] {
        self(value)
    }
}

/// The sum of sound weights, or `None`.
fn total(weights: &[f64]) -> Option<f64> {
    let sound = weights.iter().all(|w| w.is_finite() && *w >= 0.0);
    sound
        .then(|| weights.iter().sum())
        .filter(|sum: &f64| sum.is_finite())
}

impl<S, C, W, const N: usize> Kernel<S> for Mixture<C, W, N>
where
    C: Components<S, N>,
    W: Suitability<C::Value, N>,
{
    type Value = C::Value;

    fn propose<D: Draws + ?Sized>(
        &self,
        state: &mut S,
        current: &Self::Value,
        proposed: &mut Self::Value,
        draws: &mut D,
    ) -> Move {
        let there = self.weights.weights(current);
        let Some(sum) = total(&there) else {
            return unopened(f64::NAN);
        };
        if sum <= 0.0 {
            return unopened(0.0);
        }
        let component = draws.index(&there);
        let of_component = self
            .kernels
            .propose(component, state, current, proposed, draws);
        if of_component.kind == Move::NONE {
            // a mixture within, of which no kernel was asked: nobody has anything to take back
            return of_component;
        }
        let mut proposal = Move {
            kind: self.kind(component, of_component.kind),
            independent: of_component.independent && W::FIXED,
            ..of_component
        };
        if proposal.ratio > 0.0 {
            let back = self.weights.weights(proposed);
            let chance = there[component] / sum;
            proposal.ratio *= match total(&back) {
                Some(sum) if sum > 0.0 => back[component] / sum / chance,
                Some(_) => 0.0,
                None => f64::NAN,
            };
        }
        proposal
    }

    fn accept_move(&self, state: &mut S, proposal: &Move) {
        if proposal.kind != Move::NONE {
            let (component, own) = component::<N>(proposal);
            self.kernels.accept(component, state, &own);
        }
    }

    fn reject_move(&self, state: &mut S, proposal: &Move) {
        if proposal.kind != Move::NONE {
            let (component, own) = component::<N>(proposal);
            self.kernels.reject(component, state, &own);
        }
    }

    fn enter<D: Draws + ?Sized>(&self, state: &mut S, draws: &mut D) {
        for component in 0..N {
            self.kernels.enter(component, state, draws);
        }
    }

    fn exchange<D: Draws + ?Sized>(&self, a: &mut S, b: &mut S, draws: &mut D) {
        self.kernels.exchange(a, b, draws);
    }
}

/// A move for which no kernel was asked.
fn unopened(ratio: f64) -> Move {
    Move::new(Move::NONE, ratio)
}

/// Which component made a move, and the move as that component knows it.
fn component<const N: usize>(proposal: &Move) -> (usize, Move) {
    let own = Move {
        kind: proposal.kind / N,
        ..*proposal
    };
    (proposal.kind % N, own)
}

/// `N` kernels over the same state and value, addressed by number: tuples and arrays.
pub trait Components<S, const N: usize> {
    /// What their evaluations yield.
    type Value;

    /// [`Kernel::propose`] of one of them.
    fn propose<D: Draws + ?Sized>(
        &self,
        component: usize,
        state: &mut S,
        current: &Self::Value,
        proposed: &mut Self::Value,
        draws: &mut D,
    ) -> Move;

    /// [`Kernel::accept_move`] of one of them.
    fn accept(&self, component: usize, state: &mut S, proposal: &Move);

    /// [`Kernel::reject_move`] of one of them.
    fn reject(&self, component: usize, state: &mut S, proposal: &Move);

    /// [`Kernel::enter`] of one of them.
    fn enter<D: Draws + ?Sized>(&self, component: usize, state: &mut S, draws: &mut D);

    /// [`Kernel::exchange`] of the first: kernels that share a state agree on how it moves
    /// between levels.
    fn exchange<D: Draws + ?Sized>(&self, a: &mut S, b: &mut S, draws: &mut D);
}

impl<S, A: Kernel<S>, const N: usize> Components<S, N> for [A; N] {
    type Value = A::Value;

    fn propose<D: Draws + ?Sized>(
        &self,
        component: usize,
        state: &mut S,
        current: &Self::Value,
        proposed: &mut Self::Value,
        draws: &mut D,
    ) -> Move {
        self[component].propose(state, current, proposed, draws)
    }

    fn accept(&self, component: usize, state: &mut S, proposal: &Move) {
        self[component].accept_move(state, proposal);
    }

    fn reject(&self, component: usize, state: &mut S, proposal: &Move) {
        self[component].reject_move(state, proposal);
    }

    fn enter<D: Draws + ?Sized>(&self, component: usize, state: &mut S, draws: &mut D) {
        self[component].enter(state, draws);
    }

    fn exchange<D: Draws + ?Sized>(&self, a: &mut S, b: &mut S, draws: &mut D) {
        self[0].exchange(a, b, draws);
    }
}

macro_rules! components_of_a_tuple {
    ($count:literal: $first:ident 0 $(, $kernel:ident $number:tt)*) => {
        impl<S, $first, $($kernel),*> Components<S, $count> for ($first, $($kernel),*)
        where
            $first: Kernel<S>,
            $($kernel: Kernel<S, Value = $first::Value>),*
        {
            type Value = $first::Value;

            fn propose<Draw: Draws + ?Sized>(
                &self,
                component: usize,
                state: &mut S,
                current: &Self::Value,
                proposed: &mut Self::Value,
                draws: &mut Draw,
            ) -> Move {
                match component {
                    $($number => self.$number.propose(state, current, proposed, draws),)*
                    _ => self.0.propose(state, current, proposed, draws),
                }
            }

            fn accept(&self, component: usize, state: &mut S, proposal: &Move) {
                match component {
                    $($number => self.$number.accept_move(state, proposal),)*
                    _ => self.0.accept_move(state, proposal),
                }
            }

            fn reject(&self, component: usize, state: &mut S, proposal: &Move) {
                match component {
                    $($number => self.$number.reject_move(state, proposal),)*
                    _ => self.0.reject_move(state, proposal),
                }
            }

            fn enter<Draw: Draws + ?Sized>(
                &self,
                component: usize,
                state: &mut S,
                draws: &mut Draw,
            ) {
                match component {
                    $($number => self.$number.enter(state, draws),)*
                    _ => self.0.enter(state, draws),
                }
            }

            fn exchange<Draw: Draws + ?Sized>(&self, a: &mut S, b: &mut S, draws: &mut Draw) {
                self.0.exchange(a, b, draws);
            }
        }
    };
}

components_of_a_tuple!(2: A 0, B 1);
components_of_a_tuple!(3: A 0, B 1, C 2);
components_of_a_tuple!(4: A 0, B 1, C 2, D 3);
components_of_a_tuple!(5: A 0, B 1, C 2, D 3, E 4);
components_of_a_tuple!(6: A 0, B 1, C 2, D 3, E 4, F 5);
components_of_a_tuple!(7: A 0, B 1, C 2, D 3, E 4, F 5, G 6);
components_of_a_tuple!(8: A 0, B 1, C 2, D 3, E 4, F 5, G 6, H 7);

#[cfg(test)]
mod tests;
