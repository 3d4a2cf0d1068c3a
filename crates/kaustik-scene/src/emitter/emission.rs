//! Where light walks start.

use std::f64::consts::PI;

use glam::DVec3;
use kaustik_bsdf::{Frame, warp};
use kaustik_geometry::Ray;
use kaustik_spectrum::Wavelengths;

use super::density::lambertian_pdf;
use super::{AreaSample, DARK, EmissionPdf, EmissionSample, Emitter, Emitters, TriangleEmitter};
use crate::Interior;
use crate::matter::Matter;

impl Emitters {
    /// The start of a light walk. `u(i)` gives coordinate `i` of five: choice, position (two),
    /// direction (two).
    pub(crate) fn sample_emission(
        &self,
        matter: &Matter,
        wavelengths: &Wavelengths,
        mut u: impl FnMut(u32) -> f64,
    ) -> Option<EmissionSample> {
        let chosen = self.choose(|| u(0))?;
        self.emission_of(chosen, matter, wavelengths, u)
    }

    /// The start of a photon's walk, with the emitter chosen by its flux, as far as the floors of [`Shares`](super::shares) let it.
    pub(crate) fn sample_photon(
        &self,
        matter: &Matter,
        wavelengths: &Wavelengths,
        mut u: impl FnMut(u32) -> f64,
    ) -> Option<EmissionSample> {
        let choice = self.photon_choice.as_ref().unwrap_or(&self.choice);
        let chosen = self.choose_by(choice, || u(0))?;
        self.emission_of(chosen, matter, wavelengths, u)
    }

    fn emission_of(
        &self,
        (emitter, probability): (&Emitter, f64),
        matter: &Matter,
        wavelengths: &Wavelengths,
        u: impl FnMut(u32) -> f64,
    ) -> Option<EmissionSample> {
        match emitter {
            Emitter::Triangle(triangle) => {
                // What shrinks to nothing for an instant sends out nothing.
                (triangle.inverse_area(matter) > 0.0)
                    .then(|| self.triangle_emission(matter, triangle, probability, wavelengths, u))
            }
            Emitter::Punctual(index) => {
                self.punctual_emission(matter, *index, probability, wavelengths, u)
            }
            Emitter::Environment => self.environment_emission(probability, wavelengths, u),
        }
    }

    fn environment_emission(
        &self,
        probability: f64,
        wavelengths: &Wavelengths,
        mut u: impl FnMut(u32) -> f64,
    ) -> Option<EmissionSample> {
        let environment = self.environment.as_ref()?;
        let (toward, pdf) = environment.sample([u(3), u(4)]);
        let radiance = environment.radiance(toward, wavelengths);
        let densities = EmissionPdf {
            position: pdf * probability,
            direction: self.disc_pdf(),
            cos: 1.0,
            infinite: true,
            hittable: true,
            emitter: DARK,
        };
        let pdf = densities.position * densities.direction;
        (pdf > 0.0).then(|| EmissionSample {
            ray: self.ray_from_disc(-toward, [u(1), u(2)]),
            weight: radiance / pdf as f32,
            pdf: densities,
            interior: Interior::VACUUM,
            area: None,
            fading: None,
        })
    }

    fn triangle_emission(
        &self,
        matter: &Matter,
        triangle: &TriangleEmitter,
        probability: f64,
        wavelengths: &Wavelengths,
        mut u: impl FnMut(u32) -> f64,
    ) -> EmissionSample {
        let surface = triangle.surface(matter, warp::uniform_triangle([u(1), u(2)]));
        let both_sides = matter.material(triangle.material).emits_on_both_sides();
        let (mut side, mut v) = (1.0, u(4));
        let mut sides = 1.0;
        if both_sides {
            // The lower half of the last coordinate shines to the back.
            sides = 2.0;
            side = if v < 0.5 { -1.0 } else { 1.0 };
            v = (2.0 * v).fract();
        }
        let normal = surface.geometric_normal.as_dvec3() * side;
        let direction = Frame::from_z(normal).to_world(warp::cosine_hemisphere([u(3), v]));
        let cos = normal.dot(direction).max(0.0);
        // The cosine of the density cancels the emitter's.
        let inverse_area = triangle.inverse_area(matter);
        let position_weight = 1.0 / (probability * inverse_area);
        let weight = position_weight * PI * sides;
        EmissionSample {
            ray: Ray::spawn(&surface, direction.as_vec3()),
            weight: matter.covered_emission(triangle.material, &surface, wavelengths)
                * weight as f32,
            pdf: EmissionPdf {
                position: probability * inverse_area,
                direction: lambertian_pdf(cos, both_sides),
                cos,
                infinite: false,
                hittable: true,
                emitter: self.number(triangle),
            },
            interior: self.interior_beside(matter, triangle, &surface, normal),
            area: Some(AreaSample {
                surface,
                weight: position_weight,
                both_sides,
                material: triangle.material,
                emitter: self.number(triangle),
            }),
            fading: None,
        }
    }

    fn punctual_emission(
        &self,
        matter: &Matter,
        index: u32,
        probability: f64,
        wavelengths: &Wavelengths,
        mut u: impl FnMut(u32) -> f64,
    ) -> Option<EmissionSample> {
        let light = self.punctual[index as usize].at(matter.world.time());
        let emitter = self.punctual_index(index) as u32;
        if light.is_directional() {
            let weight = PI * self.radius * self.radius / probability;
            return Some(EmissionSample {
                ray: self.ray_from_disc(light.axis(), [u(1), u(2)]),
                weight: light.intensity(light.axis(), wavelengths) * weight as f32,
                pdf: EmissionPdf {
                    position: probability,
                    direction: self.disc_pdf(),
                    cos: 1.0,
                    infinite: true,
                    hittable: false,
                    emitter,
                },
                interior: Interior::VACUUM,
                area: None,
                fading: None,
            });
        }
        let (direction, pdf) = light.sample_direction([u(3), u(4)]);
        let weight = 1.0 / (pdf * probability);
        weight.is_finite().then(|| EmissionSample {
            ray: Ray::new(light.position.as_vec3(), direction.as_vec3()),
            weight: light.intensity(direction, wavelengths) * weight as f32,
            pdf: EmissionPdf {
                position: probability,
                direction: pdf,
                cos: 1.0,
                infinite: false,
                hittable: false,
                emitter,
            },
            interior: self.interior_about(matter, index, &light),
            area: None,
            fading: Some(index),
        })
    }

    /// Parallel light along `direction`, from a disc that covers the scene's sphere.
    pub(super) fn ray_from_disc(&self, direction: DVec3, u: [f64; 2]) -> Ray {
        let frame = Frame::from_z(direction);
        let [x, y] = warp::concentric_disk(u);
        let origin = self.center + (frame.x * x + frame.y * y - frame.z) * self.radius;
        Ray::new(origin.as_vec3(), direction.as_vec3())
    }
}
