use super::{LN_2_POW_53, sign_and_rest, size_within, wrap};
use crate::{Draws, Mutation, Scalable};

/// A Cauchy-distributed step, wound round the circle: mostly small, now and then a leap.
///
/// Half of the steps are shorter than `scale`, and the chance of one longer than d falls
/// only as 1/d, so that a chain that has found a narrow mode still leaves it (the "fast
/// annealing" of Szu and Hartley 1987). With c = 2 pi scale the density at circular
/// distance d is sinh(c) / (cosh(c) - cos(2 pi d)) (Mardia and Jupp 2000, section 3.5.7).
///
/// A wound Cauchy variable is the image of a uniform angle under the map of the circle
/// tan(out/2) = tanh(c/2) tan(in/2) (McCullagh 1996), so that nothing has to be wound. One
/// uniform number decides the sign (its first bit) and the size (the rest).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrappedCauchy {
    scale: f64,
    /// tanh(pi scale).
    squeeze: f64,
}

impl WrappedCauchy {
    /// Steps with median size `scale` before they are wound, a fraction of the domain.
    /// Scales outside (0, 1] are moved to the nearest that makes sense.
    pub fn new(scale: f64) -> Self {
        let scale = size_within(scale, 1.0);
        Self {
            scale,
            squeeze: libm::tanh(std::f64::consts::PI * scale),
        }
    }

    /// The median size of a step before it is wound.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// The density of a step to circular distance `distance`, per unit of the circle.
    pub fn density(&self, distance: f64) -> f64 {
        // the same with half angles, where nothing cancels for small scales
        let (t, angle) = (self.squeeze, std::f64::consts::PI * distance);
        let (s, c) = (libm::sin(angle), libm::cos(angle));
        t / (s * s + t * t * c * c)
    }
}

impl Mutation for WrappedCauchy {
    #[inline]
    fn mutate<D: Draws + ?Sized>(&self, x: f64, draws: &mut D) -> f64 {
        let (sign, xi) = sign_and_rest(draws.uniform());
        let half = std::f64::consts::FRAC_PI_2 * xi;
        let step = std::f64::consts::FRAC_1_PI * libm::atan(self.squeeze * libm::tan(half));
        wrap(x + sign * step)
    }

    /// The wave of frequency k is dampened by exp(-2 pi k scale): k = 1 is the slowest.
    fn mixed_after(&self) -> u64 {
        (LN_2_POW_53 / (std::f64::consts::TAU * self.scale)).ceil() as u64
    }
}

impl Scalable for WrappedCauchy {
    fn scaled(&self, factor: f64) -> Self {
        Self::new(self.scale * factor)
    }
}
