//! Cameras ready for rays: from a point of the image to a ray and back.
//!
//! Conventions:
//! - The *raster* is the unit square over the whole image, x to the right, y down. A pixel's
//!   radiance is the number of pixels times the integral over the pixel.
//! - Importance integrates to one over the whole image (and over the lens), so a ray drawn
//!   with a uniform raster point carries throughput exactly 1.
//! - The image's aspect ratio decides the horizontal field; the description's vertical field
//!   stands. Pixels are square.
//!
//! Directions, positions and densities are f64; what is traced is rounded to f32 by the
//! caller. A path that is joined to the lens is therefore projected from its f32 vertex with
//! f64 arithmetic, and [`Camera::raster_of`] undoes [`Camera::sample_ray`] to 1e-9 or so.
//!
//! The raster may exceed the unit square: a reconstruction filter that reaches over the
//! image's edge draws from a larger window, [`Camera::with_window`] makes light tracing
//! reach as far. All densities stay per unit of the *image's* raster area; whoever draws from a
//! larger window divides by its area.

mod aperture;
mod orthographic;
mod perspective;
mod pose;

use glam::{Affine3A, DVec2, DVec3};
use kaustik_geometry::Ray;

use crate::description::{CameraDescription, Projection};
use orthographic::Orthographic;
use perspective::Perspective;
use pose::Pose;

/// A camera that cannot be built from its description.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CameraError {
    /// The image has no pixels.
    #[error("an image of {width} x {height} pixels is empty")]
    EmptyImage {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The transform has no usable axes (a zero scale, or values that are not finite).
    #[error("camera '{name}': its transform has no view direction")]
    Transform {
        /// The camera's name.
        name: String,
    },
    /// The projection or lens is out of range.
    #[error("camera '{name}': {what} is {value}, expected {expected}")]
    OutOfRange {
        /// The camera's name.
        name: String,
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f32,
        /// The permitted range in words.
        expected: &'static str,
    },
}

/// A ray from the lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraRay {
    /// On the lens, in the world.
    pub origin: DVec3,
    /// Unit, into the scene.
    pub direction: DVec3,
}

impl CameraRay {
    /// What is traced, in single precision.
    #[inline]
    pub fn ray(&self) -> Ray {
        Ray::new(self.origin.as_vec3(), self.direction.as_vec3())
    }
}

/// A point of the lens that sees a given point of the scene: the last edge of a light path
/// (`t = 1`).
///
/// Joining a vertex `x` with throughput `alpha` and scattering value `f` contributes
/// `alpha f |cos_x| importance` (times visibility) at `raster`, where `cos_x` is the cosine
/// between `x`'s geometric normal and `direction`. That is `G We / p_lens`
/// with the cosine at `x` taken out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LensSample {
    /// On the lens, in the world.
    pub position: DVec3,
    /// Unit, from the point to the lens.
    pub direction: DVec3,
    /// From the point to the lens, > 0.
    pub distance: f64,
    /// Where the image shows it; inside the camera's window.
    pub raster: DVec2,
    /// Cosine between the ray and the optical axis, in (0, 1].
    pub cos: f64,
    /// Importance `We`: per area of the lens and projected solid angle; for a pinhole per
    /// projected solid angle, for an orthographic camera per area of its window.
    pub we: f64,
    /// Density of `position` per area of the lens; 1 where that is Dirac.
    pub pdf: f64,
    /// `We cos / (p_lens distance^2)`; an orthographic camera's Dirac direction has neither the cosine
    /// nor the distance. Equals [`Camera::raster_density`] of the joined edge.
    pub importance: f64,
}

/// Where a light ray meets the lens: the last edge of a light path that was not joined (`t = 0`).
///
/// A light walk that carries `alpha` along the ray contributes `alpha we` at `raster`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LensHit {
    /// On the lens, in the world.
    pub position: DVec3,
    /// From the ray's origin, > 0.
    pub distance: f64,
    /// Point of the image; inside the camera's window.
    pub raster: DVec2,
    /// Cosine between the ray and the optical axis, in (0, 1].
    pub cos: f64,
    /// Importance: per area of the lens and projected solid angle.
    pub we: f64,
}

/// A camera in the world. Looks along its local -z, +y is up.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    pose: Pose,
    optics: Optics,
    window: [DVec2; 2],
}

#[derive(Clone, Debug, PartialEq)]
enum Optics {
    Perspective(Perspective),
    Orthographic(Orthographic),
}

impl Camera {
    /// A camera for an image of `width` by `height` pixels. The transform's scale and shear
    /// are ignored: the view direction is kept, then the up direction as far as it can be.
    pub fn new(
        description: &CameraDescription,
        width: u32,
        height: u32,
    ) -> Result<Self, CameraError> {
        if width == 0 || height == 0 {
            return Err(CameraError::EmptyImage { width, height });
        }
        let name = &description.name;
        let pose = Pose::new(&description.transform)
            .ok_or_else(|| CameraError::Transform { name: name.clone() })?;
        let aspect = f64::from(width) / f64::from(height);
        let optics = match description.projection {
            Projection::Perspective { yfov, .. } => {
                Optics::Perspective(Perspective::new(name, yfov, aspect, description.lens)?)
            }
            Projection::Orthographic { ymag, .. } => {
                Optics::Orthographic(Orthographic::new(name, ymag, aspect)?)
            }
        };
        Ok(Self {
            pose,
            optics,
            window: [DVec2::ZERO, DVec2::ONE],
        })
    }

    /// The same camera elsewhere; `None` if the transform has no usable axes.
    pub(crate) fn moved(&self, transform: &Affine3A) -> Option<Self> {
        Some(Self {
            pose: Pose::new(transform)?,
            ..self.clone()
        })
    }

    /// The same camera that accepts joined light paths within `[min, max)` of the raster
    /// (the unit square by default).
    #[must_use]
    pub fn with_window(mut self, min: DVec2, max: DVec2) -> Self {
        self.window = [min, max];
        self
    }

    /// The ray of a raster point and a lens coordinate, each in [0,1)^2 (the raster may lie
    /// outside). Throughput 1 for uniform arguments. A pinhole ignores `lens`.
    #[must_use]
    pub fn sample_ray(&self, raster: DVec2, lens: [f64; 2]) -> CameraRay {
        let (origin, direction) = match &self.optics {
            Optics::Perspective(optics) => optics.ray(raster, lens),
            Optics::Orthographic(optics) => optics.ray(raster),
        };
        CameraRay {
            origin: self.pose.point_to_world(origin),
            direction: self.pose.vector_to_world(direction),
        }
    }

    /// The ray of a raster point that leaves a given point of the lens (world): what a path keeps when
    /// only its raster point moves. A pinhole and an orthographic camera ignore `lens_point`.
    #[must_use]
    pub fn ray_from(&self, lens_point: DVec3, raster: DVec2) -> CameraRay {
        let (origin, direction) = match &self.optics {
            Optics::Perspective(optics) => {
                optics.ray_from(self.pose.point_to_local(lens_point), raster)
            }
            Optics::Orthographic(optics) => optics.ray(raster),
        };
        CameraRay {
            origin: self.pose.point_to_world(origin),
            direction: self.pose.vector_to_world(direction),
        }
    }

    /// Where a point of the lens (world) is when the camera has gone from where `from` stands to where this one does:
    /// the same point of the lens. The law of the lens is kept, since lengths are.
    #[must_use]
    pub fn carried(&self, from: &Self, lens_point: DVec3) -> DVec3 {
        (self.pose).point_to_world(from.pose.point_to_local(lens_point))
    }

    /// A point of the lens (world) moved within its plane, along the camera's own axes, by a share of the
    /// opening's radius (that of the corners, if it has any); `None` if that is no point of the lens any
    /// more. A camera without an aperture has one point.
    #[must_use]
    pub fn moved_on_lens(&self, lens_point: DVec3, by: DVec2) -> Option<DVec3> {
        let Optics::Perspective(optics) = &self.optics else {
            return None;
        };
        let moved = optics.moved_on_lens(self.pose.point_to_local(lens_point), by)?;
        Some(self.pose.point_to_world(moved))
    }

    /// Density of `direction` (unit, into the scene) per solid angle when the raster is
    /// uniform over the unit square: `1 / (A_1 cos^3)`; 0 behind the camera, not clipped to the
    /// window. 1 for an orthographic camera, whose direction is Dirac.
    #[must_use]
    pub fn pdf_direction(&self, direction: DVec3) -> f64 {
        match &self.optics {
            Optics::Perspective(optics) => optics.pdf_direction(direction.dot(self.pose.forward())),
            Optics::Orthographic(_) => 1.0,
        }
    }

    /// Raster area per area perpendicular to the ray, at `point` seen from `lens_point`: multiply by
    /// the cosine at a surface for the area density of its being hit by a camera ray,
    /// `|cos| / (r^2 A_1 cos^3)`. 0 behind the camera; not clipped to the window.
    #[must_use]
    pub fn raster_density(&self, lens_point: DVec3, point: DVec3) -> f64 {
        match &self.optics {
            Optics::Perspective(optics) => {
                let along = point - lens_point;
                let r2 = along.length_squared();
                if r2 == 0.0 {
                    return 0.0;
                }
                let cos = along.dot(self.pose.forward()) / r2.sqrt();
                optics.pdf_direction(cos) / r2
            }
            Optics::Orthographic(optics) => optics.raster_per_area(),
        }
    }

    /// A point of the lens for a light path's last vertex; `None` if the point is behind
    /// the camera or outside its window. A pinhole and an orthographic camera ignore `u`.
    #[must_use]
    pub fn sample_lens(&self, point: DVec3, u: [f64; 2]) -> Option<LensSample> {
        let local = self.pose.point_to_local(point);
        let sample = match &self.optics {
            Optics::Perspective(optics) => optics.sample_lens(local, u)?,
            Optics::Orthographic(optics) => optics.sample_lens(local)?,
        };
        let [min, max] = self.window;
        let inside = sample.raster.cmpge(min).all() && sample.raster.cmplt(max).all();
        inside.then(|| LensSample {
            position: self.pose.point_to_world(sample.position),
            direction: self.pose.vector_to_world(sample.direction),
            ..sample
        })
    }

    /// Where light that travels from `origin` along `direction` (unit) meets the lens from the front;
    /// `None` if it misses the lens or comes from outside the window, and for cameras whose lens has no
    /// area.
    #[must_use]
    pub fn meet_lens(&self, origin: DVec3, direction: DVec3) -> Option<LensHit> {
        let Optics::Perspective(optics) = &self.optics else {
            return None;
        };
        let origin = self.pose.point_to_local(origin);
        let hit = optics.meet_lens(origin, self.pose.vector_to_local(direction))?;
        let [min, max] = self.window;
        let inside = hit.raster.cmpge(min).all() && hit.raster.cmplt(max).all();
        inside.then(|| LensHit {
            position: self.pose.point_to_world(hit.position),
            ..hit
        })
    }

    /// The raster point whose ray passes `lens_point` along `direction` (unit, into the
    /// scene): the inverse of [`sample_ray`](Self::sample_ray). `None` behind the camera; may lie
    /// outside the unit square.
    #[must_use]
    pub fn raster_of(&self, lens_point: DVec3, direction: DVec3) -> Option<DVec2> {
        let lens_point = self.pose.point_to_local(lens_point);
        let direction = self.pose.vector_to_local(direction);
        match &self.optics {
            Optics::Perspective(optics) => optics.raster_of(lens_point, direction),
            Optics::Orthographic(optics) => {
                (direction.z < 0.0).then(|| optics.raster_of(lens_point))
            }
        }
    }

    /// Is the lens a single point (a pinhole)?
    #[must_use]
    pub fn is_dirac_position(&self) -> bool {
        matches!(&self.optics, Optics::Perspective(optics) if optics.is_pinhole())
    }

    /// Has the lens area, so that its points take coordinates?
    #[must_use]
    pub fn has_aperture(&self) -> bool {
        !self.is_dirac_position() && !self.is_dirac_direction()
    }

    /// Do all rays share one direction (orthographic)?
    #[must_use]
    pub fn is_dirac_direction(&self) -> bool {
        matches!(&self.optics, Optics::Orthographic(_))
    }

    /// Density of a lens point per area: `1 / A_L` for a thin lens, else 1.
    #[must_use]
    pub fn pdf_lens(&self) -> f64 {
        match &self.optics {
            Optics::Perspective(optics) => optics.pdf_lens(),
            Optics::Orthographic(_) => 1.0,
        }
    }

    /// Centre of the lens.
    #[must_use]
    pub fn position(&self) -> DVec3 {
        self.pose.position()
    }

    /// Unit view direction.
    #[must_use]
    pub fn forward(&self) -> DVec3 {
        self.pose.forward()
    }
}

#[cfg(test)]
mod tests;
