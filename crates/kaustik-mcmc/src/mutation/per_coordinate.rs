use kaustik_pss::Stream;

use crate::{Draws, Mutation, Scalable};

/// Each coordinate its own mutation.
///
/// Coordinates mean different things: a place seen through a lens wants finer steps than
/// the choice among three lamps. Any function of the address that is fixed is still a
/// symmetric mutation of the whole point; what coordinates owe while they sleep is paid
/// with their own.
///
/// ```
/// use kaustik_mcmc::{Exponential, PerCoordinate};
/// use kaustik_pss::Stream;
///
/// let mutation = PerCoordinate::new(Exponential::default())
///     .with(Stream::Camera, 0..2, Exponential::new(1e-4, 1e-2))
///     .with(Stream::Camera, (4..256).step_by(4), Exponential::new(0.1, 0.5))
///     .with_stream(Stream::Light, Exponential::new(1e-3, 0.1));
/// # assert_eq!(mutation.at(Stream::Camera, 8), &Exponential::new(0.1, 0.5));
/// ```
///
/// For mutations of different kinds let `M` be an enum of them.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Written<M>"))]
pub struct PerCoordinate<M> {
    /// The first is for all that is not said otherwise.
    mutations: Vec<M>,
    streams: [Table; Stream::COUNT],
}

/// Positions in the list of mutations.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Table {
    /// Of the first coordinates.
    first: Vec<u16>,
    /// Of all others.
    rest: u16,
}

impl<M> PerCoordinate<M> {
    /// The same mutation for all coordinates, so far.
    pub fn new(others: M) -> Self {
        Self {
            mutations: vec![others],
            streams: std::array::from_fn(|_| Table::default()),
        }
    }

    /// The given coordinates of a stream move by `mutation`. Later words overrule earlier
    /// ones. Takes memory up to the largest index.
    ///
    /// # Panics
    ///
    /// After 65,535 mutations.
    #[must_use]
    pub fn with(
        mut self,
        stream: Stream,
        indices: impl IntoIterator<Item = u32>,
        mutation: M,
    ) -> Self {
        let position = self.add(mutation);
        let table = &mut self.streams[stream as usize];
        for index in indices {
            let index = index as usize;
            if index >= table.first.len() {
                table.first.resize(index + 1, table.rest);
            }
            table.first[index] = position;
        }
        self
    }

    /// All coordinates of a stream move by `mutation`; overrules all that was said of it.
    ///
    /// # Panics
    ///
    /// After 65,535 mutations.
    #[must_use]
    pub fn with_stream(mut self, stream: Stream, mutation: M) -> Self {
        let rest = self.add(mutation);
        self.streams[stream as usize] = Table {
            first: Vec::new(),
            rest,
        };
        self
    }

    /// The mutation of a coordinate.
    #[inline]
    pub fn at(&self, stream: Stream, index: u32) -> &M {
        let table = &self.streams[stream as usize];
        let position = table.first.get(index as usize).unwrap_or(&table.rest);
        &self.mutations[usize::from(*position)]
    }

    fn add(&mut self, mutation: M) -> u16 {
        let position = u16::try_from(self.mutations.len()).expect("at most 65,535 mutations");
        self.mutations.push(mutation);
        position
    }
}

#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct Written<M> {
    mutations: Vec<M>,
    streams: [Table; Stream::COUNT],
}

#[cfg(feature = "serde")]
impl<M> TryFrom<Written<M>> for PerCoordinate<M> {
    type Error = &'static str;

    fn try_from(written: Written<M>) -> Result<Self, Self::Error> {
        let Written { mutations, streams } = written;
        let exists = |position: &u16| usize::from(*position) < mutations.len();
        let sound = |table: &Table| table.first.iter().chain([&table.rest]).all(exists);
        if !streams.iter().all(sound) {
            return Err("a coordinate's mutation does not exist");
        }
        Ok(Self { mutations, streams })
    }
}

#[deny(clippy::missing_trait_methods)]
impl<M: Mutation> Mutation for PerCoordinate<M> {
    /// That of the coordinates of which nothing was said: a number without an address.
    fn mutate<D: Draws + ?Sized>(&self, x: f64, draws: &mut D) -> f64 {
        self.mutations[0].mutate(x, draws)
    }

    #[inline]
    fn mutate_at<D: Draws + ?Sized>(
        &self,
        stream: Stream,
        index: u32,
        x: f64,
        draws: &mut D,
    ) -> f64 {
        self.at(stream, index).mutate_at(stream, index, x, draws)
    }

    fn mixed_after(&self) -> u64 {
        let all = self.mutations.iter().map(Mutation::mixed_after);
        all.max().unwrap_or(u64::MAX)
    }

    #[inline]
    fn mixed_after_at(&self, stream: Stream, index: u32) -> u64 {
        self.at(stream, index).mixed_after_at(stream, index)
    }
}

impl<M: Scalable> Scalable for PerCoordinate<M> {
    /// All of them, by the same factor.
    fn scaled(&self, factor: f64) -> Self {
        Self {
            mutations: self.mutations.iter().map(|m| m.scaled(factor)).collect(),
            streams: self.streams.clone(),
        }
    }
}
