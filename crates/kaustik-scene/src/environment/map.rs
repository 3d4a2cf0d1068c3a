use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

use glam::{DMat3, DVec3, Quat};
use kaustik_bsdf::warp;

use super::distribution::Distribution;
use super::{EnvironmentError, check_radiance};
use crate::description::{ImageData, Pixels};
use crate::texture;

/// An equirectangular picture around the scene.
#[derive(Clone, Debug)]
pub(super) struct Map {
    image: Arc<ImageData>,
    strength: f32,
    /// World to picture.
    to_picture: DMat3,
    distribution: Option<Distribution>,
}

impl Map {
    pub(super) fn new(
        image: Arc<ImageData>,
        strength: f32,
        rotation: Quat,
    ) -> Result<Self, EnvironmentError> {
        texture::check(&image)?;
        let Pixels::RgbF32(values) = &image.pixels else {
            let name = image.name.clone();
            return Err(EnvironmentError::NotFloat { name });
        };
        check_radiance(strength)?;
        for &value in values {
            check_radiance(value)?;
            check_radiance(value * strength)?;
        }
        let rotation = rotation.as_dquat();
        if (rotation.length_squared() - 1.0).abs() > 1e-3 {
            return Err(EnvironmentError::Rotation {
                rotation: rotation.as_quat(),
            });
        }
        let mut map = Self {
            strength,
            to_picture: DMat3::from_quat(rotation.normalize()).transpose(),
            distribution: None,
            image,
        };
        let (width, height) = map.size();
        map.distribution = (strength > 0.0)
            .then(|| Distribution::new(width, height, |x, y| map.weight(x, y)))
            .flatten();
        Ok(map)
    }

    /// Bilinear radiance, strength included.
    pub(super) fn rgb(&self, direction: DVec3) -> [f32; 3] {
        let (width, height) = self.size();
        let [u, v] = uv(self.to_picture * direction);
        let (x, y) = (u * width as f64 - 0.5, v * height as f64 - 0.5);
        let (i, j) = (x.floor(), y.floor());
        let (s, t) = ((x - i) as f32, (y - j) as f32);
        let column = |i: f64| (i as i64).rem_euclid(width as i64) as usize;
        let row = |j: f64| (j as i64).clamp(0, height as i64 - 1) as usize;
        let line = |j: f64| {
            let (a, b) = (
                self.texel(column(i), row(j)),
                self.texel(column(i + 1.0), row(j)),
            );
            std::array::from_fn::<f32, 3, _>(|c| a[c] + (b[c] - a[c]) * s)
        };
        let (a, b) = (line(j), line(j + 1.0));
        // the last bit of a sum of products may fall below 0
        std::array::from_fn(|c| ((a[c] + (b[c] - a[c]) * t) * self.strength).max(0.0))
    }

    /// `None` for a black picture.
    pub(super) fn sample(&self, u: [f64; 2]) -> Option<(DVec3, f64)> {
        let distribution = self.distribution.as_ref()?;
        let (point, pdf) = distribution.sample(u, |x, y| self.weight(x, y));
        Some((self.to_picture.transpose() * direction(point), pdf))
    }

    /// `None` for a black picture.
    pub(super) fn pdf(&self, direction: DVec3) -> Option<f64> {
        let distribution = self.distribution.as_ref()?;
        let point = uv(self.to_picture * direction);
        Some(distribution.pdf(point, |x, y| self.weight(x, y)))
    }

    /// Mean over the sphere, each texel weighted with the solid angle of its rectangle.
    pub(super) fn mean_rgb(&self) -> [f32; 3] {
        let (width, height) = self.size();
        let mut sum = [0.0; 3];
        for y in 0..height {
            let edge = |y: usize| libm::cos(std::f64::consts::PI * y as f64 / height as f64);
            let area = 0.5 * (edge(y) - edge(y + 1)) / width as f64;
            for x in 0..width {
                let texel = self.texel(x, y);
                for (sum, value) in sum.iter_mut().zip(texel) {
                    *sum += area * f64::from(value);
                }
            }
        }
        sum.map(|sum| (sum * f64::from(self.strength)) as f32)
    }

    fn size(&self) -> (usize, usize) {
        (self.image.width as usize, self.image.height as usize)
    }

    fn texel(&self, x: usize, y: usize) -> [f32; 3] {
        let index = 3 * (y * self.image.width as usize + x);
        match &self.image.pixels {
            Pixels::RgbF32(values) => std::array::from_fn(|c| values[index + c]),
            Pixels::Rgba8(_) | Pixels::Rgba16(_) => [0.0; 3], // refused by `new`
        }
    }

    /// What importance sampling goes by: the sum of the channels, positive wherever any is.
    fn weight(&self, x: usize, y: usize) -> f64 {
        self.texel(x, y).iter().map(|&c| f64::from(c)).sum()
    }
}

/// Where the picture shows a direction given in its own frame: (0, 0) is the top left. Up is the
/// top row, -z the middle column, +x to the right of it.
fn uv(d: DVec3) -> [f64; 2] {
    let u = 0.5 + 0.5 * FRAC_1_PI * libm::atan2(d.x, -d.z);
    let across = (d.x * d.x + d.z * d.z).sqrt();
    let v = FRAC_1_PI * libm::atan2(across, d.y);
    [u.clamp(0.0, 1.0), v.clamp(0.0, 1.0)]
}

/// The inverse of [`uv`], unit.
fn direction([u, v]: [f64; 2]) -> DVec3 {
    let (sin, cos) = warp::sin_cos_turns(0.5 * v);
    let (x, z) = warp::sin_cos_turns(u - 0.5);
    DVec3::new(sin * x, cos, -sin * z)
}
