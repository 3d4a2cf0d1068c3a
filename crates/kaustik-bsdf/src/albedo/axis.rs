use crate::bsdf::SMOOTH_ALPHA;
use crate::local::within;

/// Between which nodes of an evenly spaced axis a value lies, and how far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AxisPosition {
    index: usize,
    fraction: f32,
}

impl AxisPosition {
    /// Of `t` in `[0, 1]` (clamped; NaN is 0) on `nodes` >= 2 nodes.
    #[inline]
    pub(crate) fn new(t: f64, nodes: usize) -> Self {
        let last = nodes - 1;
        let x = within(t, 0.0, 1.0) * last as f64;
        let index = (x as usize).min(last - 1);
        Self {
            index,
            fraction: (x - index as f64) as f32,
        }
    }

    /// The lower node.
    #[inline]
    pub(crate) fn index(self) -> usize {
        self.index
    }

    /// Linear interpolation between the two nodes' values.
    #[inline]
    pub(crate) fn mix(self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.fraction
    }
}

/// Cosine to axis: the root of the mean of `mu` and `mu (1 + alpha) / (mu + alpha)`. Half of the
/// nodes lie where facets shadow each other at grazing, and more the nearer to the plane, where
/// thin media lose light suddenly.
#[inline]
pub(crate) fn cosine_axis(mu: f64, alpha: f64) -> f64 {
    (0.5 * mu * (1.0 + (1.0 + alpha) / (mu + alpha))).sqrt()
}

/// Inverse of [`cosine_axis`]; kept off 0, where facets cannot be seen.
pub(crate) fn cosine_at(t: f64, alpha: f64) -> f64 {
    // mu^2 + b mu = 2 t^2 alpha
    let b = 1.0 + 2.0 * alpha - 2.0 * t * t;
    let mu = 0.5 * ((b * b + 8.0 * t * t * alpha).sqrt() - b);
    mu.clamp(1e-6 * alpha, 1.0)
}

/// `dmu / dt` at `mu`.
pub(crate) fn cosine_slope(mu: f64, alpha: f64) -> f64 {
    let spread = mu + alpha;
    4.0 * cosine_axis(mu, alpha) / (1.0 + (1.0 + alpha) * alpha / (spread * spread))
}

/// Roughness to axis: by the root, as glTF's roughness is, from the smoothest rough alpha up.
#[inline]
pub(crate) fn alpha_axis(alpha: f64) -> f64 {
    let low = SMOOTH_ALPHA.sqrt();
    (alpha.sqrt() - low) / (1.0 - low)
}

/// Inverse of [`alpha_axis`].
pub(crate) fn alpha_at(t: f64) -> f64 {
    let low = SMOOTH_ALPHA.sqrt();
    let root = low + t * (1.0 - low);
    root * root
}

/// How the loss falls, about: `alpha^2 / (mu^2 + alpha^2)`. Tables hold the loss over this, which
/// is of order one everywhere and varies slowly.
#[inline]
pub(crate) fn bump(mu: f64, alpha: f64) -> f64 {
    let a2 = alpha * alpha;
    a2 / (mu * mu + a2)
}

/// Cosine-weighted mean of [`bump`] over the hemisphere.
#[inline]
pub(crate) fn bump_mean(alpha: f64) -> f64 {
    let a2 = alpha * alpha;
    a2 * libm::log1p(1.0 / a2)
}
