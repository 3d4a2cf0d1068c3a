//! Kernels keep the paths' measure, and densities are what the maps say.

mod builtin;
mod faults;
mod invariance;
mod jacobian;
mod kinds;
mod printed;
mod rules;
mod seeds;
pub(crate) mod stage;
mod written;

use glam::DVec2;
use kaustik_mcmc::Draws;
use kaustik_path::{BuilderSettings, ScalarTarget};
use kaustik_pss::{Coordinates, Stream};
use kaustik_scene::Scene;

use crate::PathSpace;

/// Paths of at most so many edges, through a part of the raster.
pub(crate) fn space(scene: &Scene, max_edges: u32) -> PathSpace<'_> {
    PathSpace {
        scene,
        settings: BuilderSettings {
            max_edges,
            window_min: DVec2::new(0.2, 0.1),
            window_max: DVec2::new(0.9, 0.9),
            ..BuilderSettings::default()
        },
        target: ScalarTarget::Xyz,
        pixels: DVec2::splat(16.0),
    }
}

/// Every coordinate from a generator; a builder asks for each once.
struct Fresh<'a, D>(&'a mut D);

impl<D: Draws> Coordinates for Fresh<'_, D> {
    fn get(&mut self, _: Stream, _: u32) -> f64 {
        self.0.uniform()
    }
}
