//! Which replicas may exchange states.

use std::fmt;
use std::ops::Range;

use crate::Draws;

/// The pairs of levels that may exchange states, parted into matchings.
///
/// A line, where each level has two neighbours, is the usual graph. RELT (sec. 6) asks for
/// more: levels that are only partially ordered, such as two special targets above one
/// general one. Any set of pairs is a graph here. States travel along pairs only, so a level
/// that no pair reaches stays alone; that is slow, never wrong.
///
/// # Matchings
///
/// Pairs that share no level can be tried at once, and in any order: together they are a
/// *matching*. On a line there are two, the even pairs (0,1), (2,3), ... and the odd pairs
/// (1,2), (3,4), ... . For other graphs "even" and "odd" are replaced by a colouring of the
/// pairs: in the order given, each pair joins the first matching in which neither of its
/// levels occurs. With at most d pairs at a level this makes at most 2 d - 1 matchings.
/// Wherever a [`Schedule`](crate::Schedule) says "matching", these are meant.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "Vec<(usize, usize)>", into = "Vec<(usize, usize)>")
)]
pub struct SwapGraph<const K: usize> {
    /// Pairs (a < b), ordered by matching.
    pairs: Vec<[usize; 2]>,
    /// Where matching c ends in `pairs`.
    ends: Vec<usize>,
    /// Equal weights, one for each pair.
    ones: Vec<f64>,
}

impl<const K: usize> SwapGraph<K> {
    /// Neighbouring levels: (0,1), (1,2), ..., (K-2,K-1).
    pub fn line() -> Self {
        Self::colour((1..K).map(|b| [b - 1, b]))
    }

    /// Every two levels.
    pub fn complete() -> Self {
        Self::colour((0..K).flat_map(|b| (0..b).map(move |a| [a, b])))
    }

    /// The given pairs, in either order of their levels.
    ///
    /// # Errors
    ///
    /// If a pair has a level that is K or more, pairs a level with itself, or is there twice.
    pub fn new(pairs: &[(usize, usize)]) -> Result<Self, SwapGraphError> {
        let ordered = |&(a, b): &(usize, usize)| [a.min(b), a.max(b)];
        for (i, pair) in pairs.iter().enumerate() {
            let [a, b] = ordered(pair);
            if b >= K {
                return Err(SwapGraphError::NoSuchLevel {
                    level: b,
                    levels: K,
                });
            }
            if a == b {
                return Err(SwapGraphError::Itself { level: a });
            }
            if pairs[..i].iter().any(|other| ordered(other) == [a, b]) {
                return Err(SwapGraphError::Twice { pair: (a, b) });
            }
        }
        Ok(Self::colour(pairs.iter().map(ordered)))
    }

    fn colour(pairs: impl Iterator<Item = [usize; 2]>) -> Self {
        let mut matchings: Vec<Vec<[usize; 2]>> = Vec::new();
        for [a, b] in pairs {
            let free =
                |m: &Vec<[usize; 2]>| m.iter().flatten().all(|&level| level != a && level != b);
            match matchings.iter_mut().find(|m| free(m)) {
                Some(matching) => matching.push([a, b]),
                None => matchings.push(vec![[a, b]]),
            }
        }
        let mut end = 0;
        let pairs = matchings.concat();
        Self {
            ones: vec![1.0; pairs.len()],
            ends: matchings
                .iter()
                .map(|m| {
                    end += m.len();
                    end
                })
                .collect(),
            pairs,
        }
    }

    /// All pairs (lower level first), ordered by matching.
    pub fn pairs(&self) -> &[[usize; 2]] {
        &self.pairs
    }

    /// How many matchings there are: 2 for a line of three levels or more.
    pub fn matchings(&self) -> usize {
        self.ends.len()
    }

    /// One of the pairs, each with the same probability.
    pub(crate) fn any_pair<D: Draws + ?Sized>(&self, draws: &mut D) -> usize {
        draws.index(&self.ones)
    }

    /// One of the matchings, each with the same probability.
    pub(crate) fn any_matching<D: Draws + ?Sized>(&self, draws: &mut D) -> usize {
        draws.index(&self.ones[..self.matchings()])
    }

    /// Where a matching stands in [`pairs`](Self::pairs).
    ///
    /// # Panics
    ///
    /// If there are not so many.
    pub fn matching(&self, index: usize) -> Range<usize> {
        let start = index.checked_sub(1).map_or(0, |before| self.ends[before]);
        start..self.ends[index]
    }
}

/// The pairs are the graph.
impl<const K: usize> PartialEq for SwapGraph<K> {
    fn eq(&self, other: &Self) -> bool {
        self.pairs == other.pairs
    }
}

impl<const K: usize> Eq for SwapGraph<K> {}

#[cfg(feature = "serde")]
impl<const K: usize> From<SwapGraph<K>> for Vec<(usize, usize)> {
    /// The pairs in their order, which makes the same matchings again.
    fn from(graph: SwapGraph<K>) -> Self {
        graph.pairs.iter().map(|&[a, b]| (a, b)).collect()
    }
}

#[cfg(feature = "serde")]
impl<const K: usize> TryFrom<Vec<(usize, usize)>> for SwapGraph<K> {
    type Error = SwapGraphError;

    fn try_from(pairs: Vec<(usize, usize)>) -> Result<Self, SwapGraphError> {
        Self::new(&pairs)
    }
}

impl<const K: usize> Default for SwapGraph<K> {
    fn default() -> Self {
        Self::line()
    }
}

/// Why pairs of levels are no graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SwapGraphError {
    /// A pair names a level that does not exist.
    NoSuchLevel {
        /// The level named.
        level: usize,
        /// How many levels there are.
        levels: usize,
    },
    /// A pair joins a level with itself.
    Itself {
        /// The level.
        level: usize,
    },
    /// A pair is given twice.
    Twice {
        /// The pair, lower level first.
        pair: (usize, usize),
    },
}

impl fmt::Display for SwapGraphError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoSuchLevel { level, levels } => {
                write!(f, "a pair names level {level}, but there are {levels}")
            }
            Self::Itself { level } => write!(f, "level {level} is paired with itself"),
            Self::Twice { pair: (a, b) } => write!(f, "the pair ({a}, {b}) is given twice"),
        }
    }
}

impl std::error::Error for SwapGraphError {}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_line_is_even_and_odd() {
        let line = SwapGraph::<6>::line();
        assert_eq!(line.matchings(), 2);
        assert_eq!(line.pairs()[line.matching(0)], [[0, 1], [2, 3], [4, 5]]);
        assert_eq!(line.pairs()[line.matching(1)], [[1, 2], [3, 4]]);
        assert_eq!(SwapGraph::<1>::line().matchings(), 0);
        assert_eq!(SwapGraph::<2>::line(), SwapGraph::complete());
    }

    #[test]
    fn what_is_no_graph_is_refused() {
        type G = SwapGraph<3>;
        let (level, levels) = (3, 3);
        let unknown = SwapGraphError::NoSuchLevel { level, levels };
        assert_eq!(G::new(&[(0, 1), (3, 1)]), Err(unknown));
        assert_eq!(G::new(&[(1, 1)]), Err(SwapGraphError::Itself { level: 1 }));
        let pair = (0, 1);
        assert_eq!(
            G::new(&[(0, 1), (1, 0)]),
            Err(SwapGraphError::Twice { pair })
        );
        assert_eq!(G::new(&[]).map(|g| g.matchings()), Ok(0));
    }

    proptest! {
        #[test]
        fn matchings_share_no_level(mask in 0u32..1 << 15) {
            let all = SwapGraph::<6>::complete();
            let chosen: Vec<_> = (0..15).filter(|i| mask >> i & 1 == 1)
                .map(|i| (all.pairs()[i][1], all.pairs()[i][0])).collect();
            let graph = SwapGraph::<6>::new(&chosen).expect("distinct pairs");
            let mut found = 0;
            for m in 0..graph.matchings() {
                let matching = &graph.pairs()[graph.matching(m)];
                let mut levels: Vec<_> = matching.iter().flatten().collect();
                found += matching.len();
                levels.sort_unstable();
                levels.dedup();
                prop_assert_eq!(levels.len(), 2 * matching.len());
            }
            prop_assert_eq!(found, chosen.len());
        }
    }
}
