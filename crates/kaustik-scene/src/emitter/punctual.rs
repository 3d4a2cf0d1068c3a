//! Lights without area (`KHR_lights_punctual`): point, spot, directional.

use std::borrow::Cow;
use std::sync::Arc;

use glam::{Affine3A, DVec3};
use kaustik_bsdf::{Frame, warp};
use kaustik_geometry::Motion;
use kaustik_spectrum::{EmissionSpectrum, Spectrum, Wavelengths, uplift_emission};

use crate::description::{LightDescription, LightKind};
use crate::material::luminance;

/// A light whose position or direction is Dirac: no ray can hit it.
#[derive(Clone, Debug)]
pub(crate) struct Punctual {
    shape: Shape,
    intensity: EmissionSpectrum,
    /// Of the intensity, for the choice among emitters.
    luminance: f64,
    /// Light fades to nothing at this distance; infinite without `range`.
    range: f64,
    pub(crate) position: DVec3,
    /// The direction in which it shines (spot, directional).
    axis: DVec3,
    /// Of a light that moves.
    motion: Option<Arc<Motion>>,
}

/// Its light as it arrives at a point.
pub(crate) struct Arrival {
    /// Unit, from the point to the light.
    pub(crate) toward: DVec3,
    /// Square of the distance; 1 if the light is infinitely far away.
    pub(crate) squared: f64,
    /// Intensity, faded; irradiance on a surface that faces it if it is infinitely far away.
    pub(crate) intensity: Spectrum,
}

#[derive(Clone, Copy, Debug)]
enum Shape {
    Point,
    Spot { cos_inner: f64, cos_outer: f64 },
    Directional,
}

impl Punctual {
    pub(crate) fn new(light: &LightDescription) -> Self {
        let rgb = light.color.map(|c| c * light.intensity);
        let shape = match light.kind {
            LightKind::Point => Shape::Point,
            LightKind::Spot { inner, outer } => Shape::Spot {
                cos_inner: libm::cos(f64::from(inner)),
                cos_outer: libm::cos(f64::from(outer)),
            },
            LightKind::Directional => Shape::Directional,
        };
        let (position, axis) = stand(&light.transform);
        Self {
            shape,
            intensity: uplift_emission(rgb),
            luminance: f64::from(luminance(rgb)),
            range: (light.range.filter(|&range| range > 0.0)).map_or(f64::INFINITY, f64::from),
            position,
            axis,
            motion: None,
        }
    }

    /// Lets it move.
    pub(crate) fn carry(&mut self, motion: Motion) {
        (self.position, self.axis) = stand(&motion.at(0.0));
        self.motion = (!motion.is_still()).then(|| Arc::new(motion));
    }

    pub(crate) fn moves(&self) -> bool {
        self.motion.is_some()
    }

    /// The light at a time.
    #[inline]
    pub(crate) fn at(&self, time: f32) -> Cow<'_, Self> {
        let Some(motion) = &self.motion else {
            return Cow::Borrowed(self);
        };
        let (position, axis) = stand(&motion.at(time));
        Cow::Owned(Self {
            position,
            axis,
            motion: None,
            ..self.clone()
        })
    }

    pub(crate) fn is_directional(&self) -> bool {
        matches!(self.shape, Shape::Directional)
    }

    /// The direction in which a directional light travels.
    pub(crate) fn axis(&self) -> DVec3 {
        self.axis
    }

    /// Flux at unit spectrum scale, for the choice among emitters: the solid angle that it
    /// fills (spot: with its falloff); a directional light needs the scene's disc as well.
    pub(crate) fn power(&self, scene_disc: f64) -> f64 {
        let extent = match self.shape {
            Shape::Point => 4.0 * std::f64::consts::PI,
            Shape::Spot {
                cos_inner,
                cos_outer,
            } => {
                // Falloff t^2 over the rim integrates to a third of it.
                2.0 * std::f64::consts::PI
                    * ((1.0 - cos_inner) + (cos_inner - cos_outer).max(0.0) / 3.0)
            }
            Shape::Directional => scene_disc,
        };
        extent * self.luminance
    }

    /// Intensity (per steradian) toward `direction`, or irradiance of a directional light.
    pub(crate) fn intensity(&self, direction: DVec3, wavelengths: &Wavelengths) -> Spectrum {
        self.intensity.eval(wavelengths) * self.falloff(direction) as f32
    }

    /// Share of the intensity left toward `direction`, in [0, 1]. The extension's form:
    /// linear in the cosine between the two cones, squared.
    fn falloff(&self, direction: DVec3) -> f64 {
        match self.shape {
            Shape::Point | Shape::Directional => 1.0,
            Shape::Spot {
                cos_inner,
                cos_outer,
            } => {
                let cos = self.axis.dot(direction);
                let t = (cos - cos_outer) / (cos_inner - cos_outer).max(f64::MIN_POSITIVE);
                let t = t.clamp(0.0, 1.0);
                t * t
            }
        }
    }

    /// The extension's window over the inverse square: 1 near the light, 0 beyond `range`.
    pub(crate) fn window(&self, distance: f64) -> f64 {
        if self.range.is_infinite() {
            return 1.0;
        }
        let ratio = distance / self.range;
        (1.0 - (ratio * ratio) * (ratio * ratio)).clamp(0.0, 1.0)
    }

    /// Its light as it arrives at `position`, where nothing stands between.
    pub(crate) fn arrival(&self, position: DVec3, wavelengths: &Wavelengths) -> Arrival {
        if self.is_directional() {
            return Arrival {
                toward: -self.axis,
                squared: 1.0,
                intensity: self.intensity(self.axis, wavelengths),
            };
        }
        let to = self.position - position;
        let squared = to.length_squared();
        let distance = squared.sqrt();
        let toward = to / distance;
        Arrival {
            toward,
            squared,
            intensity: self.intensity(-toward, wavelengths) * self.window(distance) as f32,
        }
    }

    /// The axis and the angle about it (radians) within which it shines (point, spot).
    pub(crate) fn cone(&self) -> (DVec3, f64) {
        let angle = match self.shape {
            Shape::Spot { cos_outer, .. } => libm::acos(cos_outer.clamp(-1.0, 1.0)),
            Shape::Point | Shape::Directional => std::f64::consts::PI,
        };
        (self.axis, angle)
    }

    /// Where the last of its light has faded; infinite if it does not.
    pub(crate) fn range(&self) -> f64 {
        self.range
    }

    /// A direction of emission with its density per solid angle (point, spot).
    pub(crate) fn sample_direction(&self, u: [f64; 2]) -> (DVec3, f64) {
        match self.shape {
            Shape::Spot { cos_outer, .. } => {
                let local = warp::uniform_cone(u, cos_outer);
                (
                    Frame::from_z(self.axis).to_world(local),
                    warp::uniform_cone_pdf(cos_outer),
                )
            }
            Shape::Point | Shape::Directional => (warp::uniform_sphere(u), warp::SPHERE_PDF),
        }
    }

    /// Density of [`Self::sample_direction`].
    pub(crate) fn direction_pdf(&self, direction: DVec3) -> f64 {
        match self.shape {
            Shape::Spot { cos_outer, .. } if self.axis.dot(direction) < cos_outer => 0.0,
            Shape::Spot { cos_outer, .. } => warp::uniform_cone_pdf(cos_outer),
            Shape::Point => warp::SPHERE_PDF,
            Shape::Directional => 0.0,
        }
    }
}

/// Where a light with this transform is, and in which direction it shines.
fn stand(transform: &Affine3A) -> (DVec3, DVec3) {
    let axis = transform.transform_vector3(-glam::Vec3::Z).as_dvec3();
    let position = transform.translation.as_dvec3();
    (position, axis.normalize_or(DVec3::NEG_Z))
}
