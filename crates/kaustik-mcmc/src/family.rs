/// What is cheap: the K densities of a value, one for each level.
///
/// Densities are linear (not logarithms), need no normalisation, and are finite and at
/// least 0; zero is an ordinary density. A NaN, an infinity or a negative number is a
/// defect of the target: the chain counts it and treats the whole value as one of
/// density zero, so that it neither enters the state nor reaches a recorder.
///
/// A density must be positive wherever what is to be estimated is not zero. If you have log
/// densities, subtract a constant before exponentiating.
///
/// Closures `Fn(&V) -> [f64; K]` are families:
///
/// ```
/// # use kaustik_mcmc::Family;
/// let tempered = |energy: &f64| [(-energy).exp(), (-0.5 * energy).exp()];
/// assert_eq!(tempered.densities(&0.0), [1.0, 1.0]);
/// ```
#[doc(alias = "tempering")]
pub trait Family<V, const K: usize> {
    /// The densities of `value`, in the order of the levels.
    fn densities(&self, value: &V) -> [f64; K];
}

impl<V, F, const K: usize> Family<V, K> for F
where
    F: Fn(&V) -> [f64; K],
{
    fn densities(&self, value: &V) -> [f64; K] {
        self(value)
    }
}

/// The densities of a value, or `None` if one of them is not finite and at least 0.
///
/// Every algorithm reads densities through this.
pub fn checked_densities<V, const K: usize>(
    family: &(impl Family<V, K> + ?Sized),
    value: &V,
) -> Option<[f64; K]> {
    let densities = family.densities(value);
    densities
        .iter()
        .all(|d| d.is_finite() && *d >= 0.0)
        .then_some(densities)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_bad_density_spoils_the_value() {
        let family = |v: &f64| [1.0, *v];
        assert_eq!(checked_densities(&family, &0.0), Some([1.0, 0.0]));
        for bad in [f64::NAN, f64::INFINITY, -1.0, f64::NEG_INFINITY] {
            assert_eq!(checked_densities(&family, &bad), None);
        }
    }
}
