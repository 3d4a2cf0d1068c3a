//! A point written down and read again (feature `serde`): a state, never a proposal.

use kaustik_pss::Stream;
use serde::{Deserialize, Serialize, Serializer};

use super::{Clock, Coordinate, Point, replays, restore};
use crate::Mutation;
use crate::serial::MOST;

/// No state that is read may ask for more replayed steps than these, all its coordinates
/// together: about a minute's work. Chains come near it only by a mutation that hardly moves or
/// (with nearly equal sizes) never mixes, and without large steps: a hundred million accepted steps
/// with two hundred coordinates that nothing reads.
const MOST_REPLAYED: u64 = 1 << 34;

/// What is written: the current state. Of an open proposal there is no trace.
#[derive(Serialize)]
#[serde(rename = "Point")]
struct Written<'a, M> {
    mutation: &'a M,
    time: i64,
    large_time: i64,
    streams: &'a [Vec<Coordinate>; Stream::COUNT],
}

#[derive(Deserialize)]
#[serde(rename = "Point")]
pub(crate) struct Read<M> {
    mutation: M,
    time: i64,
    large_time: i64,
    streams: [Vec<Coordinate>; Stream::COUNT],
}

/// An open proposal (one that was forgotten) is rolled back in what is written.
impl<M: Serialize> Serialize for Point<M> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut rolled_back = None;
        if !self.undo.is_empty() {
            restore(rolled_back.insert(self.streams.clone()), &self.undo);
        }
        let written = Written {
            mutation: &self.mutation,
            time: self.clock.time,
            large_time: self.clock.large_time,
            streams: rolled_back.as_ref().unwrap_or(&self.streams),
        };
        written.serialize(serializer)
    }
}

impl<M: Mutation> TryFrom<Read<M>> for Point<M> {
    type Error = &'static str;

    fn try_from(read: Read<M>) -> Result<Self, Self::Error> {
        let (time, large_time) = (read.time, read.large_time);
        if !(0..=MOST as i64).contains(&time) {
            return Err("a point's time is below 0 or beyond 2^48");
        }
        if !(0..time.max(1)).contains(&large_time) {
            return Err("a point's last large step is not in its past");
        }
        let past = -1..time.max(0);
        let sound = |c: &Coordinate| past.contains(&c.modify) && past.contains(&c.seen);
        if !read.streams.iter().flatten().all(sound) {
            return Err("a coordinate's times are not in its point's past");
        }
        let point = Self {
            mutation: read.mutation,
            streams: read.streams,
            undo: Vec::new(),
            clock: Clock {
                time,
                large_time,
                large: true, // each proposal says anew
                open: false,
            },
        };
        if point.replayed() > MOST_REPLAYED {
            return Err("a point's coordinates owe more than 2^34 steps");
        }
        Ok(point)
    }
}

impl<M: Mutation> Point<M> {
    /// How many steps [`settle`](Self::settle) would replay.
    fn replayed(&self) -> u64 {
        let mut all = 0u64;
        for (stream, stored) in Stream::ALL.into_iter().zip(&self.streams) {
            for (index, coordinate) in (0..).zip(stored) {
                if coordinate.modify >= self.clock.large_time {
                    let address = (stream, index);
                    let owed = replays(coordinate, address, &self.clock, &self.mutation);
                    all = all.saturating_add(owed.unwrap_or(0));
                }
            }
        }
        all
    }
}

impl From<Coordinate> for (f64, i64, i64) {
    fn from(coordinate: Coordinate) -> Self {
        (coordinate.value, coordinate.modify, coordinate.seen)
    }
}

impl TryFrom<(f64, i64, i64)> for Coordinate {
    type Error = &'static str;

    fn try_from((value, modify, seen): (f64, i64, i64)) -> Result<Self, Self::Error> {
        if (0.0..1.0).contains(&value) {
            Ok(Self {
                value,
                modify,
                seen,
            })
        } else {
            Err("a coordinate is not in [0, 1)")
        }
    }
}
