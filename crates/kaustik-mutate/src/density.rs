//! With which density a step of a walk makes a vertex: see the crate's page on the measure.

use glam::DVec3;
use kaustik_bsdf::{Lobe, Mode, shading};
use kaustik_scene::{EmissionPdf, EmitterPoint};

use crate::PathSpace;
use crate::factor::{Factor, factor};
use crate::vertex::{PathVertex, VertexKind};
use crate::vertices::Vertices;
use crate::ways::{Making, Ways};

/// What of a step with the light is geometry: vertex `i` from vertex `i - 1`, per solid angle of the
/// direction taken.
#[inline]
pub(crate) fn geometry_to_eye(path: &impl Vertices, i: usize) -> f64 {
    let (from, to) = (path.at(i - 1), path.at(i));
    let measure = match (from.specular, to.specular) {
        (true, _) => 1.0,
        (false, true) => 1.0 / factor(Factor::CosBeforeRunToEye, from.cos_eye),
        (false, false) => {
            factor(Factor::CosToEye, to.cos_light)
                / factor(Factor::DistanceToEye, from.edge.squared)
        }
    };
    measure
        * factor(Factor::PassedToEye, from.edge.passed * to.opacity)
        * factor(Factor::MeetingToEye, meeting(to, to.wi))
}

/// Probability that a walk which comes to a vertex from local direction `w` does not pass it as a pane.
#[inline]
fn meeting(vertex: &PathVertex, w: DVec3) -> f64 {
    match vertex.kind {
        VertexKind::Surface => vertex.bsdf.passing(w).meeting(),
        // No emitter is a pane.
        VertexKind::Emitter(_) | VertexKind::Lens => 1.0,
    }
}

/// What of a step against the light is geometry: vertex `i` from vertex `i + 1`.
#[inline]
pub(crate) fn geometry_to_light(path: &impl Vertices, i: usize) -> f64 {
    let (to, from) = (path.at(i), path.at(i + 1));
    let measure = match (from.specular, to.specular) {
        (true, _) => 1.0,
        (false, true) => 1.0 / factor(Factor::CosBeforeRunToLight, from.cos_light),
        (false, false) => {
            factor(Factor::CosToLight, to.cos_eye)
                / factor(Factor::DistanceToLight, to.edge.squared)
        }
    };
    measure
        * factor(Factor::PassedToLight, to.edge.passed * to.opacity)
        * factor(Factor::MeetingToLight, meeting(to, to.wo))
}

/// `s / S`: what a walk with the light has in its density at a Dirac scattering, beside the probability.
///
/// Both ways to make a run are divided by the one Jacobian `cos_b d(omega_b)/dA_a`. Against the light that leaves the density of the
/// direction at `b`. With the light a beam of étendue 1 (area times solid angle times cosine) leaves a scattering with `S / s` of it: `S` for
/// normals that are bent, `1 / s` for the change of index; so its density there grows by `s / S`.
#[inline]
pub(crate) fn bending(vertex: &PathVertex) -> f64 {
    let PathVertex { wi, wo, ng, .. } = *vertex;
    let particles = shading::walk_factor(wi, wo, ng, Mode::Importance);
    let particles = factor(Factor::ShadingNormal, particles);
    if !vertex.transmitted {
        return 1.0 / particles;
    }
    let share = |mode| {
        let delta = vertex.bsdf.delta(wo, true, mode);
        delta.map_or(0.0, |delta| f64::from(delta.share.max()))
    };
    factor(
        Factor::Index,
        share(Mode::Radiance) / share(Mode::Importance),
    ) / particles
}

impl PathSpace<'_> {
    /// Density of the lens point, 1 where it is Dirac.
    #[inline]
    pub(crate) fn start_at_lens(&self) -> f64 {
        factor(Factor::LensPdf, self.lens_pdf())
    }

    /// The same, of no particular walk.
    #[inline]
    pub(crate) fn lens_pdf(&self) -> f64 {
        let pdf = self.scene.camera().pdf_lens();
        if self.has_aperture() {
            pdf * self.unit_area()
        } else {
            pdf
        }
    }

    /// Density with which emission sampling makes vertex 0.
    #[inline]
    pub(crate) fn emitter_point_pdf(&self, path: &impl Vertices) -> f64 {
        let pdf = self.emission(path).position;
        if path.at(0).kind == VertexKind::Emitter(EmitterPoint::Surface) {
            pdf * self.unit_area()
        } else {
            pdf
        }
    }

    /// How much more often vertex 0 is chosen where it alone is made with the light, and joined to vertex 1, than where a walk with
    /// the light goes on from it. The lens asks for no emitter of its own.
    #[inline]
    pub(crate) fn emitter_odds(&self, path: &impl Vertices) -> f64 {
        let next = path.at(1);
        if next.kind == VertexKind::Lens || !self.scene.chooses_emitters_by_place() {
            return 1.0;
        }
        let pdf = self.emission(path);
        let odds = (self.scene).next_event_odds(&pdf, next.vertex.position);
        factor(Factor::EmitterOdds, odds)
    }

    /// The unit of area for the density of the vertex `to` that a walk makes from its neighbour `from`, D where that
    /// does not scatter into a Dirac direction and S where it does:
    ///
    /// - D to D: per area, `unit_area`;
    /// - D to S, S to D, S to S: in a run, whose density is by direction, 1;
    /// - D or S to what is infinitely far away: by direction, 1;
    /// - what is infinitely far away to D or S: its light comes through an area, whatever that meets, `unit_area`.
    #[inline]
    pub(crate) fn unit_of(&self, from: &PathVertex, to: &PathVertex) -> f64 {
        let by_direction = self.is_endless(to) || from.specular || to.specular;
        if by_direction && !self.is_endless(from) {
            1.0
        } else {
            self.unit_area()
        }
    }

    /// Densities with which emission sampling makes vertex 0 and leaves it.
    #[inline]
    pub(crate) fn emission(&self, path: &impl Vertices) -> EmissionPdf {
        let vertex = path.at(0);
        match vertex.kind {
            VertexKind::Emitter(EmitterPoint::Punctual(index)) => {
                let next = path.at(1).vertex.position;
                self.scene
                    .punctual_view(index, next, path.wavelengths())
                    .pdf
            }
            VertexKind::Emitter(EmitterPoint::Environment(toward)) => {
                self.scene.environment_emission_pdf(toward)
            }
            _ => self.scene.emission_pdf(&vertex.vertex, vertex.toward_eye),
        }
    }

    /// Density with which a walk with the light makes vertex `i > 0` from the one before.
    #[inline]
    pub(crate) fn step_to_eye_pdf(&self, path: &impl Vertices, i: usize) -> f64 {
        if path.at(i).kind == VertexKind::Lens {
            return 0.0; // no walk is stopped by the lens here
        }
        let from = path.at(i - 1);
        let direction = if matches!(from.kind, VertexKind::Emitter(_)) {
            factor(Factor::Emission, self.emission(path).direction)
        } else if from.specular {
            let delta = from.bsdf.delta(from.wi, from.transmitted, Mode::Importance);
            let probability = delta.map_or(0.0, |delta| delta.probability);
            factor(Factor::DiracToEye, probability) * bending(from)
        } else {
            let pdf = from.bsdf.pdf(from.wi, from.wo, Mode::Importance);
            factor(Factor::DirectionToEye, pdf)
        };
        direction * geometry_to_eye(path, i) * self.unit_of(from, path.at(i))
    }

    /// Density with which a walk from the eye makes vertex `i` from the one after it.
    #[inline]
    pub(crate) fn step_to_light_pdf(&self, path: &impl Vertices, i: usize) -> f64 {
        if !path.at(i).is_hittable() {
            return 0.0;
        }
        let from = path.at(i + 1);
        let direction = if from.kind == VertexKind::Lens {
            let lens = from.vertex.position;
            let raster = self.raster_per_direction(lens, from.toward_light);
            factor(Factor::Raster, raster) * factor(Factor::RasterPdf, self.raster_pdf())
        } else if from.specular {
            let delta = from.bsdf.delta(from.wo, from.transmitted, Mode::Radiance);
            let probability = delta.map_or(0.0, |delta| delta.probability);
            factor(Factor::DiracToLight, probability)
        } else {
            let pdf = from.bsdf.pdf(from.wo, from.wi, Mode::Radiance);
            factor(Factor::DirectionToLight, pdf)
        };
        direction * geometry_to_light(path, i) * self.unit_of(from, path.at(i))
    }

    /// The sum over all ways to make the vertices `first..end` between those that are kept: the first
    /// `i` of them by a walk with the light, the others by one from the eye, for all `i` up to their
    /// number. A way whose joining edge touches a Dirac scattering is none. At the ends of the path
    /// walks begin with a point of an emitter and of the lens.
    pub(crate) fn all_ways(&self, path: &impl Vertices, first: usize, end: usize) -> f64 {
        let none = Ways::none(self.joins(path, first));
        (first..end)
            .fold(none, |ways, i| ways.then(self.making(path, i)))
            .sum
    }

    /// Vertex `i`, made in either way.
    #[inline]
    pub(crate) fn making(&self, path: &impl Vertices, i: usize) -> Making {
        let by_light = match i {
            0 => factor(Factor::EmitterPoint, self.emitter_point_pdf(path)),
            _ => self.step_to_eye_pdf(path, i),
        };
        let by_eye = match path.at(i).kind {
            VertexKind::Lens => self.start_at_lens(),
            _ => self.step_to_light_pdf(path, i),
        };
        let joins = match self.joins(path, i + 1) {
            true if i == 0 => self.emitter_odds(path),
            joins => f64::from(u8::from(joins)),
        };
        Making {
            by_light,
            by_eye,
            joins,
        }
    }

    /// May vertices `i - 1` and `i` have been joined? Beyond the ends of the path nothing needs to be. Parallel rays do not
    /// meet light from infinitely far away but by chance.
    #[inline]
    fn joins(&self, path: &impl Vertices, i: usize) -> bool {
        if i == 0 || i == path.len() {
            return true;
        }
        let (light, eye) = (path.at(i - 1), path.at(i));
        let parallel = eye.kind == VertexKind::Lens
            && matches!(
                light.kind,
                VertexKind::Emitter(EmitterPoint::Environment(_))
            )
            && self.scene.camera().is_dirac_direction();
        !(light.specular || eye.specular || parallel)
    }
}
