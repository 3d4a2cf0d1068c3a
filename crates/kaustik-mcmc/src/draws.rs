use rand::Rng;

/// Every decision of every algorithm in this crate is one of these three calls.
///
/// A generator is one way to answer them: each [`rand::Rng`] is a `Draws`. The other is
/// the [enumerator](crate::testing::Enumerator), which follows all answers in turn and so
/// turns an algorithm into its exact transition matrix. That is why nothing here asks a
/// generator directly, and why a decision with a known probability must be
/// [`bernoulli`](Self::bernoulli) or [`index`](Self::index), not a comparison with
/// [`uniform`](Self::uniform).
pub trait Draws {
    /// A number uniform in [0, 1).
    fn uniform(&mut self) -> f64;

    /// True with probability `p`. Never for `p <= 0` or NaN, always for `p >= 1`.
    fn bernoulli(&mut self, p: f64) -> bool;

    /// An index with probability proportional to its weight.
    ///
    /// Weights are finite and at least 0; a weight of zero is never chosen as long as
    /// another is positive. If none is (or there are none), the answer is 0.
    fn index(&mut self, weights: &[f64]) -> usize;
}

/// Draws by reference: what stands in for them where something takes its source by value, such as
/// [`Independent::new`](crate::Independent::new) within a kernel that was itself lent a `&mut D`.
///
/// ```
/// use kaustik_mcmc::{ByRef, Draws, Independent, Target};
///
/// /// A fresh sample of the uniform law, whatever gives the numbers.
/// fn sample<T: Target, D: Draws + ?Sized>(target: &T, value: &mut T::Value, draws: &mut D) {
///     target.evaluate(&mut Independent::new(ByRef(draws)), value);
/// }
/// ```
#[derive(Debug)]
pub struct ByRef<'a, D: ?Sized>(pub &'a mut D);

impl<D: Draws + ?Sized> Draws for ByRef<'_, D> {
    #[inline]
    fn uniform(&mut self) -> f64 {
        self.0.uniform()
    }

    #[inline]
    fn bernoulli(&mut self, p: f64) -> bool {
        self.0.bernoulli(p)
    }

    fn index(&mut self, weights: &[f64]) -> usize {
        self.0.index(weights)
    }
}

/// 2^-53: uniform numbers are its multiples, so that 1 is never reached.
const ULP: f64 = 1.0 / (1u64 << 53) as f64;

/// The formulas are our own and pinned by tests, because a change of values in a
/// library would change every picture.
impl<R: Rng + ?Sized> Draws for R {
    #[inline]
    fn uniform(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 * ULP
    }

    #[inline]
    fn bernoulli(&mut self, p: f64) -> bool {
        self.uniform() < p
    }

    fn index(&mut self, weights: &[f64]) -> usize {
        let total: f64 = weights.iter().sum();
        let mut rest = self.uniform() * total;
        let mut last = 0;
        for (i, &weight) in weights.iter().enumerate() {
            if weight > 0.0 {
                if rest < weight {
                    return i;
                }
                rest -= weight;
                last = i;
            }
        }
        last // rounding ate the remainder: the last one that has any weight
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generator;

    #[test]
    fn values_are_pinned() {
        let mut rng = generator(1, 2);
        assert_eq!(rng.uniform().to_bits(), 4_605_860_807_854_009_296);
    }

    #[test]
    fn certain_answers_are_certain() {
        let mut rng = generator(3, 0);
        for _ in 0..1000 {
            assert!(rng.bernoulli(1.0) && rng.bernoulli(7.0));
            assert!(!rng.bernoulli(0.0) && !rng.bernoulli(-1.0) && !rng.bernoulli(f64::NAN));
            assert_eq!(rng.index(&[0.0, 0.0, 1e-300, 0.0]), 2);
        }
        assert_eq!((rng.index(&[]), rng.index(&[0.0, 0.0])), (0, 0));
    }

    #[test]
    fn indices_follow_their_weights() {
        let mut rng = generator(4, 0);
        let mut counts = [0u32; 4];
        for _ in 0..80_000 {
            counts[rng.index(&[1.0, 0.0, 2.0, 5.0])] += 1;
        }
        let expected = [10_000.0, 0.0, 20_000.0, 50_000.0];
        assert_eq!(counts[1], 0);
        for i in [0, 2, 3] {
            let z = (f64::from(counts[i]) - expected[i]) / f64::sqrt(expected[i]);
            assert!(z.abs() < 4.0, "{counts:?}");
        }
    }
}
