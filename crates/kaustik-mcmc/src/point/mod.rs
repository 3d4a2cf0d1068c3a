//! The lazy point: a state of infinitely many coordinates, of which few are ever made.

mod record;
mod seeded;
#[cfg(feature = "serde")]
mod serial;

pub use seeded::Seeding;

use kaustik_pss::{Coordinates, Stream};

use crate::{Draws, Mutation, Proposal};

/// How a point moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Step {
    /// Every coordinate takes one step of the point's mutation.
    Small,
    /// Every coordinate is a fresh uniform number, independent of the current state.
    Large,
}

/// A point of the infinite-dimensional unit cube, mutated lazily (Kelemen et al. 2002,
/// sections 4 and 6).
///
/// In principle every accepted step moves all coordinates. In practice a coordinate is
/// brought up to date when it is read: each has the time of its last change, the point has
/// a clock that counts accepted steps, and what a coordinate slept through since is
/// replayed then. One that was not read since the last accepted large step is simply drawn:
/// the mutation keeps the uniform law, so "uniform and then n perturbations" of something
/// that nobody has seen *is* uniform. (The paper replays.)
///
/// A point is moved through [`propose`](Self::propose), which gives a [`Proposal`] to
/// read from and to decide upon.
///
/// # The debt belongs to a mutation
///
/// A coordinate that sleeps owes steps of the mutation that was in force while it slept.
/// Paying them later with other step sizes would bias the chain. So the point owns its
/// mutation, and what changes it pays the debt first: [`set_mutation`](Self::set_mutation),
/// [`exchange`](Self::exchange). If the sizes of your mutation change by themselves (through a
/// `Cell`, say), call [`settle`](Self::settle) before each change. If you move a point to
/// another level by hand, call [`settle`](Self::settle) or [`refresh`](Self::refresh) first.
///
/// # Memory
///
/// Coordinates are stored densely per stream, up to the largest index that was ever read.
/// Once the largest index has been met, a step allocates nothing.
#[derive(Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(
        try_from = "serial::Read<M>",
        bound(deserialize = "M: Mutation + serde::Deserialize<'de>")
    )
)]
#[doc(alias = "primary sample space")]
#[doc(alias = "lazy evaluation")]
pub struct Point<M> {
    pub(crate) mutation: M,
    pub(crate) streams: [Vec<Coordinate>; Stream::COUNT],
    pub(crate) undo: Vec<Undo>,
    pub(crate) clock: Clock,
}

/// By hand for `clone_from`, which takes over a state in the memory that is there.
impl<M: Clone> Clone for Point<M> {
    fn clone(&self) -> Self {
        Self {
            mutation: self.mutation.clone(),
            streams: self.streams.clone(),
            undo: self.undo.clone(),
            clock: self.clock,
        }
    }

    fn clone_from(&mut self, other: &Self) {
        self.mutation.clone_from(&other.mutation);
        self.streams.clone_from(&other.streams);
        self.undo.clone_from(&other.undo);
        self.clock = other.clock;
    }
}

/// The clock of a point. It goes wherever the coordinates go.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clock {
    /// Time stamp of the next proposal: the number of accepted steps, the first included. The current state's own is one less.
    pub(crate) time: i64,
    /// Time stamp of the last accepted large step.
    pub(crate) large_time: i64,
    /// Whether the open proposal is a large step.
    pub(crate) large: bool,
    /// Whether there is an open proposal.
    pub(crate) open: bool,
}

/// One stored coordinate.
///
/// What it is follows from `modify` and the point's [`Clock`]:
///
/// | `modify` | the coordinate | when it is read |
/// |---|---|---|
/// | below `large_time` | is older than the last large step, or was never used | it is drawn |
/// | from there to `time - 2` | sleeps, and owes `time - 1 - modify` steps | these are replayed |
/// | `time - 1` | is the current state's | it is as it stands |
/// | `time` | is the open proposal's | it is as it stands |
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "(f64, i64, i64)", into = "(f64, i64, i64)")
)]
pub(crate) struct Coordinate {
    /// In [0, 1).
    pub(crate) value: f64,
    /// The time for which `value` is right.
    pub(crate) modify: i64,
    /// The time of the state whose evaluation last read this: for [`refresh`](Point::refresh).
    pub(crate) seen: i64,
}

impl Coordinate {
    /// Never used.
    pub(crate) const NEW: Self = Self {
        value: 0.0,
        modify: -1,
        seen: -1,
    };
}

/// What a coordinate was in the current state, for a rejection.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Undo {
    pub(crate) stream: Stream,
    pub(crate) index: u32,
    pub(crate) old: Coordinate,
}

impl<M: Mutation> Point<M> {
    /// A point that is nowhere yet: its first step should be an accepted
    /// [large](Step::Large) one.
    pub fn new(mutation: M) -> Self {
        Self {
            mutation,
            streams: std::array::from_fn(|_| Vec::new()),
            undo: Vec::new(),
            clock: Clock {
                time: 0,
                large_time: 0,
                large: true,
                open: false,
            },
        }
    }

    /// Opens a proposal: the point one step on. Reading it makes the coordinates, `draws`
    /// gives their randomness and takes the decision.
    pub fn propose<'a, D: Draws + ?Sized>(
        &'a mut self,
        step: Step,
        draws: &'a mut D,
    ) -> Proposal<'a, M, D> {
        Proposal::open(self, step, draws)
    }

    /// The current state, to be read without moving: for rebuilding its value.
    pub fn current<'a, D: Draws + ?Sized>(&'a mut self, draws: &'a mut D) -> Current<'a, M, D> {
        self.roll_back();
        Current {
            point: self,
            draws,
            marks: false,
        }
    }

    /// As [`current`](Self::current), for an evaluation that the state is to have from now on: what it reads is what
    /// [`refresh`](Self::refresh) keeps.
    pub(crate) fn evaluated_anew<'a, D: Draws + ?Sized>(
        &'a mut self,
        draws: &'a mut D,
    ) -> Current<'a, M, D> {
        Current {
            marks: true,
            ..self.current(draws)
        }
    }

    /// The coordinates of these streams took no part in the last so many accepted steps, and owe nothing for them.
    pub(crate) fn excuse(&mut self, streams: &[Stream], steps: u64) {
        for &stream in streams {
            for coordinate in &mut self.streams[stream as usize] {
                if coordinate.modify >= self.clock.large_time {
                    coordinate.modify += steps as i64;
                }
            }
        }
    }

    /// The mutation of small steps.
    pub fn mutation(&self) -> &M {
        &self.mutation
    }

    /// Changes the mutation of small steps, after paying what is owed to the old one.
    pub fn set_mutation<D: Draws + ?Sized>(&mut self, mutation: M, draws: &mut D) {
        self.settle(draws);
        self.mutation = mutation;
    }

    /// Exchanges the coordinates of two points. The mutations stay where they are, and
    /// are paid before.
    pub fn exchange<D: Draws + ?Sized>(&mut self, other: &mut Self, draws: &mut D) {
        self.settle(draws);
        other.settle(draws);
        std::mem::swap(&mut self.streams, &mut other.streams);
        std::mem::swap(&mut self.clock, &mut other.clock);
    }

    /// Pays the debt of every stored coordinate: replays, with the mutation in force, the
    /// steps that it slept through.
    ///
    /// One of two exact cures before a change of mutation, with [`refresh`](Self::refresh). It
    /// changes neither the current value nor the law of the chain.
    pub fn settle<D: Draws + ?Sized>(&mut self, draws: &mut D) {
        self.roll_back();
        let Self {
            mutation,
            streams,
            clock,
            ..
        } = self;
        for (stream, stored) in Stream::ALL.into_iter().zip(streams) {
            for (index, coordinate) in (0..).zip(stored) {
                if coordinate.modify >= clock.large_time {
                    catch_up(coordinate, (stream, index), clock, mutation, draws);
                }
            }
        }
    }

    /// Forgets every coordinate that the evaluation of the current state did not read, so
    /// that it is drawn anew when next needed.
    ///
    /// The other exact cure before a change of mutation, and the cheaper one: what no
    /// evaluation has read is uniform and independent of the rest under every target, so
    /// this is a Gibbs step. Call it at moments that do not depend on the last decision:
    /// on a schedule, or at an exchange, never because something was accepted.
    pub fn refresh(&mut self) {
        self.roll_back();
        let current = self.clock.time - 1;
        for coordinate in self.streams.iter_mut().flatten() {
            if coordinate.seen != current {
                *coordinate = Coordinate::NEW;
            }
        }
    }

    /// Forgets the state but keeps the memory: as [`new`](Self::new).
    pub fn clear(&mut self) {
        self.undo.clear();
        for coordinate in self.streams.iter_mut().flatten() {
            *coordinate = Coordinate::NEW;
        }
        self.clock = Clock {
            time: 0,
            large_time: 0,
            large: true,
            open: false,
        };
    }

    /// Makes room for the first `count` coordinates of a stream, so that reading them
    /// never allocates.
    pub fn reserve(&mut self, stream: Stream, count: usize) {
        let stored = &mut self.streams[stream as usize];
        if stored.len() < count {
            stored.resize(count, Coordinate::NEW);
        }
        let all = self.streams.iter().map(Vec::len).sum::<usize>();
        self.undo.reserve(all.saturating_sub(self.undo.len()));
    }

    /// How many accepted steps the state is old: 0 for a point that is nowhere yet.
    pub fn time(&self) -> u64 {
        self.clock.time as u64
    }

    /// Makes a proposal that was [left open](Proposal::leave_open) the current state. Does nothing where
    /// there is none, or it has been rejected meanwhile: a fault of the caller (debug builds panic).
    pub fn commit(&mut self) {
        debug_assert!(self.clock.open, "no proposal is open");
        if !std::mem::take(&mut self.clock.open) {
            return;
        }
        if self.clock.large {
            self.clock.large_time = self.clock.time;
        }
        self.clock.time += 1;
        self.undo.clear();
    }

    /// Restores every coordinate that a proposal which was [left open](Proposal::leave_open) has read,
    /// to the bit. Without one nothing changes.
    pub fn roll_back(&mut self) {
        self.clock.open = false;
        restore(&mut self.streams, &self.undo);
        self.undo.clear();
    }

    /// A stored coordinate, made on its first use.
    #[inline]
    pub(crate) fn slot(
        streams: &mut [Vec<Coordinate>; Stream::COUNT],
        stream: Stream,
        index: u32,
    ) -> &mut Coordinate {
        let stored = &mut streams[stream as usize];
        let index = index as usize;
        if index >= stored.len() {
            grow(stored, index);
        }
        &mut stored[index]
    }

    /// Brings a coordinate to the time of the current state: as if it had been mutated in
    /// every accepted step.
    #[inline]
    pub(crate) fn bring_up<D: Draws + ?Sized>(
        coordinate: &mut Coordinate,
        address: (Stream, u32),
        clock: &Clock,
        mutation: &M,
        draws: &mut D,
    ) {
        if coordinate.modify < clock.large_time {
            coordinate.value = draws.uniform(); // stale or never used: unseen
            coordinate.modify = clock.time - 1;
        } else if coordinate.modify + 1 < clock.time {
            catch_up(coordinate, address, clock, mutation, draws);
        }
    }
}

/// Puts back what was.
fn restore(streams: &mut [Vec<Coordinate>; Stream::COUNT], undo: &[Undo]) {
    for &Undo { stream, index, old } in undo {
        streams[stream as usize][index as usize] = old;
    }
}

/// Replays the accepted steps that a coordinate slept through.
#[inline(never)]
fn catch_up<M: Mutation, D: Draws + ?Sized>(
    coordinate: &mut Coordinate,
    (stream, index): (Stream, u32),
    clock: &Clock,
    mutation: &M,
    draws: &mut D,
) {
    let now = clock.time - 1;
    match replays(coordinate, (stream, index), clock, mutation) {
        Some(owed) => {
            for _ in 0..owed {
                coordinate.value = mutation.mutate_at(stream, index, coordinate.value, draws);
            }
        }
        None => coordinate.value = draws.uniform(),
    }
    coordinate.modify = coordinate.modify.max(now);
}

/// How many steps bring a coordinate that was made since the last large step up to date. `None` if they are so
/// many that a fresh uniform number does instead (see [`Mutation::mixed_after`]).
fn replays<M: Mutation>(
    coordinate: &Coordinate,
    (stream, index): (Stream, u32),
    clock: &Clock,
    mutation: &M,
) -> Option<u64> {
    let owed = (clock.time - 1).saturating_sub(coordinate.modify).max(0) as u64;
    (owed <= mutation.mixed_after_at(stream, index)).then_some(owed)
}

#[cold]
fn grow(stored: &mut Vec<Coordinate>, index: usize) {
    stored.resize(index + 1, Coordinate::NEW);
}

/// The current state of a [`Point`], readable.
///
/// Coordinates that its evaluation has read are returned as they were, to the bit; others
/// are brought up to date or drawn, and stay.
#[derive(Debug)]
pub struct Current<'a, M, D: ?Sized> {
    point: &'a mut Point<M>,
    draws: &'a mut D,
    /// Whether what is read counts as read by the state's evaluation.
    marks: bool,
}

impl<M: Mutation, D: Draws + ?Sized> Coordinates for Current<'_, M, D> {
    fn get(&mut self, stream: Stream, index: u32) -> f64 {
        let Point {
            mutation,
            streams,
            clock,
            ..
        } = &mut *self.point;
        let coordinate = Point::<M>::slot(streams, stream, index);
        Point::bring_up(coordinate, (stream, index), clock, mutation, self.draws);
        if self.marks {
            coordinate.seen = clock.time - 1;
        }
        coordinate.value
    }
}
