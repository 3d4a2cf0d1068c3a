//! Joining two vertices of a path that were not neighbours before.

use glam::DVec3;
use kaustik_scene::EmitterPoint;
use kaustik_spectrum::{Spectrum, Wavelengths};

use crate::vertex::{Edge, PathVertex, VertexKind};
use crate::{Path, PathSpace};

impl PathSpace<'_> {
    /// Makes vertices `i` and `i + 1`, of which everything else is known, neighbours. `false` if no
    /// light passes between them.
    pub(crate) fn join(&self, path: &mut Path, i: usize) -> bool {
        let Some((direction, squared)) = self.between(path, i) else {
            return false;
        };
        let (light, eye) = path.pair(i);
        light.toward_eye = -direction;
        eye.toward_light = direction;
        light.edge.squared = squared;
        light.specular = false;
        eye.specular = false;
        self.refresh(path, i) && self.refresh(path, i + 1) && self.see(path, i)
    }

    /// Unit direction from vertex `i + 1` to vertex `i`, and the square of the distance. Puts a lens of
    /// parallel rays where it sees vertex `i`.
    fn between(&self, path: &mut Path, i: usize) -> Option<(DVec3, f64)> {
        let wavelengths = path.wavelengths;
        let (light, eye) = path.pair(i);
        let last = eye.kind == VertexKind::Lens;
        let camera = self.scene.camera();
        match light.kind {
            // No walk from the eye finds such a light, and it has no size in the picture.
            VertexKind::Emitter(EmitterPoint::Punctual(_)) if last => None,
            VertexKind::Emitter(EmitterPoint::Punctual(index)) => {
                let view = self
                    .scene
                    .punctual_view(index, eye.vertex.position, &wavelengths);
                (view.squared > 0.0).then_some((view.toward, view.squared))
            }
            VertexKind::Emitter(EmitterPoint::Environment(_))
                if last && camera.is_dirac_direction() =>
            {
                None
            }
            VertexKind::Emitter(EmitterPoint::Environment(toward)) => Some((toward, 1.0)),
            _ if last && camera.is_dirac_direction() => {
                let sample = camera.sample_lens(light.vertex.position, [0.5; 2])?;
                eye.vertex.position = sample.position;
                Some((-sample.direction, 1.0))
            }
            _ => {
                let along = light.vertex.position - eye.vertex.position;
                let squared = along.length_squared();
                (squared > 0.0).then(|| (along / squared.sqrt(), squared))
            }
        }
    }

    /// Looks along the edge from vertex `i` to vertex `i + 1`.
    fn see(&self, path: &mut Path, i: usize) -> bool {
        let wavelengths = path.wavelengths;
        let (light, eye) = path.pair(i);
        let passed = self.passed(light, eye, &wavelengths);
        light.edge = Edge {
            squared: light.edge.squared,
            passed: 1.0,
            transmittance: self.transmittance_between(light, eye, &wavelengths),
        };
        light.edge.dim(passed);
        !passed.is_nothing()
    }

    /// Share of light left by what fills the edge between two neighbours; all of it where it comes
    /// from infinitely far away.
    pub(crate) fn transmittance_between(
        &self,
        light: &PathVertex,
        eye: &PathVertex,
        wavelengths: &Wavelengths,
    ) -> Spectrum {
        if self.is_endless(light) {
            return Spectrum::ONE;
        }
        // The square that an edge to the lens keeps is that of its geometry term: 1 for parallel rays.
        let distance = if eye.kind == VertexKind::Lens {
            (light.vertex.position - eye.vertex.position).length()
        } else {
            light.edge.squared.sqrt()
        };
        let interior = self.interior_between(light, eye);
        (self.scene).transmittance(&interior, wavelengths, distance)
    }

    /// Is it an emitter without extent at a place?
    #[inline]
    pub(crate) fn is_point(&self, vertex: &PathVertex) -> bool {
        matches!(vertex.kind, VertexKind::Emitter(EmitterPoint::Punctual(_)))
            && !self.is_endless(vertex)
    }

    /// Does the edge from here to the eye come from infinitely far away?
    pub(crate) fn is_endless(&self, light: &crate::vertex::PathVertex) -> bool {
        match light.kind {
            VertexKind::Emitter(EmitterPoint::Environment(_)) => true,
            VertexKind::Emitter(EmitterPoint::Punctual(index)) => {
                self.scene.punctual_position(index).is_none()
            }
            _ => false,
        }
    }
}
