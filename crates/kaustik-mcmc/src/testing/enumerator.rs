use std::collections::BTreeMap;

use crate::Draws;

/// Answers every draw with each possible answer in turn, and knows their probabilities.
///
/// [`uniform`](Draws::uniform) is replaced by the middles of `cells` equal cells: exact
/// for programs that treat uniform numbers as coordinates on a grid of that many cells (or
/// fewer that divide it). Decisions must be `bernoulli` or `index`.
#[derive(Debug)]
pub struct Enumerator {
    cells: usize,
    /// The branches of the run, in the order of the draws.
    branches: Vec<Branch>,
    /// How many draws the run has made.
    depth: usize,
    /// Probability of the run so far.
    probability: f64,
}

/// One draw: the answer that is being followed, and those still to come, with their
/// probabilities; the last of the list is followed.
#[derive(Debug)]
struct Branch {
    answers: Vec<(usize, f64)>,
}

impl Enumerator {
    fn new(cells: usize) -> Self {
        Self {
            cells,
            branches: Vec::new(),
            depth: 0,
            probability: 1.0,
        }
    }

    /// The answer of this run to a draw with these probabilities.
    fn branch(&mut self, probabilities: impl Iterator<Item = f64>) -> usize {
        if self.depth == self.branches.len() {
            let mut answers: Vec<_> = probabilities
                .enumerate()
                .filter(|(_, p)| *p > 0.0)
                .collect();
            answers.reverse();
            self.branches.push(Branch { answers });
        }
        let answers = &self.branches[self.depth].answers;
        let &(answer, p) = answers.last().unwrap_or(&(0, 1.0));
        self.depth += 1;
        self.probability *= p;
        answer
    }

    /// Moves to the next run; false after the last.
    fn advance(&mut self) -> bool {
        self.depth = 0;
        self.probability = 1.0;
        while let Some(branch) = self.branches.last_mut() {
            branch.answers.pop();
            if !branch.answers.is_empty() {
                return true;
            }
            self.branches.pop();
        }
        false
    }
}

impl Draws for Enumerator {
    fn uniform(&mut self) -> f64 {
        let cells = self.cells;
        let cell = self.branch((0..cells).map(|_| 1.0 / cells as f64));
        (cell as f64 + 0.5) / cells as f64
    }

    fn bernoulli(&mut self, p: f64) -> bool {
        let p = if p > 0.0 { p.min(1.0) } else { 0.0 };
        self.branch([1.0 - p, p].into_iter()) == 1
    }

    fn index(&mut self, weights: &[f64]) -> usize {
        let total: f64 = weights.iter().sum();
        self.branch(weights.iter().map(|w| w / total))
    }
}

/// The exact law of what a program returns: every outcome with its probability.
///
/// The program is run once for each sequence of answers and must depend on nothing but
/// its draws. `cells` is the grid of [`Enumerator`]. The number of runs grows with the
/// product of the numbers of answers.
///
/// ```
/// use kaustik_mcmc::{Draws, testing::enumerate};
///
/// let law = enumerate(1, |draws| u8::from(draws.bernoulli(0.25)) + u8::from(draws.bernoulli(0.25)));
/// assert_eq!(law[&2], 0.0625);
/// assert_eq!(law[&1], 0.375);
/// ```
pub fn enumerate<T: Ord>(
    cells: usize,
    mut program: impl FnMut(&mut Enumerator) -> T,
) -> BTreeMap<T, f64> {
    let mut law = BTreeMap::new();
    each_run(cells, &mut program, |outcome, p| {
        *law.entry(outcome).or_insert(0.0) += p;
    });
    law
}

/// Calls `take` with the outcome and the probability of each run.
pub(super) fn each_run<T>(
    cells: usize,
    program: &mut impl FnMut(&mut Enumerator) -> T,
    mut take: impl FnMut(T, f64),
) {
    let mut draws = Enumerator::new(cells);
    loop {
        let outcome = program(&mut draws);
        take(outcome, draws.probability);
        if !draws.advance() {
            break;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_sum_to_one_and_impossible_branches_are_not_taken() {
        let law = enumerate(3, |draws| {
            let x = draws.uniform();
            let i = draws.index(&[0.0, 1.0, 3.0]);
            assert!(draws.bernoulli(1.0) && !draws.bernoulli(0.0));
            // the number of draws may depend on the answers
            let more = if draws.bernoulli(0.5) {
                draws.index(&[1.0, 1.0])
            } else {
                7
            };
            ((x * 3.0) as usize, i, more)
        });
        assert_eq!(law.len(), 3 * 2 * 3);
        assert!((law.values().sum::<f64>() - 1.0).abs() < 1e-15);
        assert!((law[&(2, 2, 1)] - 1.0 / 3.0 * 0.75 * 0.25).abs() < 1e-16);
    }
}
