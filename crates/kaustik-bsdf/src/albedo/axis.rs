use crate::bsdf::SMOOTH_ALPHA;

/// Between which nodes of an evenly spaced axis a value lies, and how far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    index: usize,
    fraction: f32,
}

impl Place {
    /// Of `t` in `[0, 1]` (clamped; NaN is 0) on `nodes` >= 2 nodes.
    #[inline]
    pub(crate) fn new(t: f64, nodes: usize) -> Self {
        let last = nodes - 1;
        let x = t.max(0.0).min(1.0) * last as f64;
        let index = (x as usize).min(last - 1);
        Self { index, fraction: (x - index as f64) as f32 }
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

/// Cosine to axis: `mu (1 + s) / (mu + s)` with `s` the alpha's scale.
#[inline]
pub(crate) fn cosine_axis(mu: f64, alpha: f64) -> f64 {
    let s = cosine_scale(alpha);
    mu * (1.0 + s) / (mu + s)
}

/// Inverse of [`cosine_axis`]; kept off 0 exactly, where facets cannot be seen.
pub(crate) fn cosine_at(t: f64, alpha: f64) -> f64 {
    let s = cosine_scale(alpha);
    (s * t / (1.0 + s - t)).clamp(1e-8, 1.0)
}

/// `dmu / dt` at `t`.
pub(crate) fn cosine_slope(t: f64, alpha: f64) -> f64 {
    let s = cosine_scale(alpha);
    s * (1.0 + s) / ((1.0 + s - t) * (1.0 + s - t))
}

#[inline]
fn cosine_scale(alpha: f64) -> f64 {
    alpha
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
