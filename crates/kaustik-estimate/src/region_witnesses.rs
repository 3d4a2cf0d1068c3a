//! Which visits of a ladder tell regions what touches them.

use kaustik_mcmc::Visit;

use crate::first_meetings::FirstMeetings;
use crate::{PhotonMap, PhotonValue, RegionSums, Sharing};

/// Passes visits on to one half of the region statistics: every visit of the higher levels, but only
/// one in `stride` of the first level.
///
/// Where nearly all steps belong to the first chain, using all of its visits took an eighth of the
/// render time, and fewer are enough.
#[derive(Debug)]
pub struct RegionWitnesses<'a, const K: usize> {
    sums: &'a RegionSums<K>,
    half: usize,
    /// Of so many visits of the first level that touch anything one is a witness, > 0.
    stride: u64,
    /// Such visits since the last witness.
    passed: u64,
    /// Room for paths that meet many points.
    firsts: FirstMeetings,
}

impl<'a, const K: usize> RegionWitnesses<'a, K> {
    /// For sums of an iteration, their first or second half, and one witness of so many visits (> 0) of the first level.
    pub fn new(sums: &'a RegionSums<K>, half: usize, stride: u64) -> Self {
        Self {
            sums,
            half,
            stride,
            // in the middle of a stride
            passed: stride / 2,
            firsts: FirstMeetings::default(),
        }
    }

    /// A visit of a path that touches points.
    #[inline]
    pub(crate) fn take(
        &mut self,
        visit: &Visit<'_, PhotonValue, K>,
        map: &PhotonMap<'_>,
        sharing: &Sharing<K>,
    ) {
        let mut stands_for = 1;
        if visit.level == 0 {
            self.passed += 1;
            if self.passed < self.stride {
                return;
            }
            (self.passed, stands_for) = (0, self.stride);
        }
        let firsts = &mut self.firsts;
        (self.sums).take(visit, stands_for as f64, map, sharing, self.half, firsts);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::region_sums::tests::Nowhere;
    use crate::{Combine, Meeting, PhotonLevels, PhotonTargetKind, Witnesses};

    const VISITS: u64 = 800;

    /// What 800 visits of each of two levels, which touch two points, tell the leaf of these.
    fn told(stride: u64) -> crate::LeafTally {
        let nowhere = Nowhere::default();
        let sharing = Sharing {
            combine: Combine::Balance,
            rough: [1.0, 0.5],
            samples: [1.0, 3.0],
        };
        let levels = PhotonLevels([PhotonTargetKind::Uniform, PhotonTargetKind::Full]);
        let mut sums = RegionSums::new(1, &levels, Witnesses::All);
        sums.begin(vec![0; 2]);
        sums.expect(0.5);
        let value = PhotonValue {
            meetings: [0, 1].map(|point| Meeting { photon: 0, point }).to_vec(),
            ..PhotonValue::default()
        };
        let mut witnesses = RegionWitnesses::new(&sums, 0, stride);
        for number in 0..2 * VISITS {
            let visit = Visit {
                level: (number % 2) as usize,
                value: &value,
                densities: &[1.0, 1.0],
                weight: 1.0,
                independent: 0.0,
            };
            witnesses.take(&visit, &nowhere.map(), &sharing);
        }
        sums.tallies(&[1.0; 2])[0]
    }

    /// Sums are as if each visit of the first level had told; what is known rests on fewer paths.
    #[test]
    fn a_witness_stands_for_the_visits_since_the_last() {
        let (all, some) = (told(1), told(16));
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-3, "{a}, not {b}");
        // expected samples: 1 and 6 at any path
        let [first, second] = [1.0, 36.0].map(|share| share / 37.0 * VISITS as f64);
        near(all.psi[0], 2.0 * (first + 0.5 * second));
        near(some.psi[0], all.psi[0]);
        near(all.paths, first + second);
        near(some.paths, first / 16.0 + second);
    }
}
