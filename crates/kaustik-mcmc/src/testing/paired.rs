use std::fmt;

use super::{Sequential, normal_tails};
use crate::{Mean, Pcg64Dxsm, generator};

/// The paired test of invariance, for kernels on states that have no grid, such as paths.
///
/// Draw a state x0 by any method whose density p is known, with weight w = f(x0) / p(x0),
/// f the target; make `steps` steps of the kernel. If it keeps f, then for every function
/// h the means of w h(x0) and w h(xn) are equal: no burn-in, no ergodicity, no normaliser
/// is needed. The difference is taken *pair by pair*, so that all that the kernel leaves
/// alone cancels; a missing factor of the acceptance ratio, or of a Jacobian, stands out.
///
/// Functions share the risk of a false alarm, and what is clearly fine is not tried again: of 20 functions a
/// z-score below about 2.7. More `starts` see smaller faults.
///
/// Take 10 to 30 functions that between them see each part of a state (positions,
/// directions, lengths, bins). Several kernels: test each alone, for one's fault hides in
/// the mixture. Weights should not be wilder than a few hundred times their mean: z-scores
/// trust the central limit theorem.
///
/// Deterministic: draw i takes its numbers from `generator(seed, i)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairedTest {
    /// How many starts of positive weight, at least 100: draws of weight 0 tell nothing, and are not counted.
    pub starts: u64,
    /// Steps of the kernel from each, at least 1. A few dozen make small faults large.
    pub steps: u32,
    /// The seed of all numbers.
    pub seed: u64,
}

impl Default for PairedTest {
    /// 20,000 starts of 25 steps.
    fn default() -> Self {
        Self {
            starts: 20_000,
            steps: 25,
            seed: 1,
        }
    }
}

/// How the means of test functions changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Changes<const H: usize> {
    /// For each function the mean of w h(xn) - w h(x0), with its standard error.
    pub changes: [Mean; H],
    /// The share of starts of positive weight after which some function differed: a kernel
    /// that does nothing keeps everything.
    pub moved: f64,
}

/// So many draws, at most, for a start of positive weight in the mean.
const MOST_DRAWS: u64 = 1000;
/// After so many of which none had weight nothing starts at all.
const MOST_DARK: u64 = 100_000;

impl PairedTest {
    /// Runs all pairs. `start` draws a state and its weight f/p, at least 0; `step` makes one
    /// step of the kernel on a state of positive weight; `functions` of the state are
    /// finite.
    ///
    /// # Panics
    ///
    /// If a weight is negative, infinite or no number, or if fewer than one draw in a thousand has positive weight. (If none
    /// of 100,000 has, nothing moved.)
    pub fn run<S, const H: usize>(
        &self,
        mut start: impl FnMut(&mut Pcg64Dxsm) -> (S, f64),
        mut step: impl FnMut(&mut S, &mut Pcg64Dxsm),
        functions: impl Fn(&S) -> [f64; H],
    ) -> Changes<H> {
        let mut changes = [Mean::new(); H];
        let mut moved = Mean::new();
        for n in 0..self.starts.saturating_mul(MOST_DRAWS) {
            if moved.count() == self.starts || (moved.count() == 0 && n == MOST_DARK) {
                break;
            }
            let mut rng = generator(self.seed, n);
            let (mut state, weight) = start(&mut rng);
            assert!(
                weight >= 0.0 && weight.is_finite(),
                "start {n} has the weight {weight}: expected a finite one that is not negative"
            );
            if weight > 0.0 {
                let before = functions(&state);
                (0..self.steps).for_each(|_| step(&mut state, &mut rng));
                let after = functions(&state);
                let differs = before.map(f64::to_bits) != after.map(f64::to_bits);
                moved.push(f64::from(u8::from(differs)));
                for h in 0..H {
                    changes[h].push(weight * (after[h] - before[h]));
                }
            }
        }
        assert!(
            moved.count() == self.starts || moved.count() == 0,
            "of {MOST_DRAWS} times as many draws only {} had weight, expected {} starts",
            moved.count(),
            self.starts
        );
        Changes {
            changes,
            moved: moved.mean(),
        }
    }
}

impl<const H: usize> Changes<H> {
    /// The mean changes over their standard errors. A function that never changed has 0.
    pub fn z(&self) -> [f64; H] {
        self.changes.map(|change| {
            let still = change.mean().abs() <= 0.0 && change.variance() <= 0.0;
            if still {
                0.0
            } else {
                change.mean() / change.standard_error()
            }
        })
    }

    /// The mean of the squared z: about 1 if all is well, the more the worse. (Functions of
    /// one state are not independent, so this is a figure to look at, not one to test.)
    pub fn chi_square(&self) -> f64 {
        self.z().iter().map(|z| z * z).sum::<f64>() / H as f64
    }

    /// The p-value of all functions together: that of the largest |z|, times their number,
    /// which holds however they depend on each other. 0 if nothing ever moved, NaN if a function was.
    pub fn p_value(&self) -> f64 {
        if self.moved <= 0.0 {
            return 0.0;
        }
        let tails = self.z().map(normal_tails).into_iter();
        // A function that became NaN refutes, whatever the others say.
        let smallest = tails.fold(1.0, |least: f64, p| match least.is_nan() || p.is_nan() {
            true => f64::NAN,
            false => least.min(p),
        });
        if smallest.is_nan() {
            return f64::NAN;
        }
        (smallest * H as f64).min(1.0)
    }
}

impl<const H: usize> fmt::Display for Changes<H> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (h, (change, z)) in self.changes.iter().zip(self.z()).enumerate() {
            let (mean, error) = (change.mean(), change.standard_error());
            writeln!(f, "function {h}: {mean:+.4e} +- {error:.1e}, z = {z:+.2}")?;
        }
        write!(
            f,
            "chi2 a function {:.2}, moved {:.1} %, p = {:.3e}",
            self.chi_square(),
            100.0 * self.moved,
            self.p_value()
        )
    }
}

/// Asserts that a kernel keeps its target, by [`PairedTest`] in the stages of
/// [`Sequential`]: a correct kernel fails with probability 1e-5.
///
/// Arguments as [`PairedTest::run`]'s. Here a point of the disc in polar coordinates, where
/// a uniform density is r, and the factor that is so easily left out:
///
/// ```
/// use kaustik_mcmc::testing::{PairedTest, assert_invariant};
/// use kaustik_mcmc::{Draws, Mutation, Uniform, acceptance, decide};
///
/// let run = |jacobian: bool| {
///     assert_invariant(
///         &PairedTest::default(),
///         // uniform in r, so that w = f/p = r
///         |rng| { let r = rng.uniform(); ([r, rng.uniform()], r) },
///         |[r, phi], rng| {
///             let [s, psi] = [*r, *phi].map(|x| Uniform::new(0.4).mutate(x, rng));
///             let ratio = if jacobian { s / *r } else { 1.0 };
///             if decide(acceptance(1.0, 1.0, ratio), rng) { (*r, *phi) = (s, psi) }
///         },
///         |[r, phi]| [*r, r * r, *phi, r * (std::f64::consts::TAU * phi).cos()],
///     );
/// };
/// run(true);
/// assert!(std::panic::catch_unwind(|| run(false)).is_err());
/// ```
///
/// # Panics
///
/// If a mean changes, or nothing moves, with all changes.
#[track_caller]
pub fn assert_invariant<S, const H: usize>(
    test: &PairedTest,
    mut start: impl FnMut(&mut Pcg64Dxsm) -> (S, f64),
    mut step: impl FnMut(&mut S, &mut Pcg64Dxsm),
    functions: impl Fn(&S) -> [f64; H],
) {
    let mut last = None;
    let outcome = Sequential::default().run(|stage, factor| {
        let test = PairedTest {
            seed: test.seed ^ (u64::from(stage) << 48),
            starts: test.starts * factor,
            ..*test
        };
        let changes = test.run(&mut start, &mut step, &functions);
        let p = changes.p_value();
        last = Some(changes);
        p
    });
    if let (Err((stage, _)), Some(changes)) = (outcome, last) {
        panic!("the target is not kept (stage {stage})\n{changes}");
    }
}
