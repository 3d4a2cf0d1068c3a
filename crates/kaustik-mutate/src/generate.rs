//! Vertices made anew from either end of a path: what all kernels begin with.

use glam::{DVec2, DVec3};
use kaustik_mcmc::Draws;
use kaustik_scene::EmitterPoint;

use crate::vertex::{PathVertex, VertexKind};
use crate::walk::WalkDirection;
use crate::{Path, PathSpace};

impl PathSpace<'_> {
    /// Makes vertices `part`, the first `by_light` of them by a walk with the light, the others by one from
    /// the eye, and joins the two. `false` if that fails, or no light passes.
    pub(crate) fn generate<D: Draws + ?Sized>(
        &self,
        y: &mut Path,
        part: std::ops::Range<usize>,
        by_light: usize,
        draws: &mut D,
    ) -> bool {
        let joint = part.start + by_light;
        debug_assert!(joint < y.len(), "a walk with the light made the lens");
        // An emitter that is only joined is chosen from where that is done, which must be there first.
        let beside = joint == 1 && part.start == 0 && self.scene.chooses_emitters_by_place();
        let walked = if beside { joint } else { part.start };
        for i in walked..joint {
            let made = match i {
                0 => self.begin_at_light(y, draws),
                _ => self.scatter(y, i - 1, WalkDirection::ToEye, draws),
            };
            if !made {
                return false;
            }
        }
        for i in (joint..part.end).rev() {
            let made = match y.len() - 1 - i {
                0 => self.begin_at_lens(y, draws),
                1 => self.leave_lens(y, draws),
                _ => self.scatter(y, i + 1, WalkDirection::ToLight, draws),
            };
            if !made {
                return false;
            }
        }
        if beside && !self.begin_beside(y, draws) {
            return false;
        }
        match joint {
            0 => self.refresh(y, 0),
            _ => self.join(y, joint - 1),
        }
    }

    /// Vertex 0 by emission sampling.
    pub(crate) fn begin_at_light<D: Draws + ?Sized>(&self, y: &mut Path, draws: &mut D) -> bool {
        self.draw_emitter(y.at_mut(0), None, draws)
    }

    /// Vertex 0, to be joined to vertex 1, which is there: by next event, unless that is the lens.
    pub(crate) fn begin_beside<D: Draws + ?Sized>(&self, y: &mut Path, draws: &mut D) -> bool {
        let next = y.at(1);
        let from = (next.kind != VertexKind::Lens).then_some(next.vertex.position);
        self.draw_emitter(y.at_mut(0), from, draws)
    }

    /// A point of an emitter, chosen for a place or for a walk.
    pub(crate) fn draw_emitter<D: Draws + ?Sized>(
        &self,
        vertex: &mut PathVertex,
        from: Option<DVec3>,
        draws: &mut D,
    ) -> bool {
        let draw = |_| draws.uniform();
        let point = match from {
            Some(from) => (self.scene).sample_emitter_point_from(from, draw, &mut vertex.vertex),
            None => self.scene.sample_emitter_point(draw, &mut vertex.vertex),
        };
        let Some(point) = point else {
            return false;
        };
        vertex.kind = VertexKind::Emitter(point);
        vertex.specular = false;
        vertex.dispersive = false;
        vertex.opacity = match point {
            EmitterPoint::Surface if self.scene.has_alpha() => {
                f64::from(self.scene.opacity(&vertex.vertex))
            }
            _ => 1.0,
        };
        true
    }

    /// The last vertex by a fresh point of the lens.
    pub(crate) fn begin_at_lens<D: Draws + ?Sized>(&self, y: &mut Path, draws: &mut D) -> bool {
        let lens = y.at_mut(y.len() - 1);
        lens.kind = VertexKind::Lens;
        lens.specular = false;
        let u = [draws.uniform(), draws.uniform()];
        let ray = self.scene.camera().sample_ray(DVec2::splat(0.5), u);
        lens.vertex.position = ray.origin;
        true
    }

    /// From the lens through a fresh raster point to the next vertex.
    pub(crate) fn leave_lens<D: Draws + ?Sized>(&self, y: &mut Path, draws: &mut D) -> bool {
        let u = DVec2::new(draws.uniform(), draws.uniform());
        self.look_through(y, self.settings.raster(u), draws)
    }

    /// From the lens, at the point where it is, through a raster point to the next vertex.
    pub(crate) fn look_through<D: Draws + ?Sized>(
        &self,
        y: &mut Path,
        raster: DVec2,
        draws: &mut D,
    ) -> bool {
        let n = y.len();
        let lens = y.at_mut(n - 1);
        let ray = self.scene.camera().ray_from(lens.vertex.position, raster);
        lens.vertex.position = ray.origin;
        lens.toward_light = ray.direction;
        self.refresh(y, n - 1) && self.step_to_light(y, n - 2, &ray.ray(), draws)
    }
}
