//! Means over square tiles: where a bias too small for any single pixel shows.

use super::Reference;
use crate::Image;
use serde::Serialize;

/// One tile's means, a channel at a time (R, G, B).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Tile {
    /// First column, in pixels of the image.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Means of the image.
    pub mean: [f64; 3],
    /// Means of the reference.
    pub reference: [f64; 3],
    /// `mean` / `reference` - 1; 0 where both are 0, infinite where the reference alone is.
    pub deviation: [f64; 3],
    /// Standard error of the reference's mean as its halves tell it; `None` without halves.
    pub reference_error: Option<[f64; 3]>,
}

impl Tile {
    /// The largest deviation of the three channels, as a positive number.
    #[must_use]
    pub fn worst(&self) -> f64 {
        self.deviation
            .iter()
            .fold(0.0, |worst, deviation| deviation.abs().max(worst))
    }
}

/// Means over tiles of `side` x `side` pixels (smaller ones at the right and lower border), row by row.
/// `None` if the sizes differ or `side` is 0. Pixels that are not finite are left out.
#[must_use]
pub fn tiles(image: &Image, reference: &Reference<'_>, side: u32) -> Option<Vec<Tile>> {
    let (width, height) = (image.width(), image.height());
    let other = reference.image();
    if side == 0 || (width, height) != (other.width(), other.height()) {
        return None;
    }
    let rows = (0..height).step_by(side as usize);
    let corners = rows.flat_map(|y| (0..width).step_by(side as usize).map(move |x| (x, y)));
    Some(
        corners
            .map(|corner| tile(image, reference, corner, side))
            .collect(),
    )
}

fn tile(image: &Image, reference: &Reference<'_>, (x, y): (u32, u32), side: u32) -> Tile {
    let (mut sum, mut other, mut squares, mut count) = ([0.0; 3], [0.0; 3], [0.0; 3], 0u64);
    for row in y..(y + side).min(image.height()) {
        for column in x..(x + side).min(image.width()) {
            let pixel = row as usize * image.width() as usize + column as usize;
            let value = image.pixel(pixel);
            let [a, b] = reference.pair(pixel);
            if !value.iter().chain(&a).chain(&b).all(|v| v.is_finite()) {
                continue;
            }
            count += 1;
            for c in 0..3 {
                sum[c] += value[c];
                other[c] += 0.5 * (a[c] + b[c]);
                // (A - B)/2 has the variance of r = (A + B)/2.
                squares[c] += 0.25 * (a[c] - b[c]) * (a[c] - b[c]);
            }
        }
    }
    let count = count.max(1) as f64;
    let mean = sum.map(|v| v / count);
    let r = other.map(|v: f64| v / count);
    let deviation = std::array::from_fn(|c| match (mean[c] == 0.0, r[c] == 0.0) {
        (true, true) => 0.0,
        _ => mean[c] / r[c] - 1.0,
    });
    let reference_error = reference
        .half()
        .map(|_| squares.map(|v: f64| v.sqrt() / count));
    Tile {
        x,
        y,
        mean,
        reference: r,
        deviation,
        reference_error,
    }
}
