use glam::DVec3;
use kaustik_bsdf::{Lobe, Mode};
use kaustik_spectrum::Spectrum;

use super::vertex::PathVertex;

/// The last vertex of a subpath, joined to something.
#[derive(Clone, Copy, Debug)]
pub(super) struct Joined<'a> {
    pub(super) vertex: &'a PathVertex,
    /// Local direction of the join.
    pub(super) wi: DVec3,
    /// What the subpath carries into it.
    pub(super) value: Spectrum,
    /// Densities of `wi` from where the subpath came from, and of the way back. Where the value is zero they mean nothing.
    pub(super) pdfs: [f64; 2],
}

impl<'a> Joined<'a> {
    /// `mode` is that of the subpath.
    #[inline]
    pub(super) fn new(vertex: &'a PathVertex, wi: DVec3, mode: Mode) -> Self {
        let (f, pdfs) = vertex.bsdf.eval_pdfs(vertex.wo, wi, mode);
        Self {
            vertex,
            wi,
            value: vertex.throughput * f,
            pdfs,
        }
    }

    /// Geometric cosine of the join.
    #[inline]
    pub(super) fn cos(&self) -> f64 {
        self.wi.dot(self.vertex.ng).abs()
    }
}
