use std::collections::BTreeMap;
use std::fmt;

use crate::{Coordinates, Stream};

/// A point written down, for replay.
///
/// Asking for a coordinate returns what was recorded, to the bit. An address that was
/// never recorded reads as 0.5 and is remembered as [`missing`](Self::missing): an
/// evaluation that misses one is another path than the one that was recorded.
///
/// Made by [`Recording`] or collected from `(stream, index, value)`.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Written", into = "Written"))]
pub struct Recorded {
    values: BTreeMap<(Stream, u32), f64>,
    missing: Option<(Stream, u32)>,
}

/// What an unrecorded coordinate reads as: the middle, where no map has an edge.
const ABSENT: f64 = 0.5;

impl Recorded {
    /// A point without coordinates.
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets one coordinate. `value` should lie in [0, 1); it is kept as it is.
    pub fn set(&mut self, stream: Stream, index: u32, value: f64) {
        self.values.insert((stream, index), value);
    }

    /// The recorded coordinate, or `None`. Unlike a read, this leaves no trace.
    pub fn value(&self, stream: Stream, index: u32) -> Option<f64> {
        self.values.get(&(stream, index)).copied()
    }

    /// All coordinates, ordered by stream and index.
    pub fn iter(&self) -> impl Iterator<Item = (Stream, u32, f64)> + '_ {
        self.values
            .iter()
            .map(|(&(stream, index), &value)| (stream, index, value))
    }

    /// How many coordinates are recorded.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Whether nothing is recorded.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// The first address that was read without having been recorded.
    pub fn missing(&self) -> Option<(Stream, u32)> {
        self.missing
    }

    /// Forgets all coordinates.
    pub fn clear(&mut self) {
        self.values.clear();
        self.missing = None;
    }
}

impl Coordinates for Recorded {
    fn get(&mut self, stream: Stream, index: u32) -> f64 {
        match self.values.get(&(stream, index)) {
            Some(&value) => value,
            None => {
                self.missing.get_or_insert((stream, index));
                ABSENT
            }
        }
    }
}

impl FromIterator<(Stream, u32, f64)> for Recorded {
    fn from_iter<I: IntoIterator<Item = (Stream, u32, f64)>>(coordinates: I) -> Self {
        let mut point = Self::new();
        for (stream, index, value) in coordinates {
            point.set(stream, index, value);
        }
        point
    }
}

/// A point as a list: not every format has maps with such keys.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
struct Written {
    coordinates: Vec<(Stream, u32, f64)>,
    missing: Option<(Stream, u32)>,
}

#[cfg(feature = "serde")]
impl From<Recorded> for Written {
    fn from(point: Recorded) -> Self {
        Self {
            coordinates: point.iter().collect(),
            missing: point.missing,
        }
    }
}

/// Indices are small (the contract of a builder). One beyond this in a file is a mistake or
/// a trap: a chain would take memory up to it.
#[cfg(feature = "serde")]
const LARGEST_INDEX: u32 = (1 << 24) - 1;

#[cfg(feature = "serde")]
impl TryFrom<Written> for Recorded {
    type Error = &'static str;

    fn try_from(written: Written) -> Result<Self, Self::Error> {
        let large = |&(_, index, _): &(Stream, u32, f64)| index > LARGEST_INDEX;
        if written.coordinates.iter().any(large) {
            return Err("a coordinate with an index of 2^24 or more");
        }
        let outside = |(_, _, value): &(Stream, u32, f64)| !(0.0..1.0).contains(value);
        if written.coordinates.iter().any(outside) {
            return Err("a coordinate that is not in [0, 1)");
        }
        let mut point: Self = written.coordinates.into_iter().collect();
        point.missing = written.missing;
        Ok(point)
    }
}

/// Passes every ask on and writes the answer down.
///
/// A repeated ask is answered from the record, so that a source which remembers nothing
/// still gives one number an address.
pub struct Recording<'a> {
    source: &'a mut dyn Coordinates,
    record: Recorded,
}

impl<'a> Recording<'a> {
    /// Starts an empty record of what is read from `source`.
    pub fn new(source: &'a mut dyn Coordinates) -> Self {
        Self {
            source,
            record: Recorded::new(),
        }
    }

    /// The record so far.
    pub fn record(&self) -> &Recorded {
        &self.record
    }

    /// Ends the recording.
    pub fn finish(self) -> Recorded {
        self.record
    }
}

impl Coordinates for Recording<'_> {
    fn get(&mut self, stream: Stream, index: u32) -> f64 {
        if let Some(value) = self.record.value(stream, index) {
            return value;
        }
        let value = self.source.get(stream, index);
        self.record.set(stream, index, value);
        value
    }
}

impl fmt::Debug for Recording<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Recording")
            .field("record", &self.record)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// A source that never answers twice alike.
    struct Counter(f64);

    impl Coordinates for Counter {
        fn get(&mut self, _: Stream, _: u32) -> f64 {
            self.0 += 1.0 / 1024.0;
            self.0
        }
    }

    #[test]
    fn an_unrecorded_coordinate_is_noted() {
        let mut point = Recorded::new();
        point.set(Stream::Light, 0, 0.125);
        assert_eq!(point.get(Stream::Light, 0).to_bits(), 0.125f64.to_bits());
        assert_eq!(point.missing(), None);
        assert_eq!(point.get(Stream::Light, 1).to_bits(), 0.5f64.to_bits());
        point.get(Stream::Time, 0);
        assert_eq!(point.missing(), Some((Stream::Light, 1)));
        point.clear();
        assert!(point.is_empty() && point.missing().is_none());
    }

    #[cfg(feature = "serde")]
    #[test]
    fn a_file_gives_back_the_point_or_an_error() {
        let mut point = Recorded::new();
        point.set(Stream::Light, 7, 1.0 / 3.0);
        point.set(Stream::Camera, 0, 0.0);
        point.get(Stream::Time, 2);
        let file = serde_json::to_string(&point).unwrap();
        let again: Recorded = serde_json::from_str(&file).unwrap();
        assert_eq!(again, point);
        for (from, to) in [
            ("7", "16777216"),
            ("Light", "Shadow"),
            ("0.0", "\"x\""),
            ("0.0", "1.0"),
            ("0.0", "-0.25"),
        ] {
            let broken = file.replacen(from, to, 1);
            assert_ne!(broken, file);
            assert!(
                serde_json::from_str::<Recorded>(&broken).is_err(),
                "{broken}"
            );
        }
    }

    proptest! {
        #[test]
        fn replay_returns_what_was_read(asks in prop::collection::vec((0usize..7, 0u32..5), 0..40)) {
            let mut source = Counter(0.0);
            let mut recording = Recording::new(&mut source);
            let first: Vec<u64> = asks
                .iter()
                .map(|&(s, i)| recording.get(Stream::ALL[s], i).to_bits())
                .collect();
            let mut replay = recording.finish();
            let second: Vec<u64> = asks
                .iter()
                .map(|&(s, i)| replay.get(Stream::ALL[s], i).to_bits())
                .collect();
            prop_assert_eq!(first, second);
            prop_assert!(replay.missing().is_none());
            let copy: Recorded = replay.iter().collect();
            prop_assert_eq!(copy, replay);
        }
    }
}
