//! What is left of an error when the brightness is set right: an error of form, not of scale.

use super::colour::ToXyz;
use super::{Measured, Reference, measure};
use crate::Image;

/// The measures of a picture after it was scaled so that its mean luminance is that of the reference; pixels
/// that are not finite do not count. As it stands if either is black. `None` if the sizes differ.
///
/// A Metropolis render has its scale from an estimate apart; this tells the rest of its error from that.
#[must_use]
pub fn matched(image: &Image, reference: &Reference<'_>) -> Option<Measured> {
    let factor = brightness_factor(image, reference)?;
    let mut scaled = image.clone();
    scaled.scale_pixels(|_| factor as f32);
    measure(&scaled, reference)
}

/// What a picture is to be multiplied by to have the mean luminance of the reference; pixels that are not
/// finite do not count. 1 if either is black. `None` if the sizes differ.
#[must_use]
pub fn brightness_factor(image: &Image, reference: &Reference<'_>) -> Option<f64> {
    let size = |i: &Image| (i.width(), i.height());
    if size(image) != size(reference.image()) {
        return None;
    }
    let colour = ToXyz::new();
    let [mut x, mut r] = [0.0; 2];
    for pixel in 0..image.pixels() {
        let [mine, other] =
            [image.pixel(pixel), reference.mean(pixel)].map(|v| colour.luminance(v));
        if mine.is_finite() && other.is_finite() {
            x += mine;
            r += other;
        }
    }
    if !(x > 0.0 && r > 0.0) {
        return Some(1.0);
    }
    Some(r / x)
}
