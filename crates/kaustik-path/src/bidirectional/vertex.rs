//! A vertex of either subpath, with all that joining it takes.

use glam::DVec3;
use kaustik_bsdf::Bsdf;
use kaustik_scene::{Interior, Vertex};
use kaustik_spectrum::Spectrum;

use super::form::Onward;
use super::running::Running;
use crate::walk::{Scatter, Walk};

/// Written once when a walk reaches it, read by every connection.
#[derive(Clone, Debug)]
pub(crate) struct PathVertex {
    pub(crate) vertex: Vertex,
    pub(crate) bsdf: Bsdf,
    /// Local direction to where the subpath came from.
    pub(crate) wo: DVec3,
    /// Local geometric normal.
    pub(crate) ng: DVec3,
    /// The same direction as `wo`, in the world.
    pub(crate) back: DVec3,
    pub(crate) throughput: Spectrum,
    pub(crate) interior: Interior,
    pub(crate) running: Running,
    pub(crate) onward: Onward,
    /// Probability with which roulette has let the subpath come so far.
    pub(crate) survived: f32,
    /// Edges from the subpath's end.
    pub(crate) edges: u32,
    pub(crate) dispersive: bool,
    pub(crate) connectable: bool,
    /// The walk went on from here by a Dirac scattering.
    pub(crate) delta: bool,
}

impl Default for PathVertex {
    /// A slot to write into.
    fn default() -> Self {
        Self {
            vertex: Vertex::default(),
            bsdf: Bsdf::black(),
            wo: DVec3::Z,
            ng: DVec3::Z,
            back: DVec3::Z,
            throughput: Spectrum::ZERO,
            interior: Interior::VACUUM,
            running: Running::default(),
            onward: Onward::UNJOINED,
            survived: 1.0,
            edges: 0,
            dispersive: false,
            connectable: false,
            delta: false,
        }
    }
}

impl PathVertex {
    /// Takes over from a walk that has just reached [`Self::vertex`].
    #[inline]
    pub(super) fn reach(&mut self, walk: &Walk) {
        self.back = -walk.direction;
        self.wo = self.vertex.frame.to_local(self.back);
        self.ng = self.vertex.local_normal();
        self.throughput = walk.throughput;
        self.interior = walk.interior;
        self.survived = walk.survived;
        self.edges = walk.edges;
        self.dispersive = walk.dispersive;
        self.delta = false;
    }

    /// As the walk wants it.
    #[inline]
    pub(super) fn scatter(&self) -> Scatter<'_> {
        Scatter {
            vertex: &self.vertex,
            bsdf: &self.bsdf,
            wo: self.wo,
            ng: self.ng,
        }
    }

    /// Geometric cosine of the edge that led here.
    #[inline]
    pub(super) fn cos_back(&self) -> f64 {
        self.wo.dot(self.ng).abs()
    }

    /// [`Running::rivals`] for a path that goes on from here, where a walk the other way would scatter with density `back`.
    #[inline]
    pub(super) fn rivals(&self, heuristic: super::Heuristic, back: f64) -> f64 {
        (self.running).rivals(heuristic, self.onward.odds(), back)
    }
}
