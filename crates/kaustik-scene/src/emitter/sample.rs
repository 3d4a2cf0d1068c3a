//! What the emitters hand out.

use glam::{DVec3, Vec3};
use kaustik_geometry::{Ray, Surface};
use kaustik_spectrum::Spectrum;

use super::EmissionPdf;
use crate::Interior;

/// Where the far end of a connection to an emitter lies.
#[derive(Clone, Copy, Debug)]
pub enum Reach {
    /// On an emissive triangle: the point, rounded once, and the unit normal of the front.
    Surface(Vec3, Vec3),
    /// At a point light.
    Point(DVec3),
    /// Infinitely far away.
    Infinity,
}

/// Next-event estimation: what a point receives from one direction.
#[derive(Clone, Copy, Debug)]
pub struct DirectSample {
    /// Unit, from the point to the emitter.
    pub wi: DVec3,
    /// Density per solid angle at the point, the choice of the emitter included; of a Dirac
    /// emitter the probability of its choice.
    pub pdf: f64,
    /// How much more often the emitter is chosen by next event from there than by light walks: the share of `pdf` in which
    /// the two differ ([`Scene::next_event_odds`](crate::Scene::next_event_odds)).
    pub odds: f64,
    /// Density with which a light walk from the emitter's point would take the direction `-wi`: per
    /// solid angle, at infinity per area perpendicular to it ([`EmissionPdf::direction`]).
    pub emission_pdf: f64,
    /// Radiance from there; of a Dirac emitter the irradiance on a surface that faces it.
    pub radiance: Spectrum,
    /// A Dirac emitter: no ray can hit it, so no other technique finds this light.
    pub delta: bool,
    /// The emitter's end of the shadow ray.
    pub reach: Reach,
}

impl DirectSample {
    /// A slot to write into.
    #[inline]
    pub fn nothing() -> Self {
        Self {
            wi: DVec3::Z,
            pdf: 0.0,
            odds: 1.0,
            emission_pdf: 0.0,
            radiance: Spectrum::ZERO,
            delta: false,
            reach: Reach::Infinity,
        }
    }
}

/// The start of a light walk.
#[derive(Clone, Copy, Debug)]
pub struct EmissionSample {
    /// The first ray.
    pub ray: Ray,
    /// Emitted radiance times cosine over all densities: `Le |cos| / (P p_A p_w)`.
    pub weight: Spectrum,
    /// With which densities the point and the direction were drawn.
    pub pdf: EmissionPdf,
    /// The solids around the emitter, on the side of the ray.
    pub interior: Interior,
    /// The point on an emissive triangle with `1 / (P p_A)`, for joining it to the lens; `None` for Dirac
    /// emitters and the environment.
    pub area: Option<AreaSample>,
    /// The light fades with distance (`range`): index of the punctual light.
    pub(crate) fading: Option<u32>,
}

/// A point on an emissive triangle.
#[derive(Clone, Copy, Debug)]
pub struct AreaSample {
    /// The point.
    pub surface: Surface,
    /// `1 / (P p_A)`.
    pub weight: f64,
    /// Both sides emit.
    pub both_sides: bool,
    /// Index of the material.
    pub material: u32,
    /// Index of the triangle in the list of emitters.
    pub(crate) emitter: u32,
}
