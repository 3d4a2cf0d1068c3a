//! Where a film's pixels lie: the full image, the crop window, the filter.

use crate::{FilmError, Filter};
use serde::{Deserialize, Serialize};

/// A rectangle of whole pixels, half-open: columns `x0..x1`, rows `y0..y1`, y downwards from the top.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Window {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// Column after the last.
    pub x1: u32,
    /// Row after the last.
    pub y1: u32,
}

impl Window {
    /// The whole of an image of this size.
    #[must_use]
    pub fn full(width: u32, height: u32) -> Self {
        Self {
            x0: 0,
            y0: 0,
            x1: width,
            y1: height,
        }
    }

    /// Columns; 0 if the corners are swapped.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.x1.saturating_sub(self.x0)
    }

    /// Rows; 0 if the corners are swapped.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.y1.saturating_sub(self.y0)
    }

    /// Number of pixels.
    #[must_use]
    pub fn area(&self) -> u64 {
        u64::from(self.width()) * u64::from(self.height())
    }

    /// Whether every pixel of `other` is one of this window's.
    #[must_use]
    pub fn contains(&self, other: &Window) -> bool {
        self.x0 <= other.x0 && self.y0 <= other.y0 && self.x1 >= other.x1 && self.y1 >= other.y1
    }
}

impl std::fmt::Display for Window {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{},{},{},{}", self.x0, self.y0, self.x1, self.y1)
    }
}

/// A rectangle of raster points, in pixels; half-open.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bounds {
    /// Smallest x and y.
    pub min: [f64; 2],
    /// Largest x and y.
    pub max: [f64; 2],
}

impl Bounds {
    /// Width times height, in pixels: what a uniform raster point's density is the inverse of.
    #[must_use]
    pub fn area(&self) -> f64 {
        (self.max[0] - self.min[0]) * (self.max[1] - self.min[1])
    }

    /// The point of the rectangle at (u, v), each in [0, 1).
    #[must_use]
    pub fn point(&self, u: f64, v: f64) -> [f64; 2] {
        [
            self.min[0] + u * (self.max[0] - self.min[0]),
            self.min[1] + v * (self.max[1] - self.min[1]),
        ]
    }
}

/// Size, crop and filter of a film: everything but its sums.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Layout {
    /// Columns of the full image, >= 1.
    pub width: u32,
    /// Rows of the full image, >= 1.
    pub height: u32,
    /// The pixels that the film holds, in coordinates of the full image.
    pub crop: Window,
    /// How a splat spreads.
    pub filter: Filter,
}

impl Layout {
    /// The whole image with the default filter (a box of one pixel).
    #[must_use]
    pub fn new(width: u32, height: u32) -> Self {
        Self {
            width,
            height,
            crop: Window::full(width, height),
            filter: Filter::default(),
        }
    }

    /// The same with another filter.
    #[must_use]
    pub fn with_filter(self, filter: Filter) -> Self {
        Self { filter, ..self }
    }

    /// The same, holding the pixels of this window only.
    #[must_use]
    pub fn with_crop(self, crop: Window) -> Self {
        Self { crop, ..self }
    }

    /// Has the crop window pixels, and none that the image does not have?
    ///
    /// # Errors
    ///
    /// If not.
    pub fn check(&self) -> Result<(), FilmError> {
        let whole = Window::full(self.width, self.height);
        if self.crop.area() > 0 && whole.contains(&self.crop) {
            return Ok(());
        }
        Err(FilmError::Empty {
            width: self.width,
            height: self.height,
            crop: self.crop,
        })
    }

    /// The raster points that can touch a pixel of the crop window: the window extended on each side by
    /// the filter's radius less half a pixel (a pixel is sampled at its centre). Raster points are to be
    /// drawn uniformly from here, and nothing is renormalised at the border: with the one-pixel box this
    /// is the window itself.
    #[must_use]
    pub fn extended_bounds(&self) -> Bounds {
        let margin = self.filter.radius() - 0.5;
        let (x0, y0) = (f64::from(self.crop.x0), f64::from(self.crop.y0));
        let (x1, y1) = (f64::from(self.crop.x1), f64::from(self.crop.y1));
        Bounds {
            min: [x0 - margin, y0 - margin],
            max: [x1 + margin, y1 + margin],
        }
    }
}
