//! Starts of chains by path tracing: what a pixel's sample sees.

use glam::DVec2;
use kaustik_bsdf::Lobe;
use kaustik_mcmc::Draws;
use kaustik_scene::EmitterPoint;
use kaustik_spectrum::Wavelengths;

use crate::seed::survives;
use crate::vertex::VertexKind;
use crate::walk::WalkDirection;
use crate::{Path, PathSpace};

/// A path tracer that keeps its paths: a walk from the eye, each of whose vertices is joined to a point of an
/// emitter, and which may run into one.
///
/// Each complete path x of a sample comes with its own weight w f/p, w the balance heuristic between the
/// two ways to make it, so that the sum over a sample's paths of weight times h(x) has the mean
/// of f h. Holds the memory of the walk.
#[derive(Clone, Debug, Default)]
pub struct Tracer {
    /// Vertices from the eye are at its end.
    walk: Path,
    path: Path,
}

impl Tracer {
    /// That has traced nothing.
    pub fn new() -> Self {
        Self::default()
    }

    /// Traces a sample through a raster point (the unit square over the whole image) and tells `found` of each of its
    /// paths, with the weighted density: that of a raster point uniform over the window. Weights are
    /// positive; what is not a number is told as it is. `wavelength_u`: the number in [0, 1) that
    /// the wavelengths are made of. Without `next_event` emitters are found by running into them.
    ///
    /// Tells nothing of paths of fewer than `min_edges`. Where something moves the first number that is drawn
    /// is the time of all of the sample's paths.
    pub fn sample<D: Draws + ?Sized>(
        &mut self,
        space: &PathSpace<'_>,
        (raster, wavelength_u): (DVec2, f64),
        next_event: bool,
        draws: &mut D,
        found: &mut impl FnMut(&Path, f64),
    ) {
        self.walk.time = space.draw_time(draws);
        space.at(self.walk.time, |space| {
            self.trace(space, (raster, wavelength_u), next_event, draws, found);
        });
    }

    /// In a scene that stands at the sample's time.
    fn trace<D: Draws + ?Sized>(
        &mut self,
        space: &PathSpace<'_>,
        (raster, wavelength_u): (DVec2, f64),
        next_event: bool,
        draws: &mut D,
        found: &mut impl FnMut(&Path, f64),
    ) {
        let last = space.settings.max_edges as usize + 1;
        self.walk.wavelength_u = wavelength_u;
        self.walk.wavelengths = Wavelengths::sample(wavelength_u, space.settings.wavelengths);
        // Slot 0 stays free: what is written there is an emitter, and here it is not known yet.
        self.walk.resize(last + 1);
        space.begin_at_lens(&mut self.walk, draws);
        let mut survived = 1.0;
        for i in (1..last).rev() {
            let vertices = last - i;
            let Some(survival) = survives(&self.walk, i + 1, vertices, draws) else {
                return;
            };
            survived *= survival;
            let made = match vertices {
                1 => space.look_through(&mut self.walk, raster, draws),
                _ => space.scatter(&mut self.walk, i + 1, WalkDirection::ToLight, draws),
            };
            if !made {
                return;
            }
            let vertex = self.walk.at(i);
            let escaped = vertex.is_environment();
            if (escaped || space.scene.is_emitter(&vertex.vertex)) && self.hit(space, vertices) {
                self.tell(space, (survived, next_event), found);
            }
            if escaped {
                return;
            }
            let joins = next_event && i > 1 && self.walk.at(i).bsdf.is_connectable();
            if joins && self.join(space, vertices, draws) {
                self.tell(space, (survived, next_event), found);
            }
        }
    }

    /// The path whose emitter the walk has run into after so many edges.
    fn hit(&mut self, space: &PathSpace<'_>, edges: usize) -> bool {
        self.take(edges + 1, 0);
        let first = self.path.at_mut(0);
        first.specular = false;
        if first.kind == VertexKind::Surface {
            first.kind = VertexKind::Emitter(EmitterPoint::Surface);
        }
        space.refresh(&mut self.path, 0) && space.evaluate(&mut self.path)
    }

    /// The path of the walk of so many edges, and one more to an emitter.
    fn join<D: Draws + ?Sized>(
        &mut self,
        space: &PathSpace<'_>,
        edges: usize,
        draws: &mut D,
    ) -> bool {
        self.take(edges + 1, 1);
        let path = &mut self.path;
        space.begin_beside(path, draws) && space.join(path, 0) && space.evaluate(path)
    }

    /// Copies so many vertices from the eye behind `free` ones.
    fn take(&mut self, vertices: usize, free: usize) {
        let Self { walk, path } = self;
        path.resize(vertices + free);
        path.tune(walk);
        (path.raster, path.importance) = (walk.raster, walk.importance);
        path.copy(free, walk, walk.len() - vertices..walk.len());
    }

    fn tell(
        &self,
        space: &PathSpace<'_>,
        (survived, next_event): (f64, bool),
        found: &mut impl FnMut(&Path, f64),
    ) {
        let path = &self.path;
        if path.edges() >= space.settings.min_edges as usize {
            let weight = path.density() / (traced(space, path, next_event) * survived);
            found(path, weight);
        }
    }
}

/// The sum of the densities of the two ways in which a path tracer makes a path.
fn traced(space: &PathSpace<'_>, path: &Path, next_event: bool) -> f64 {
    let steps = 1..path.edges();
    let walk = steps.fold(space.start_at_lens(), |product, i| {
        product * space.step_to_light_pdf(path, i)
    });
    // What is seen without a scattering between is never joined: that would be light tracing.
    let joined = next_event && path.edges() > 1 && !path.is_specular(1);
    let position = if joined {
        space.emitter_point_pdf(path) * space.emitter_odds(path)
    } else {
        0.0
    };
    walk * (space.step_to_light_pdf(path, 0) + position)
}
