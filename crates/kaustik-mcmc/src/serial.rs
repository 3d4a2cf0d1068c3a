//! How states are written down and read again: parts that are common to all of them.
//!
//! Whatever comes from outside is checked where it is read, so that no later step panics on
//! it: levels below K, lists of the right length, counters that leave room to count on,
//! densities that are densities. What cannot harm (a mean of anything) is taken as it is.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Visitor};
use serde::ser::{Serialize, SerializeTuple, Serializer};

/// Lists of fixed length of any length: serde itself ends at 32.
pub(crate) mod array {
    use super::*;

    pub(crate) fn serialize<T: Serialize, S: Serializer, const N: usize>(
        items: &[T; N],
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(N)?;
        for item in items {
            tuple.serialize_element(item)?;
        }
        tuple.end()
    }

    pub(crate) fn deserialize<'de, T, D, const N: usize>(
        deserializer: D,
    ) -> Result<[T; N], D::Error>
    where
        T: Deserialize<'de>,
        D: Deserializer<'de>,
    {
        deserializer.deserialize_tuple(N, Items(PhantomData))
    }
}

struct Items<T, const N: usize>(PhantomData<T>);

impl<'de, T: Deserialize<'de>, const N: usize> Visitor<'de> for Items<T, N> {
    type Value = [T; N];

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a list of {N}")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<[T; N], A::Error> {
        let mut items = Vec::with_capacity(N);
        while items.len() < N {
            match list.next_element()? {
                Some(item) => items.push(item),
                None => return Err(Error::invalid_length(items.len(), &self)),
            }
        }
        items
            .try_into()
            .map_err(|items: Vec<T>| Error::invalid_length(items.len(), &"a list"))
    }
}

/// A list as [`array`] has it, on its own or within another.
struct Array<T, const N: usize>([T; N]);

impl<T: Serialize, const N: usize> Serialize for Array<T, N> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        array::serialize(&self.0, serializer)
    }
}

impl<'de, T: Deserialize<'de>, const N: usize> Deserialize<'de> for Array<T, N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        array::deserialize(deserializer).map(Self)
    }
}

/// Square tables.
pub(crate) mod table {
    use super::*;

    pub(crate) fn serialize<T: Serialize + Copy, S: Serializer, const N: usize>(
        rows: &[[T; N]; N],
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        array::serialize(&rows.map(Array), serializer)
    }

    pub(crate) fn deserialize<'de, T, D, const N: usize>(
        deserializer: D,
    ) -> Result<[[T; N]; N], D::Error>
    where
        T: Deserialize<'de>,
        D: Deserializer<'de>,
    {
        let rows: [Array<T, N>; N] = array::deserialize(deserializer)?;
        Ok(rows.map(|row| row.0))
    }
}

/// Lists that may be missing.
pub(crate) mod optional_array {
    use super::*;

    pub(crate) fn serialize<T: Serialize + Copy, S: Serializer, const N: usize>(
        items: &Option<[T; N]>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        items.map(Array).serialize(serializer)
    }

    pub(crate) fn deserialize<'de, T, D, const N: usize>(
        deserializer: D,
    ) -> Result<Option<[T; N]>, D::Error>
    where
        T: Deserialize<'de>,
        D: Deserializer<'de>,
    {
        let items: Option<Array<T, N>> = Option::deserialize(deserializer)?;
        Ok(items.map(|items| items.0))
    }
}

/// What a format does to numbers: written where it is text, and compared when it is read. A chain whose coordinates are
/// an ulp off goes on, but as another chain.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ExactNumbers;

/// Numbers of 17 digits that come back changed where digits and power of ten are rounded one after the other.
const PROBES: [f64; 4] = [
    182.07566377777874,
    1.7748622025346439,
    0.19687904392603262,
    13.057182715311999,
];

impl Serialize for ExactNumbers {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if serializer.is_human_readable() {
            PROBES.serialize(serializer)
        } else {
            serializer.serialize_unit()
        }
    }
}

impl<'de> Deserialize<'de> for ExactNumbers {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if !deserializer.is_human_readable() {
            <()>::deserialize(deserializer)?;
            return Ok(Self);
        }
        let read = <[f64; PROBES.len()]>::deserialize(deserializer)?;
        check(
            read.map(f64::to_bits) == PROBES.map(f64::to_bits),
            "the reader changes numbers in their last bits (of `serde_json`, take the feature `float_roundtrip`)",
        )?;
        Ok(Self)
    }
}

/// Numbers that may be infinite, which stands for "not known" and which some formats (JSON)
/// cannot write: as options.
pub(crate) mod known {
    use super::*;

    pub(crate) fn serialize<S: Serializer>(x: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        let known = *x < f64::INFINITY;
        known.then_some(*x).serialize(serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        let known = Option::deserialize(deserializer)?;
        Ok(known.unwrap_or(f64::INFINITY))
    }
}

/// Densities: finite, at least 0.
pub(crate) mod densities {
    use super::*;

    pub(crate) use super::array::serialize;

    pub(crate) fn deserialize<'de, D, const N: usize>(deserializer: D) -> Result<[f64; N], D::Error>
    where
        D: Deserializer<'de>,
    {
        let densities: [f64; N] = array::deserialize(deserializer)?;
        check(
            densities.iter().all(is_density),
            "a density is not finite and at least 0",
        )?;
        Ok(densities)
    }
}

fn is_density(x: &f64) -> bool {
    x.is_finite() && *x >= 0.0
}

/// Refuses what does not hold.
pub(crate) fn check<E: Error>(holds: bool, otherwise: &str) -> Result<(), E> {
    if holds {
        Ok(())
    } else {
        Err(E::custom(otherwise))
    }
}

/// A number that must be finite and at least 0.
pub(crate) fn sound<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let x = f64::deserialize(deserializer)?;
    check(is_density(&x), "a number is not finite and at least 0")?;
    Ok(x)
}

/// A number that must be finite.
pub(crate) fn finite<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let x = f64::deserialize(deserializer)?;
    check(x.is_finite(), "a number is not finite")?;
    Ok(x)
}

/// What is left over of whole numbers, in [0, 1), if anything is carried.
pub(crate) fn left_over<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<f64>, D::Error> {
    let share: Option<f64> = Option::deserialize(deserializer)?;
    check(
        share.is_none_or(|share| (0.0..1.0).contains(&share)),
        "a number that is carried is not in [0, 1)",
    )?;
    Ok(share)
}

/// What has been counted, with room to count on and to be merged.
pub(crate) fn count<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u64, D::Error> {
    let count = u64::deserialize(deserializer)?;
    check(count <= MOST, "a count beyond 2^48")?;
    Ok(count)
}

/// No run counts so far.
pub(crate) const MOST: u64 = 1 << 48;

/// A level of K.
pub(crate) fn level<'de, D: Deserializer<'de>, const K: usize>(
    deserializer: D,
) -> Result<usize, D::Error> {
    let level = usize::deserialize(deserializer)?;
    check(level < K, "a level that does not exist")?;
    Ok(level)
}
