//! Kernels keep the paths' measure, and densities are what the maps say.

mod invariance;
mod jacobian;
mod printed;
mod seeds;
mod stage;

use glam::DVec2;
use kaustik_path::{BuilderSettings, ScalarTarget};
use kaustik_scene::Scene;

use crate::PathSpace;

/// Paths of at most so many edges.
fn space(scene: &Scene, max_edges: u32) -> PathSpace<'_> {
    PathSpace {
        scene,
        settings: BuilderSettings {
            max_edges,
            ..BuilderSettings::default()
        },
        target: ScalarTarget::Xyz,
        pixels: DVec2::splat(16.0),
    }
}
