//! What a path brings to the image.

use kaustik_bsdf::{Lobe, Mode, shading};
use kaustik_scene::EmitterPoint;
use kaustik_spectrum::Xyz;

use crate::vertex::{PathVertex, VertexKind};
use crate::vertices::Vertices;
use crate::{Path, PathSpace};

/// Below it a product is scaled up, above its inverse down: single precision ends at 1e-38 and
/// 3e38, and a glossy scattering alone may bring 1e5.
const SMALL: f32 = 1e-12;

impl PathSpace<'_> {
    /// Works out vertex `i` for the directions that it now has; `false` if no light passes.
    pub(crate) fn refresh(&self, path: &mut Path, i: usize) -> bool {
        match path.at(i).kind {
            // A walk that has left the scene too early ends in an emitter, too.
            VertexKind::Emitter(_) => i == 0 && self.emit(path),
            VertexKind::Lens => self.look(path, i),
            VertexKind::Surface => scatter(path.at_mut(i)),
        }
    }

    /// Vertex 0 emits toward the next.
    fn emit(&self, path: &mut Path) -> bool {
        let wavelengths = path.wavelengths;
        let (vertex, next) = path.pair(0);
        vertex.cos_eye = 1.0;
        vertex.value = match vertex.kind {
            VertexKind::Emitter(EmitterPoint::Surface) => {
                vertex.cos_eye = vertex.vertex.normal.dot(vertex.toward_eye).abs();
                (self.scene).emitted(&vertex.vertex, vertex.toward_eye, &wavelengths)
            }
            VertexKind::Emitter(EmitterPoint::Punctual(index)) => {
                let view = (self.scene).punctual_view(index, next.vertex.position, &wavelengths);
                view.intensity
            }
            VertexKind::Emitter(EmitterPoint::Environment(toward)) => {
                self.scene.environment(toward, &wavelengths)
            }
            VertexKind::Surface | VertexKind::Lens => return false,
        };
        !vertex.value.is_zero()
    }

    /// The lens, vertex `i`, sees along its `toward_light`.
    fn look(&self, path: &mut Path, i: usize) -> bool {
        let camera = self.scene.camera();
        let lens = path.at_mut(i);
        let direction = lens.toward_light;
        let parallel = camera.is_dirac_direction();
        let cos = if parallel {
            1.0
        } else {
            camera.forward().dot(direction)
        };
        lens.cos_light = cos;
        let per_direction = self.raster_per_direction(lens.vertex.position, direction);
        let Some(raster) = camera.raster_of(lens.vertex.position, direction) else {
            return false;
        };
        path.raster = raster;
        path.importance = self.lens_pdf() * per_direction / cos;
        path.importance > 0.0 && self.serves(raster)
    }

    /// Sums up the path from its vertices and edges; `false` if it brings nothing. A density that is not a
    /// number is left for the chain to count.
    pub(crate) fn evaluate(&self, path: &mut Path) -> bool {
        if path.edges() < self.settings.min_edges as usize
            || !self.admits((1..path.edges()).map(|i| path.is_specular(i)))
        {
            return false;
        }
        let (density, colour) = self.light_of(path, path.importance);
        (path.density, path.colour) = (density, colour);
        density > 0.0 || density.is_nan()
    }

    /// The density of a path, seen with this importance, and its colour.
    #[inline]
    pub(crate) fn light_of(&self, path: &impl Vertices, importance: f64) -> (f64, Xyz) {
        let mut scale = importance;
        let mut value = path.at(0).value;
        let mut dispersive = false;
        let unit = self.unit_area();
        if self.is_point(path.at(0)) {
            // It has no area, but a distance like all others: one unit too many in what follows.
            scale /= unit;
        }
        for i in 0..path.len() - 1 {
            let (vertex, next) = (path.at(i), path.at(i + 1));
            let edge = &vertex.edge;
            if i > 0 {
                value *= vertex.value;
                dispersive |= vertex.dispersive;
            }
            value *= edge.transmittance;
            scale *= edge.passed * vertex.opacity;
            if !vertex.specular && !next.specular {
                scale *= vertex.cos_eye * next.cos_light / edge.squared;
                scale *= if self.is_endless(vertex) { 1.0 } else { unit };
            }
            if value.max() < SMALL {
                value *= 1.0 / SMALL;
                scale *= f64::from(SMALL);
            }
            // A lamp may be as bright as numbers go. What is infinite stays so, and is counted.
            while value.max() > 1.0 / SMALL && value.max().is_finite() {
                value *= SMALL;
                scale *= 1.0 / f64::from(SMALL);
            }
        }
        let xyz = if dispersive {
            path.wavelengths().hero_to_xyz(value)
        } else {
            path.wavelengths().to_xyz(value)
        };
        let scalar = self.target.of(xyz);
        (scalar * scale, xyz * (1.0 / scalar) as f32)
    }
}

/// Scattering at a surface between its two directions.
fn scatter(vertex: &mut PathVertex) -> bool {
    vertex.wi = vertex.vertex.frame.to_local(vertex.toward_light);
    vertex.wo = vertex.vertex.frame.to_local(vertex.toward_eye);
    let PathVertex { wi, wo, ng, .. } = *vertex;
    vertex.cos_light = wi.dot(ng).abs();
    vertex.cos_eye = wo.dot(ng).abs();
    let factor = shading::connection_factor(wo, wi, ng);
    if factor == 0.0 {
        return false;
    }
    if vertex.specular {
        let Some(delta) = vertex.bsdf.delta(wo, vertex.transmitted, Mode::Radiance) else {
            return false;
        };
        vertex.value = delta.share;
        vertex.dispersive = delta.dispersive;
    } else {
        vertex.value = vertex.bsdf.eval(wo, wi, Mode::Radiance) * factor as f32;
        vertex.dispersive = vertex.bsdf.dispersive_between(wo, wi);
    }
    !vertex.value.is_zero()
}
