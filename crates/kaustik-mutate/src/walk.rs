//! Steps along a ray, from one vertex of a path to the next.

use glam::DVec3;
use kaustik_bsdf::{Lobe, Mode};
use kaustik_geometry::Ray;
use kaustik_mcmc::Draws;
use kaustik_scene::{EmitterPoint, Interior, Passed};
use kaustik_spectrum::{Spectrum, Wavelengths};

use crate::vertex::{Edge, PathVertex, VertexKind};
use crate::{Path, PathSpace};

/// Which way a walk runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum WalkDirection {
    /// From vertex `i` to vertex `i - 1`.
    ToLight,
    /// From vertex `i` to vertex `i + 1`.
    ToEye,
}

impl PathSpace<'_> {
    /// The solids beyond a vertex toward `direction` (world).
    #[inline]
    pub(crate) fn beyond(&self, vertex: &PathVertex, direction: DVec3) -> Interior {
        match vertex.kind {
            VertexKind::Surface => {
                let PathVertex { interior, back, .. } = vertex;
                (self.scene).interior_toward(&vertex.vertex, interior, *back, direction)
            }
            VertexKind::Emitter(point) => {
                self.scene
                    .emitter_interior(point, &vertex.vertex, direction)
            }
            VertexKind::Lens => self.scene.camera_interior(),
        }
    }

    /// From vertex `i + 1` along its `toward_light` to what `ray` meets, which becomes vertex `i`: a
    /// surface, which must emit if `i` is 0, or the environment. `false` where there is none.
    pub(crate) fn step_to_light<D: Draws + ?Sized>(
        &self,
        path: &mut Path,
        i: usize,
        ray: &Ray,
        draws: &mut D,
    ) -> bool {
        let wavelengths = path.wavelengths;
        let (slot, from) = path.pair(i);
        let direction = from.toward_light;
        let mut interior = self.beyond(from, direction);
        let start = interior;
        let draw = || draws.uniform();
        let segment =
            (self.scene).advance(ray, &mut interior, &wavelengths, draw, &mut slot.vertex);
        slot.toward_eye = -direction;
        slot.specular = false;
        slot.transmitted = false;
        slot.dispersive = false;
        if segment.escapes() {
            let seen = !self.scene.environment(direction, &wavelengths).is_zero();
            slot.kind = VertexKind::Emitter(EmitterPoint::Environment(direction));
            slot.opacity = 1.0;
            slot.edge = Edge::default();
            if seen && segment.by_chance {
                (slot.edge).dim(self.scene.visibility(ray, &start, &wavelengths));
            }
            return seen;
        }
        let squared = (slot.vertex.position - from.vertex.position).length_squared();
        let parallel = from.kind == VertexKind::Lens && self.scene.camera().is_dirac_direction();
        slot.edge = Edge {
            squared: if parallel { 1.0 } else { squared },
            passed: 1.0,
            transmittance: segment.transmittance,
        };
        self.arrive(slot, interior, -direction);
        if segment.by_chance {
            slot.edge.dim(self.passed(slot, from, &wavelengths));
        }
        if i == 0 {
            slot.kind = VertexKind::Emitter(EmitterPoint::Surface);
            return self.scene.is_emitter(&slot.vertex);
        }
        (self.scene).write_bsdf(&slot.vertex, &wavelengths, &interior, &mut slot.bsdf);
        true
    }

    /// From vertex `i` along its `toward_eye` to the surface that `ray` meets, which becomes vertex
    /// `i + 1`. `false` where there is none.
    pub(crate) fn step_to_eye<D: Draws + ?Sized>(
        &self,
        path: &mut Path,
        i: usize,
        ray: &Ray,
        draws: &mut D,
    ) -> bool {
        let wavelengths = path.wavelengths;
        let (from, slot) = path.pair(i);
        let direction = from.toward_eye;
        let mut interior = self.beyond(from, direction);
        let draw = || draws.uniform();
        let segment =
            (self.scene).advance(ray, &mut interior, &wavelengths, draw, &mut slot.vertex);
        if segment.escapes() {
            return false;
        }
        slot.toward_light = -direction;
        slot.specular = false;
        slot.transmitted = false;
        slot.dispersive = false;
        self.arrive(slot, interior, -direction);
        (self.scene).write_bsdf(&slot.vertex, &wavelengths, &interior, &mut slot.bsdf);
        from.edge = self.edge_from(from, slot, segment.transmittance);
        if segment.by_chance {
            from.edge.dim(self.passed(from, slot, &wavelengths));
        }
        true
    }

    /// The edge from a vertex to the next toward the eye, a surface.
    fn edge_from(&self, from: &PathVertex, to: &PathVertex, transmittance: Spectrum) -> Edge {
        let origin = match from.kind {
            VertexKind::Emitter(EmitterPoint::Environment(_)) => None,
            VertexKind::Emitter(EmitterPoint::Punctual(index)) => {
                self.scene.punctual_position(index)
            }
            _ => Some(from.vertex.position),
        };
        match origin {
            // What comes from infinitely far away is not dimmed.
            None => Edge::default(),
            Some(origin) => Edge {
                squared: (to.vertex.position - origin).length_squared(),
                passed: 1.0,
                transmittance,
            },
        }
    }

    /// What is the same for every surface that a walk finds.
    #[inline]
    fn arrive(&self, slot: &mut PathVertex, interior: Interior, back: DVec3) {
        slot.kind = VertexKind::Surface;
        slot.interior = interior;
        slot.back = back;
        slot.ng = slot.vertex.local_normal();
        slot.opacity = f64::from(self.scene.opacity(&slot.vertex));
    }

    /// What passes between two neighbours; nothing where they do not see each other.
    pub(crate) fn passed(
        &self,
        light: &PathVertex,
        eye: &PathVertex,
        wavelengths: &Wavelengths,
    ) -> Passed {
        let interior = self.interior_between(light, eye);
        (self.scene).visibility(&self.sight(light, eye), &interior, wavelengths)
    }

    /// The solids around the beginning of [`Self::sight`]: where interfaces are hidden, those at its other
    /// end are others.
    pub(crate) fn interior_between(&self, light: &PathVertex, eye: &PathVertex) -> Interior {
        match (eye.kind, light.kind) {
            (VertexKind::Lens, VertexKind::Emitter(EmitterPoint::Environment(_))) => {
                self.scene.camera_interior()
            }
            (VertexKind::Lens, _) => self.beyond(light, light.toward_eye),
            _ => self.beyond(eye, eye.toward_light),
        }
    }

    /// The ray between two neighbours, from the eye's side where that is a surface.
    fn sight(&self, light: &PathVertex, eye: &PathVertex) -> Ray {
        let toward = eye.toward_light.as_vec3();
        let at_lens = eye.kind == VertexKind::Lens;
        match light.kind {
            VertexKind::Emitter(EmitterPoint::Environment(_)) if at_lens => {
                Ray::new(eye.vertex.position.as_vec3(), toward)
            }
            VertexKind::Emitter(EmitterPoint::Environment(_)) => {
                Ray::spawn(&eye.vertex.surface, toward)
            }
            VertexKind::Emitter(EmitterPoint::Punctual(index)) => {
                match self.scene.punctual_position(index) {
                    Some(point) => Ray::towards(&eye.vertex.surface, point.as_vec3()),
                    None => Ray::spawn(&eye.vertex.surface, toward),
                }
            }
            _ if at_lens => Ray::towards(&light.vertex.surface, eye.vertex.position.as_vec3()),
            _ => Ray::between(&eye.vertex.surface, &light.vertex.surface),
        }
    }

    /// Draws how a walk goes on from vertex `i`, and follows it to its neighbour: from the emitter, too, on the way
    /// to the eye.
    pub(crate) fn scatter<D: Draws + ?Sized>(
        &self,
        path: &mut Path,
        i: usize,
        towards: WalkDirection,
        draws: &mut D,
    ) -> bool {
        let from = path.at_mut(i);
        let (choice, u) = (draws.uniform(), [draws.uniform(), draws.uniform()]);
        if let (WalkDirection::ToEye, VertexKind::Emitter(point)) = (towards, from.kind) {
            let (ray, direction) = self.scene.sample_departure(point, &from.vertex, u);
            from.toward_eye = direction;
            return self.leave_emitter(path, &ray, draws);
        }
        let frame = from.vertex.frame;
        let sample = match towards {
            WalkDirection::ToLight => {
                from.wo = frame.to_local(from.toward_eye);
                from.bsdf.sample(from.wo, choice, u, Mode::Radiance)
            }
            WalkDirection::ToEye => {
                from.wi = frame.to_local(from.toward_light);
                from.bsdf.sample(from.wi, choice, u, Mode::Importance)
            }
        };
        let Some(sample) = sample else {
            return false;
        };
        from.specular = sample.delta;
        from.transmitted = sample.transmitted;
        *from.ahead_mut(towards) = frame.to_world(sample.wi);
        self.follow(path, i, towards, draws)
    }

    /// Follows the direction of the surface vertex `i` that leads this way to its neighbour.
    pub(crate) fn follow<D: Draws + ?Sized>(
        &self,
        path: &mut Path,
        i: usize,
        towards: WalkDirection,
        draws: &mut D,
    ) -> bool {
        if !self.refresh(path, i) {
            return false;
        }
        let from = path.at_mut(i);
        let direction = from.ahead_mut(towards).as_vec3();
        let ray = Ray::spawn(&from.vertex.surface, direction);
        match towards {
            WalkDirection::ToLight => self.step_to_light(path, i - 1, &ray, draws),
            WalkDirection::ToEye => self.step_to_eye(path, i, &ray, draws),
        }
    }

    /// The first edge of a walk from the light, along `toward_eye` of vertex 0.
    pub(crate) fn leave_emitter<D: Draws + ?Sized>(
        &self,
        path: &mut Path,
        ray: &Ray,
        draws: &mut D,
    ) -> bool {
        self.step_to_eye(path, 0, ray, draws) && self.refresh(path, 0)
    }
}
