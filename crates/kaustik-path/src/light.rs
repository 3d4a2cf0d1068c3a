//! Light tracing: walks from the emitters, every vertex joined to the lens.

use glam::DVec3;
use kaustik_bsdf::{Bsdf, Lobe, Mode, shading};
use kaustik_geometry::Ray;
use kaustik_pss::{Coordinates, Stream};
use kaustik_scene::camera::LensSample;
use kaustik_scene::{AreaSample, EmissionSample, Scene, Vertex};
use kaustik_spectrum::Wavelengths;

use crate::contributions::colour;
use crate::instant::at_its_time;
use crate::shadow::Shadow;
use crate::trace::{Event, note};
use crate::walk::{Scatter, Walk};
use crate::{BuilderSettings, Class, Contributions, PathBuilder, layout};

/// Walks from the emitters. Strategy t = 1 for every vertex, and (1, 1), the emitter itself
/// joined to the lens, because a light tracer has no other way to show it.
/// What is seen in Dirac surfaces and the environment itself stay dark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightTracing {
    /// What all builders are told.
    pub settings: BuilderSettings,
}

impl PathBuilder for LightTracing {
    fn build(&self, scene: &Scene, u: &mut dyn Coordinates, out: &mut Contributions) {
        out.clear();
        let sampling = self.settings.wavelengths;
        let wavelengths = Wavelengths::sample(u.get(Stream::Wavelength, 0), sampling);
        at_its_time(scene, u, |scene, u| self.trace(scene, &wavelengths, u, out));
    }
}

impl LightTracing {
    fn trace(
        &self,
        scene: &Scene,
        wavelengths: &Wavelengths,
        u: &mut dyn Coordinates,
        out: &mut Contributions,
    ) {
        let emission = scene.sample_emission(wavelengths, |i| u.get(Stream::Light, i));
        let Some(emission) = emission else { return };
        if let Some(area) = &emission.area
            && self.settings.min_edges <= 1
        {
            self.join_emitter(scene, area, wavelengths, u, out);
        }
        let mut walk = Walk::from_emitter(&emission, emission.weight, wavelengths);
        self.follow(scene, &emission, &mut walk, u, out);
        out.count_walk(walk.edges);
    }

    /// A splat's scale: one over the area of the window, from which other builders draw the raster.
    fn scale(&self) -> f64 {
        self.settings.raster_pdf()
    }

    fn follow(
        &self,
        scene: &Scene,
        emission: &EmissionSample,
        walk: &mut Walk<'_>,
        u: &mut dyn Coordinates,
        out: &mut Contributions,
    ) {
        let (mut vertex, mut bsdf) = (Vertex::default(), Bsdf::black());
        while walk.edges + 1 < self.settings.max_edges && !walk.throughput.is_zero() {
            let Some(distance) = walk.advance(scene, u, &mut vertex) else {
                return;
            };
            if walk.edges == 1 {
                walk.throughput *= scene.fading(emission, distance);
            }
            let scatter = walk.scatter(scene, &vertex, &mut bsdf);
            if walk.edges + 1 >= self.settings.min_edges {
                self.join(scene, walk, &scatter, u, out);
            }
            if walk.bounce(scene, &scatter, u).is_none() || !walk.survives(u) {
                return;
            }
        }
    }

    /// Joins the vertex just reached to a point of the lens.
    fn join(
        &self,
        scene: &Scene,
        walk: &Walk<'_>,
        scatter: &Scatter<'_>,
        u: &mut dyn Coordinates,
        out: &mut Contributions,
    ) {
        if !scatter.bsdf.is_connectable() {
            return;
        }
        let vertex = scatter.vertex;
        let lens = find_lens(&self.settings, scene, vertex.position, walk.edges, u);
        let Some(lens) = lens else { return };
        let wi = vertex.frame.to_local(lens.direction);
        let factor = shading::connection_factor(wi, scatter.wo, scatter.ng);
        if factor == 0.0 {
            return;
        }
        let f = scatter.bsdf.eval(scatter.wo, wi, Mode::Importance);
        let geometry = factor * wi.dot(scatter.ng).abs() * lens.importance * self.scale();
        let mut value = walk.throughput * f * geometry as f32;
        if value.is_zero() {
            return;
        }
        note(|| Event::Join {
            s: walk.edges + 1,
            t: 1,
            points: Some([vertex.position, lens.position]),
            weight: 1.0,
            value,
        });
        let back = -walk.direction;
        let shadow = Shadow {
            ray: Ray::towards(&vertex.surface, lens.position.as_vec3()),
            interior: scene.interior_toward(vertex, &walk.interior, back, lens.direction),
            distance: lens.distance,
        };
        out.count_shadow();
        if !shadow.dim(scene, walk.wavelengths, &mut value) {
            return;
        }
        let dispersive = walk.dispersive || scatter.bsdf.dispersive_between(scatter.wo, wi);
        let xyz = colour(value, dispersive, walk.wavelengths);
        out.push(lens.raster, xyz, Class::L4);
    }

    /// Strategy (1, 1): the emitter seen directly.
    fn join_emitter(
        &self,
        scene: &Scene,
        area: &AreaSample,
        wavelengths: &Wavelengths,
        u: &mut dyn Coordinates,
        out: &mut Contributions,
    ) {
        let position = area.surface.position.as_dvec3();
        let lens = find_lens(&self.settings, scene, position, 0, u);
        let Some(lens) = lens else { return };
        let radiance = scene.area_radiance(area, lens.direction, wavelengths);
        let cos = area
            .surface
            .geometric_normal
            .as_dvec3()
            .dot(lens.direction)
            .abs();
        let geometry = area.weight * cos * lens.importance * self.scale();
        let mut value = radiance * geometry as f32;
        if value.is_zero() {
            return;
        }
        note(|| Event::Join {
            s: 1,
            t: 1,
            points: Some([position, lens.position]),
            weight: 1.0,
            value,
        });
        let shadow = Shadow {
            ray: Ray::towards(&area.surface, lens.position.as_vec3()),
            interior: scene.area_interior(area, lens.direction),
            distance: lens.distance,
        };
        out.count_shadow();
        if !shadow.dim(scene, wavelengths, &mut value) {
            return;
        }
        out.push(lens.raster, wavelengths.to_xyz(value), Class::L4);
    }
}

/// Draws a point of the lens for the vertex at `position`, after `edges` edges; `None` if the window does not show it
/// from there.
#[inline]
pub(crate) fn find_lens(
    settings: &BuilderSettings,
    scene: &Scene,
    position: DVec3,
    edges: u32,
    u: &mut dyn Coordinates,
) -> Option<LensSample> {
    let lens = lens_coordinates(scene, edges, u);
    let lens = scene.camera().sample_lens(position, lens)?;
    settings.serves(lens.raster).then_some(lens)
}

/// The lens point for the vertex after `edges` edges; a pinhole asks for nothing.
fn lens_coordinates(scene: &Scene, edges: u32, u: &mut dyn Coordinates) -> [f64; 2] {
    if !scene.camera().has_aperture() {
        return [0.5; 2];
    }
    [0, 1].map(|i| u.get(Stream::Connection, layout::lens(edges) + i))
}
