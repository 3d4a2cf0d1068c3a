//! Textures ready for look-ups.
//!
//! The decoded bytes are kept as they are, shared with the [`Description`](crate::Description)
//! and all other textures on the same image: a texel costs four bytes (eight, of an image with 16 bits a
//! channel), and a colour is decoded when it is read, through a table of all values. Decoding comes before
//! interpolation, so a bilinear look-up is linear in light. There are no mip levels: a path tracer averages
//! over its samples.
//!
//! A look-up never fails: NaN reads the texel at 0, infinite coordinates read some texel.

mod uv_map;

use std::sync::{Arc, LazyLock};

use glam::Vec2;
use kaustik_spectrum::srgb_to_linear;

use crate::description::{Filtering, ImageData, Pixels, TextureDescription, Wrap};

pub use uv_map::UvMap;

/// An image that does not hold the pixels that its size says.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TextureError {
    /// Zero columns or rows.
    #[error("image '{name}' is empty ({width} x {height})")]
    Empty {
        /// The image's name.
        name: String,
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// Too few or too many values.
    #[error("image '{name}' holds {found} values, expected {expected} for its size")]
    Length {
        /// The image's name.
        name: String,
        /// Values there are.
        found: usize,
        /// Values that the size asks for.
        expected: u64,
    },
}

/// How the stored values of a colour channel stand for numbers. Alpha is always linear, and so are
/// float images.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coding {
    /// Colours: base colour, emission, specular and sheen colour.
    Srgb,
    /// Data: roughness, metallic, normals, transmission, thickness.
    Linear,
}

/// The decoded values of all bytes in one coding.
type Table = [f32; 256];

pub(crate) static SRGB: LazyLock<Table> =
    LazyLock::new(|| std::array::from_fn(|byte| srgb_to_linear(byte as f32 / 255.0)));

/// The same for 16 bits. Made when the first such image is read.
pub(crate) static SRGB_16: LazyLock<Vec<f32>> =
    LazyLock::new(|| (0..=u16::MAX).map(|v| srgb_to_linear(share(v))).collect());

/// A number of 16 bits as a share of the largest.
pub(crate) fn share(value: u16) -> f32 {
    f32::from(value) / f32::from(u16::MAX)
}

static LINEAR: LazyLock<Table> = LazyLock::new(|| std::array::from_fn(|byte| byte as f32 / 255.0));

/// An image with its sampling.
#[derive(Clone, Debug)]
pub struct Texture {
    image: Arc<ImageData>,
    wrap: [Wrap; 2],
    filtering: Filtering,
    tables: [&'static Table; 2],
}

impl Texture {
    /// `image` is the one that the description names. Fails if it does not hold `width *
    /// height` pixels, at least one.
    pub fn new(
        description: &TextureDescription,
        image: Arc<ImageData>,
    ) -> Result<Self, TextureError> {
        check(&image)?;
        Ok(Self {
            image,
            wrap: [description.wrap_s, description.wrap_t],
            filtering: description.filtering,
            tables: [&SRGB, &LINEAR],
        })
    }

    /// Red, green, blue and alpha at `uv` (v down, as glTF has it). Linear values; bytes give
    /// [0, 1], float images what they hold.
    #[must_use]
    pub fn sample(&self, uv: Vec2, coding: Coding) -> [f32; 4] {
        let size = [self.image.width, self.image.height];
        let [s, t] = [0, 1].map(|axis| fold(uv[axis], self.wrap[axis]) * f64::from(size[axis]));
        match self.filtering {
            Filtering::Nearest => self.texel(s as i64, t as i64, coding),
            Filtering::Linear => {
                let (s, t) = (s - 0.5, t - 0.5);
                let (x, y) = (s.floor(), t.floor());
                let (fx, fy) = ((s - x) as f32, (t - y) as f32);
                let (x, y) = (x as i64, y as i64);
                let a = self.texel(x, y, coding);
                let b = self.texel(x + 1, y, coding);
                let c = self.texel(x, y + 1, coding);
                let d = self.texel(x + 1, y + 1, coding);
                std::array::from_fn(|i| {
                    let top = a[i] + (b[i] - a[i]) * fx;
                    let bottom = c[i] + (d[i] - c[i]) * fx;
                    top + (bottom - top) * fy
                })
            }
        }
    }

    /// Mean over all texels.
    #[must_use]
    pub fn mean(&self, coding: Coding) -> [f32; 4] {
        let (width, height) = (i64::from(self.image.width), i64::from(self.image.height));
        let mut sum = [0.0_f64; 4];
        for y in 0..height {
            for x in 0..width {
                let texel = self.texel(x, y, coding);
                for (sum, value) in sum.iter_mut().zip(texel) {
                    *sum += f64::from(value);
                }
            }
        }
        sum.map(|sum| (sum / (width * height) as f64) as f32)
    }

    /// The image that is read.
    #[must_use]
    pub fn image(&self) -> &Arc<ImageData> {
        &self.image
    }

    /// A texel; coordinates one step outside wrap.
    fn texel(&self, x: i64, y: i64, coding: Coding) -> [f32; 4] {
        let x = wrapped(x, self.image.width, self.wrap[0]);
        let y = wrapped(y, self.image.height, self.wrap[1]);
        let index = y * self.image.width as usize + x;
        match &self.image.pixels {
            Pixels::Rgba8(bytes) => {
                let table = match coding {
                    Coding::Srgb => self.tables[0],
                    Coding::Linear => self.tables[1],
                };
                let [r, g, b, a] = std::array::from_fn(|i| usize::from(bytes[4 * index + i]));
                [table[r], table[g], table[b], self.tables[1][a]]
            }
            Pixels::Rgba16(values) => {
                let texel: [u16; 4] = std::array::from_fn(|i| values[4 * index + i]);
                let [r, g, b] = [0, 1, 2].map(|i| match coding {
                    Coding::Srgb => SRGB_16[usize::from(texel[i])],
                    Coding::Linear => share(texel[i]),
                });
                [r, g, b, share(texel[3])]
            }
            Pixels::RgbF32(values) => {
                let [r, g, b] = std::array::from_fn(|i| values[3 * index + i]);
                [r, g, b, 1.0]
            }
        }
    }
}

/// Does the image hold as many values as its size says, at least one pixel?
pub(crate) fn check(image: &ImageData) -> Result<(), TextureError> {
    let ImageData { width, height, .. } = *image;
    let name = || image.name.clone();
    if width == 0 || height == 0 {
        let name = name();
        return Err(TextureError::Empty {
            name,
            width,
            height,
        });
    }
    let (found, channels) = match &image.pixels {
        Pixels::Rgba8(bytes) => (bytes.len(), 4),
        Pixels::Rgba16(values) => (values.len(), 4),
        Pixels::RgbF32(values) => (values.len(), 3),
    };
    // 2^32 * 2^32 * 4 overflows u64; such an image fails below in any case
    let expected = (u64::from(width) * u64::from(height)).saturating_mul(channels);
    if found as u64 == expected {
        Ok(())
    } else {
        let name = name();
        Err(TextureError::Length {
            name,
            found,
            expected,
        })
    }
}

/// A coordinate brought into [0, 1]; f64 keeps the fraction of f32 coordinates exact.
fn fold(coordinate: f32, wrap: Wrap) -> f64 {
    let c = f64::from(coordinate);
    let folded = match wrap {
        Wrap::Repeat => c - c.floor(),
        Wrap::Mirror => {
            let period = c - 2.0 * (0.5 * c).floor();
            if period <= 1.0 { period } else { 2.0 - period }
        }
        Wrap::Clamp => c.clamp(0.0, 1.0),
    };
    if folded.is_nan() { 0.0 } else { folded }
}

/// The column (or row) that `index`, within one step of [0, size], stands for.
fn wrapped(index: i64, size: u32, wrap: Wrap) -> usize {
    let size = i64::from(size);
    let index = match wrap {
        Wrap::Repeat => index.rem_euclid(size),
        // a mirrored edge repeats its own texel
        Wrap::Mirror | Wrap::Clamp => index.clamp(0, size - 1),
    };
    index as usize
}

#[cfg(test)]
mod tests;
