//! Linear Rec.709 to XYZ in `f64`, for sums over many pixels.

use kaustik_spectrum::{Rgb, Xyz};

/// The matrix of the conversion that the rest of the workspace uses, by its columns.
#[derive(Clone, Copy, Debug)]
pub(super) struct ToXyz([[f64; 3]; 3]);

impl ToXyz {
    pub(super) fn new() -> Self {
        let column = |rgb| Xyz::from(Rgb(rgb)).0.map(f64::from);
        Self([
            column([1.0, 0.0, 0.0]),
            column([0.0, 1.0, 0.0]),
            column([0.0, 0.0, 1.0]),
        ])
    }

    pub(super) fn xyz(&self, rgb: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|row| (0..3).map(|c| self.0[c][row] * rgb[c]).sum())
    }

    /// Y alone.
    pub(super) fn luminance(&self, rgb: [f64; 3]) -> f64 {
        (0..3).map(|c| self.0[c][1] * rgb[c]).sum()
    }
}
