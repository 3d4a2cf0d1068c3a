//! Normalised standard deviation over independent renders of one method.

use super::colour::ToXyz;
use crate::Image;
use serde::Serialize;

/// Spread of a method's pictures: for each pixel the standard deviation of its luminance over the
/// pictures (n - 1 in the denominator) divided by its mean, over the pixels whose mean is above zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Nsd {
    /// Mean over pixels: the image's NSD.
    pub mean: f64,
    /// 5 % quantile over pixels.
    pub quantile_5: f64,
    /// Median over pixels.
    pub median: f64,
    /// 95 % quantile over pixels.
    pub quantile_95: f64,
    /// Root of the mean variance over pixels, divided by the mean luminance.
    pub pooled: f64,
    /// Pixels that entered.
    pub pixels: u64,
    /// Pictures.
    pub images: usize,
}

/// NSD of two or more pictures of one size and place; `None` for fewer, other sizes or places, or no pixel above zero.
#[must_use]
pub fn nsd(images: &[&Image]) -> Option<Nsd> {
    spread(images, |_| false)
}

/// The same, where a pixel that is dark in all pictures but not in the reference counts with its bound, the
/// square root of the number of pictures: a method must not be rated by those pixels alone that it finds.
#[must_use]
pub fn nsd_beside(images: &[&Image], reference: &Image) -> Option<Nsd> {
    if images.first()?.shape() != reference.shape() {
        return None;
    }
    let colour = ToXyz::new();
    spread(images, |pixel| {
        colour.luminance(reference.pixel(pixel)) > 0.0
    })
}

/// NSD of each pixel, row by row from the top, as [`nsd_beside`] takes it: its mean over the pixels that are
/// lit in a picture or in the reference is the image's. 0 where all are dark; NaN where a picture is not
/// finite.
#[must_use]
pub fn nsd_map(images: &[&Image], reference: &Image) -> Option<Vec<f32>> {
    let fits = images
        .iter()
        .all(|image| image.shape() == reference.shape());
    if images.len() < 2 || !fits {
        return None;
    }
    let colour = ToXyz::new();
    let value = |pixel| {
        let [mean, variance] = moments(images, pixel, &colour);
        let is_dark = colour.luminance(reference.pixel(pixel)) <= 0.0;
        let value = match mean {
            m if m > 0.0 => variance.sqrt() / m,
            m if !m.is_finite() => f64::NAN,
            _ if is_dark => 0.0,
            _ => (images.len() as f64).sqrt(),
        };
        value as f32
    };
    Some((0..reference.pixels()).map(value).collect())
}

/// Mean and variance (n - 1 in the denominator) of a pixel's luminance over the pictures.
fn moments(images: &[&Image], pixel: usize, colour: &ToXyz) -> [f64; 2] {
    let n = images.len() as f64;
    let luminance = |image: &&Image| colour.luminance(image.pixel(pixel));
    let mean = images.iter().map(luminance).sum::<f64>() / n;
    let square = |image| (luminance(image) - mean) * (luminance(image) - mean);
    [mean, images.iter().map(square).sum::<f64>() / (n - 1.0)]
}

/// Over the pixels that are lit, or are to be.
fn spread(images: &[&Image], is_to_be_lit: impl Fn(usize) -> bool) -> Option<Nsd> {
    let (first, rest) = images.split_first()?;
    if rest.is_empty() || rest.iter().any(|image| image.shape() != first.shape()) {
        return None;
    }
    let colour = ToXyz::new();
    let n = images.len() as f64;
    let (mut values, mut variances, mut means) = (Vec::new(), 0.0, 0.0);
    for pixel in 0..first.pixels() {
        let [mean, variance] = moments(images, pixel, &colour);
        if !variance.is_finite() {
            continue;
        }
        if mean > 0.0 {
            values.push((variance.sqrt() / mean) as f32);
            variances += variance;
            means += mean;
        } else if is_to_be_lit(pixel) {
            values.push(n.sqrt() as f32);
        }
    }
    // black pictures have no spread, whatever is to be lit
    if means <= 0.0 {
        return None;
    }
    let pixels = values.len() as f64;
    let mean = values.iter().map(|&v| f64::from(v)).sum::<f64>() / pixels;
    values.sort_unstable_by(f32::total_cmp);
    let quantile = |q: f64| f64::from(values[((pixels - 1.0) * q + 0.5) as usize]);
    Some(Nsd {
        mean,
        quantile_5: quantile(0.05),
        median: quantile(0.5),
        quantile_95: quantile(0.95),
        pooled: (variances / pixels).sqrt() / (means / pixels),
        pixels: values.len() as u64,
        images: images.len(),
    })
}
