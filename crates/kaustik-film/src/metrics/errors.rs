//! Error measures over whole pictures.

use super::Reference;
use super::colour::ToXyz;
use crate::Image;
use serde::Serialize;

/// Share of pixels that are dropped as the worst: 0.1 %, rounded down to whole pixels.
const DROPPED: f64 = 0.001;

/// Error measures of one picture. With halves the squared ones are estimates that may come out negative.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// Mean over pixels and R, G, B of (x - r)^2, or of (x - A)(x - B).
    pub mse: f64,
    /// Root of `mse`; 0 if that is negative.
    pub rmse: f64,
    /// Mean over pixels and R, G, B of the same divided by r^2 + 0.01 mean(r)^2, the latter mean being
    /// over all pixels and channels. Infinite if r is black and x is not.
    pub relative_mse: f64,
    /// RMSE over pixels and X, Y, Z: RELT (25); 0 if the estimate of its square is negative.
    pub rmse_xyz: f64,
    /// Mean luminance of x over mean luminance of r, less 1. Infinite if r is black and x is not.
    pub bias: f64,
}

/// Shares in [0, 1] of pixels whose luminance is off by more than a part of the reference's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PixelShares {
    /// |Y - Y_r| > 5 % of Y_r.
    pub over_5_percent: f64,
    /// More than 10 %.
    pub over_10_percent: f64,
    /// More than 20 %.
    pub over_20_percent: f64,
}

/// All that is measured pixel by pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Measured {
    /// Over all pixels.
    pub raw: Errors,
    /// Without the 0.1 % of pixels of the largest relative squared error.
    pub trimmed: Errors,
    /// Shares of pixels with a large relative error.
    pub shares: PixelShares,
    /// Pixels left out because they are not finite, here or in the reference.
    pub non_finite: u64,
}

/// Compares the main layers of two pictures of one size. `None` if the sizes differ.
#[must_use]
pub fn measure(image: &Image, reference: &Reference<'_>) -> Option<Measured> {
    let size = |i: &Image| (i.width(), i.height());
    if size(image) != size(reference.image()) {
        return None;
    }
    let colour = ToXyz::new();
    let floor = floor(image, reference);
    let mut all = Sums::default();
    let mut shares = [0u64; 3];
    let mut scores = Vec::new();
    for pixel in finite(image, reference) {
        let term = Term::new(image, reference, pixel, floor, &colour);
        for (share, limit) in shares.iter_mut().zip([0.05, 0.1, 0.2]) {
            let [x, r] = term.luminance;
            *share += u64::from((x - r).abs() > limit * r.abs());
        }
        scores.push(term.score as f32);
        all.add(&term);
    }
    let count = scores.len() as f64;
    let share = |hits: u64| {
        if count > 0.0 {
            hits as f64 / count
        } else {
            0.0
        }
    };
    let [over_5_percent, over_10_percent, over_20_percent] = shares.map(share);
    let worst = Worst::of(&scores);
    let mut kept = Sums::default();
    for (index, pixel) in finite(image, reference).enumerate() {
        if worst.keeps(index, scores[index]) {
            kept.add(&Term::new(image, reference, pixel, floor, &colour));
        }
    }
    Some(Measured {
        raw: all.errors(),
        trimmed: kept.errors(),
        shares: PixelShares {
            over_5_percent,
            over_10_percent,
            over_20_percent,
        },
        non_finite: image.pixels() as u64 - scores.len() as u64,
    })
}

/// The pixels that are finite in all pictures.
fn finite<'a>(image: &'a Image, reference: &'a Reference<'_>) -> impl Iterator<Item = usize> + 'a {
    (0..image.pixels()).filter(|&pixel| {
        let [a, b] = reference.pair(pixel);
        image
            .pixel(pixel)
            .iter()
            .chain(&a)
            .chain(&b)
            .all(|v| v.is_finite())
    })
}

/// 0.01 mean(r)^2.
fn floor(image: &Image, reference: &Reference<'_>) -> f64 {
    let mut sum = 0.0;
    let mut count = 0u64;
    for pixel in finite(image, reference) {
        sum += reference.mean(pixel).iter().sum::<f64>();
        count += 3;
    }
    let mean = sum / (count.max(1)) as f64;
    0.01 * mean * mean
}

/// What one pixel brings.
struct Term {
    square: f64,
    relative: f64,
    xyz: f64,
    /// Of x and of r.
    luminance: [f64; 2],
    /// How bad the pixel is, for dropping the worst.
    score: f64,
}

impl Term {
    fn new(
        image: &Image,
        reference: &Reference<'_>,
        pixel: usize,
        floor: f64,
        colour: &ToXyz,
    ) -> Self {
        let x = image.pixel(pixel);
        let [a, b] = reference.pair(pixel);
        let r = reference.mean(pixel);
        let from = |other: [f64; 3]| -> [f64; 3] { std::array::from_fn(|c| x[c] - other[c]) };
        let (da, db, dr) = (from(a), from(b), from(r));
        let mut term = Self {
            square: 0.0,
            relative: 0.0,
            xyz: 0.0,
            luminance: [colour.luminance(x), colour.luminance(r)],
            score: 0.0,
        };
        for c in 0..3 {
            let scale = r[c] * r[c] + floor;
            let product = da[c] * db[c];
            term.square += product;
            // A black reference and a black picture agree; light on black is off by no share of it.
            if scale > 0.0 {
                term.relative += product / scale;
                term.score += dr[c] * dr[c] / scale;
            } else if product > 0.0 {
                (term.relative, term.score) = (f64::INFINITY, f64::INFINITY);
            }
        }
        let (da, db) = (colour.xyz(da), colour.xyz(db));
        term.xyz = (0..3).map(|c| da[c] * db[c]).sum();
        term
    }
}

/// Sums over pixels.
#[derive(Default)]
struct Sums {
    pixels: u64,
    square: f64,
    relative: f64,
    xyz: f64,
    luminance: [f64; 2],
}

impl Sums {
    fn add(&mut self, term: &Term) {
        self.pixels += 1;
        self.square += term.square;
        self.relative += term.relative;
        self.xyz += term.xyz;
        self.luminance[0] += term.luminance[0];
        self.luminance[1] += term.luminance[1];
    }

    fn errors(&self) -> Errors {
        let samples = (3 * self.pixels.max(1)) as f64;
        let mse = self.square / samples;
        let [x, r] = self.luminance;
        Errors {
            mse,
            rmse: mse.max(0.0).sqrt(),
            relative_mse: self.relative / samples,
            rmse_xyz: (self.xyz / samples).max(0.0).sqrt(),
            bias: match (r > 0.0, x > 0.0) {
                (true, _) => x / r - 1.0,
                (false, true) => f64::INFINITY,
                (false, false) => 0.0,
            },
        }
    }
}

/// Which pixels are the worst.
struct Worst {
    /// Scores above it are dropped.
    threshold: f32,
    /// Of those equal to it, those up to and including this index are dropped as well.
    last: Option<usize>,
}

impl Worst {
    /// `scores` are those of the finite pixels, in order.
    fn of(scores: &[f32]) -> Self {
        let count = (scores.len() as f64 * DROPPED) as usize;
        if count == 0 {
            return Self {
                threshold: f32::INFINITY,
                last: None,
            };
        }
        let mut sorted = scores.to_vec();
        let (_, threshold, _) = sorted.select_nth_unstable_by(count - 1, |a, b| b.total_cmp(a));
        let threshold = *threshold;
        let above = scores.iter().filter(|&&score| score > threshold).count();
        let ties = (0..scores.len()).filter(|&i| scores[i].total_cmp(&threshold).is_eq());
        Self {
            threshold,
            last: ties.take(count - above).last(),
        }
    }

    fn keeps(&self, index: usize, score: f32) -> bool {
        score < self.threshold
            || (score.total_cmp(&self.threshold).is_eq()
                && self.last.is_none_or(|last| index > last))
    }
}
