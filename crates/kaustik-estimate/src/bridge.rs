//! Normalisers of chains from what all of them visit.
//!
//! Each visit of chain `j` says how likely every other chain was to have made it: the posterior
//! `(T_l / b0_l) / sum_m (T_m / b0_m)`. Their means under chain `j` are a stochastic matrix `A`, and `x_l = b_l / b0_l` is its
//! stationary law, for any `b0`:
//!
//! ```text
//! sum_j x_j A_jl = integral of (sum_j T_j / b0_j) (T_l / b0_l) / (sum_m T_m / b0_m) = b_l / b0_l
//! ```
//!
//! So ratios of normalisers stand on visits from both sides, where the mean of `T_l / T_j` under chain `j` hangs on the few
//! that it makes to where chain `l` mostly is. (Geyer 1994 has the same equations, solved for `b0` as well.)

/// Sums of posteriors over the visits of the chains above the first: that one draws uniform samples, and says by itself how
/// likely the second is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bridge<const K: usize> {
    sums: [[f64; K]; K],
}

impl<const K: usize> Default for Bridge<K> {
    fn default() -> Self {
        Self {
            sums: [[0.0; K]; K],
        }
    }
}

impl<const K: usize> Bridge<K> {
    /// Takes a weighted visit of the chain at `level`, with the densities of all levels there and rough normalisers.
    #[inline]
    pub fn take(&mut self, level: usize, weight: f64, densities: &[f64; K], rough: &[f64; K]) {
        if level == 0 {
            return;
        }
        let sum: f64 = (1..K).map(|l| densities[l] / rough[l]).sum();
        if sum > 0.0 && sum.is_finite() {
            let weight = weight / sum;
            for l in 1..K {
                self.sums[level][l] += weight * densities[l] / rough[l];
            }
        }
    }

    /// Adds what other chains of the same levels have visited, with the same rough normalisers.
    pub fn merge(&mut self, other: &Self) {
        for (row, more) in self.sums.iter_mut().zip(&other.sums) {
            for (sum, more) in row.iter_mut().zip(more) {
                *sum += more;
            }
        }
    }

    /// Normalisers over that of the second level, for the rough ones that the visits were taken with. 0 for the first
    /// level, and for all where a chain has visited nothing.
    pub fn ratios(&self, rough: &[f64; K]) -> [f64; K] {
        let mut matrix = self.sums;
        for row in &mut matrix[1..] {
            let sum: f64 = row.iter().sum();
            if sum <= 0.0 {
                return [0.0; K];
            }
            for value in row.iter_mut() {
                *value /= sum;
            }
        }
        let law = stationary(matrix);
        let second = law[1] * rough[1];
        std::array::from_fn(|l| {
            if l == 0 || second <= 0.0 {
                0.0
            } else {
                law[l] * rough[l] / second
            }
        })
    }
}

/// The stationary law of the states from the second on, not scaled, by elimination without differences (Grassmann, Taksar
/// and Heyman 1985).
fn stationary<const K: usize>(mut a: [[f64; K]; K]) -> [f64; K] {
    for n in (2..K).rev() {
        let leaves: f64 = a[n][1..n].iter().sum();
        if leaves <= 0.0 {
            // Nothing leads from here to the states before: they are not on one scale.
            return [0.0; K];
        }
        for i in 1..n {
            a[i][n] /= leaves;
            for j in 1..n {
                a[i][j] += a[i][n] * a[n][j];
            }
        }
    }
    let mut law = [0.0; K];
    law[1] = 1.0;
    for n in 2..K {
        law[n] = (1..n).map(|i| law[i] * a[i][n]).sum();
    }
    law
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever the rough normalisers are, visits in proportion to the targets give the true ratios.
    #[test]
    fn ratios_are_those_of_the_integrals() {
        // ten places, four targets over them, the first one uniform
        let targets: Vec<[f64; 4]> = (0..10)
            .map(|i| {
                let x = f64::from(i);
                let seen = f64::from(u8::from(i >= 4));
                [
                    1.0,
                    seen,
                    seen / (1.0 + x),
                    seen / (1.0 + x) * (0.01 + 0.002 * x * x),
                ]
            })
            .collect();
        let integral = |l: usize| targets.iter().map(|t| t[l]).sum::<f64>();
        for rough in [[1.0; 4], [1.0, 0.3, 7.0, 1e-4]] {
            let mut halves = [Bridge::default(); 2];
            for (place, t) in targets.iter().enumerate() {
                for level in 0..4 {
                    // chains of different lengths
                    let weight = (1.0 + level as f64) * t[level] / integral(level);
                    halves[place % 2].take(level, weight, t, &rough);
                }
            }
            let [mut all, other] = halves;
            all.merge(&other);
            let found = all.ratios(&rough);
            for l in 1..4 {
                let wanted = integral(l) / integral(1);
                assert!((found[l] / wanted - 1.0).abs() < 1e-12, "{l}: {found:?}");
            }
        }
    }

    /// Chains that visit nothing, or that never meet, say nothing.
    #[test]
    fn what_is_not_joined_has_no_ratio() {
        let rough = [1.0; 3];
        let mut bridge = Bridge::<3>::default();
        assert_eq!(bridge.ratios(&rough), [0.0; 3]);
        bridge.take(1, 2.0, &[1.0, 1.0, 0.0], &rough);
        assert_eq!(bridge.ratios(&rough), [0.0; 3]);
        bridge.take(2, 2.0, &[1.0, 0.0, 1.0], &rough);
        assert_eq!(bridge.ratios(&rough), [0.0; 3]);
        bridge.take(2, 2.0, &[1.0, 1.0, 1.0], &rough);
        assert!(bridge.ratios(&rough)[1] > 0.0);
    }
}
