/// Which lineage of states stands at which level, and how lineages travel.
///
/// A lineage is what an exchange moves: it begins at the level of its number. How it wanders
/// between the bottom (level 0, where states are made anew) and the top (level K-1, the most
/// difficult) tells whether a ladder works: states that are made and never arrive are of no use
/// (Katzgraber et al. 2006; Syed et al. 2021).
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct IndexProcess<const K: usize> {
    #[cfg_attr(
        feature = "serde",
        serde(
            serialize_with = "crate::serial::array::serialize",
            deserialize_with = "permutation"
        )
    )]
    lineages: [usize; K],
    #[cfg_attr(feature = "serde", serde(with = "crate::serial::array"))]
    ends: [Option<End>; K],
}

/// Which end of the ladder a lineage has been at last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
enum End {
    Bottom,
    /// At the top, and whether it came from the bottom.
    Top(bool),
}

/// What came about in one round of exchanges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Arrivals {
    /// A lineage has come from the bottom to the top.
    pub(crate) restart: bool,
    /// A lineage has come from the bottom to the top and back to the bottom.
    pub(crate) round_trip: bool,
}

impl<const K: usize> IndexProcess<K> {
    pub(crate) fn new() -> Self {
        let mut process = Self {
            lineages: std::array::from_fn(|level| level),
            ends: [None; K],
        };
        process.arrive();
        process
    }

    /// The lineage at each level.
    pub fn lineages(&self) -> &[usize; K] {
        &self.lineages
    }

    /// The level at which a lineage stands.
    ///
    /// # Panics
    ///
    /// If `lineage` is K or more.
    pub fn level(&self, lineage: usize) -> usize {
        let found = self.lineages.iter().position(|&l| l == lineage);
        assert!(found.is_some(), "lineage {lineage} of {K}");
        found.unwrap_or(0)
    }

    pub(crate) fn swap(&mut self, a: usize, b: usize) {
        self.lineages.swap(a, b);
    }

    /// Notes who stands at the ends, now that exchanges are over: passing through counts
    /// for nothing, because no step was taken there.
    pub(crate) fn arrive(&mut self) -> Arrivals {
        if K < 2 {
            return Arrivals::default();
        }
        let top = &mut self.ends[self.lineages[K - 1]];
        let restart = *top == Some(End::Bottom);
        if !matches!(top, Some(End::Top(_))) {
            *top = Some(End::Top(restart));
        }
        let bottom = &mut self.ends[self.lineages[0]];
        let round_trip = *bottom == Some(End::Top(true));
        *bottom = Some(End::Bottom);
        Arrivals {
            restart,
            round_trip,
        }
    }
}

/// Each lineage stands at one level.
#[cfg(feature = "serde")]
fn permutation<'de, D: serde::Deserializer<'de>, const K: usize>(
    deserializer: D,
) -> Result<[usize; K], D::Error> {
    let lineages: [usize; K] = crate::serial::array::deserialize(deserializer)?;
    let all = (0..K).all(|lineage| lineages.contains(&lineage));
    crate::serial::check(all, "a lineage is missing")?;
    Ok(lineages)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arrive(process: &mut IndexProcess<3>, swaps: &[(usize, usize)]) -> (bool, bool) {
        swaps.iter().for_each(|&(a, b)| process.swap(a, b));
        let Arrivals {
            restart,
            round_trip,
        } = process.arrive();
        (restart, round_trip)
    }

    #[test]
    fn trips_are_counted_from_the_bottom() {
        let mut p = IndexProcess::new();
        let none = (false, false);
        assert_eq!(arrive(&mut p, &[(0, 1)]), none); // 1 0 2
        assert_eq!(arrive(&mut p, &[(1, 2)]), (true, false)); // 1 2 0: 0 has come up
        assert_eq!(arrive(&mut p, &[]), none); // and is there still
        assert_eq!(arrive(&mut p, &[(0, 1)]), none); // 2 1 0: 2 has been up, but not from below
        assert_eq!(arrive(&mut p, &[(1, 2)]), (true, false)); // 2 0 1: 1 was at the bottom
        assert_eq!(arrive(&mut p, &[(0, 1)]), (false, true)); // 0 2 1: 0 is back
        assert_eq!((p.level(0), p.level(2), p.lineages()), (0, 1, &[0, 2, 1]));
    }

    #[test]
    fn passing_through_is_no_arrival() {
        let mut p = IndexProcess::new();
        assert_eq!(arrive(&mut p, &[(0, 1), (1, 2), (1, 2)]), (false, false));
    }

    #[test]
    fn one_level_has_no_ends() {
        assert_eq!(IndexProcess::<1>::new().arrive(), Arrivals::default());
    }
}
