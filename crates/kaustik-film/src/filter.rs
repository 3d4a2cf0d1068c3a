//! Pixel filters for splatting: the weights with which one raster point adds to the pixels around it.
//!
//! A Metropolis film cannot divide a pixel by the sum of its weights, because the number of points that
//! fall near it *is* its brightness. So the weights of one splat are divided by their own sum instead: at
//! every raster point they sum to one, over all pixels of the support, whether or not the film holds
//! those pixels. What a point brings is then kept whole, and every pixel's weight function integrates to
//! one. The tent of radius 1 and the Mitchell cubic of radius 2 sum to one by themselves; Gaussians and
//! other radii are so divided, a ripple of a few per cent.
//!
//! All filters are separable. Mitchell's has negative lobes: the film's sums are signed.

use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// Most pixels that a splat can touch along one axis.
pub(crate) const MAX_TAPS: usize = 17;

/// A separable pixel filter with its radius in pixels.
///
/// Built by [`Filter::new`] or from text: `box`, `tent`, `gaussian`, `mitchell`, `blackman-harris`, each
/// alone or with a radius, as in `tent:2`. A larger radius makes a filter wider, except for the Gaussian,
/// which is `exp(-2 x^2)` at a distance of `x` pixels whatever its radius: there it only says where the
/// filter ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Filter {
    shape: Shape,
    radius: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    Box,
    Tent,
    Gaussian,
    Mitchell,
    BlackmanHarris,
}

/// One row a filter: name, shape, default radius, smallest radius (below it a point could miss every
/// pixel centre, or meet only zeros).
const TABLE: [(&str, Shape, f64, f64); 5] = [
    ("box", Shape::Box, 0.5, 0.5),
    ("tent", Shape::Tent, 1.0, 1.0),
    ("gaussian", Shape::Gaussian, 1.5, 1.0),
    ("mitchell", Shape::Mitchell, 2.0, 1.5),
    ("blackman-harris", Shape::BlackmanHarris, 1.5, 1.0),
];

/// Largest radius of any filter, in pixels.
const MAX_RADIUS: f64 = 8.0;

/// A filter that cannot be had.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FilterError {
    /// No filter of this name.
    #[error(
        "unknown filter '{0}': expected box, tent, gaussian, mitchell or blackman-harris, each optionally with a radius in pixels as in gaussian:2"
    )]
    UnknownName(String),
    /// Text after the colon that is not a number.
    #[error("filter radius '{0}' is not a number: expected pixels, as in gaussian:2")]
    NotANumber(String),
    /// A radius that this filter cannot have.
    #[error("radius {radius} of filter '{name}' is out of range: expected {min} to {max} pixels")]
    Radius {
        /// The filter's name.
        name: &'static str,
        /// The radius asked for.
        radius: f64,
        /// Smallest allowed.
        min: f64,
        /// Largest allowed.
        max: f64,
    },
}

impl Filter {
    /// The default: each splat goes to the one pixel that holds it.
    pub const BOX: Filter = Filter {
        shape: Shape::Box,
        radius: 0.5,
    };
    /// Linear, two pixels wide.
    pub const TENT: Filter = Filter {
        shape: Shape::Tent,
        radius: 1.0,
    };
    /// exp(-2 x^2) less its value at the radius of 1.5 pixels (standard deviation 0.5 pixel).
    pub const GAUSSIAN: Filter = Filter {
        shape: Shape::Gaussian,
        radius: 1.5,
    };
    /// Mitchell and Netravali's cubic with B = C = 1/3, radius 2; negative beyond the first pixel.
    pub const MITCHELL: Filter = Filter {
        shape: Shape::Mitchell,
        radius: 2.0,
    };

    /// The window of Blackman and Harris with four terms over a radius of 1.5 pixels: about a Gaussian,
    /// with no step at its edge.
    pub const BLACKMAN_HARRIS: Filter = Filter {
        shape: Shape::BlackmanHarris,
        radius: 1.5,
    };

    /// A filter by name, with its default radius if none is given.
    ///
    /// # Errors
    /// An unknown name (the error lists them); a radius below what the shape needs or above 8 pixels.
    pub fn new(name: &str, radius: Option<f64>) -> Result<Self, FilterError> {
        let Some(&(name, shape, default, min)) = TABLE.iter().find(|row| row.0 == name) else {
            return Err(FilterError::UnknownName(name.to_owned()));
        };
        let radius = radius.unwrap_or(default);
        if !(min..=MAX_RADIUS).contains(&radius) {
            return Err(FilterError::Radius {
                name,
                radius,
                min,
                max: MAX_RADIUS,
            });
        }
        Ok(Self { shape, radius })
    }

    /// The names that [`Filter::new`] knows.
    #[must_use]
    pub fn names() -> [&'static str; 5] {
        TABLE.map(|row| row.0)
    }

    /// This filter's name.
    #[must_use]
    pub fn name(&self) -> &'static str {
        TABLE[self.shape as usize].0
    }

    /// Half the width of the support, in pixels: 0.5 to 8.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Whether each splat touches exactly one pixel with weight one.
    #[must_use]
    pub fn is_single_pixel(&self) -> bool {
        self.shape == Shape::Box && self.radius <= 0.5
    }

    /// The pixels along one axis that a point at `x` (in pixels; pixel i spans i to i + 1) touches: index
    /// of the first, and their weights, which sum to one. Weights may be negative (Mitchell).
    ///
    /// `x` must be finite and within +-2^52.
    #[must_use]
    pub fn taps(&self, x: f64) -> Taps {
        // Centres i + 0.5 in (x - radius, x + radius]: half-open, so that a one-pixel box is floor(x).
        let first = floor(x - self.radius - 0.5) + 1;
        let last = floor(x + self.radius - 0.5);
        let count = ((last - first + 1) as usize).min(MAX_TAPS);
        let edge = match self.shape {
            Shape::Gaussian => libm::exp(-2.0 * self.radius * self.radius),
            _ => 0.0,
        };
        let mut weights = [0.0; MAX_TAPS];
        let mut distance = first as f64 + 0.5 - x;
        let mut sum = 0.0;
        for weight in &mut weights[..count] {
            *weight = self.shape_at(distance, edge);
            sum += *weight;
            distance += 1.0;
        }
        let scale = 1.0 / sum;
        for weight in &mut weights[..count] {
            *weight *= scale;
        }
        Taps {
            first,
            weights,
            count,
        }
    }

    /// The unnormalised shape at a distance in pixels, |distance| <= radius; `edge` is the Gaussian's
    /// value at the radius.
    fn shape_at(&self, distance: f64, edge: f64) -> f64 {
        match self.shape {
            Shape::Box => 1.0,
            Shape::Tent => (self.radius - distance.abs()).max(0.0),
            Shape::Gaussian => (libm::exp(-2.0 * distance * distance) - edge).max(0.0),
            Shape::Mitchell => mitchell(2.0 * distance / self.radius),
            Shape::BlackmanHarris => blackman_harris(distance / self.radius),
        }
    }
}

/// Largest integer <= x, for |x| < 2^62. (`f64::floor` is a call where the processor's baseline has no
/// instruction for it.)
fn floor(x: f64) -> i64 {
    let whole = x as i64;
    whole - i64::from(whole as f64 > x)
}

/// The cubic of Mitchell and Netravali (1988), B = C = 1/3, support [-2, 2], up to a constant factor.
fn mitchell(x: f64) -> f64 {
    let x = x.abs();
    if x < 1.0 {
        (7.0 * x - 12.0) * x * x + 16.0 / 3.0
    } else if x < 2.0 {
        ((-7.0 / 3.0 * x + 12.0) * x - 20.0) * x + 32.0 / 3.0
    } else {
        0.0
    }
}

/// The minimum four-term window of Harris (1978) over [-1, 1], positive throughout.
fn blackman_harris(x: f64) -> f64 {
    // cosines of two and three times the angle from that of the angle itself
    let c = libm::cos(std::f64::consts::PI * x);
    let (c2, c3) = (2.0 * c * c - 1.0, (4.0 * c * c - 3.0) * c);
    0.35875 + 0.48829 * c + 0.14128 * c2 + 0.01168 * c3
}

/// The pixels that one point touches along one axis.
#[derive(Clone, Copy, Debug)]
pub struct Taps {
    first: i64,
    weights: [f64; MAX_TAPS],
    count: usize,
}

impl Taps {
    /// Index of the first pixel; may be negative.
    #[must_use]
    pub fn first(&self) -> i64 {
        self.first
    }

    /// Weights of the pixels from the first on; they sum to one.
    #[must_use]
    pub fn weights(&self) -> &[f64] {
        &self.weights[..self.count]
    }
}

impl Default for Filter {
    fn default() -> Self {
        Self::BOX
    }
}

impl FromStr for Filter {
    type Err = FilterError;

    fn from_str(text: &str) -> Result<Self, FilterError> {
        let Some((name, radius)) = text.split_once(':') else {
            return Self::new(text, None);
        };
        let radius = radius
            .parse()
            .map_err(|_| FilterError::NotANumber(radius.to_owned()))?;
        Self::new(name, Some(radius))
    }
}

impl std::fmt::Display for Filter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}:{}", self.name(), self.radius)
    }
}

impl TryFrom<String> for Filter {
    type Error = FilterError;

    fn try_from(text: String) -> Result<Self, FilterError> {
        text.parse()
    }
}

impl From<Filter> for String {
    fn from(filter: Filter) -> Self {
        filter.to_string()
    }
}
