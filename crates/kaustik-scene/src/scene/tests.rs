//! What rays meet: solids within solids, partly transparent surfaces, panes, bent normals.

mod alpha;
mod normals;
mod panes;
mod reflectances;
mod solids;
mod surroundings;
mod tangents;

use glam::{DVec3, Vec3};
use kaustik_geometry::Ray;
use kaustik_spectrum::Spectrum;

use crate::testing::wavelengths;
use crate::{Interior, Scene, Segment, Vertex};

/// The next surface along a ray, with one number for what is partly transparent.
fn meet(scene: &Scene, ray: &Ray, interior: &mut Interior, u: f64) -> Option<(Vertex, Segment)> {
    let mut vertex = Vertex::default();
    let segment = scene.advance(ray, interior, &wavelengths(), || u, &mut vertex);
    (!segment.escapes()).then_some((vertex, segment))
}

/// What passes a segment, the same at all wavelengths.
fn passed_share(scene: &Scene, ray: &Ray, interior: &Interior) -> f32 {
    let share = scene.visibility(ray, interior, &wavelengths()).share;
    assert_eq!(share, Spectrum::splat(share.hero()));
    share.hero()
}

/// The next surface from `origin` along `direction`, from outside of all solids.
fn look(scene: &Scene, origin: Vec3, direction: Vec3) -> Vertex {
    let ray = Ray::new(origin, direction);
    let (vertex, _) = meet(scene, &ray, &mut { Interior::VACUUM }, 0.5).expect("a surface");
    vertex
}

fn close(a: DVec3, b: DVec3) -> bool {
    (a - b).length() < 1e-6
}
