//! Lens and multi-chain perturbations (Veach 1997, 11.4; Batty sec. 3.2).

use glam::DVec2;
use kaustik_bsdf::{Lobe, Mode};
use kaustik_mcmc::Draws;

use crate::density::geometry_to_light;
use crate::factor::{Factor, factor};
use crate::walk::WalkDirection;
use crate::{Path, PathSpace, Radii};

/// Which paths a perturbation from the lens moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Run {
    /// `(L or D) D S* E`, and `L S* E`: the raster point moves.
    Single,
    /// With at least one more `D` that is followed by `S`: the direction there moves as well.
    Multiple,
}

/// Moves the raster point, traces the same string of scatterings again, and joins the first vertex
/// that can be joined to the next one of the path.
#[derive(Clone, Copy, Debug)]
pub struct LensPerturbation<'a> {
    /// Where the paths run.
    pub space: &'a PathSpace<'a>,
    /// Jitter of the raster point, in pixels.
    pub radii: Radii,
    /// Jitter of directions, in radians ([`Run::Multiple`]).
    pub angles: Radii,
    /// Which paths it moves.
    pub run: Run,
}

/// What is traced again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Part {
    /// The last vertex traced.
    last: usize,
    /// Vertices where the direction moves.
    turns: u32,
}

/// The part that is traced again; `None` if no walk from the eye could have made it.
fn part(path: &Path) -> Option<Part> {
    let mut turns = 0;
    for i in (1..path.edges()).rev() {
        if path.is_specular(i) {
            continue;
        }
        if i == 1 || !path.is_specular(i - 1) {
            return Some(Part { last: i, turns });
        }
        turns += 1;
    }
    (path.edges() > 0 && path.at(0).is_hittable()).then_some(Part { last: 0, turns })
}

impl<'a> LensPerturbation<'a> {
    /// One for each [`Run`], in its order.
    pub fn runs(space: &'a PathSpace<'a>, radii: Radii, angles: Radii) -> [Self; 2] {
        [Run::Single, Run::Multiple].map(|run| Self {
            space,
            radii,
            angles,
            run,
        })
    }

    /// Is the path of the kind that this perturbation moves?
    pub fn suits(&self, path: &Path) -> bool {
        part(path).is_some_and(|part| (part.turns > 0) == (self.run == Run::Multiple))
    }

    pub(crate) fn perturb<D: Draws + ?Sized>(
        &self,
        x: &Path,
        y: &mut Path,
        draws: &mut D,
    ) -> Option<f64> {
        let space = self.space;
        let part = part(x).filter(|_| self.suits(x))?;
        let n = x.len();
        y.resize(n);
        y.tune(x);
        y.copy(n - 1, x, n - 1..n);
        let (step, _) = self.radii.step(draws);
        let raster: DVec2 = x.raster + step / space.pixels;
        if !space.serves(raster) {
            return None;
        }
        if !space.look_through(y, raster, draws) {
            return None;
        }
        for i in (part.last + 1..n - 1).rev() {
            self.scatter_alike(x, y, i, draws)?;
        }
        self.conclude(x, y, part.last)
    }

    /// Scatters at vertex `i` as the other path does.
    fn scatter_alike<D: Draws + ?Sized>(
        &self,
        x: &Path,
        y: &mut Path,
        i: usize,
        draws: &mut D,
    ) -> Option<()> {
        let old = x.at(i);
        let vertex = y.at_mut(i);
        vertex.specular = old.specular;
        vertex.transmitted = old.specular && old.transmitted;
        if old.specular {
            let wo = vertex.vertex.frame.to_local(vertex.toward_eye);
            let delta = (vertex.bsdf).delta(wo, vertex.transmitted, Mode::Radiance)?;
            vertex.toward_light = vertex.vertex.frame.to_world(delta.wi);
        } else {
            vertex.toward_light = self.angles.turn(old.toward_light, draws)?.0;
        }
        self.space
            .follow(y, i, WalkDirection::ToLight, draws)
            .then_some(())
    }

    /// Joins what was traced to what is kept; the ratio of the densities back and there.
    fn conclude(&self, x: &Path, y: &mut Path, last: usize) -> Option<f64> {
        let space = self.space;
        if last == 0 {
            if !space.refresh(y, 0) {
                return None;
            }
        } else {
            if !y.at(last).bsdf.is_connectable() {
                return None;
            }
            y.copy(last - 1, x, last - 1..last);
            if !space.join(y, last - 1) {
                return None;
            }
            y.copy(0, x, 0..last - 1);
        }
        if !space.evaluate(y) {
            return None;
        }
        Some(density(space, x, last) / density(space, y, last))
    }
}

/// Density of the part that is traced from the lens up to vertex `last`, but for the jitters, which are symmetric.
pub(crate) fn density(space: &PathSpace<'_>, path: &Path, last: usize) -> f64 {
    let lens = path.at(path.edges());
    let start = space.raster_per_direction(lens.vertex.position, lens.toward_light);
    let start = factor(Factor::Raster, start);
    (last..path.edges()).fold(start, |product, i| {
        // What is seen directly may be an emitter at a place here, and one infinitely far away there.
        let unit = space.unit_of(path.at(i + 1), path.at(i));
        product * geometry_to_light(path, i) * unit
    })
}
