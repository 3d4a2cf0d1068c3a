use crate::Draws;

/// How a weighted population is turned into an unweighted one of the same size N.
///
/// Both give each member i an expected number of N w_i / sum w copies, which is all that
/// unbiasedness asks for. Neither copies a member of weight zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Resampling {
    /// One offset for N equidistant pointers into the cumulated weights (Kitagawa 1996):
    /// each member gets the integer below or above its expected number. Adds the least noise;
    /// the default.
    #[default]
    Systematic,
    /// N independent choices. Noisier, but members are independent given the weights: what
    /// the theory of error estimates assumes.
    Multinomial,
}

impl Resampling {
    /// Chooses how many copies each member gets: `copies[i]` of member i, `weights.len()` in
    /// all. `sums` is memory to work in; both vectors are overwritten.
    ///
    /// Weights are finite and at least 0, one of them positive.
    pub fn copies<D: Draws + ?Sized>(
        self,
        weights: &[f64],
        copies: &mut Vec<u32>,
        sums: &mut Vec<f64>,
        draws: &mut D,
    ) {
        self.copies_in_all(weights.len(), weights, copies, sums, draws);
    }

    /// The same for so many copies in all, more or fewer than there are members: member i gets an expected number of
    /// count w_i / sum w.
    pub fn copies_in_all<D: Draws + ?Sized>(
        self,
        count: usize,
        weights: &[f64],
        copies: &mut Vec<u32>,
        sums: &mut Vec<f64>,
        draws: &mut D,
    ) {
        sums.clear();
        sums.push(0.0);
        let mut sum = 0.0;
        sums.extend(weights.iter().map(|weight| {
            sum += weight;
            sum
        }));
        copies.clear();
        copies.resize(weights.len(), 0);
        match self {
            Self::Systematic => systematic(count, sums, copies, draws),
            Self::Multinomial => {
                for _ in 0..count {
                    let chosen = descend(weights.len(), |i| sums[i], draws);
                    copies[chosen] += 1;
                }
            }
        }
    }
}

/// Pointers stand at U + j, j = 0, 1, ..., with one U uniform in [0, 1); member i gets those
/// below its upper bound c_i and not below that of the member before.
///
/// How many lie below c is floor(c), and one more if U < frac(c). U is not drawn but
/// narrowed down: it is known to lie in [low, high), and only a fraction between the two
/// asks for a decision, with known odds (so that the enumerator can follow). That happens
/// about ln N times.
fn systematic<D: Draws + ?Sized>(count: usize, sums: &[f64], copies: &mut [u32], draws: &mut D) {
    let (count, total) = (count as f64, sums[sums.len() - 1]);
    let (mut low, mut high) = (0.0, 1.0);
    let mut before = 0.0;
    for (copies, sum) in copies.iter_mut().zip(&sums[1..]) {
        let bound = sum / total * count; // N itself for the last, without rounding
        let (whole, part) = (bound.floor(), bound - bound.floor());
        let below = if part <= low {
            false
        } else if part >= high {
            true
        } else if draws.index(&[part - low, high - part]) == 0 {
            high = part;
            true
        } else {
            low = part;
            false
        };
        let pointers = whole + f64::from(u8::from(below));
        *copies = (pointers - before) as u32;
        before = pointers;
    }
}

/// An index below `count`, with probability proportional to its share of the cumulated
/// weights `sum` (`sum(i)` is that of all before i), by about log2 count decisions.
pub(crate) fn descend<D: Draws + ?Sized>(
    count: usize,
    sum: impl Fn(usize) -> f64,
    draws: &mut D,
) -> usize {
    let (mut low, mut high) = (0, count);
    while high - low > 1 {
        let middle = low.midpoint(high);
        let halves = [sum(middle) - sum(low), sum(high) - sum(middle)];
        if draws.index(&halves) == 0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::generator;
    use crate::testing::enumerate;

    const BOTH: [Resampling; 2] = [Resampling::Systematic, Resampling::Multinomial];

    fn copies(scheme: Resampling, weights: &[f64], draws: &mut impl Draws) -> Vec<u32> {
        let (mut copies, mut sums) = (Vec::new(), Vec::new());
        scheme.copies(weights, &mut copies, &mut sums, draws);
        copies
    }

    fn weights() -> impl Strategy<Value = Vec<f64>> {
        let weight = prop_oneof![1 => Just(0.0), 3 => 1e-3..1.0f64, 1 => Just(0.25)];
        prop::collection::vec(weight, 1..6).prop_filter("dead", |w| w.iter().sum::<f64>() > 0.0)
    }

    proptest! {
        #[test]
        fn expected_copies_are_proportional_to_weights(weights in weights(), count in 1..6usize) {
            let (n, total) = (weights.len(), weights.iter().sum::<f64>());
            for scheme in BOTH {
                let law = enumerate(1, |draws| {
                    let (mut copies, mut sums) = (Vec::new(), Vec::new());
                    scheme.copies_in_all(count, &weights, &mut copies, &mut sums, draws);
                    copies
                });
                let mut mean = vec![0.0; n];
                for (copies, p) in &law {
                    prop_assert_eq!(copies.iter().sum::<u32>() as usize, count);
                    for i in 0..n {
                        mean[i] += p * f64::from(copies[i]);
                        let expected = count as f64 * weights[i] / total;
                        if scheme == Resampling::Systematic {
                            prop_assert!((f64::from(copies[i]) - expected).abs() < 1.0 + 1e-9);
                        }
                        prop_assert!(copies[i] == 0 || weights[i] > 0.0);
                    }
                }
                for i in 0..n {
                    prop_assert!((mean[i] - count as f64 * weights[i] / total).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn multinomial_choices_are_independent() {
        let law = enumerate(1, |draws| {
            copies(Resampling::Multinomial, &[0.5, 0.2, 0.3], draws)
        });
        assert!((law[&vec![3, 0, 0]] - 0.125).abs() < 1e-15);
        assert!((law[&vec![1, 1, 1]] - 6.0 * 0.03).abs() < 1e-15);
    }

    #[test]
    fn large_populations_keep_their_size() {
        let mut rng = generator(8, 0);
        let weights: Vec<f64> = (0..10_000).map(|_| rng.uniform().powi(8)).collect();
        for scheme in BOTH {
            for _ in 0..10 {
                let copies = copies(scheme, &weights, &mut rng);
                assert_eq!(copies.iter().sum::<u32>(), 10_000);
            }
        }
        assert_eq!(copies(BOTH[0], &[3.0; 7], &mut rng), [1; 7]);
    }
}
