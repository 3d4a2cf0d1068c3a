//! The accept/reject decision. There is one in the whole workspace, and it is here.

use crate::Draws;

/// The probability with which Metropolis and Hastings accept a proposal.
///
/// `current` and `proposed` are the densities of the target, finite and at least 0;
/// `ratio` is the chance of proposing the way back over that of the way there,
/// T(v -> u) / T(u -> v): 1 for symmetric proposals. The result is
/// min(1, ratio * proposed / current), in [0, 1].
///
/// A state of density zero can only be a bad start: from it, every possible proposal is
/// accepted. A number that is no density or no ratio (NaN, infinite, negative) gives 0.
#[inline]
pub fn acceptance(current: f64, proposed: f64, ratio: f64) -> f64 {
    let sound = |x: f64| x.is_finite() && x >= 0.0;
    if !(sound(current) && sound(proposed) && sound(ratio)) || ratio <= 0.0 {
        return 0.0;
    }
    if current <= 0.0 {
        return 1.0;
    }
    if !SAFE.contains(&(proposed / current)) {
        return (ratio * proposed / current).min(1.0); // the quotient alone over- or underflows
    }
    (ratio * (proposed / current)).min(1.0)
}

/// Accepts with the given probability.
#[inline]
pub fn decide<D: Draws + ?Sized>(acceptance: f64, draws: &mut D) -> bool {
    draws.bernoulli(acceptance)
}

/// The probability with which two replicas exchange their states: min(1, r) with r of RELT
/// eq. 9. (The paper prints max.)
///
/// `own` are the densities q_k(u_k) and q_l(u_l) of both states where they are, `crossed`
/// those where they would go, q_k(u_l) and q_l(u_k); r is the product of `crossed` over
/// the product of `own`. Normalising constants cancel. No product over- or underflows: where
/// one might, mantissas and exponents are multiplied apart.
///
/// A state that may not go to the other level (a zero among `crossed`) is never exchanged,
/// whatever the rest. A zero among `own` can only be a bad start: then any possible exchange
/// is accepted. A number that is no density (NaN, infinite, negative) gives 0.
#[inline]
pub fn exchange_acceptance(own: [f64; 2], crossed: [f64; 2]) -> f64 {
    let (current, proposed) = (own[0] * own[1], crossed[0] * crossed[1]);
    if SAFE.contains(&current) && SAFE.contains(&proposed) {
        let positive = own[0] > 0.0 && crossed[0] > 0.0; // not two negative ones
        return if positive {
            acceptance(current, proposed, 1.0)
        } else {
            0.0
        };
    }
    extreme_acceptance(own, crossed)
}

/// Products in this range were rounded, but neither over- nor underflowed.
const SAFE: std::ops::Range<f64> = 1e-280..1e280;

#[cold]
fn extreme_acceptance(own: [f64; 2], crossed: [f64; 2]) -> f64 {
    let sound = |x: &f64| x.is_finite() && *x >= 0.0;
    if !(own.iter().all(sound) && crossed.iter().all(sound)) || crossed.contains(&0.0) {
        return 0.0;
    }
    let product = |[a, b]: [f64; 2]| {
        let ((a, i), (b, j)) = (libm::frexp(a), libm::frexp(b));
        (a * b, i + j)
    };
    let ((current, under), (proposed, over)) = (product(own), product(crossed));
    // the mantissas are in [1/4, 1) or zero, so that beyond these powers nothing changes
    let proposed = libm::ldexp(proposed, (over - under).clamp(-1100, 900));
    acceptance(current, proposed, 1.0)
}

#[cfg(test)]
mod tests {
    use super::{acceptance, exchange_acceptance};

    #[test]
    fn exchanges_follow_the_product_of_quotients() {
        let (tiny, huge) = (1e-300, 1e300);
        let cases = [
            (([2.0, 3.0], [1.0, 3.0]), 0.5),
            (([1.0, 3.0], [2.0, 3.0]), 1.0),
            (([tiny, tiny], [tiny, 0.25 * tiny]), 0.25), // products underflow
            (([huge, huge], [0.25 * huge, huge]), 0.25), // products overflow
            (([huge, tiny], [tiny, 0.5 * huge]), 0.5),
            (([tiny, tiny], [huge, huge]), 1.0),
            (([huge, huge], [tiny, tiny]), 0.0),
            (([5e-324, 1e-300], [5e-324, 5e-301]), 0.5),
            (([1.0, 1.0], [0.0, huge]), 0.0),
            (([0.0, 1.0], [1.0, tiny]), 1.0), // a bad start
            (([0.0, 1.0], [1.0, 0.0]), 0.0),
            (([0.0, 0.0], [0.0, 0.0]), 0.0),
            (([-1.0, -1.0], [1.0, 1.0]), 0.0),
            (([1.0, 1.0], [-1.0, -1.0]), 0.0),
            (([1.0, f64::NAN], [1.0, 1.0]), 0.0),
            (([1.0, 1.0], [1.0, f64::INFINITY]), 0.0),
        ];
        for ((own, crossed), expected) in cases {
            let a = exchange_acceptance(own, crossed);
            assert!((a - expected).abs() < 1e-12, "{own:?} {crossed:?}: {a}");
        }
    }

    #[test]
    fn follows_metropolis_and_hastings() {
        let cases = [
            ((2.0, 1.0, 1.0), 0.5),
            ((1.0, 2.0, 1.0), 1.0),
            ((1.0, 2.0, 0.25), 0.5),
            ((1.0, 0.0, 1.0), 0.0),
            ((1.0, 1.0, 0.0), 0.0),
            ((0.0, 1e-300, 1.0), 1.0),
            ((0.0, 0.0, 1.0), 1.0),
            ((1e-300, 1e300, 1.0), 1.0),
            ((1e-300, 1e300, 0.0), 0.0),
            ((1e-150, 1e150, 5e-301), 0.5),
            ((1e160, 1e-160, 1e300), 0.0),
            ((1e200, 5e-110, 1e300), 0.5e-9),
            ((1.0, f64::NAN, 1.0), 0.0),
            ((1.0, f64::INFINITY, 1.0), 0.0),
            ((0.0, f64::INFINITY, 1.0), 0.0),
            ((1.0, -1.0, 1.0), 0.0),
            ((1.0, 1.0, f64::NAN), 0.0),
            ((1.0, 1.0, f64::INFINITY), 0.0),
        ];
        for ((current, proposed, ratio), expected) in cases {
            let a = acceptance(current, proposed, ratio);
            assert!(
                (a - expected).abs() < 1e-15,
                "{current} {proposed} {ratio}: {a}"
            );
        }
    }
}
