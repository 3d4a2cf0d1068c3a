use super::{Enumerator, enumerate};

/// The exact transition matrix P of a kernel on the states 0..n.
///
/// ```
/// use kaustik_mcmc::{Draws, acceptance, decide, testing::TransitionMatrix};
///
/// let pi = [0.5, 0.0, 0.2, 0.3];
/// // propose either neighbour on a ring of four, accept as Metropolis does
/// let kernel = TransitionMatrix::of(4, 1, |from, draws| {
///     let to = (from + [1, 3][draws.index(&[1.0, 1.0])]) % 4;
///     if decide(acceptance(pi[from], pi[to], 1.0), draws) { to } else { from }
/// });
/// assert!(kernel.stationarity_defect(&pi) < 1e-15);
/// assert!(kernel.balance_defect(&pi) < 1e-15);
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
        for from in 0..states {
            for (to, p) in enumerate(cells, |draws| step(from, draws)) {
                probabilities[from * states + to] += p;
            }
        }
        Self {
            states,
            probabilities,
        }
    }

    /// The probability to go from one state to another in one step.
    pub fn probability(&self, from: usize, to: usize) -> f64 {
        self.probabilities[from * self.states + to]
    }

    /// |pi P - pi|_1 for the unnormalised law `pi`, relative to its sum.
    pub fn stationarity_defect(&self, pi: &[f64]) -> f64 {
        let total: f64 = pi.iter().sum();
        (0..self.states)
            .map(|to| {
                let inflow: f64 = (0..self.states)
                    .map(|from| pi[from] * self.probability(from, to))
                    .sum();
                (inflow - pi[to]).abs() / total
            })
            .sum()
    }

    /// max |pi(x) P(x, y) - pi(y) P(y, x)| for the unnormalised law `pi`, relative to its
    /// sum.
    pub fn balance_defect(&self, pi: &[f64]) -> f64 {
        let total: f64 = pi.iter().sum();
        let pairs = (0..self.states).flat_map(|x| (0..x).map(move |y| (x, y)));
        pairs
            .map(|(x, y)| {
                let there = pi[x] * self.probability(x, y);
                let back = pi[y] * self.probability(y, x);
                (there - back).abs() / total
            })
            .fold(0.0, f64::max)
    }
}
