use kaustik_pss::{Coordinates, Stream};

use crate::decide::decide;
use crate::point::{Coordinate, Undo};
use crate::{Draws, Mutation, Point, Step};

/// A point one step on, until it is decided.
///
/// Read the coordinates, evaluate what you like, and [`decide`](Self::decide). A proposal
/// that is dropped is rejected: the point is then as if it had never been made, to the
/// bit, in all coordinates that its state consists of. So a step cannot be decided twice, nor
/// be left open but by [`leave_open`](Self::leave_open), which says so.
///
/// This is the whole of Kelemen's method for a program that would rather keep its own loop:
///
/// ```
/// use kaustik_mcmc::{Coordinates, Draws, Exponential, Point, Step, Stream, acceptance, generator};
///
/// let brightness = |u: &mut dyn Coordinates| u.get(Stream::Camera, 0); // yours
///
/// let mut rng = generator(1, 0);
/// let mut point = Point::new(Exponential::default());
/// let mut first = point.propose(Step::Large, &mut rng);
/// let mut current = brightness(&mut first);
/// first.accept();
/// for _ in 0..100 {
///     let step = if rng.bernoulli(0.3) { Step::Large } else { Step::Small };
///     let mut proposal = point.propose(step, &mut rng);
///     let proposed = brightness(&mut proposal);
///     let a = acceptance(current, proposed, 1.0);
///     // the picture gets `current` with weight 1 - a and `proposed` with weight a, where these are above 0: what is
///     // proposed with weight 0 may be no number
///     if proposal.decide(a) {
///         current = proposed;
///     }
/// }
/// # assert!(current > 0.0);
/// ```
#[derive(Debug)]
#[must_use = "a dropped proposal is a rejected one"]
pub struct Proposal<'a, M: Mutation, D: Draws + ?Sized> {
    point: &'a mut Point<M>,
    draws: &'a mut D,
    open: bool,
}

impl<'a, M: Mutation, D: Draws + ?Sized> Proposal<'a, M, D> {
    pub(crate) fn open(point: &'a mut Point<M>, step: Step, draws: &'a mut D) -> Self {
        point.roll_back(); // of a proposal that was forgotten (mem::forget)
        (point.clock.large, point.clock.open) = (step == Step::Large, true);
        Self {
            point,
            draws,
            open: true,
        }
    }

    /// Accepts with the given probability (NaN: never) and tells whether it did.
    ///
    /// On acceptance the proposal is the point's state; otherwise the point is what it was.
    pub fn decide(mut self, acceptance: f64) -> bool {
        let accepted = decide(acceptance, self.draws);
        if accepted {
            self.point.commit();
            self.open = false;
        }
        accepted
    }

    /// Accepts without asking, as a first state is.
    pub fn accept(mut self) {
        self.point.commit();
        self.open = false;
    }

    /// Rejects without asking: the same as dropping it.
    pub fn reject(self) {}

    /// Whether this is a small or a large step.
    pub fn step(&self) -> Step {
        if self.point.clock.large {
            Step::Large
        } else {
            Step::Small
        }
    }

    /// The source of randomness, for decisions of one's own that belong to this step.
    pub fn draws(&mut self) -> &mut D {
        self.draws
    }

    /// Ends the borrow without deciding: for a [`Kernel`](crate::Kernel) of one's own on points. Its
    /// `accept` then calls [`Point::commit`] and its `reject` [`Point::roll_back`]; in a [`Ladder`](crate::Ladder)
    /// its `exchange` calls [`Point::exchange`], or step sizes change places with the points. A kernel that
    /// wraps a [`PointKernel`](crate::PointKernel) and passes all of these on to it need not know of them.
    ///
    /// What moves or settles the point before that ([`propose`](Point::propose),
    /// [`current`](Point::current), [`settle`](Point::settle), [`set_mutation`](Point::set_mutation),
    /// [`exchange`](Point::exchange), [`refresh`](Point::refresh)) rejects the proposal.
    pub fn leave_open(mut self) {
        self.open = false;
    }
}

impl<M: Mutation, D: Draws + ?Sized> Coordinates for Proposal<'_, M, D> {
    #[inline]
    fn get(&mut self, stream: Stream, index: u32) -> f64 {
        let Point {
            mutation,
            streams,
            undo,
            clock,
        } = &mut *self.point;
        let coordinate = Point::<M>::slot(streams, stream, index);
        if coordinate.modify == clock.time {
            return coordinate.value; // asked before
        }
        if !clock.large {
            // Before the push: the caught-up value belongs to the CURRENT state and must
            // survive a rejection (Kelemen sec. 6).
            Point::bring_up(coordinate, (stream, index), clock, mutation, self.draws);
        }
        let old = *coordinate;
        undo.push(Undo { stream, index, old });
        *coordinate = Coordinate {
            value: if clock.large {
                self.draws.uniform()
            } else {
                mutation.mutate_at(stream, index, old.value, self.draws)
            },
            modify: clock.time,
            seen: clock.time,
        };
        coordinate.value
    }
}

impl<M: Mutation, D: Draws + ?Sized> Drop for Proposal<'_, M, D> {
    fn drop(&mut self) {
        if self.open {
            self.point.roll_back();
        }
    }
}
