use std::fmt;

use super::{Sequential, chi_square_tail};
use crate::{Draws, Pcg64Dxsm, generator};

/// The exact rank test of a *reversible* kernel, for states of any kind (Gandy and Scott,
/// "Unit testing for MCMC and other Monte Carlo methods", 2020, algorithm 2).
///
/// Needed is a way to draw from the target exactly; for targets in closed form there is.
/// From an exact draw, put in the middle of a chain at a random place, the kernel runs
/// forwards to one end and, because a reversible chain looks the same from behind, forwards
/// again to the other. If the kernel keeps the target and is reversible, no place of the
/// chain is distinguished; so the rank of the exact draw among all, under any statistic,
/// is uniform: *exactly*, however short the chain and slow its mixing. Ties are broken at
/// random.
///
/// Deterministic: chain i takes its numbers from `generator(seed, i)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RankTest {
    /// States of a chain, the exact draw among them: at least 2. Few are enough (5 to 20).
    pub length: usize,
    /// Steps from one state to the next, at least 1: large enough to move noticeably.
    pub thin: usize,
    /// How many chains: at least five times the length.
    pub chains: u64,
    /// The seed of all numbers.
    pub seed: u64,
}

impl Default for RankTest {
    /// 20,000 chains of 10 states, five steps from each to the next.
    fn default() -> Self {
        Self {
            length: 10,
            thin: 5,
            chains: 20_000,
            seed: 1,
        }
    }
}

/// Where the exact draws ranked.
#[derive(Clone, Debug, PartialEq)]
pub struct Ranks<const H: usize> {
    /// For each statistic, how many exact draws had each rank.
    pub counts: [Vec<u64>; H],
    /// The share of chains of which some statistic differed somewhere: a kernel that does nothing is reversible with
    /// respect to everything.
    pub moved: f64,
}

impl RankTest {
    /// Counts ranks. `start` draws from the target exactly, `step` makes one step of the
    /// kernel, and `statistics` are real functions of the state, finite.
    ///
    /// # Panics
    ///
    /// If chains are shorter than two states or make no step from one to the next, or there are none.
    pub fn run<S: Clone, const H: usize>(
        &self,
        mut start: impl FnMut(&mut Pcg64Dxsm) -> S,
        mut step: impl FnMut(&mut S, &mut Pcg64Dxsm),
        statistics: impl Fn(&S) -> [f64; H],
    ) -> Ranks<H> {
        assert!(
            self.length >= 2 && self.thin >= 1 && self.chains >= 1,
            "nothing to rank in {self:?}"
        );
        let even = vec![1.0; self.length];
        let mut moved = 0u64;
        let mut counts = std::array::from_fn(|_| vec![0; self.length]);
        for chain in 0..self.chains {
            let mut rng = generator(self.seed, chain);
            let middle = rng.index(&even);
            let exact = start(&mut rng);
            let own = statistics(&exact);
            let (mut below, mut ties) = ([0; H], [0; H]);
            // reversible: the way back is another way there
            for steps in [middle, self.length - 1 - middle] {
                let mut state = exact.clone();
                for _ in 0..steps {
                    (0..self.thin).for_each(|_| step(&mut state, &mut rng));
                    for (h, other) in statistics(&state).into_iter().enumerate() {
                        below[h] += usize::from(other < own[h]);
                        ties[h] += usize::from(other.to_bits() == own[h].to_bits());
                    }
                }
            }
            moved += u64::from(ties.iter().any(|ties| *ties + 1 < self.length));
            for h in 0..H {
                counts[h][below[h] + rng.index(&even[..=ties[h]])] += 1;
            }
        }
        Ranks {
            counts,
            moved: moved as f64 / self.chains as f64,
        }
    }
}

impl<const H: usize> Ranks<H> {
    /// The p-value of each statistic: of its chi-square against uniform ranks.
    pub fn p_values(&self) -> [f64; H] {
        std::array::from_fn(|h| {
            let counts = &self.counts[h];
            let expected = counts.iter().sum::<u64>() as f64 / counts.len() as f64;
            let squares = counts.iter().map(|n| (*n as f64 - expected).powi(2));
            chi_square_tail(squares.sum::<f64>() / expected, counts.len() as f64 - 1.0)
        })
    }

    /// The p-value of all statistics together: the smallest, times their number. 0 if nothing ever moved.
    pub fn p_value(&self) -> f64 {
        if self.moved <= 0.0 {
            return 0.0;
        }
        let smallest = self.p_values().into_iter().fold(1.0, f64::min);
        (smallest * H as f64).min(1.0)
    }
}

impl<const H: usize> fmt::Display for Ranks<H> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (h, p) in self.p_values().iter().enumerate() {
            writeln!(f, "statistic {h}: p = {p:.3e}, ranks {:?}", self.counts[h])?;
        }
        let (p, moved) = (self.p_value(), 100.0 * self.moved);
        write!(f, "together: p = {p:.3e}, moved {moved:.1} %")
    }
}

/// Asserts that a kernel keeps its target and is reversible, by [`RankTest`] in the stages
/// of [`Sequential`]: a correct kernel fails with probability 1e-5, for one in
/// 100,000 seeds.
///
/// Arguments as [`RankTest::run`]'s.
///
/// ```
/// use kaustik_mcmc::testing::{RankTest, assert_reversible};
/// use kaustik_mcmc::{Draws, Mutation, Uniform, acceptance, decide};
///
/// // the density 2 x on the unit interval: the square root of a uniform number
/// assert_reversible(
///     &RankTest::default(),
///     |rng| rng.uniform().sqrt(),
///     |x, rng| {
///         let y = Uniform::new(0.5).mutate(*x, rng);
///         if decide(acceptance(*x, y, 1.0), rng) { *x = y }
///     },
///     |x| [*x, (x - 0.5).abs()],
/// );
/// ```
///
/// # Panics
///
/// If the ranks are not uniform, with their counts.
#[track_caller]
pub fn assert_reversible<S: Clone, const H: usize>(
    test: &RankTest,
    mut start: impl FnMut(&mut Pcg64Dxsm) -> S,
    mut step: impl FnMut(&mut S, &mut Pcg64Dxsm),
    statistics: impl Fn(&S) -> [f64; H],
) {
    let mut last = None;
    let outcome = Sequential::default().run(|stage, factor| {
        let test = RankTest {
            seed: test.seed ^ (u64::from(stage) << 48),
            chains: test.chains * factor,
            ..*test
        };
        let ranks = test.run(&mut start, &mut step, &statistics);
        let p = ranks.p_value();
        last = Some(ranks);
        p
    });
    if let (Err((stage, _)), Some(ranks)) = (outcome, last) {
        panic!("not reversible with its target (stage {stage})\n{ranks}");
    }
}
