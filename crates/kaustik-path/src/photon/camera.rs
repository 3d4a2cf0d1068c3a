//! From the camera to the first surface that scatters widely.

use glam::DVec2;
use kaustik_bsdf::{Bsdf, Lobe};
use kaustik_pss::Coordinates;
use kaustik_scene::{Scene, Vertex};
use kaustik_spectrum::Wavelengths;

use super::MeasurementPoints;
use super::Sheet;
use super::narrow::{Part, take};
use super::outline::Outline;
use super::points::Seen;
use crate::walk::Scatter;
use crate::{BuilderSettings, camera_walk};

/// A pixel's footprint grows as one over the cosine under which a surface is seen, up to this one.
const LEAST_COSINE: f64 = 0.01;

/// Leaves measurement points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasurementWalk {
    /// What all builders are told, of which it uses the longest path and the window.
    pub settings: BuilderSettings,
    /// GGX roughness from which on a lobe is wide, in [0, 1].
    pub threshold: f64,
    /// Columns and rows of the image.
    pub pixels: DVec2,
    /// Radius of a point in widths of a square as large as the pixel's footprint: the pixel, projected onto the surface over the
    /// whole length of the path from the eye.
    pub radius: f64,
}

impl MeasurementWalk {
    /// Walks, and adds the point that it ends in, if there is one.
    pub fn trace(
        &self,
        scene: &Scene,
        wavelengths: &Wavelengths,
        u: &mut dyn Coordinates,
        out: &mut MeasurementPoints,
    ) {
        let (mut walk, raster) = camera_walk::start(&self.settings, scene, wavelengths, u);
        let (origin, direction) = (walk.ray.origin.as_dvec3(), walk.direction);
        let mut length = 0.0;
        let (mut vertex, mut bsdf) = (Vertex::default(), Bsdf::black());
        while walk.edges + 1 < self.settings.max_edges {
            let Some(distance) = walk.advance(scene, u, &mut vertex) else {
                return;
            };
            length += distance;
            let scatter = walk.scatter(scene, &vertex, &mut bsdf);
            match take(&mut walk, &scatter, self.threshold, u) {
                Part::Wide(bsdf) => {
                    // What the image shows of one pixel, if nothing on the way spread or gathered the rays.
                    let density =
                        (scene.camera()).raster_density(origin, origin + direction * length);
                    let width = 1.0 / (density * self.pixels.element_product()).sqrt();
                    let cosine = scatter.wo.dot(scatter.ng);
                    // A disc as large as the footprint, which a slant makes long, not wide: one as long as that would blur
                    // over many pixels on either side.
                    let radius = self.radius * width / cosine.abs().max(LEAST_COSINE).sqrt();
                    let (surface, normal) = (&vertex.surface, vertex.normal.as_vec3());
                    let (above, through) = (cosine > 0.0, bsdf.transmits());
                    let world = scene.world();
                    let outline =
                        Outline::look(world, surface, normal, above, through, radius as f32);
                    out.push(Seen {
                        vertex: &vertex,
                        bsdf,
                        wo: scatter.wo,
                        throughput: walk.throughput,
                        dispersive: walk.dispersive,
                        edges: walk.edges,
                        raster,
                        radius,
                        sheet: Sheet::new(scene, &vertex, scatter.bsdf),
                        outline,
                    });
                    return;
                }
                Part::Narrow(narrow) => {
                    let scatter = Scatter {
                        bsdf: &narrow,
                        ..scatter
                    };
                    if walk.bounce(scene, &scatter, u).is_none() || !walk.survives(u) {
                        return;
                    }
                }
            }
        }
    }
}
