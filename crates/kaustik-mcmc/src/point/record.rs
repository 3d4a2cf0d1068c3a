//! Points written down and read again.

use kaustik_pss::{Recorded, Stream};

use crate::mutation::BELOW_ONE;
use crate::point::{Clock, Coordinate, Point};

impl<M> Point<M> {
    /// The coordinates that the evaluation of the current state has read: what is needed
    /// to evaluate it again, anywhere, to the bit.
    ///
    /// Coordinates that the evaluation did not read carry no information and are left out.
    /// Empty for a point that is nowhere yet.
    ///
    /// ```
    /// use kaustik_mcmc::{Coordinates, Exponential, Point, Step, Stream, generator};
    ///
    /// let evaluate = |u: &mut dyn Coordinates| u.get(Stream::Light, 3) - u.get(Stream::Camera, 0);
    /// let mut rng = generator(1, 0);
    /// let mut point = Point::new(Exponential::default());
    /// let mut first = point.propose(Step::Large, &mut rng);
    /// let value = evaluate(&mut first);
    /// first.accept();
    ///
    /// let mut recorded = point.record();
    /// assert_eq!(evaluate(&mut recorded), value);
    /// // and a chain goes on from it
    /// let mut again = Point::from_recorded(Exponential::default(), &recorded);
    /// assert_eq!(evaluate(&mut again.current(&mut rng)), value);
    /// ```
    pub fn record(&self) -> Recorded {
        let current = self.clock.time - 1;
        let mut recorded = Recorded::new();
        for (stream, stored) in Stream::ALL.into_iter().zip(&self.streams) {
            for (index, coordinate) in (0..).zip(stored) {
                if current >= 0 && coordinate.seen == current {
                    recorded.set(stream, index, coordinate.value);
                }
            }
        }
        // of a proposal that was forgotten (mem::forget)
        for undo in &self.undo {
            if current >= 0 && undo.old.seen == current {
                recorded.set(undo.stream, undo.index, undo.old.value);
            }
        }
        recorded
    }

    /// A point whose current state has these coordinates; others are drawn when needed.
    ///
    /// Values outside of [0, 1) are moved to the nearest within, NaN to 0. Memory is taken
    /// up to the largest index of each stream.
    pub fn from_recorded(mutation: M, recorded: &Recorded) -> Self {
        let mut streams: [Vec<Coordinate>; Stream::COUNT] = std::array::from_fn(|_| Vec::new());
        for (stream, index, value) in recorded.iter() {
            let (stored, index) = (&mut streams[stream as usize], index as usize);
            if index >= stored.len() {
                stored.resize(index + 1, Coordinate::NEW);
            }
            stored[index] = Coordinate {
                value: on_circle(value),
                modify: 0,
                seen: 0,
            };
        }
        Self {
            mutation,
            streams,
            undo: Vec::new(),
            clock: Clock {
                time: 1,
                large_time: 0,
                large: false,
                open: false,
            },
        }
    }
}

/// The nearest number of [0, 1); 0 for NaN.
pub(super) fn on_circle(x: f64) -> f64 {
    if x.is_nan() {
        0.0
    } else {
        x.clamp(0.0, BELOW_ONE)
    }
}
