use crate::warp;
use glam::DVec3;
use std::f64::consts::FRAC_1_PI;

/// Where light goes that met many facets: the density that compensation is sampled by.
///
/// The compensating lobe follows `loss(wi) cos`, and the loss falls like `1 / cos^2` from a bump
/// at cosines of the order of alpha. Cosine sampling would hardly ever look there and return
/// fireflies; so `w = cos^2` is drawn with density proportional to `1 / (w + alpha^2)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rebound {
    a2: f64,
    /// Logarithm of `1 + 1 / alpha^2`, the density's norm.
    norm: f64,
}

impl Rebound {
    /// For facets of roughness `alpha`, positive.
    #[inline]
    pub(crate) fn new(alpha: f64) -> Self {
        let a2 = alpha * alpha;
        Self {
            a2,
            norm: libm::log1p(1.0 / a2),
        }
    }

    /// Draws a direction above.
    #[inline]
    pub(crate) fn sample(self, u: [f64; 2]) -> DVec3 {
        let [x, y] = warp::concentric_disk(u);
        let squared = (x * x + y * y).min(1.0);
        // the disk's centre is the normal: 1 - r^2 is the uniform number of w
        let w = (self.a2 * libm::expm1((1.0 - squared) * self.norm)).clamp(0.0, 1.0);
        let scale = ((1.0 - w) / squared.max(f64::MIN_POSITIVE)).sqrt();
        DVec3::new(x * scale, y * scale, w.sqrt())
    }

    /// Density of [`sample`](Self::sample) per solid angle; `cosine` at least 0.
    #[inline]
    pub(crate) fn pdf(self, cosine: f64) -> f64 {
        FRAC_1_PI * cosine / ((cosine * cosine + self.a2) * self.norm)
    }
}
