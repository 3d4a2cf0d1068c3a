//! How often each length and each strategy is tried (`docs/papers/mmlt.md`).

use kaustik_pss::{Coordinates, Stream};

use super::technique_spread::TechniqueSpread;
use crate::layout;

/// A strategy `(s, t)` and the probability with which it was chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Technique {
    /// Vertices from the light, the point on the emitter included.
    pub s: u32,
    /// Vertices from the eye, the point on the lens included.
    pub t: u32,
    /// Of the length and, given it, of the strategy: in (0, 1].
    pub probability: f64,
}

/// Share of the tries that go to lengths whatever the pilot saw in them, the more so the shorter: none may be
/// out of reach, and a length that the pilot met too rarely must not weigh too much.
const EVEN_LENGTHS: f64 = 0.1;
/// The same for the strategies of a length.
const EVEN_STRATEGIES: f64 = 0.25;
/// Of longer paths all strategies are tried alike.
const LEARNED_EDGES: u32 = 64;

/// Fixed probabilities of all lengths and of the strategies of each.
///
/// The value of a technique is divided by its probability, so that any probabilities give the right mean as
/// long as none is zero where there is light, and as long as they do not depend on the samples that
/// they weigh. So they are fixed before: from a pilot with random numbers of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Techniques {
    /// The shortest path in edges.
    least: u32,
    /// Is there a strategy t = 0?
    lens: bool,
    /// Over the lengths from `least` on: sums of the probabilities up to each, the last 1.
    lengths: Vec<f64>,
    /// The same over the strategies of each length, empty where all are alike.
    strategies: Vec<Vec<f64>>,
}

impl Techniques {
    /// Longest paths that can be told apart, in edges.
    pub const MOST_EDGES: u32 = 4096;

    /// Lengths by the inverse of their square, and of each length all strategies alike. `lens` tells whether
    /// a walk can run into the lens. Lengths run from `least` (at least 1) to `most` edges, at most
    /// [`MOST_EDGES`](Self::MOST_EDGES); if there are none, nothing is ever drawn.
    pub fn even(least: u32, most: u32, lens: bool) -> Self {
        let least = least.max(1);
        let lengths = (least..=most.min(Self::MOST_EDGES))
            .map(prior)
            .collect::<Vec<_>>();
        Self {
            least,
            lens,
            strategies: vec![Vec::new(); lengths.len()],
            lengths: cumulative(&lengths),
        }
    }

    /// Probabilities learnt from a pilot. With `strategies`, each technique is chosen in proportion to the
    /// spread of its values. Without it, and for paths of more than 64 edges, each length is chosen in
    /// proportion to the spread over its strategies, taken with equal probability. A fixed share is spread
    /// over all techniques whatever the pilot saw.
    ///
    /// Apart from that share, these probabilities minimise the variance of independent samples. In a chain
    /// they flatten peaks: what brings much light at few points is tried more often and weighs less.
    #[must_use]
    pub fn learned(&self, spread: &TechniqueSpread, strategies: bool) -> Self {
        let is_learned = |edges: u32| strategies && edges <= LEARNED_EDGES;
        let length = |edges| match is_learned(edges) {
            true => spread.length(edges),
            false => spread.even_length(edges, self.count(edges)),
        };
        let seen: Vec<f64> = self.edges().map(length).collect();
        let prior: Vec<f64> = self.edges().map(prior).collect();
        let learn = |edges: u32| {
            let count = self.count(edges);
            if !is_learned(edges) || spread.length(edges) <= 0.0 {
                return Vec::new();
            }
            let seen: Vec<f64> = (0..count).map(|s| spread.of(edges, s)).collect();
            cumulative(&mixed(&seen, &vec![1.0; count], EVEN_STRATEGIES))
        };
        Self {
            least: self.least,
            lens: self.lens,
            lengths: cumulative(&mixed(&seen, &prior, EVEN_LENGTHS)),
            strategies: self.edges().map(learn).collect(),
        }
    }

    /// The share of tries that the other, over the same lengths, gives to other techniques: their total variation, in [0, 1].
    pub fn differs_by(&self, other: &Self) -> f64 {
        let pairs = self.all().zip(other.all());
        let sum: f64 = pairs
            .map(|(a, b)| (a.probability - b.probability).abs())
            .sum();
        0.5 * sum
    }

    /// Are there no lengths at all?
    pub fn is_empty(&self) -> bool {
        self.lengths.is_empty()
    }

    fn edges(&self) -> std::ops::Range<u32> {
        self.least..self.least + self.lengths.len() as u32
    }

    /// Strategies of a length: `s` from 0 on. (1, 1) and (2, 0) do not count, so that an emitter that is seen directly
    /// has one.
    fn count(&self, edges: u32) -> usize {
        if edges == 1 {
            1
        } else {
            edges as usize + 1 + usize::from(self.lens)
        }
    }

    /// All strategies with their probabilities, shortest paths first, then by `s`.
    pub fn all(&self) -> impl Iterator<Item = Technique> + '_ {
        self.edges().enumerate().flat_map(move |(index, edges)| {
            (0..self.count(edges)).map(move |s| self.technique(index, edges, s))
        })
    }

    /// Draws a length and a strategy; `None` if there are no lengths.
    #[inline]
    pub fn draw(&self, u: &mut dyn Coordinates) -> Option<Technique> {
        if self.lengths.is_empty() {
            return None;
        }
        let index = cell(&self.lengths, u.get(Stream::Technique, layout::LENGTH));
        let edges = self.least + index as u32;
        let count = self.count(edges);
        if count == 1 {
            return Some(self.technique(index, edges, 0));
        }
        let at = u.get(Stream::Technique, layout::STRATEGY);
        let strategies = &self.strategies[index];
        let s = if strategies.is_empty() {
            ((at * count as f64) as usize).min(count - 1)
        } else {
            cell(strategies, at)
        };
        Some(self.technique(index, edges, s))
    }

    #[inline]
    fn technique(&self, index: usize, edges: u32, s: usize) -> Technique {
        let strategies = &self.strategies[index];
        let given_length = if strategies.is_empty() {
            1.0 / self.count(edges) as f64
        } else {
            width(strategies, s)
        };
        Technique {
            s: s as u32,
            t: edges + 1 - s as u32,
            probability: width(&self.lengths, index) * given_length,
        }
    }
}

/// Without a pilot: short paths are cheap, and mostly bring more light.
fn prior(edges: u32) -> f64 {
    1.0 / f64::from(edges).powi(2)
}

/// Both in proportion to their sums, the second with this share.
fn mixed(seen: &[f64], even: &[f64], share: f64) -> Vec<f64> {
    let (of_seen, of_even): (f64, f64) = (seen.iter().sum(), even.iter().sum());
    let learned = if of_seen > 0.0 && of_seen.is_finite() {
        (1.0 - share) / of_seen
    } else {
        0.0
    };
    (seen.iter().zip(even))
        .map(|(seen, even)| seen * learned + even * share / of_even)
        .collect()
}

/// Sums up to each, over the sum of all; the last is 1.
fn cumulative(weights: &[f64]) -> Vec<f64> {
    let all: f64 = weights.iter().sum();
    let mut sum = 0.0;
    let mut sums: Vec<f64> = weights
        .iter()
        .map(|weight| {
            sum += weight;
            sum / all
        })
        .collect();
    if let Some(last) = sums.last_mut() {
        *last = 1.0;
    }
    sums
}

/// The cell of [0, 1) that holds `u`. The first ones are the likely ones.
#[inline]
fn cell(sums: &[f64], u: f64) -> usize {
    let found = sums.iter().position(|&sum| u < sum);
    found.unwrap_or(sums.len() - 1)
}

/// The cell's probability.
#[inline]
fn width(sums: &[f64], index: usize) -> f64 {
    sums[index] - if index == 0 { 0.0 } else { sums[index - 1] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kaustik_pss::Recorded;

    fn spread() -> TechniqueSpread {
        let mut spread = TechniqueSpread::default();
        for (s, t, light) in [(0, 2, 1.0), (1, 2, 3.0), (0, 3, 1.0), (2, 2, f64::NAN)] {
            spread.add((s, t), 1.0, light);
        }
        spread
    }

    fn tables() -> [Techniques; 4] {
        let even = Techniques::even(1, 5, false);
        let lens = Techniques::even(3, 70, true);
        [
            even.learned(&spread(), true),
            lens.learned(&spread(), false),
            even,
            lens,
        ]
    }

    #[test]
    fn probabilities_sum_to_one_and_none_is_zero() {
        for table in tables() {
            let sum: f64 = table.all().map(|technique| technique.probability).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{sum}");
            assert!(table.all().all(|technique| technique.probability > 0.0));
            let mut from_eye = table.all().filter(|technique| technique.s <= 1);
            assert!(from_eye.all(|technique| technique.t >= 2));
        }
    }

    /// Each is drawn as often as its probability says: by cells of a fine grid, to its width.
    #[test]
    fn draws_follow_the_probabilities() {
        const STEPS: u32 = 400;
        for table in tables() {
            let mut found = std::collections::BTreeMap::new();
            for i in 0..STEPS * STEPS {
                let mut u = Recorded::new();
                let at = |i: u32| (f64::from(i) + 0.5) / f64::from(STEPS);
                u.set(Stream::Technique, layout::LENGTH, at(i / STEPS));
                u.set(Stream::Technique, layout::STRATEGY, at(i % STEPS));
                let technique = table.draw(&mut u).expect("lengths");
                *found.entry((technique.s, technique.t)).or_insert(0.0) +=
                    1.0 / f64::from(STEPS * STEPS);
            }
            for technique in table.all() {
                let share = found
                    .get(&(technique.s, technique.t))
                    .copied()
                    .unwrap_or(0.0);
                let off: f64 = share - technique.probability;
                assert!(off.abs() < 2.0 / f64::from(STEPS), "{technique:?}: {share}");
            }
        }
    }

    #[test]
    fn what_brings_light_is_tried_more_often() {
        let table = Techniques::even(1, 5, false).learned(&spread(), true);
        let share = |s, t| {
            let mut all = table.all();
            let found = all.find(|technique| (technique.s, technique.t) == (s, t));
            found.expect("a strategy").probability
        };
        assert!(share(1, 2) > 2.0 * share(0, 3) && share(0, 3) > 2.0 * share(2, 1));
        assert!(share(0, 2) > 10.0 * share(0, 4));
    }

    #[test]
    fn tables_differ_by_what_they_give_elsewhere() {
        let even = Techniques::even(1, 5, false);
        let learned = even.learned(&spread(), true);
        assert!(even.differs_by(&even) == 0.0);
        let more = even.all().zip(learned.all());
        let more: f64 = more
            .map(|(a, b)| (b.probability - a.probability).max(0.0))
            .sum();
        assert!((even.differs_by(&learned) - more).abs() < 1e-12 && more > 0.1);
    }

    #[test]
    fn no_lengths_draw_nothing() {
        let table = Techniques::even(3, 2, false);
        assert_eq!(table.draw(&mut Recorded::new()), None);
        assert_eq!(table.all().count(), 0);
        let again = table.learned(&spread(), true);
        assert_eq!(again.draw(&mut Recorded::new()), None);
    }
}
