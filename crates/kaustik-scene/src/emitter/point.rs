//! A point of an emitter as the first vertex of a light path: what it sends anywhere.

use glam::DVec3;
use kaustik_bsdf::{Frame, warp};
use kaustik_geometry::Ray;
use kaustik_spectrum::{Spectrum, Wavelengths};

use super::{Arrival, DARK, EmissionPdf, Emitter, Emitters, TriangleEmitter};
use crate::matter::Matter;
use crate::{Interior, Vertex};

/// Where a light path begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EmitterPoint {
    /// On an emissive triangle.
    Surface,
    /// A punctual light, by number.
    Punctual(u32),
    /// Infinitely far away, in the direction (unit) from which the environment shines.
    Environment(DVec3),
}

/// A punctual light as a point of the scene receives it.
#[derive(Clone, Copy, Debug)]
pub struct PunctualView {
    /// Unit, from the point to the light.
    pub toward: DVec3,
    /// Square of the distance; 1 if the light is infinitely far away.
    pub squared: f64,
    /// Intensity, faded; irradiance on a surface that faces it if it is infinitely far away.
    pub intensity: Spectrum,
    /// Densities of emission: the position's is the probability of the light.
    pub pdf: EmissionPdf,
}

impl Emitters {
    /// A point by the law of light walks, of an emitter that they choose or that next event at `from` does; one on a triangle
    /// is written into `vertex`. `u(i)` gives coordinate `i` of three.
    pub(crate) fn sample_point(
        &self,
        matter: &Matter,
        from: Option<DVec3>,
        mut u: impl FnMut(u32) -> f64,
        vertex: &mut Vertex,
    ) -> Option<EmitterPoint> {
        let emitter = match from {
            Some(from) => self.choose_from(from, || u(0))?.emitter,
            None => self.choose(|| u(0))?.0,
        };
        Some(match emitter {
            Emitter::Triangle(triangle) => {
                // What has shrunk to nothing has no point that anything finds.
                if triangle.inverse_area(matter) <= 0.0 {
                    return None;
                }
                let weights = warp::uniform_triangle([u(1), u(2)]);
                vertex.surface = triangle.surface(matter, weights);
                vertex.position = vertex.surface.position.as_dvec3();
                vertex.normal = vertex.surface.geometric_normal.as_dvec3();
                vertex.frame = Frame::from_z(vertex.normal);
                vertex.instance = triangle.instance;
                vertex.primitive = triangle.primitive;
                vertex.material = triangle.material;
                EmitterPoint::Surface
            }
            Emitter::Punctual(index) => EmitterPoint::Punctual(*index),
            Emitter::Environment => {
                let (toward, pdf) = self.environment.as_ref()?.sample([u(1), u(2)]);
                if pdf <= 0.0 {
                    return None;
                }
                EmitterPoint::Environment(toward)
            }
        })
    }

    /// A direction of emission and where its ray begins, by the law of light walks.
    pub(crate) fn sample_departure(
        &self,
        matter: &Matter,
        point: EmitterPoint,
        vertex: &Vertex,
        u: [f64; 2],
    ) -> (Ray, DVec3) {
        match point {
            EmitterPoint::Surface => {
                let (mut side, mut v) = (1.0, u[1]);
                if matter.material(vertex.material).emits_on_both_sides() {
                    side = if v < 0.5 { -1.0 } else { 1.0 };
                    v = (2.0 * v).fract();
                }
                let local = warp::cosine_hemisphere([u[0], v]);
                let direction = Frame::from_z(vertex.normal * side).to_world(local);
                (Ray::spawn(&vertex.surface, direction.as_vec3()), direction)
            }
            EmitterPoint::Punctual(index) => {
                let light = self.punctual[index as usize].at(matter.world.time());
                if light.is_directional() {
                    (self.ray_from_disc(light.axis(), u), light.axis())
                } else {
                    let (direction, _) = light.sample_direction(u);
                    let ray = Ray::new(light.position.as_vec3(), direction.as_vec3());
                    (ray, direction)
                }
            }
            EmitterPoint::Environment(toward) => (self.ray_from_disc(-toward, u), -toward),
        }
    }

    /// Index of a triangle in the list.
    pub(super) fn number(&self, triangle: &TriangleEmitter) -> u32 {
        self.first_of_instance[triangle.instance as usize] + triangle.primitive
    }

    /// Index of the emitter that a triangle is.
    #[inline]
    pub(super) fn triangle_index(&self, vertex: &Vertex) -> Option<usize> {
        let first = self.first_of_instance[vertex.instance as usize];
        (first != DARK).then(|| (first + vertex.primitive) as usize)
    }

    /// The solids around a point, on the side of `direction`.
    pub(crate) fn point_interior(
        &self,
        matter: &Matter,
        point: EmitterPoint,
        vertex: &Vertex,
        direction: DVec3,
    ) -> Interior {
        match point {
            EmitterPoint::Surface => {
                let index = self.triangle_index(vertex);
                match index.map(|index| &self.list[index]) {
                    Some(Emitter::Triangle(triangle)) => {
                        self.interior_beside(matter, triangle, &vertex.surface, direction)
                    }
                    _ => Interior::VACUUM,
                }
            }
            EmitterPoint::Punctual(index) => {
                let light = self.punctual[index as usize].at(matter.world.time());
                self.interior_about(matter, index, &light)
            }
            EmitterPoint::Environment(_) => Interior::VACUUM,
        }
    }

    /// A punctual light as `position` receives it.
    pub(crate) fn punctual_view(
        &self,
        matter: &Matter,
        index: u32,
        position: DVec3,
        wavelengths: &Wavelengths,
    ) -> PunctualView {
        let light = self.punctual[index as usize].at(matter.world.time());
        let emitter = self.punctual_index(index);
        let probability = self.choice.probability(emitter);
        let Arrival {
            toward,
            squared,
            intensity,
        } = light.arrival(position, wavelengths);
        let pdf = EmissionPdf {
            position: probability,
            direction: self.punctual_pdf(&light, toward),
            cos: 1.0,
            infinite: light.is_directional(),
            hittable: false,
            emitter: emitter as u32,
        };
        PunctualView {
            toward,
            squared,
            intensity,
            pdf,
        }
    }

    /// Where a punctual light is; `None` if infinitely far away.
    pub(crate) fn punctual_position(&self, matter: &Matter, index: u32) -> Option<DVec3> {
        let light = self.punctual[index as usize].at(matter.world.time());
        (!light.is_directional()).then_some(light.position)
    }

    pub(crate) fn has_punctual(&self, index: u32) -> bool {
        (index as usize) < self.punctual.len()
    }

    /// Its place in the list: triangles come first, then punctual lights in order.
    pub(super) fn punctual_index(&self, index: u32) -> usize {
        let environment = usize::from(self.environment.is_some());
        self.list.len() - environment - self.punctual.len() + index as usize
    }
}
