//! How likely emission sampling is to start a light walk as it did, for weights.

use std::f64::consts::{FRAC_1_PI, PI};

use glam::DVec3;

use super::{DARK, Emitter, Emitters};
use crate::Vertex;
use crate::matter::Matter;

/// Densities with which emission sampling takes a point of an emitter and a direction from it.
/// Next event draws the point by the same law, and the emitter as often or [`odds`](crate::Scene::next_event_odds) times
/// as often. Their units go by what emits (`P`: the probability of the emitter):
///
/// | emitter | `position` | `direction` |
/// |---|---|---|
/// | surface | `P` times per area | per solid angle |
/// | environment, at infinity | `P` times per solid angle | per area across the direction |
/// | Dirac position (point, spot) | `P` | per solid angle |
/// | Dirac direction (directional) | `P` | per area across the direction |
///
/// Of a surface that a walk has met both are 0 toward a side to which it sends nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissionPdf {
    /// `P p_A` per area; of an emitter at infinity `P p_env` per solid angle; of a Dirac position or
    /// direction the probability `P` of the emitter.
    pub position: f64,
    /// Per solid angle; of an emitter at infinity per area perpendicular to the direction,
    /// `1 / (pi R^2)`.
    pub direction: f64,
    /// Cosine at the emitter; 1 where there is no surface.
    pub cos: f64,
    /// The emitter lies at infinity: what it meets has the density `direction |cos|` per area,
    /// without the square of a distance, and is found by the emitter's density per solid angle.
    pub infinite: bool,
    /// A ray may run into it; neither its position nor its direction is Dirac.
    pub hittable: bool,
    /// Which emitter, by its number among the scene's; `u32::MAX` for the environment and for what emits nothing.
    pub emitter: u32,
}

impl Emitters {
    /// Of a surface that a walk met and left toward `direction` (unit, world); zero densities where
    /// the surface is no emitter or sends nothing there.
    pub(crate) fn surface_pdf(
        &self,
        matter: &Matter,
        vertex: &Vertex,
        direction: DVec3,
    ) -> EmissionPdf {
        let cos = vertex.normal.dot(direction);
        let first = self.first_of_instance[vertex.instance as usize];
        let mut pdf = EmissionPdf {
            position: 0.0,
            direction: 0.0,
            cos: cos.abs(),
            infinite: false,
            hittable: true,
            emitter: DARK,
        };
        let material = matter.material(vertex.material);
        if first == DARK || !material.emits_toward(cos) {
            return pdf;
        }
        let index = (first + vertex.primitive) as usize;
        if let Emitter::Triangle(triangle) = self.list[index] {
            pdf.position = self.choice.probability(index) * triangle.inverse_area(matter);
            pdf.emitter = index as u32;
            pdf.direction = lambertian_pdf(cos, material.emits_on_both_sides());
        }
        pdf
    }

    /// Of the environment, for light that arrives from `toward` (unit, away from the scene).
    pub(crate) fn infinity_pdf(&self, toward: DVec3) -> EmissionPdf {
        EmissionPdf {
            position: self.environment_pdf(toward),
            direction: self.disc_pdf(),
            cos: 1.0,
            infinite: true,
            hittable: true,
            emitter: DARK,
        }
    }

    /// Density of a point on the disc that covers the scene's sphere.
    #[inline]
    pub(super) fn disc_pdf(&self) -> f64 {
        1.0 / (PI * self.radius * self.radius)
    }
}

/// Density per solid angle of a direction at this cosine from a diffuse emitter.
#[inline]
pub(super) fn lambertian_pdf(cos: f64, both_sides: bool) -> f64 {
    cos.abs() * FRAC_1_PI * if both_sides { 0.5 } else { 1.0 }
}
