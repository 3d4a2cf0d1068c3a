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

/// A generator that is no [`rand::Rng`], as a renderer has its own: all draws from its uniform numbers in [0, 1).
///
/// ```
/// use kaustik_mcmc::{Draws, Uniforms};
///
/// let mut state = 1u32; // the renderer's own
/// let mut draws = Uniforms(|| {
///     state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
///     f64::from(state) / 4_294_967_296.0
/// });
/// assert!(draws.index(&[0.0, 2.0, 1.0]) > 0 && draws.bernoulli(1.0));
/// ```
#[derive(Debug)]
pub struct Uniforms<F>(pub F);

impl<F: FnMut() -> f64> Draws for Uniforms<F> {
    #[inline]
    fn uniform(&mut self) -> f64 {
        (self.0)()
    }

    #[inline]
    fn bernoulli(&mut self, p: f64) -> bool {
        self.uniform() < p
    }

    fn index(&mut self, weights: &[f64]) -> usize {
        index_by(self.uniform(), weights)
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
        index_by(self.uniform(), weights)
    }
}

/// The index at which the running sum of the weights passes a share `u` of all.
fn index_by(u: f64, weights: &[f64]) -> usize {
    let total: f64 = weights.iter().sum();
    if total.is_finite() {
        return index_within(u * total, weights.iter().copied());
    }
    // A sum that overflows tells nothing: that of their parts does.
    let part = 0.5 / weights.len() as f64; // half, as parts are rounded too
    let parts = weights.iter().map(|weight| weight * part);
    index_within(u * parts.clone().sum::<f64>(), parts)
}

fn index_within(mut rest: f64, weights: impl Iterator<Item = f64>) -> usize {
    let mut last = 0;
    for (i, weight) in weights.enumerate() {
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

    /// Each of three that are too large to be summed up is chosen a third of the time.
    #[test]
    fn weights_may_be_as_large_as_numbers_are() {
        let mut rng = generator(5, 0);
        let mut counts = [0; 3];
        for _ in 0..3000 {
            counts[rng.index(&[f64::MAX; 3])] += 1;
        }
        assert!(
            counts.iter().all(|count| (850..1150).contains(count)),
            "{counts:?}"
        );
        let law = crate::testing::enumerate(1, |draws| draws.index(&[f64::MAX, f64::MAX / 4.0]));
        assert!((law[&0] - 0.8).abs() < 1e-12 && law.len() == 2, "{law:?}");
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
