//! Bidirectional mutation (Veach 1997, 11.4.2).

use std::ops::RangeInclusive;

use kaustik_mcmc::Draws;
use kaustik_spectrum::Wavelengths;

use crate::factor::{Factor, factor};
use crate::{Path, PathSpace};

/// Deletes a part of the path and makes it anew, longer or shorter, by walks from both its ends. Moves
/// between all paths: the whole path may be made anew, with its wavelengths and its time.
#[derive(Clone, Copy, Debug)]
pub struct BidirectionalMutation<'a> {
    /// Where the paths run.
    pub space: &'a PathSpace<'a>,
}

/// More edges are deleted only with the whole path.
const MOST_DELETED: usize = 16;
/// A part grows or shrinks by no more edges.
const MOST_CHANGE: usize = 12;
/// A whole path is made anew with no more lengths than this, from the least on: those of paths of 64 edges, and more than parts
/// have.
const MOST_LENGTHS: usize = 66;
/// Weight of making the whole path anew, beside the 1 or so of the shorter deletions that begin at one vertex: of a path of 2, 5,
/// 10 edges that is 0.73, 0.47, 0.30 of all mutations (0.64, 0.43, 0.28 with a lens that has area). Shorter ones go from one room to the
/// next by way of all lengths between, if at all.
const WHOLE: f64 = 4.0;

/// Veach's `p_d1`, by the number of edges.
const DELETION: [f64; MOST_DELETED + 1] = {
    let mut weights = [0.0; MOST_DELETED + 1];
    (weights[1], weights[2]) = (0.25, 0.5);
    let mut n = 3;
    while n <= MOST_DELETED {
        weights[n] = 1.0 / (1u64 << n) as f64;
        n += 1;
    }
    weights
};

/// `p_a1`, by how many edges a part grows or shrinks.
const CHANGE: [f64; MOST_CHANGE + 1] = {
    let mut weights = [0.0; MOST_CHANGE + 1];
    (weights[0], weights[1]) = (0.5, 0.15);
    let mut n = 2;
    while n <= MOST_CHANGE {
        weights[n] = 0.2 / (1u64 << n) as f64;
        n += 1;
    }
    weights
};

/// A whole path is made anew with one edge more that many times as often.
const LONGER: f64 = 0.7;

/// What is deleted: vertices `first..end`; those before and behind are kept. `end - first + 1` edges go,
/// virtual ones beyond the ends of the path included.
///
/// A vertex keeps its role: an emitter is not kept as a place that scatters, nor the other way
/// round. A point sampled on an emitter lacks the data that scattering there needs; and unless
/// the surface does both, such a path carries no light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Cut {
    first: usize,
    end: usize,
}

impl Cut {
    fn edges(self) -> usize {
        self.end + 1 - self.first
    }

    /// Everything that can go: a lens that is one point stays.
    fn whole(path: &Path, aperture: bool) -> Self {
        Self {
            first: 0,
            end: path.edges() + usize::from(aperture),
        }
    }

    fn weight(self, path: &Path, aperture: bool) -> f64 {
        let whole = if self == Self::whole(path, aperture) {
            WHOLE
        } else {
            0.0
        };
        whole + DELETION.get(self.edges()).copied().unwrap_or(0.0)
    }

    /// Has the lens of a path with so many edges gone?
    fn is_without_lens(self, edges: usize) -> bool {
        self.end == edges + 1
    }

    /// The fewest edges that may stand in its place: an emitter or a lens at least, if that went.
    fn least(self, edges: usize) -> usize {
        if self.first == 0 || self.is_without_lens(edges) {
            2
        } else {
            1
        }
    }

    /// In how many ways the vertices that stand in its place in a path of so many edges are shared between a walk
    /// with the light and one from the eye: the lens is always begun at.
    fn splits(self, edges: usize) -> usize {
        self.edges() - usize::from(self.is_without_lens(edges))
    }

    /// Are both ends kept vertices that can be joined, or beyond the path?
    fn is_open(self, path: &Path) -> bool {
        let first = self.first == 0 || !path.is_specular(self.first - 1);
        first && (self.end == path.len() || !path.is_specular(self.end))
    }
}

/// All cuts of a path that have a weight: those of few edges, and the whole path.
fn cuts(path: &Path, aperture: bool) -> impl Iterator<Item = (Cut, f64)> {
    let top = Cut::whole(path, aperture).end;
    let ends = move |first: usize| {
        let furthest = top.min(first + MOST_DELETED - 1);
        let whole = (first == 0 && furthest < top).then_some(top);
        (first.max(1)..=furthest).chain(whole)
    };
    (0..path.len())
        .flat_map(move |first| ends(first).map(move |end| Cut { first, end }))
        .filter(move |cut| cut.is_open(path))
        .map(move |cut| (cut, cut.weight(path, aperture)))
        .filter(|(_, weight)| *weight > 0.0)
}

/// Weights of the numbers of edges to add after a cut, from 1 on.
struct Additions {
    weights: [f64; MOST_LENGTHS],
    /// How many have a meaning.
    count: usize,
    /// Edges of the first.
    from: usize,
    sum: f64,
}

impl Additions {
    /// To a path that has lost `cut`, within the lengths that paths may have.
    fn new(space: &PathSpace<'_>, path: &Path, cut: Cut) -> Self {
        let whole = cut == Cut::whole(path, space.has_aperture());
        let choose = if whole { Self::of_whole } else { Self::of_part };
        choose(path.edges(), cut, &space.lengths())
    }

    /// About as many edges as there were.
    fn of_part(edges: usize, cut: Cut, lengths: &RangeInclusive<usize>) -> Self {
        let lost = cut.edges();
        let from = lost.saturating_sub(MOST_CHANGE).max(cut.least(edges));
        // One edge for one changes nothing.
        Self::weighted(edges, cut, lengths, from..=lost + MOST_CHANGE, |added| {
            let change = CHANGE.get(added.abs_diff(lost));
            change
                .filter(|_| (lost, added) != (1, 1))
                .copied()
                .unwrap_or(0.0)
        })
    }

    /// Of a whole path: whatever it was.
    fn of_whole(edges: usize, cut: Cut, lengths: &RangeInclusive<usize>) -> Self {
        let from = cut.least(edges);
        let mut weight = 1.0 / LONGER;
        Self::weighted(edges, cut, lengths, from..=usize::MAX, |_| {
            weight *= LONGER;
            weight
        })
    }

    /// Weights of so many edges, asked for in that order; those that make the path too short or too long have none.
    fn weighted(
        edges: usize,
        cut: Cut,
        lengths: &RangeInclusive<usize>,
        of: RangeInclusive<usize>,
        mut weight: impl FnMut(usize) -> f64,
    ) -> Self {
        let (lost, from) = (cut.edges(), *of.start());
        let mut weights = [0.0; MOST_LENGTHS];
        let mut count = 1;
        for (i, added) in of.take(MOST_LENGTHS).enumerate() {
            if edges + added > lengths.end() + lost {
                break;
            }
            let weight = weight(added);
            if edges + added >= lengths.start() + lost {
                weights[i] = weight;
                count = i + 1;
            }
        }
        let sum = weights[..count].iter().sum();
        Self {
            weights,
            count,
            from,
            sum,
        }
    }

    /// Weights of `from` edges and more.
    fn weights(&self) -> &[f64] {
        &self.weights[..self.count]
    }

    /// Probability of so many edges.
    fn probability(&self, added: usize) -> f64 {
        let weight = added
            .checked_sub(self.from)
            .and_then(|i| self.weights.get(i));
        // The longest path cannot grow: then nothing has a weight.
        weight
            .filter(|weight| **weight > 0.0)
            .map_or(0.0, |weight| weight / self.sum)
    }
}

impl BidirectionalMutation<'_> {
    pub(crate) fn mutate<D: Draws + ?Sized>(
        &self,
        x: &Path,
        y: &mut Path,
        draws: &mut D,
    ) -> Option<f64> {
        if x.edges() == 0 {
            return None;
        }
        let space = self.space;
        let aperture = space.has_aperture();
        let sum = cuts_sum(x, aperture);
        let cut = choose(x, aperture, sum, draws)?;
        let additions = Additions::new(space, x, cut);
        let added = additions.from + draws.index(additions.weights());
        if additions.probability(added) <= 0.0 {
            return None;
        }
        let new = Cut {
            first: cut.first,
            end: cut.first + added - 1,
        };
        self.keep(x, y, cut, new);
        let splits = new.splits(y.edges());
        let by_light = ((splits as f64 * draws.uniform()) as usize).min(splits - 1);
        if cut == Cut::whole(x, aperture) {
            y.wavelength_u = draws.uniform();
            y.wavelengths = Wavelengths::sample(y.wavelength_u, space.settings.wavelengths);
            y.time = space.draw_time(draws);
        }
        // What is kept of the path stands where it stood: only a whole path has another time.
        let there = space.at(y.time, |space| {
            if cut == Cut::whole(x, aperture) && space.scene.moves() && !aperture {
                y.at_mut(new.end).vertex.position = space.scene.camera().position();
            }
            if !space.generate(y, new.first..new.end, by_light, draws) || !new.is_open(y) {
                return None;
            }
            keep_rest(x, y, cut, new);
            let lit = space.evaluate(y);
            lit.then(|| density(space, (x, cut, sum), &additions, (y, new)))
        })?;
        let additions = Additions::new(space, y, new);
        let from = (&*y, new, cuts_sum(y, aperture));
        Some(density(space, from, &additions, (x, cut)) / there)
    }

    /// Copies the vertices next to the cut.
    fn keep(&self, x: &Path, y: &mut Path, cut: Cut, new: Cut) {
        y.resize(x.len() - (cut.end - cut.first) + (new.end - new.first));
        y.tune(x);
        if cut.first > 0 {
            y.copy(cut.first - 1, x, cut.first - 1..cut.first);
        }
        if cut.end < x.len() {
            y.copy(new.end, x, cut.end..cut.end + 1);
            (y.raster, y.importance) = (x.raster, x.importance);
        }
    }
}

/// T(x -> y): probabilities of the cut, of the number of new edges and of a way to make them, times the density of each
/// way, summed. `sum` is that of the weights of all cuts of x; the space is that at the time of y.
fn density(
    space: &PathSpace<'_>,
    (x, cut, sum): (&Path, Cut, f64),
    additions: &Additions,
    (y, new): (&Path, Cut),
) -> f64 {
    let weight = factor(Factor::CutWeight, cut.weight(x, space.has_aperture()));
    let each = factor(Factor::Addition, additions.probability(new.edges()))
        / factor(Factor::Splits, new.splits(y.edges()) as f64);
    let ways = space.all_ways(y, new.first, new.end);
    weight / factor(Factor::CutsOfPath, sum) * each * ways
}

/// Copies the vertices further from the cut.
fn keep_rest(x: &Path, y: &mut Path, cut: Cut, new: Cut) {
    if cut.first > 1 {
        y.copy(0, x, 0..cut.first - 1);
    }
    if cut.end + 1 < x.len() {
        y.copy(new.end + 1, x, cut.end + 1..x.len());
    }
}

/// The sum of the weights of all cuts.
fn cuts_sum(path: &Path, aperture: bool) -> f64 {
    cuts(path, aperture).map(|(_, weight)| weight).sum()
}

/// Chooses a cut; `sum` is that of the weights of all.
fn choose<D: Draws + ?Sized>(path: &Path, aperture: bool, sum: f64, draws: &mut D) -> Option<Cut> {
    let mut rest = draws.uniform() * sum;
    let mut last = None;
    for (cut, weight) in cuts(path, aperture) {
        last = Some(cut);
        if rest < weight {
            break;
        }
        rest -= weight;
    }
    last
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_stay_within_bounds() {
        let lengths = 2..=8;
        for edges in lengths.clone() {
            for (first, end) in
                (0..=edges).flat_map(|a| (a.max(1)..=edges + 1).map(move |b| (a, b)))
            {
                let cut = Cut { first, end };
                let lost = cut.edges();
                let additions = Additions::of_part(edges, cut, &lengths);
                let sum: f64 = (1..40).map(|added| additions.probability(added)).sum();
                let all = if (edges, lost) == (8, 1) { 0.0 } else { 1.0 };
                assert!((sum - all).abs() < 1e-12, "{edges} {cut:?}: {sum}");
                for added in (1..40).filter(|&added| additions.probability(added) > 0.0) {
                    let after = edges + added - lost;
                    assert!(lengths.contains(&after) && (lost, added) != (1, 1));
                    // An emitter stands in the place of one that went, and a lens in that of a lens.
                    assert!((first > 0 && end <= edges) || added > 1);
                }
            }
        }
    }

    #[test]
    fn a_whole_path_is_as_long_as_chance_says_whatever_it_was() {
        for aperture in [0, 1] {
            let law = |edges: usize| {
                let (first, end) = (0, edges + aperture);
                let cut = Cut { first, end };
                let additions = Additions::of_whole(edges, cut, &(1..=9));
                [1, 2, 3, 5, 9, 10].map(|after| additions.probability(after + 1 + aperture))
            };
            let [one, two, _, five, nine, ten] = law(2);
            assert!((two / one - LONGER).abs() < 1e-12 && ten <= 0.0);
            assert!((nine / five - LONGER.powi(4)).abs() < 1e-12);
            // nothing shorter than may be, and everything up to the longest
            let cut = Cut {
                first: 0,
                end: 64 + aperture,
            };
            let deep = Additions::of_whole(64, cut, &(3..=64));
            let all = |after: &usize| deep.probability(after + 1 + aperture) > 0.0;
            assert_eq!(
                (1..=70).filter(all).collect::<Vec<_>>(),
                Vec::from_iter(3..=64)
            );
            for edges in 1..=9 {
                let same = law(edges)
                    .iter()
                    .zip(law(2))
                    .all(|(a, b)| (a - b).abs() < 1e-12);
                assert!(same, "{edges}");
            }
        }
    }
}
