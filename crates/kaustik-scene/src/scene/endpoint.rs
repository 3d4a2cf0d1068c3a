//! The first vertex of a light path, and what a path that is kept must know of the scene.

use glam::DVec3;
use kaustik_geometry::Ray;
use kaustik_spectrum::Wavelengths;

use super::Scene;
use crate::emitter::{EmitterPoint, PunctualView};
use crate::{Interior, Vertex};

impl Scene {
    /// A point of an emitter, by the law of [`Scene::sample_emission`]: its density is [`EmissionPdf::position`](crate::EmissionPdf).
    /// One on a surface is written into `vertex`. `u(i)` gives coordinate `i` of three.
    pub fn sample_emitter_point(
        &self,
        u: impl FnMut(u32) -> f64,
        vertex: &mut Vertex,
    ) -> Option<EmitterPoint> {
        self.emitters.sample_point(&self.matter, None, u, vertex)
    }

    /// The same by the choice of [`Scene::sample_direct`] at `from`: the density is [`Scene::next_event_odds`] times that.
    pub fn sample_emitter_point_from(
        &self,
        from: DVec3,
        u: impl FnMut(u32) -> f64,
        vertex: &mut Vertex,
    ) -> Option<EmitterPoint> {
        (self.emitters).sample_point(&self.matter, Some(from), u, vertex)
    }

    /// Does next event choose emitters by the point that asks? Where it does not, [`Scene::next_event_odds`] are 1.
    #[inline]
    pub fn chooses_emitters_by_place(&self) -> bool {
        self.emitters.choose_by_place()
    }

    /// A direction of emission from a point, with the ray to follow: its density is
    /// [`EmissionPdf::direction`](crate::EmissionPdf).
    pub fn sample_departure(
        &self,
        point: EmitterPoint,
        vertex: &Vertex,
        u: [f64; 2],
    ) -> (Ray, DVec3) {
        self.emitters
            .sample_departure(&self.matter, point, vertex, u)
    }

    /// The solids around a point of an emitter, on the side of `direction` (world).
    pub fn emitter_interior(
        &self,
        point: EmitterPoint,
        vertex: &Vertex,
        direction: DVec3,
    ) -> Interior {
        self.emitters
            .point_interior(&self.matter, point, vertex, direction)
    }

    /// A punctual light as `position` receives it.
    pub fn punctual_view(
        &self,
        index: u32,
        position: DVec3,
        wavelengths: &Wavelengths,
    ) -> PunctualView {
        self.emitters
            .punctual_view(&self.matter, index, position, wavelengths)
    }

    /// Where a punctual light is; `None` if infinitely far away.
    pub fn punctual_position(&self, index: u32) -> Option<DVec3> {
        self.emitters.punctual_position(&self.matter, index)
    }

    /// Can any ray pass any surface because of its alpha?
    #[inline]
    pub fn has_alpha(&self) -> bool {
        self.matter.has_alpha
    }

    /// Can any ray pass any surface because that is a smooth pane?
    #[inline]
    pub fn has_panes(&self) -> bool {
        self.matter.has_panes
    }

    /// May rays pass its surface somewhere, because of alpha or because it is a smooth pane?
    #[inline]
    pub fn is_passed(&self, vertex: &Vertex) -> bool {
        let material = || self.matter.material(vertex.material);
        self.matter.has_alpha && material().has_alpha()
            || self.matter.has_panes && material().is_pane()
    }

    /// Share of the surface that is there at this point: its alpha.
    #[inline]
    pub fn opacity(&self, vertex: &Vertex) -> f32 {
        if self.matter.has_alpha {
            self.matter.coverage(vertex.material, &vertex.surface)
        } else {
            1.0
        }
    }

    /// Is there such a point, of a triangle that is there and with its material, within solids that are there? Of
    /// vertices that were kept outside, before anything is asked about them.
    pub fn has_vertex(&self, vertex: &Vertex, interior: &Interior) -> bool {
        let matter = &self.matter;
        let has_material = |index: u32| (index as usize) < matter.materials.len();
        matter.material_of.get(vertex.instance as usize) == Some(&vertex.material)
            && (vertex.primitive as usize) < matter.world.mesh_of(vertex.instance).triangle_count()
            && interior.solids().iter().all(|&solid| has_material(solid))
    }

    /// Is there such an emitter? `vertex` is where one on a surface lies.
    pub fn has_emitter(&self, point: EmitterPoint, vertex: &Vertex) -> bool {
        match point {
            EmitterPoint::Surface => {
                self.has_vertex(vertex, &Interior::VACUUM) && self.is_emitter(vertex)
            }
            EmitterPoint::Punctual(index) => self.emitters.has_punctual(index),
            EmitterPoint::Environment(_) => self.emitters.environment().is_some(),
        }
    }

    /// Does the surface emit toward any side?
    pub fn is_emitter(&self, vertex: &Vertex) -> bool {
        self.matter.material(vertex.material).is_emissive()
    }
}
