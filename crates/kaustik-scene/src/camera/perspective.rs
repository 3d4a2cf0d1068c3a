use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use super::aperture::Aperture;
use super::{CameraError, LensHit, LensSample};
use crate::description::{Blades, Lens};

/// A pinhole or a thin lens, in the camera's own frame (it looks along -z).
///
/// A raster point stands for a point of the plane of focus, seen through the centre of the
/// lens; the ray goes from a point of the lens to it. Every lens point thus sees the same
/// window of the plane of focus, and the density of a direction is `1 / (A_1 cos^3)` with the
/// angle of the ray itself, wherever on the lens it starts.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Perspective {
    /// Half the window on the plane at unit distance: `A_1 = 4 half.x half.y`.
    half: DVec2,
    lens: Option<ThinLens>,
}

#[derive(Clone, Debug, PartialEq)]
struct ThinLens {
    aperture: Aperture,
    pdf: f64,
    focus: f64,
}

/// Is every number of the lens of this camera within its range?
fn check(camera: &str, lens: &Lens) -> Result<(), CameraError> {
    let &Lens {
        aperture,
        focus,
        blades,
    } = lens;
    let positive = |value: f32| value > 0.0 && value.is_finite();
    let ok = positive(aperture);
    expect(ok, camera, "aperture", aperture, "a positive radius")?;
    let ok = positive(focus);
    expect(ok, camera, "focus", focus, "a positive distance")?;
    if let Some(Blades { count, rotation }) = blades {
        let ok = (3..=64).contains(&count);
        expect(ok, camera, "blades", count as f32, "3 to 64")?;
        let ok = rotation.is_finite();
        expect(ok, camera, "rotation", rotation, "an angle in radians")?;
    }
    Ok(())
}

fn expect(
    ok: bool,
    camera: &str,
    what: &'static str,
    value: f32,
    expected: &'static str,
) -> Result<(), CameraError> {
    match ok {
        true => Ok(()),
        false => Err(CameraError::OutOfRange {
            name: camera.to_owned(),
            what,
            value,
            expected,
        }),
    }
}

impl Perspective {
    pub(super) fn new(
        name: &str,
        yfov: f32,
        aspect: f64,
        lens: Option<Lens>,
    ) -> Result<Self, CameraError> {
        let y = libm::tan(0.5 * f64::from(yfov));
        let ok = yfov > 0.0 && f64::from(yfov) < PI && y.is_finite();
        expect(ok, name, "yfov", yfov, "an angle between 0 and pi")?;
        if let Some(lens) = &lens {
            check(name, lens)?;
        }
        Ok(Self {
            half: DVec2::new(y * aspect, y),
            lens: lens.map(|lens| {
                let aperture = Aperture::new(&lens);
                ThinLens {
                    pdf: 1.0 / aperture.area(),
                    aperture,
                    focus: f64::from(lens.focus),
                }
            }),
        })
    }

    pub(super) fn is_pinhole(&self) -> bool {
        self.lens.is_none()
    }

    /// A point of the lens moved by so many of its radii; `None` beyond the rim.
    pub(super) fn moved_on_lens(&self, point: DVec3, by: DVec2) -> Option<DVec3> {
        let aperture = &self.lens.as_ref()?.aperture;
        let moved = point + (by * aperture.radius()).extend(0.0);
        aperture.holds(moved).then_some(moved)
    }

    pub(super) fn pdf_lens(&self) -> f64 {
        match &self.lens {
            Some(lens) => lens.pdf,
            None => 1.0,
        }
    }

    /// Density per solid angle at this cosine to the axis: `1 / (A_1 cos^3)`, `A_1` the image's area at unit distance.
    pub(super) fn pdf_direction(&self, cos: f64) -> f64 {
        if cos > 0.0 {
            1.0 / (self.area() * cos * cos * cos)
        } else {
            0.0
        }
    }

    pub(super) fn ray(&self, raster: DVec2, u: [f64; 2]) -> (DVec3, DVec3) {
        let origin = self
            .lens
            .as_ref()
            .map_or(DVec3::ZERO, |lens| lens.aperture.point(u));
        self.ray_from(origin, raster)
    }

    /// From a point of the lens.
    pub(super) fn ray_from(&self, origin: DVec3, raster: DVec2) -> (DVec3, DVec3) {
        let window = self.window_point(raster);
        match &self.lens {
            None => (DVec3::ZERO, window.normalize()),
            Some(lens) => (origin, (window * lens.focus - origin).normalize()),
        }
    }

    pub(super) fn raster_of(&self, lens_point: DVec3, direction: DVec3) -> Option<DVec2> {
        let cos = -direction.z;
        if cos.is_nan() || cos <= 0.0 {
            return None;
        }
        let window = match &self.lens {
            None => direction / cos,
            Some(lens) => direction / cos + lens_point / lens.focus,
        };
        Some(self.raster(window))
    }

    pub(super) fn sample_lens(&self, point: DVec3, u: [f64; 2]) -> Option<LensSample> {
        let position = self
            .lens
            .as_ref()
            .map_or(DVec3::ZERO, |lens| lens.aperture.point(u));
        let along = position - point;
        let distance = along.length();
        let direction = along / distance;
        let raster = self.raster_of(position, -direction)?;
        let cos = direction.z;
        let pdf = self.pdf_lens();
        // We = 1 / (A_1 A_L cos^4), where 1 / A_L is the density of the lens point.
        let we = pdf * self.pdf_direction(cos) / cos;
        let importance = self.pdf_direction(cos) / (distance * distance);
        importance.is_finite().then_some(LensSample {
            position,
            direction,
            distance,
            raster,
            cos,
            we,
            pdf,
            importance,
        })
    }

    pub(super) fn meet_lens(&self, origin: DVec3, direction: DVec3) -> Option<LensHit> {
        let lens = self.lens.as_ref()?;
        // The camera looks along -z, so light that it sees travels along +z.
        let cos = direction.z;
        let distance = -origin.z / cos;
        if !(cos > 0.0 && distance > 0.0) {
            return None;
        }
        let mut position = origin + direction * distance;
        position.z = 0.0;
        if !lens.aperture.holds(position) {
            return None;
        }
        Some(LensHit {
            position,
            distance,
            raster: self.raster_of(position, -direction)?,
            cos,
            we: self.pdf_lens() * self.pdf_direction(cos) / cos,
        })
    }

    fn area(&self) -> f64 {
        4.0 * self.half.x * self.half.y
    }

    /// On the plane at unit distance.
    fn window_point(&self, raster: DVec2) -> DVec3 {
        let x = (2.0 * raster.x - 1.0) * self.half.x;
        let y = (1.0 - 2.0 * raster.y) * self.half.y;
        DVec3::new(x, y, -1.0)
    }

    fn raster(&self, window: DVec3) -> DVec2 {
        let x = 0.5 * (1.0 + window.x / self.half.x);
        let y = 0.5 * (1.0 - window.y / self.half.y);
        DVec2::new(x, y)
    }
}
