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
    (ratio * (proposed / current)).min(1.0)
}

/// Accepts with the given probability.
#[inline]
pub fn decide<D: Draws + ?Sized>(acceptance: f64, draws: &mut D) -> bool {
    draws.bernoulli(acceptance)
}

#[cfg(test)]
mod tests {
    use super::acceptance;

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
