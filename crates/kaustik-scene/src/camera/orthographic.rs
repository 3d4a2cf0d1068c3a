use glam::{DVec2, DVec3};

use super::{CameraError, LensSample};

/// Parallel rays along -z from a window in the plane z = 0 of the camera's own frame.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Orthographic {
    half: DVec2,
}

impl Orthographic {
    /// `ymag` is half the height; the width follows from the image.
    pub(super) fn new(name: &str, ymag: f32, aspect: f64) -> Result<Self, CameraError> {
        // glTF permits negative magnifications and advises against them; the size counts.
        let y = f64::from(ymag).abs();
        if !(y.is_finite() && y > 0.0) {
            return Err(CameraError::OutOfRange {
                name: name.to_owned(),
                what: "ymag",
                value: ymag,
                expected: "a finite size other than 0",
            });
        }
        Ok(Self {
            half: DVec2::new(y * aspect, y),
        })
    }

    pub(super) fn raster_per_area(&self) -> f64 {
        1.0 / (4.0 * self.half.x * self.half.y)
    }

    pub(super) fn ray(&self, raster: DVec2) -> (DVec3, DVec3) {
        let x = (2.0 * raster.x - 1.0) * self.half.x;
        let y = (1.0 - 2.0 * raster.y) * self.half.y;
        (DVec3::new(x, y, 0.0), DVec3::NEG_Z)
    }

    pub(super) fn raster_of(&self, point: DVec3) -> DVec2 {
        let x = 0.5 * (1.0 + point.x / self.half.x);
        let y = 0.5 * (1.0 - point.y / self.half.y);
        DVec2::new(x, y)
    }

    pub(super) fn sample_lens(&self, point: DVec3) -> Option<LensSample> {
        let distance = -point.z;
        let importance = self.raster_per_area();
        (distance > 0.0).then(|| LensSample {
            position: DVec3::new(point.x, point.y, 0.0),
            direction: DVec3::Z,
            distance,
            raster: self.raster_of(point),
            cos: 1.0,
            we: importance,
            pdf: 1.0,
            importance,
        })
    }
}
