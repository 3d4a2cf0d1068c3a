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
/// Built by [`Filter::new`] or from text: `box`, `tent`, `gaussian`, `mitchell`, each alone or with a
/// radius, as in `gaussian:2`.
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
}

/// One row a filter: name, shape, default radius, smallest radius (below it a point could miss every
/// pixel centre, or meet only zeros).
const TABLE: [(&str, Shape, f64, f64); 4] = [
    ("box", Shape::Box, 0.5, 0.5),
    ("tent", Shape::Tent, 1.0, 1.0),
    ("gaussian", Shape::Gaussian, 1.5, 1.0),
    ("mitchell", Shape::Mitchell, 2.0, 1.5),
];

/// Largest radius of any filter, in pixels.
const MAX_RADIUS: f64 = 8.0;

/// A filter that cannot be had.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FilterError {
    /// No filter of this name.
    #[error(
        "unknown filter '{0}': expected box, tent, gaussian or mitchell, each optionally with a radius in pixels as in gaussian:2"
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
    pub fn names() -> [&'static str; 4] {
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
        self.shape == Shape::Box && self.radius < 1.0
    }

    /// The pixels along one axis that a point at `x` (in pixels; pixel i spans i to i + 1) touches: index
    /// of the first, and their weights, which sum to one. Weights may be negative (Mitchell).
    ///
    /// `x` must be finite and within +-2^52.
    #[must_use]
    pub fn taps(&self, x: f64) -> Taps {
        // Centres i + 0.5 in (x - radius, x + radius]: half-open, so that a one-pixel box is floor(x).
        let first = (x - self.radius - 0.5).floor() + 1.0;
        let last = (x + self.radius - 0.5).floor();
        let mut weights = [0.0; MAX_TAPS];
        let mut count = 0;
        let mut sum = 0.0;
        while count < MAX_TAPS && first + count as f64 <= last {
            let weight = self.shape_at(first + count as f64 + 0.5 - x);
            weights[count] = weight;
            sum += weight;
            count += 1;
        }
        for weight in &mut weights[..count] {
            *weight /= sum;
        }
        Taps {
            first: first as i64,
            weights,
            count,
        }
    }

    /// The unnormalised shape at a distance in pixels, |distance| <= radius.
    fn shape_at(&self, distance: f64) -> f64 {
        match self.shape {
            Shape::Box => 1.0,
            Shape::Tent => (self.radius - distance.abs()).max(0.0),
            Shape::Gaussian => {
                let edge = libm::exp(-2.0 * self.radius * self.radius);
                (libm::exp(-2.0 * distance * distance) - edge).max(0.0)
            }
            Shape::Mitchell => mitchell(2.0 * distance / self.radius),
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn any_filter() -> impl Strategy<Value = Filter> {
        (0usize..4, 0.0..1.0f64).prop_map(|(row, u)| {
            let (name, _, default, min) = TABLE[row];
            let radius = if u < 0.3 {
                default
            } else {
                min + u * (MAX_RADIUS - min)
            };
            Filter::new(name, Some(radius)).unwrap()
        })
    }

    proptest! {
        #[test]
        fn weights_sum_to_one(filter in any_filter(), x in -100.0..100.0f64) {
            for x in [x, x.floor(), x.floor() + 0.5] {
                let taps = filter.taps(x);
                let sum: f64 = taps.weights().iter().sum();
                prop_assert!((sum - 1.0).abs() < 1e-12, "{filter} at {x}: {sum}");
            }
        }

        #[test]
        fn support_is_within_the_radius(filter in any_filter(), x in -100.0..100.0f64) {
            let taps = filter.taps(x);
            for (i, _) in taps.weights().iter().enumerate() {
                let centre = (taps.first() + i as i64) as f64 + 0.5;
                prop_assert!((centre - x).abs() <= filter.radius() + 1e-9);
            }
            let next = (taps.first() + taps.weights().len() as i64) as f64 + 0.5;
            prop_assert!(next - x > filter.radius() - 1e-9);
        }

        #[test]
        fn text_round_trips(filter in any_filter()) {
            prop_assert_eq!(filter.to_string().parse::<Filter>().unwrap(), filter);
        }
    }

    #[test]
    fn a_box_is_the_pixel_that_holds_the_point() {
        for (x, pixel) in [(0.0, 0), (0.999, 0), (1.0, 1), (-0.001, -1), (7.5, 7)] {
            let taps = Filter::BOX.taps(x);
            assert_eq!((taps.first(), taps.weights()), (pixel, &[1.0][..]));
        }
    }

    #[test]
    fn every_pixel_integrates_to_one() {
        for name in Filter::names() {
            let filter = Filter::new(name, None).unwrap();
            let n = 4000;
            let mut sum = 0.0;
            for k in 0..n {
                let x = -10.0 + 20.0 * (k as f64 + 0.5) / n as f64;
                let taps = filter.taps(x);
                let index = -taps.first();
                if (0..taps.weights().len() as i64).contains(&index) {
                    sum += taps.weights()[index as usize] * 20.0 / n as f64;
                }
            }
            assert!((sum - 1.0).abs() < 1e-3, "{name}: {sum}");
        }
    }

    #[test]
    fn mitchell_sums_to_one_by_itself_and_is_signed() {
        for k in 0..50 {
            let x = k as f64 / 50.0;
            let sum: f64 = (-3..=3).map(|i| mitchell(f64::from(i) + x)).sum();
            assert!((sum - 6.0).abs() < 1e-12, "{sum}");
        }
        assert!(
            Filter::MITCHELL
                .taps(0.2)
                .weights()
                .iter()
                .any(|&w| w < 0.0)
        );
    }

    #[test]
    fn errors_list_the_names() {
        let message = "lanczos".parse::<Filter>().unwrap_err().to_string();
        for name in Filter::names() {
            assert!(message.contains(name), "{message}");
        }
        for text in ["tent:0.5", "box:9", "box:nan", "gaussian:x", ""] {
            assert!(text.parse::<Filter>().is_err(), "{text}");
        }
    }
}
