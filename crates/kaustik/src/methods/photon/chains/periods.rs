//! How often each chain of a ladder takes a step.

use kaustik_estimate::{PhotonLevels, PhotonTargetKind};

use crate::settings::photon_options::Pace;

/// Share of uniform light paths from which on a scene is seen well enough for them to do nearly all of the work.
const WELL_SEEN: f64 = 0.4;
/// Chains rest for so many steps of the first at least where it does.
const SELDOM: u64 = 16;
/// What a step of such a chain is worth beside an independent light path. It resembles the one before
/// (decision 030).
const WORTH: f64 = 0.25;
/// One visit of the first chain in so many tells regions there what it touches: still four for one step of each other chain.
const VISITS_TO_A_WITNESS: u64 = 16;
/// Of the four chains of G sec. 4.4, where it is: each of the others takes a step to so many of the first.
const OPEN: [u32; 4] = [1, 64, 64, 64];
/// Where they are not: as in the authors' code.
const OCCLUDED: [u32; 4] = [1, 2, 2, 1];

/// The chain at each level takes a step in every so-many-th sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Periods<const K: usize>([u64; K]);

impl<const K: usize> Periods<K> {
    /// Of a ladder of some of the four chains, where such a share of uniform light paths is visible.
    pub(super) fn new(pace: Pace, levels: &PhotonLevels<K>, visible: f64) -> Self {
        let all = match pace {
            Pace::Periods(all) => all,
            // by turns: as published a chain of visibility steps only after a uniform light path that is not visible
            Pace::Auto if !levels.has(PhotonTargetKind::Full) => [1; 4],
            Pace::Auto if visible > WELL_SEEN => OPEN,
            Pace::Auto => OCCLUDED,
        };
        Self((levels.0).map(|kind| u64::from(all[kind as usize])))
    }

    #[cfg(test)]
    pub(super) fn of(periods: [u64; K]) -> Self {
        Self(periods)
    }

    /// Does the chain take a step in the sweep of this number?
    #[inline]
    pub(super) fn steps(&self, level: usize, sweep: u64) -> bool {
        sweep.is_multiple_of(self.0[level])
    }

    /// Are exchanges tried after it? Not where none but the first chain has gone anywhere: its next light
    /// path is as good as this one.
    #[inline]
    pub(super) fn exchanges(&self, sweep: u64) -> bool {
        (1..K).any(|level| self.steps(level, sweep))
    }

    /// Steps of a chain in so many sweeps from the first.
    pub(super) fn count(&self, level: usize, sweeps: u64) -> u64 {
        sweeps.div_ceil(self.0[level])
    }

    /// Does the first chain do nearly all of the work?
    fn is_open(&self) -> bool {
        K > 1
            && self.0[1..]
                .iter()
                .all(|&period| period >= SELDOM * self.0[0])
    }

    /// What a step of each chain is worth beside an independent light path.
    pub(super) fn worths(&self) -> [f64; K] {
        let of_others = if self.is_open() { WORTH } else { 1.0 };
        std::array::from_fn(|level| if level == 0 { 1.0 } else { of_others })
    }

    /// Of so many visits of the first chain one is a witness of what regions are touched by.
    pub(super) fn visits_to_a_witness(&self) -> u64 {
        if self.is_open() {
            VISITS_TO_A_WITNESS
        } else {
            1
        }
    }

    /// Steps of each chain in a sweep, in the mean.
    pub(super) fn rates(&self) -> [f64; K] {
        self.0.map(|period| 1.0 / period as f64)
    }

    /// As few sweeps as bring so many steps of all chains together.
    pub(super) fn sweeps(&self, steps: u64) -> u64 {
        // over the least common multiple, in integers: rates are seldom exact
        let turn = self
            .0
            .iter()
            .fold(1, |turn, &period| turn * period / gcd(turn, period));
        let in_turn: u64 = self.0.iter().map(|period| turn / period).sum();
        let all = u128::from(steps) * u128::from(turn);
        all.div_ceil(u128::from(in_turn)) as u64
    }
}

/// The greatest common divisor; of 0 and another number that number.
fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_steps_as_often_as_it_counts() {
        for periods in [[1, 1, 1], [4, 2, 1], [1, 8, 8], [6, 4, 3]] {
            let periods = Periods::of(periods);
            for level in 0..3 {
                for sweeps in [0, 1, 5, 24, 97] {
                    let steps = (0..sweeps).filter(|&sweep| periods.steps(level, sweep));
                    assert_eq!(steps.count() as u64, periods.count(level, sweeps));
                }
            }
            let in_turn: f64 = periods.rates().iter().sum::<f64>() * 24.0;
            let steps: u64 = (0..3).map(|level| periods.count(level, 24)).sum();
            assert!((in_turn - steps as f64).abs() < 1e-9, "{periods:?}");
            assert_eq!(periods.sweeps(steps * 5), 24 * 5, "{periods:?}");
        }
    }

    #[test]
    fn a_ladder_has_the_periods_of_its_levels() {
        let pace = Pace::Periods([8, 4, 2, 1]);
        use PhotonTargetKind::{Full, InverseKernel, Uniform, Visibility};
        let three = PhotonLevels([Uniform, InverseKernel, Full]);
        assert_eq!(Periods::new(pace, &three, 0.0), Periods::of([8, 2, 1]));
        let four = PhotonLevels(PhotonTargetKind::ALL);
        let auto = |visible| Periods::new(Pace::Auto, &four, visible);
        assert_eq!(auto(0.9), Periods::of([1, 64, 64, 64]));
        assert_eq!(auto(0.01), Periods::of([1, 2, 2, 1]));
        let two = PhotonLevels([Uniform, Visibility]);
        assert_eq!(Periods::new(Pace::Auto, &two, 0.01), Periods::of([1, 1]));
    }

    /// Where the first chain does nearly all, and nowhere else.
    #[test]
    fn independent_paths_count_for_more_where_they_are_most() {
        let counts_for_less = |periods: &Periods<3>| periods.worths().map(|worth| worth < 1.0);
        let seldom = Periods::of([1, 64, 64]);
        assert_eq!(counts_for_less(&seldom), [false, true, true]);
        assert_eq!(seldom.visits_to_a_witness(), VISITS_TO_A_WITNESS);
        for often in [[1, 2, 1], [1, 64, 2], [8, 64, 64]].map(Periods::of) {
            assert_eq!(counts_for_less(&often), [false; 3]);
            assert_eq!(often.visits_to_a_witness(), 1);
        }
        assert!(!Periods::of([1]).is_open());
    }

    #[test]
    fn exchanges_wait_for_those_that_move() {
        let periods = Periods::of([1, 4, 8]);
        let tried = (0..9).filter(|&sweep| periods.exchanges(sweep));
        assert_eq!(tried.collect::<Vec<_>>(), [0, 4, 8]);
    }
}
