use glam::DVec3;
use kaustik_bsdf::Bsdf;
use kaustik_scene::{EmitterPoint, Interior, Passed, Vertex};
use kaustik_spectrum::Spectrum;

use crate::walk::WalkDirection;

/// What a vertex is to its path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum VertexKind {
    /// The first: where the light comes from.
    Emitter(EmitterPoint),
    /// Where it is scattered.
    Surface,
    /// The last.
    Lens,
}

/// A vertex of a path, with the edge that leads from it toward the eye. Directions are unit and point away
/// from the vertex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PathVertex {
    pub(crate) kind: VertexKind,
    /// Of an emitter or surface. Of the lens, only the position means anything.
    pub(crate) vertex: Vertex,
    pub(crate) bsdf: Bsdf,
    /// The solids on the side of `back`.
    pub(crate) interior: Interior,
    /// World direction to where a walk came from that found the vertex.
    pub(crate) back: DVec3,
    /// World direction to the next vertex toward the light.
    pub(crate) toward_light: DVec3,
    /// World direction to the next vertex toward the eye.
    pub(crate) toward_eye: DVec3,
    /// `toward_light` in the local frame.
    pub(crate) wi: DVec3,
    /// `toward_eye` in the local frame.
    pub(crate) wo: DVec3,
    /// Local geometric normal.
    pub(crate) ng: DVec3,
    /// At a surface: the BSDF with the factor of shading normals, for light on its way to the
    /// eye; if it scatters into a Dirac direction, the weight of that. At the first vertex:
    /// emitted radiance, or the intensity of a punctual light.
    pub(crate) value: Spectrum,
    /// Scatters into a Dirac direction.
    pub(crate) specular: bool,
    /// It passes the surface.
    pub(crate) transmitted: bool,
    /// Refracts so that the hero counts alone.
    pub(crate) dispersive: bool,
    /// Geometric cosine toward the light; 1 where there is none.
    pub(crate) cos_light: f64,
    /// Geometric cosine toward the eye; 1 where there is none.
    pub(crate) cos_eye: f64,
    /// Share of the surface that is there.
    pub(crate) opacity: f64,
    /// The edge toward the eye.
    pub(crate) edge: Edge,
}

/// The way between two vertices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    /// Square of the length; 1 where one end is infinitely far away.
    pub(crate) squared: f64,
    /// Probability to pass what is partly transparent.
    pub(crate) passed: f64,
    /// Share of light that what fills the space leaves over, and all that is passed over the probability of it.
    pub(crate) transmittance: Spectrum,
}

impl Edge {
    /// Takes in what is in the way.
    #[inline]
    pub(crate) fn dim(&mut self, passed: Passed) {
        self.passed = passed.chance;
        self.transmittance *= passed.tint();
    }
}

impl Default for Edge {
    fn default() -> Self {
        Self {
            squared: 1.0,
            passed: 1.0,
            transmittance: Spectrum::ONE,
        }
    }
}

impl Default for PathVertex {
    /// A slot to write into.
    fn default() -> Self {
        Self {
            kind: VertexKind::Surface,
            vertex: Vertex::default(),
            bsdf: Bsdf::black(),
            interior: Interior::VACUUM,
            back: DVec3::Z,
            toward_light: DVec3::Z,
            toward_eye: DVec3::Z,
            wi: DVec3::Z,
            wo: DVec3::Z,
            ng: DVec3::Z,
            value: Spectrum::ZERO,
            specular: false,
            transmitted: false,
            dispersive: false,
            cos_light: 1.0,
            cos_eye: 1.0,
            opacity: 1.0,
            edge: Edge::default(),
        }
    }
}

impl PathVertex {
    /// The direction to the next vertex that way.
    #[inline]
    pub(crate) fn ahead_mut(&mut self, towards: WalkDirection) -> &mut DVec3 {
        match towards {
            WalkDirection::ToLight => &mut self.toward_light,
            WalkDirection::ToEye => &mut self.toward_eye,
        }
    }

    /// May a walk run into it, as into an emitter?
    #[inline]
    pub(crate) fn is_hittable(&self) -> bool {
        !matches!(self.kind, VertexKind::Emitter(EmitterPoint::Punctual(_)))
    }

    /// Of an emitter: infinitely far away?
    #[inline]
    pub(crate) fn is_environment(&self) -> bool {
        matches!(self.kind, VertexKind::Emitter(EmitterPoint::Environment(_)))
    }
}
