//! Starts whose coordinates come from elsewhere.

use kaustik_pss::{Coordinates, Stream};

use super::{Clock, Coordinate};
use crate::{Mutation, Point};

impl<M: Mutation> Point<M> {
    /// Makes the point a start whose coordinates are those of `source`: evaluate what this
    /// returns, and the point is where the evaluation was. Older states are forgotten, their
    /// memory is kept.
    ///
    /// For starts that are not drawn by this point: stratified ones, or ones confined to a
    /// part of the cube. What the evaluation does not read is drawn when it is first needed.
    /// Values outside of [0, 1) are moved to the nearest within, NaN to 0.
    ///
    /// ```
    /// use kaustik_mcmc::{Exponential, Independent, Point, generator};
    /// use kaustik_pss::{Coordinates, Stream};
    ///
    /// let evaluate = |u: &mut dyn Coordinates| u.get(Stream::Camera, 0) + u.get(Stream::Light, 2);
    /// let mut rng = generator(1, 0);
    /// let mut point = Point::new(Exponential::default());
    /// let mut source = Independent::new(generator(2, 0));
    /// let value = evaluate(&mut point.seed(&mut source));
    /// assert_eq!(evaluate(&mut point.current(&mut rng)), value);
    /// ```
    pub fn seed<'a, C: Coordinates + ?Sized>(&'a mut self, source: &'a mut C) -> Seeding<'a, M, C> {
        self.clear();
        self.clock = Clock {
            time: 1,
            large_time: 0,
            large: false,
            open: false,
        };
        Seeding {
            point: self,
            source,
        }
    }
}

/// A start that is being read: see [`Point::seed`].
#[derive(Debug)]
pub struct Seeding<'a, M, C: ?Sized> {
    point: &'a mut Point<M>,
    source: &'a mut C,
}

impl<M: Mutation, C: Coordinates + ?Sized> Seeding<'_, M, C> {
    #[inline]
    fn keep(&mut self, stream: Stream, index: u32, value: impl FnOnce(&mut C) -> f64) -> f64 {
        let coordinate = Point::<M>::slot(&mut self.point.streams, stream, index);
        if coordinate.seen < 0 {
            *coordinate = Coordinate {
                value: super::record::on_circle(value(self.source)),
                modify: 0,
                seen: 0,
            };
        }
        coordinate.value
    }
}

impl<M: Mutation, C: Coordinates + ?Sized> Coordinates for Seeding<'_, M, C> {
    #[inline]
    fn get(&mut self, stream: Stream, index: u32) -> f64 {
        self.keep(stream, index, |source| source.get(stream, index))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Exponential, Independent, Step, generator};

    fn walk(u: &mut dyn Coordinates) -> Vec<f64> {
        let first = u.get(Stream::Camera, 0);
        let count = 1 + (first * 4.0) as u32;
        let light = (0..count).map(|i| u.get(Stream::Light, i));
        let mut read = vec![first];
        read.extend(light);
        read
    }

    #[test]
    fn a_seed_is_what_its_record_is() {
        let (mut seeded, mut rng) = (Point::new(Exponential::default()), generator(3, 0));
        for ladder in 0..100 {
            let value = walk(&mut seeded.seed(&mut Independent::new(generator(4, ladder))));
            assert_eq!(value, walk(&mut Independent::new(generator(4, ladder))));
            assert_eq!(value, walk(&mut seeded.current(&mut rng)));
            // and it goes on as a point of the same record does
            let mut recorded = Point::from_recorded(Exponential::default(), &seeded.record());
            let (mut a, mut b) = (generator(5, ladder), generator(5, ladder));
            for step in 0..20 {
                let step = [Step::Small, Step::Large][usize::from(step == 9)];
                let (mut p, mut q) = (seeded.propose(step, &mut a), recorded.propose(step, &mut b));
                assert_eq!(walk(&mut p), walk(&mut q));
                assert_eq!(p.decide(0.6), q.decide(0.6));
            }
        }
    }

    #[test]
    fn strange_sources_are_moved_onto_the_circle() {
        struct Strange;
        impl Coordinates for Strange {
            fn get(&mut self, _: Stream, index: u32) -> f64 {
                [f64::NAN, -1.0, 1.0, f64::INFINITY][index as usize]
            }
        }
        let mut point = Point::new(Exponential::default());
        let mut strange = Strange;
        let mut seeding = point.seed(&mut strange);
        let values = [0, 1, 2, 3].map(|i| seeding.get(Stream::Camera, i));
        assert!(values.iter().all(|u| (0.0..1.0).contains(u)), "{values:?}");
    }

    #[test]
    fn a_source_is_asked_once() {
        let mut point = Point::new(Exponential::default());
        let mut source = Independent::new(generator(6, 0)); // another number each time
        let mut seeding = point.seed(&mut source);
        let first = seeding.get(Stream::Time, 0);
        assert_eq!(first.to_bits(), seeding.get(Stream::Time, 0).to_bits());
    }
}
