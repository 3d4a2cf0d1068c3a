//! The mean of independent pictures, and how well it is known.

use crate::{Image, ImageError};

/// Independent pictures of one size and one cost, added one at a time: their mean, its standard error as
/// their spread tells it, and the means of every other one as two halves.
#[derive(Clone, Debug)]
pub struct Spread {
    width: u32,
    height: u32,
    count: u32,
    /// Sums over all pictures and over those with an even number, R, G, B a pixel.
    sums: Vec<[f64; 3]>,
    even: Vec<[f64; 3]>,
    squares: Vec<[f64; 3]>,
}

impl Spread {
    /// No pictures yet, of this size.
    #[must_use]
    pub fn new(width: u32, height: u32) -> Self {
        let zeros = vec![[0.0; 3]; width as usize * height as usize];
        Self {
            width,
            height,
            count: 0,
            sums: zeros.clone(),
            even: zeros.clone(),
            squares: zeros,
        }
    }

    /// Adds a picture; `false`, and nothing is added, if it has another size.
    pub fn add(&mut self, image: &Image) -> bool {
        if (image.width(), image.height()) != (self.width, self.height) {
            return false;
        }
        let even = self.count.is_multiple_of(2);
        for pixel in 0..image.pixels() {
            let value = image.pixel(pixel);
            for (c, v) in value.into_iter().enumerate() {
                self.sums[pixel][c] += v;
                self.squares[pixel][c] += v * v;
                if even {
                    self.even[pixel][c] += v;
                }
            }
        }
        self.count += 1;
        true
    }

    /// Pictures so far.
    #[must_use]
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Standard error of the mean as a share: the root of the mean over pixels and R, G, B of
    /// s^2 / n divided by r^2 + 0.01 mean(r)^2, with s the deviation over the pictures (n - 1 in the
    /// denominator) and r their mean. Its square is what the mean's own noise adds to a relative
    /// MSE. `None` for fewer than two pictures, infinite for black ones, of which no share is known; pixels that are not finite are left out.
    #[must_use]
    pub fn relative_error(&self) -> Option<f64> {
        if self.count < 2 {
            return None;
        }
        let n = f64::from(self.count);
        let finite = || {
            (self.sums.iter().zip(&self.squares)).filter(|(s, _)| s.iter().all(|v| v.is_finite()))
        };
        let samples = (3 * finite().count()).max(1) as f64;
        let mean = finite().flat_map(|(s, _)| s).sum::<f64>() / n / samples;
        let floor = 0.01 * mean * mean;
        if floor <= 0.0 {
            return Some(f64::INFINITY);
        }
        let mut sum = 0.0;
        for (total, square) in finite() {
            for c in 0..3 {
                let r = total[c] / n;
                let variance = ((square[c] - n * r * r) / (n - 1.0)).max(0.0);
                let scale = r * r + floor;
                if scale > 0.0 {
                    sum += variance / n / scale;
                }
            }
        }
        Some((sum / samples).sqrt())
    }

    /// The mean of all pictures.
    ///
    /// # Errors
    /// If the size is none that an image can have.
    pub fn mean(&self) -> Result<Image, ImageError> {
        let n = f64::from(self.count.max(1));
        self.image(|pixel, c| self.sums[pixel][c] / n)
    }

    /// The means of the pictures with even and with odd numbers: independent of each other. With an even
    /// number of pictures their mean is [`mean`](Self::mean).
    ///
    /// # Errors
    /// If the size is none that an image can have.
    pub fn halves(&self) -> Result<[Image; 2], ImageError> {
        let odd = f64::from((self.count / 2).max(1));
        let even = f64::from(self.count.div_ceil(2).max(1));
        Ok([
            self.image(|pixel, c| self.even[pixel][c] / even)?,
            self.image(|pixel, c| (self.sums[pixel][c] - self.even[pixel][c]) / odd)?,
        ])
    }

    fn image(&self, value: impl Fn(usize, usize) -> f64) -> Result<Image, ImageError> {
        let plane = |c| {
            (0..self.sums.len())
                .map(|pixel| value(pixel, c) as f32)
                .collect()
        };
        Image::from_rgb(self.width, self.height, [0, 1, 2].map(plane))
    }
}
