//! Gibbs sampling of the assignment of states to levels.

use crate::Schedule;

const MOST: usize = Schedule::MOST_PERMUTED;

/// 5!
const COUNT: usize = 120;

/// The conditional law of a permutation of states over levels, given the set of states.
///
/// Permutation s, which brings the state of level s(k) to level k, has weight product over k
/// of q_k(u_s(k)).
pub(crate) struct Permutations {
    /// Relative to the largest power of two among them; the first is the identity's.
    weights: [f64; COUNT],
    count: usize,
}

/// Which level's state comes to each level.
pub(crate) type Permutation = [usize; MOST];

impl Permutations {
    /// `density(k, j)` is that of the state of level j at level k; `levels` is at most
    /// [`Schedule::MOST_PERMUTED`].
    pub(crate) fn new(levels: usize, density: impl Fn(usize, usize) -> f64) -> Self {
        // mantissas and exponents apart: no product of five can over- or underflow
        let mut parts = [[(0.0, 0); MOST]; MOST];
        for (k, row) in parts.iter_mut().enumerate().take(levels) {
            for (j, part) in row.iter_mut().enumerate().take(levels) {
                *part = libm::frexp(density(k, j));
            }
        }
        let mut products = [(0.0, i32::MIN); COUNT];
        let (mut count, mut top) = (0, i32::MIN);
        let mut next = Some(IDENTITY);
        while let Some(permutation) = next {
            let mut product = (1.0, 0);
            for (row, &j) in parts.iter().zip(&permutation[..levels]) {
                product.0 *= row[j].0;
                product.1 += row[j].1;
            }
            if product.0 > 0.0 {
                products[count] = product;
                top = top.max(product.1);
            }
            count += 1;
            next = successor(permutation, levels);
        }
        let mut weights = [0.0; COUNT];
        for (weight, (mantissa, exponent)) in weights.iter_mut().zip(products) {
            if mantissa > 0.0 {
                *weight = libm::ldexp(mantissa, exponent - top);
            }
        }
        Self { weights, count }
    }

    pub(crate) fn weights(&self) -> &[f64] {
        &self.weights[..self.count]
    }

    /// The probability of any permutation but the identity.
    pub(crate) fn change(&self) -> f64 {
        let changed: f64 = self.weights()[1..].iter().sum();
        if changed > 0.0 {
            changed / (changed + self.weights[0])
        } else {
            0.0
        }
    }

    /// The permutation whose weight stands at `index`.
    pub(crate) fn get(levels: usize, index: usize) -> Permutation {
        let mut permutation = IDENTITY;
        for _ in 0..index {
            permutation = successor(permutation, levels).unwrap_or(IDENTITY);
        }
        permutation
    }
}

const IDENTITY: Permutation = [0, 1, 2, 3, 4];

/// The next permutation of the first `levels` in lexicographic order.
fn successor(mut permutation: Permutation, levels: usize) -> Option<Permutation> {
    let p = &mut permutation[..levels];
    let ascent = (1..p.len()).rev().find(|&i| p[i - 1] < p[i])?;
    let larger = (ascent..p.len()).rev().find(|&i| p[i] > p[ascent - 1])?;
    p.swap(ascent - 1, larger);
    p[ascent..].reverse();
    Some(permutation)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_permutations_come_once_and_the_identity_first() {
        for (levels, count) in [(1, 1), (2, 2), (3, 6), (4, 24), (5, 120)] {
            let law = Permutations::new(levels, |_, _| 1.0);
            assert_eq!(law.weights().len(), count);
            let mut all: Vec<_> = (0..count).map(|i| Permutations::get(levels, i)).collect();
            assert_eq!(all[0], IDENTITY);
            all.sort_unstable();
            all.dedup();
            assert_eq!(all.len(), count);
            assert!((law.change() - (1.0 - 1.0 / count as f64)).abs() < 1e-15);
        }
    }

    #[test]
    fn weights_are_products_at_any_scale() {
        let q = [[1.0, 0.5, 0.0], [2.0, 3.0, 0.25], [4.0, 1.0, 5.0]];
        let plain = Permutations::new(3, |k, j| q[k][j]);
        for scale in [1e-300, 1e300, 5e-320] {
            // exact powers: scaling by a number that is no power of two rounds
            let scale = libm::ldexp(1.0, libm::frexp(scale).1);
            let scaled = Permutations::new(3, |k, j| q[k][j] * scale);
            for i in 0..6 {
                let p = Permutations::get(3, i);
                let product: f64 = (0..3).map(|k| q[k][p[k]]).product();
                let share = |w: &Permutations| w.weights()[i] / w.weights().iter().sum::<f64>();
                let total: f64 = 15.0 + 0.25 + 5.0 + 0.5 * 0.25 * 4.0; // the permanent of q
                assert!((share(&plain) - product / total).abs() < 1e-15, "{p:?}");
                assert!((share(&scaled) - product / total).abs() < 1e-15, "{p:?}");
            }
        }
    }

    #[test]
    fn where_nothing_is_possible_nothing_is_changed() {
        let law = Permutations::new(3, |_, _| 0.0);
        assert!(law.change() <= 0.0 && law.weights().iter().all(|w| *w <= 0.0));
    }
}
