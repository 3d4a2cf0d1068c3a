use super::{LN_2_POW_53, sign_and_rest, size_within, wrap};
use crate::normal::upper_quantile;
use crate::{Draws, Mutation, Scalable};

/// A normally distributed step, wound round the circle.
///
/// The Gaussian random walk of statistics: with a dimension's optimal size it accepts about
/// 0.234 of its steps (Roberts, Gelman and Gilks 1997), see
/// [`AcceptanceAdaptation`](crate::AcceptanceAdaptation). The density at circular distance
/// d is the sum over all integers k of the normal density of deviation sigma at d + k
/// (Mardia and Jupp 2000, section 3.5.7). One uniform number decides the sign (its first
/// bit) and the size (the rest, through the normal law's quantile).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrappedNormal {
    sigma: f64,
}

impl WrappedNormal {
    /// Steps of standard deviation `sigma`, a fraction of the domain, before they are
    /// wound. Deviations outside (0, 1] are moved to the nearest that makes sense: at 1 a
    /// step is uniform to 6 parts in 10^9.
    pub fn new(sigma: f64) -> Self {
        Self {
            sigma: size_within(sigma, 1.0),
        }
    }

    /// The standard deviation of a step.
    pub fn sigma(&self) -> f64 {
        self.sigma
    }

    /// The density of a step to circular distance `distance`, per unit of the circle.
    pub fn density(&self, distance: f64) -> f64 {
        let normal = |k: i32| {
            let z = (distance + f64::from(k)) / self.sigma;
            libm::exp(-0.5 * z * z)
        };
        let scale = self.sigma * libm::sqrt(std::f64::consts::TAU);
        (-9..=9).map(normal).sum::<f64>() / scale
    }
}

impl Mutation for WrappedNormal {
    #[inline]
    fn mutate<D: Draws + ?Sized>(&self, x: f64, draws: &mut D) -> f64 {
        let (sign, xi) = sign_and_rest(draws.uniform());
        // halves are exact: no digit is lost at either end
        let y = x + sign * self.sigma * upper_quantile(0.5 * xi, 0.5 - 0.5 * xi);
        wrap(y - y.floor())
    }

    /// The wave of frequency k is dampened by exp(-2 pi^2 k^2 sigma^2): k = 1 is the
    /// slowest.
    fn mixed_after(&self) -> u64 {
        let angle = std::f64::consts::TAU * self.sigma;
        (LN_2_POW_53 / (0.5 * angle * angle)).ceil() as u64
    }
}

impl Scalable for WrappedNormal {
    fn scaled(&self, factor: f64) -> Self {
        Self::new(self.sigma * factor)
    }
}
