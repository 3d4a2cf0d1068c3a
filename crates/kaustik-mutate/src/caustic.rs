//! Caustic perturbation (Veach 1997, 11.4; Batty sec. 3.2).

use glam::DVec3;
use kaustik_bsdf::{Frame, Lobe, Mode};
use kaustik_geometry::Ray;
use kaustik_mcmc::Draws;
use kaustik_scene::EmitterPoint;

use crate::density::{bending, geometry_to_eye};
use crate::factor::{Factor, factor};
use crate::vertex::VertexKind;
use crate::walk::WalkDirection;
use crate::{Path, PathSpace, Radii};

/// Moves the direction in which light leaves the last vertex but one that can be joined, traces the same
/// string of scatterings toward the eye, and joins the end to the lens: `(L or D) S* D E`.
///
/// The size of the jitter is that of pixels where the path is seen, so that it is not symmetric.
///
/// Two of Cline's rules apply: rule 2 at the vertex where the direction moves (an emitter, or
/// one that scatters), whose cosine is left over once the density is per solid angle, and rule
/// 5 at the vertex that is joined to the lens. Batty's report names rule 5 alone. Rule 3 does
/// not apply: the edge to the light is kept, and nothing is joined there.
#[derive(Clone, Copy, Debug)]
pub struct CausticPerturbation<'a> {
    /// Where the paths run.
    pub space: &'a PathSpace<'a>,
    /// Jitter in pixels.
    pub radii: Radii,
}

/// Where the direction moves: the vertex that the traced part leaves.
pub(crate) fn pivot(path: &Path) -> Option<usize> {
    if path.edges() < 2 || path.is_specular(path.edges() - 1) {
        return None;
    }
    (0..path.edges() - 1).rev().find(|&i| !path.is_specular(i))
}

impl CausticPerturbation<'_> {
    /// Is the path of the kind that this perturbation moves?
    pub fn suits(&self, path: &Path) -> bool {
        pivot(path).is_some()
    }

    /// Sizes of the jitter at the pivot: angles, or lengths where light comes from infinitely far away.
    fn sizes(&self, path: &Path, pivot: usize) -> Radii {
        let eye = path.edges();
        let length = |i: usize| path.at(i).edge.squared.sqrt();
        let footprint = self.space.footprint(length(eye - 1));
        if self.space.is_endless(path.at(pivot)) {
            return self.radii.times(footprint);
        }
        let chain: f64 = (pivot..eye - 1).map(length).sum();
        self.radii.times(footprint / chain)
    }

    pub(crate) fn perturb<D: Draws + ?Sized>(
        &self,
        x: &Path,
        y: &mut Path,
        draws: &mut D,
    ) -> Option<f64> {
        let space = self.space;
        let pivot = pivot(x)?;
        let (n, sizes) = (x.len(), self.sizes(x, pivot));
        y.resize(n);
        y.tune(x);
        y.copy(pivot, x, pivot..pivot + 1);
        y.copy(n - 1, x, n - 1..n);
        let size = self.move_pivot(x, y, pivot, sizes, draws)?;
        for i in pivot + 1..n - 2 {
            self.scatter_alike(x, y, i, draws)?;
        }
        if !(y.at(n - 2).bsdf.is_connectable() && space.join(y, n - 2)) {
            return None;
        }
        // Both limits scale by the same factor, so that ln(most / least), and with it the density
        // of the size, is the same there and back.
        let back = f64::from(u8::from(self.sizes(y, pivot).holds(size)));
        let back = factor(Factor::Range, back);
        if back == 0.0 {
            return None;
        }
        y.copy(0, x, 0..pivot);
        if !space.evaluate(y) {
            return None;
        }
        Some(back * density(x, pivot) / density(y, pivot))
    }

    /// Moves the direction at the pivot, or parallel light, and follows it to the next vertex. Returns the size of the
    /// jitter; `None` if nothing is met there.
    #[inline]
    fn move_pivot<D: Draws + ?Sized>(
        &self,
        x: &Path,
        y: &mut Path,
        pivot: usize,
        sizes: Radii,
        draws: &mut D,
    ) -> Option<f64> {
        if self.space.is_endless(x.at(pivot)) {
            let (ray, size) = self.shift(x, sizes, draws);
            return self.space.leave_emitter(y, &ray, draws).then_some(size);
        }
        let (direction, size) = sizes.turn(x.at(pivot).toward_eye, draws)?;
        y.at_mut(pivot).toward_eye = direction;
        self.leave(y, pivot, draws).then_some(size)
    }

    /// Scatters at vertex `i` of `y` as `x` does, into a Dirac direction, and follows it to the next vertex.
    #[inline]
    fn scatter_alike<D: Draws + ?Sized>(
        &self,
        x: &Path,
        y: &mut Path,
        i: usize,
        draws: &mut D,
    ) -> Option<()> {
        let vertex = y.at_mut(i);
        (vertex.specular, vertex.transmitted) = (true, x.at(i).transmitted);
        let wi = vertex.vertex.frame.to_local(vertex.toward_light);
        let delta = (vertex.bsdf).delta(wi, vertex.transmitted, Mode::Importance)?;
        vertex.toward_eye = vertex.vertex.frame.to_world(delta.wi);
        (self.space.follow(y, i, WalkDirection::ToEye, draws)).then_some(())
    }

    /// The first ray of parallel light, moved sideways.
    fn shift<D: Draws + ?Sized>(&self, x: &Path, sizes: Radii, draws: &mut D) -> (Ray, f64) {
        let direction = x.at(0).toward_eye;
        let (step, size) = sizes.step(draws);
        let (_, radius) = self.space.scene.bounding_sphere();
        let across = Frame::from_z(direction).to_world(DVec3::new(step.x, step.y, 0.0));
        let origin = x.at(1).vertex.position + across - direction * (2.0 * radius);
        (Ray::new(origin.as_vec3(), direction.as_vec3()), size)
    }

    /// Follows the moved direction from the pivot.
    fn leave<D: Draws + ?Sized>(&self, y: &mut Path, pivot: usize, draws: &mut D) -> bool {
        let from = y.at(pivot);
        let direction = from.toward_eye.as_vec3();
        match from.kind {
            VertexKind::Emitter(EmitterPoint::Punctual(index)) => {
                let origin = self
                    .space
                    .scene
                    .punctual_position(index)
                    .unwrap_or_default();
                let ray = Ray::new(origin.as_vec3(), direction);
                self.space.leave_emitter(y, &ray, draws)
            }
            VertexKind::Emitter(_) => {
                let ray = Ray::spawn(&from.vertex.surface, direction);
                self.space.leave_emitter(y, &ray, draws)
            }
            VertexKind::Surface | VertexKind::Lens => {
                self.space.follow(y, pivot, WalkDirection::ToEye, draws)
            }
        }
    }
}

/// Density of the traced part, but for the jitter.
fn density(path: &Path, pivot: usize) -> f64 {
    (pivot + 1..path.edges()).fold(1.0, |product, i| {
        let from = path.at(i - 1);
        let bent = if from.specular { bending(from) } else { 1.0 };
        product * bent * geometry_to_eye(path, i)
    })
}
