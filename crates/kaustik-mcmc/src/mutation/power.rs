use super::powers::power_below_one;
use super::{LN_2_POW_53, sign_and_rest, wrap};
use crate::{Draws, Mutation, Scalable};

/// Hachisuka and Jensen's mutation: a step whose length is a power of a uniform number.
///
/// With mutation size m > 0 the length is xi^(1/m + 1), either way (Hachisuka and Jensen
/// 2011, "Robust adaptive photon tracing using photon path visibility"). It is shorter than
/// x with probability x^a, a = m / (1 + m), and m / (1 + 2m) on average; so small sizes
/// still reach everywhere now and then. With p(x) = a x^(a-1) the density at circular
/// distance d is (p(d) + p(1 - d)) / 2. One uniform number decides the sign (its first
/// bit) and the length (the rest).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Power {
    size: f64,
    /// 1 + 1/size.
    exponent: f64,
}

impl Power {
    /// The smallest size that makes sense: what the authors' adaptation is bounded by.
    pub const SMALLEST: f64 = 1e-4;
    /// The largest: steps are then uniform to one part in 10^4.
    pub const LARGEST: f64 = 1e4;

    /// Steps of the given size; sizes outside of [`SMALLEST`](Self::SMALLEST) and
    /// [`LARGEST`](Self::LARGEST) are moved to the nearest that makes sense.
    pub fn new(size: f64) -> Self {
        let size = if size.is_nan() { Self::SMALLEST } else { size };
        let size = size.clamp(Self::SMALLEST, Self::LARGEST);
        Self {
            size,
            exponent: 1.0 + 1.0 / size,
        }
    }

    /// The mutation size.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// The density of a step to circular distance `distance`, in (0, 1/2], per unit of the
    /// circle.
    pub fn density(&self, distance: f64) -> f64 {
        let a = 1.0 / self.exponent;
        let p = |x: f64| a * libm::pow(x, a - 1.0);
        0.5 * (p(distance) + p(1.0 - distance))
    }
}

impl Mutation for Power {
    #[inline]
    fn mutate<D: Draws + ?Sized>(&self, x: f64, draws: &mut D) -> f64 {
        let (sign, xi) = sign_and_rest(draws.uniform());
        wrap(x + sign * power_below_one(xi, self.exponent))
    }

    /// The wave of frequency k is dampened by E cos(2 pi k length). The length's density
    /// p falls and is convex, and at least a = m / (1 + m): then over each period of the
    /// wave E (1 - cos) is at least that of a constant p of the value in its middle, so
    /// that the factor is at most 1 - a; and a convex p has no negative factor at all.
    fn mixed_after(&self) -> u64 {
        (LN_2_POW_53 * self.exponent).ceil() as u64
    }
}

impl Scalable for Power {
    fn scaled(&self, factor: f64) -> Self {
        Self::new(self.size * factor)
    }
}
