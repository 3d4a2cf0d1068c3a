use std::collections::BTreeMap;

use crate::Draws;

/// Answers every draw with each possible answer in turn, and knows their probabilities.
///
/// [`uniform`](Draws::uniform) is replaced by the middles of `cells` equal cells: exact
/// for programs that treat uniform numbers as coordinates on a grid of that many cells (or
/// fewer that divide it). Decisions must be `bernoulli` or `index`.
///
/// # Panics
///
/// A draw panics if the program is not a function of its draws (what it asks for after the
/// same answers, or how probable they are, has changed: some state was carried from one run to the next), if a run
/// makes more than 10,000 draws (it loops until it likes an answer: no finite enumeration
/// has the law of that), if it draws a uniform number and `cells` is 1, or if weights are negative or not finite.
#[derive(Debug)]
pub struct Enumerator {
    cells: usize,
    /// The draws of the run, in their order.
    branches: Vec<Branch>,
    /// Answers to come, of all branches one behind the other, with their probabilities.
    answers: Vec<(usize, f64)>,
    /// How many draws the run has made.
    depth: usize,
    /// Probability of the run so far.
    probability: f64,
}

/// One draw.
#[derive(Debug)]
struct Branch {
    /// How many answers were possible: the same draw must ask the same.
    choices: usize,
    /// Has any of them a probability?
    possible: bool,
    /// Where its answers begin.
    begin: usize,
    /// The answer that is being followed.
    followed: (usize, f64),
}

/// More draws than this are taken for a loop without end.
const LONGEST: usize = 10_000;

impl Enumerator {
    pub(super) fn new(cells: usize) -> Self {
        Self {
            cells,
            branches: Vec::new(),
            answers: Vec::new(),
            depth: 0,
            probability: 1.0,
        }
    }

    /// The probability of the run so far.
    pub(super) fn probability(&self) -> f64 {
        self.probability
    }

    /// The answer of this run to a draw with these probabilities.
    fn branch(&mut self, choices: usize, probability: impl Fn(usize) -> f64) -> usize {
        if self.depth == self.branches.len() {
            self.open(choices, &probability);
        }
        let branch = &self.branches[self.depth];
        assert!(
            branch.choices == choices,
            "draw {} had {} possible answers and now has {choices}: the program does not \
             depend on its draws alone",
            self.depth,
            branch.choices
        );
        let (answer, p) = branch.followed;
        if branch.possible {
            let now = probability(answer);
            assert!(
                now.to_bits() == p.to_bits(),
                "answer {answer} to draw {} had probability {p} and now has {now}: the program does not \
                 depend on its draws alone",
                self.depth
            );
        }
        self.depth += 1;
        self.probability *= branch.followed.1;
        branch.followed.0
    }

    fn open(&mut self, choices: usize, probability: impl Fn(usize) -> f64) {
        assert!(self.depth < LONGEST, "a run of {LONGEST} draws: it loops");
        let begin = self.answers.len();
        for answer in (0..choices).rev() {
            let p = probability(answer);
            if p > 0.0 {
                self.answers.push((answer, p));
            }
        }
        let none = self.answers.len() == begin;
        self.branches.push(Branch {
            choices,
            possible: !none,
            begin,
            followed: if none {
                (0, 1.0)
            } else {
                self.answers.pop().unwrap_or_default()
            },
        });
    }

    /// Moves to the next run; false after the last.
    pub(super) fn advance(&mut self) -> bool {
        assert!(
            self.depth == self.branches.len(),
            "a run made fewer draws than the one before it: the program does not depend on \
             its draws alone"
        );
        self.depth = 0;
        self.probability = 1.0;
        while let Some(branch) = self.branches.last_mut() {
            if self.answers.len() > branch.begin {
                branch.followed = self.answers.pop().unwrap_or_default();
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
        assert!(
            cells > 1,
            "the program draws a uniform number, and there is no grid for it: expected 2 cells or more"
        );
        let cell = self.branch(cells, |_| 1.0 / cells as f64);
        (cell as f64 + 0.5) / cells as f64
    }

    fn bernoulli(&mut self, p: f64) -> bool {
        let p = if p > 0.0 { p.min(1.0) } else { 0.0 };
        self.branch(2, |answer| if answer == 1 { p } else { 1.0 - p }) == 1
    }

    fn index(&mut self, weights: &[f64]) -> usize {
        let sound = |weight: &f64| weight.is_finite() && *weight >= 0.0;
        assert!(
            weights.iter().all(sound),
            "weights of {weights:?}: expected finite ones that are not negative"
        );
        // of parts, whose sum does not overflow
        let part = 0.5 / weights.len() as f64;
        let total: f64 = weights.iter().map(|weight| weight * part).sum();
        self.branch(weights.len(), |answer| weights[answer] * part / total)
    }
}

/// So that it can be lent to what takes its draws by value, as [`sample`](crate::sample) does.
impl Draws for &mut Enumerator {
    fn uniform(&mut self) -> f64 {
        Enumerator::uniform(self)
    }

    fn bernoulli(&mut self, p: f64) -> bool {
        Enumerator::bernoulli(self, p)
    }

    fn index(&mut self, weights: &[f64]) -> usize {
        Enumerator::index(self, weights)
    }
}

/// The exact law of what a program returns: every outcome with its probability.
///
/// The program is run once for each sequence of answers and must depend on nothing but
/// its draws. `cells` is the grid of [`Enumerator`]. The number of runs grows with the
/// product of the numbers of answers; a run of a few draws takes well under a microsecond.
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

/// The exact expectation of what a program returns, under all its draws.
///
/// `cells` is the grid of [`Enumerator`].
pub fn expectation(cells: usize, mut program: impl FnMut(&mut Enumerator) -> f64) -> f64 {
    let mut mean = 0.0;
    each_run(cells, &mut program, |outcome, p| mean += p * outcome);
    mean
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
            assert!(draws.bernoulli(1.0) && !draws.bernoulli(0.0) && !draws.bernoulli(f64::NAN));
            assert_eq!((draws.index(&[]), draws.index(&[0.0, 0.0])), (0, 0));
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

    #[test]
    fn an_expectation_is_the_mean_of_the_law() {
        let mean = expectation(4, |draws| {
            draws.uniform() + f64::from(draws.bernoulli(0.3) as u8)
        });
        assert!((mean - 0.8).abs() < 1e-15);
    }

    #[test]
    #[should_panic(expected = "does not depend on its draws alone")]
    fn a_program_that_remembers_is_refused() {
        let mut runs = 0;
        enumerate(1, |draws| {
            runs += 1;
            draws.index(&vec![1.0; 1 + runs])
        });
    }

    /// A cache that is right on a miss and wrong on a hit.
    #[test]
    #[should_panic(expected = "does not depend on its draws alone")]
    fn a_program_that_remembers_its_weights_is_refused() {
        let mut runs = 0.0;
        enumerate(1, |draws| {
            runs += 1.0;
            draws.index(&[1.0, runs])
        });
    }

    #[test]
    #[should_panic(expected = "expected 2 cells or more")]
    fn uniform_numbers_want_a_grid() {
        enumerate(1, |draws| draws.uniform() < 0.3);
    }

    #[test]
    #[should_panic(expected = "expected finite ones that are not negative")]
    fn negative_weights_are_refused() {
        enumerate(1, |draws| draws.index(&[-1.0, 2.0]));
    }

    #[test]
    #[should_panic(expected = "fewer draws")]
    fn a_program_that_stops_early_is_refused() {
        let mut runs = 0;
        enumerate(1, |draws| {
            runs += 1;
            draws.bernoulli(0.5);
            if runs == 1 {
                draws.bernoulli(0.5);
            }
        });
    }

    #[test]
    #[should_panic(expected = "it loops")]
    fn a_loop_without_end_is_refused() {
        enumerate(2, |draws| while draws.uniform() < 0.5 {});
    }
}
