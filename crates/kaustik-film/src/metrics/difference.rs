//! Signed differences, pixel by pixel.

use super::Reference;
use super::colour::ToXyz;
use crate::Image;

/// For each pixel the relative difference of luminance, `(Y - Y_r) / sqrt(Y_r^2 + 0.01 mean(Y_r)^2)`:
/// positive where the picture is too bright. The floor is that of the relative MSE. NaN where a pixel is
/// not finite, 0 everywhere against a black reference that is met. `None` if the sizes differ.
#[must_use]
pub fn difference(image: &Image, reference: &Reference<'_>) -> Option<Vec<f32>> {
    let size = |i: &Image| (i.width(), i.height());
    if size(image) != size(reference.image()) {
        return None;
    }
    let colour = ToXyz::new();
    let other = |pixel| colour.luminance(reference.mean(pixel));
    let known: Vec<f64> = (0..image.pixels())
        .map(other)
        .filter(|y| y.is_finite())
        .collect();
    let mean = known.iter().sum::<f64>() / known.len().max(1) as f64;
    let signed = |pixel| {
        let [y, r] = [colour.luminance(image.pixel(pixel)), other(pixel)];
        let scale = (r * r + 0.01 * mean * mean).sqrt();
        match y - r {
            0.0 => 0.0,
            d => (d / scale) as f32,
        }
    };
    Some((0..image.pixels()).map(signed).collect())
}
