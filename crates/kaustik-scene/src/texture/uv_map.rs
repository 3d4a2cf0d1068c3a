use glam::{DMat2, Vec2};

use crate::description::UvTransform;

/// A [`UvTransform`] with its sine and cosine taken once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvMap {
    u: Vec2,
    v: Vec2,
    offset: Vec2,
}

impl UvMap {
    /// `uv` is scaled, turned and moved, in this order (`KHR_texture_transform`).
    #[must_use]
    pub fn new(transform: &UvTransform) -> Self {
        let angle = f64::from(transform.rotation);
        let (sin, cos) = (libm::sin(angle) as f32, libm::cos(angle) as f32);
        let [x, y] = transform.scale;
        Self {
            u: Vec2::new(cos * x, sin * y),
            v: Vec2::new(-sin * x, cos * y),
            offset: transform.offset.into(),
        }
    }

    /// What it does to differences of coordinates.
    #[must_use]
    pub fn linear(&self) -> DMat2 {
        DMat2::from_cols(self.u.as_dvec2(), self.v.as_dvec2()).transpose()
    }

    /// The transformed coordinates.
    #[must_use]
    pub fn apply(&self, uv: Vec2) -> Vec2 {
        Vec2::new(self.u.dot(uv), self.v.dot(uv)) + self.offset
    }
}
