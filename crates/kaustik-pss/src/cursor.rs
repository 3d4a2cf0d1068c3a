use std::fmt;

use crate::{Coordinates, Stream};

/// Reads one stream in the order of its indices.
///
/// For builders that want the next number rather than an address. The position moves by
/// one with each number; [`skip_to`](Self::skip_to) keeps the stride per bounce fixed
/// when a bounce needs fewer numbers than its neighbours.
pub struct Cursor<'a> {
    coordinates: &'a mut dyn Coordinates,
    stream: Stream,
    position: u32,
}

impl<'a> Cursor<'a> {
    /// A cursor at index 0 of `stream`.
    pub fn new(coordinates: &'a mut dyn Coordinates, stream: Stream) -> Self {
        Self {
            coordinates,
            stream,
            position: 0,
        }
    }

    /// The coordinate at the position, in [0, 1); the position moves on by one.
    #[expect(
        clippy::should_implement_trait,
        reason = "an endless source of numbers: an Option at each would only be in the way"
    )]
    pub fn next(&mut self) -> f64 {
        let value = self.coordinates.get(self.stream, self.position);
        self.position += 1;
        value
    }

    /// The next two coordinates in order, each in [0, 1).
    pub fn next2(&mut self) -> [f64; 2] {
        let first = self.next();
        [first, self.next()]
    }

    /// The next coordinate for a renderer that computes in single precision, in [0, 1): a plain cast
    /// rounds the highest numbers, one in 30 million, up to 1, which is outside of every table.
    pub fn next_f32(&mut self) -> f32 {
        const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;
        (self.next() as f32).min(BELOW_ONE)
    }

    /// The index that [`next`](Self::next) will read.
    pub fn position(&self) -> u32 {
        self.position
    }

    /// Goes to an index, forwards or back. What is skipped shifts nothing.
    pub fn skip_to(&mut self, position: u32) {
        self.position = position;
    }

    /// The stream that is read.
    pub fn stream(&self) -> Stream {
        self.stream
    }
}

impl fmt::Debug for Cursor<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Cursor")
            .field("stream", &self.stream)
            .field("position", &self.position)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Recorded;

    #[test]
    fn a_cursor_reads_on_and_skips() {
        let mut point: Recorded = (0..8)
            .map(|i| (Stream::Camera, i, f64::from(i) / 8.0))
            .collect();
        let mut walk = Cursor::new(&mut point, Stream::Camera);
        assert_eq!(walk.next().to_bits(), 0f64.to_bits());
        assert_eq!(
            walk.next2().map(f64::to_bits),
            [0.125f64, 0.25].map(f64::to_bits)
        );
        walk.skip_to(6);
        assert_eq!(walk.next().to_bits(), 0.75f64.to_bits());
        assert_eq!((walk.position(), walk.stream()), (7, Stream::Camera));
    }

    #[test]
    fn single_precision_stays_below_one() {
        let highest = 1.0 - f64::EPSILON / 2.0;
        let mut point: Recorded = [(Stream::Camera, 0, highest), (Stream::Camera, 1, 0.25)]
            .into_iter()
            .collect();
        let mut walk = Cursor::new(&mut point, Stream::Camera);
        assert!(highest as f32 >= 1.0 && walk.next_f32() < 1.0);
        assert_eq!(walk.next_f32().to_bits(), 0.25f32.to_bits());
    }
}
