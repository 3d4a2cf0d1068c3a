use std::fmt;

use super::Enumerator;
use super::enumerator::each_run;

/// The exact transition matrix P of a kernel on the states 0..n.
///
/// ```
/// use kaustik_mcmc::{Draws, acceptance, decide};
/// use kaustik_mcmc::testing::{TransitionMatrix, assert_detailed_balance};
///
/// let pi = [0.5, 0.0, 0.2, 0.3];
/// // propose either neighbour on a ring of four, accept as Metropolis does
/// let kernel = TransitionMatrix::of(4, 1, |from, draws| {
///     let to = (from + [1, 3][draws.index(&[1.0, 1.0])]) % 4;
///     if decide(acceptance(pi[from], pi[to], 1.0), draws) { to } else { from }
/// });
/// assert_detailed_balance(&kernel, &pi);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct TransitionMatrix {
    states: usize,
    /// Row-major: from * states + to.
    probabilities: Vec<f64>,
}

impl TransitionMatrix {
    /// Enumerates one step from each state. `cells` is the grid that stands for uniform
    /// numbers, see [`Enumerator`]; the step returns a state below `states`.
    pub fn of(
        states: usize,
        cells: usize,
        mut step: impl FnMut(usize, &mut Enumerator) -> usize,
    ) -> Self {
        let mut probabilities = vec![0.0; states * states];
        for (from, row) in probabilities.chunks_exact_mut(states).enumerate() {
            each_run(
                cells,
                &mut |draws: &mut Enumerator| step(from, draws),
                |to, p| row[to] += p,
            );
        }
        Self {
            states,
            probabilities,
        }
    }

    /// The matrix that moves nothing.
    pub fn identity(states: usize) -> Self {
        Self::of(states, 1, |state, _| state)
    }

    /// This step and then another: a scan.
    ///
    /// # Panics
    ///
    /// If the numbers of states differ.
    pub fn then(&self, next: &Self) -> Self {
        assert_eq!(self.states, next.states, "matrices of different sizes");
        let rows = self.probabilities.chunks_exact(self.states);
        Self {
            states: self.states,
            probabilities: rows.flat_map(|row| next.step(row)).collect(),
        }
    }

    /// This step `count` times.
    pub fn power(&self, count: u32) -> Self {
        (0..count).fold(Self::identity(self.states), |all, _| all.then(self))
    }

    /// One of several steps, chosen with probability proportional to its weight,
    /// whatever the state.
    ///
    /// # Panics
    ///
    /// If there are none, or their numbers of states differ.
    pub fn mixture(parts: &[(f64, &Self)]) -> Self {
        let total: f64 = parts.iter().map(|part| part.0).sum();
        let states = parts[0].1.states;
        let mut probabilities = vec![0.0; states * states];
        for (weight, part) in parts {
            assert_eq!(states, part.states, "matrices of different sizes");
            for (sum, p) in probabilities.iter_mut().zip(&part.probabilities) {
                *sum += weight / total * p;
            }
        }
        Self {
            states,
            probabilities,
        }
    }

    /// How many states there are.
    pub fn states(&self) -> usize {
        self.states
    }

    /// The probability to go from one state to another in one step.
    pub fn probability(&self, from: usize, to: usize) -> f64 {
        self.probabilities[from * self.states + to]
    }

    /// The law after one step from the law `from`: the vector times the matrix.
    pub fn step(&self, from: &[f64]) -> Vec<f64> {
        let mut law = vec![0.0; self.states];
        for (mass, row) in from
            .iter()
            .zip(self.probabilities.chunks_exact(self.states))
        {
            if *mass > 0.0 {
                for (sum, p) in law.iter_mut().zip(row) {
                    *sum += mass * p;
                }
            }
        }
        law
    }

    /// |pi P - pi|_1 for the unnormalised law `pi`, relative to its sum.
    pub fn stationarity_defect(&self, pi: &[f64]) -> f64 {
        let total: f64 = pi.iter().sum();
        let after = self.step(pi);
        let change = after.iter().zip(pi).map(|(after, pi)| (after - pi).abs());
        change.sum::<f64>() / total
    }

    /// max |pi(x) P(x, y) - pi(y) P(y, x)| for the unnormalised law `pi`, relative to its
    /// sum. NaN, which no bound holds, if `pi` is no law: it has a NaN or an infinity, or sums to 0.
    pub fn balance_defect(&self, pi: &[f64]) -> f64 {
        self.worst_pair(pi).defect()
    }

    /// The pair of states whose flows differ most, for the unnormalised law `pi`.
    pub fn worst_pair(&self, pi: &[f64]) -> Imbalance {
        let total: f64 = pi.iter().sum();
        let pairs = (0..self.states).flat_map(|x| (0..x).map(move |y| [y, x]));
        pairs
            .map(|[x, y]| Imbalance {
                states: [x, y],
                masses: [pi[x] / total, pi[y] / total],
                probabilities: [self.probability(x, y), self.probability(y, x)],
            })
            .fold(Imbalance::default(), |worst, pair| {
                if is_worse(pair.defect(), worst.defect()) {
                    pair
                } else {
                    worst
                }
            })
    }

    /// The state whose mass one step changes most, for the unnormalised law `pi`.
    pub fn worst_state(&self, pi: &[f64]) -> Drift {
        let total: f64 = pi.iter().sum();
        let after = self.step(pi);
        let drifts = pi.iter().zip(&after).enumerate();
        drifts
            .map(|(state, (before, after))| Drift {
                state,
                before: before / total,
                after: after / total,
            })
            .fold(Drift::default(), |worst, drift| {
                if is_worse(drift.defect(), worst.defect()) {
                    drift
                } else {
                    worst
                }
            })
    }
}

/// A defect that is no number, as of a law that is none, is the worst: it must not pass for balance.
fn is_worse(defect: f64, worst: f64) -> bool {
    !worst.is_nan() && (defect.is_nan() || defect > worst)
}

/// Two states and what flows between them under a law: equal both ways if the kernel is
/// reversible.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Imbalance {
    /// The states.
    pub states: [usize; 2],
    /// Their masses under the normalised law.
    pub masses: [f64; 2],
    /// The probabilities to go from the first to the second, and back.
    pub probabilities: [f64; 2],
}

impl Imbalance {
    /// The flow from the first to the second, and back.
    pub fn flows(&self) -> [f64; 2] {
        [0, 1].map(|i| self.masses[i] * self.probabilities[i])
    }

    /// By how much the flows differ.
    pub fn defect(&self) -> f64 {
        let [there, back] = self.flows();
        (there - back).abs()
    }
}

impl fmt::Display for Imbalance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([x, y], [there, back]) = (self.states, self.flows());
        write!(
            f,
            "{there:.6e} flows from state {x} (mass {:.6e}) to {y} with probability {:.6e}, \
             but {back:.6e} from {y} (mass {:.6e}) to {x} with {:.6e}: difference {:.3e}",
            self.masses[0],
            self.probabilities[0],
            self.masses[1],
            self.probabilities[1],
            self.defect()
        )
    }
}

/// What one step makes of the mass of a state: nothing if the law is stationary.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drift {
    /// The state.
    pub state: usize,
    /// Its mass under the normalised law.
    pub before: f64,
    /// Its mass one step later.
    pub after: f64,
}

impl Drift {
    /// By how much the mass changes.
    pub fn defect(&self) -> f64 {
        (self.after - self.before).abs()
    }
}

impl fmt::Display for Drift {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "state {} has mass {:.6e}, but {:.6e} one step later: {:+.3e}",
            self.state,
            self.before,
            self.after,
            self.after - self.before
        )
    }
}
