//! A path traced again from the lens with the same string of scatterings, at its time or another one.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use kaustik_bsdf::{Frame, Lobe, Mode};
use kaustik_geometry::World;
use kaustik_mcmc::{Draws, Mutation, Uniform};
use kaustik_scene::EmitterPoint;

use crate::factor::{Factor, factor};
use crate::lens::density;
use crate::vertex::{PathVertex, VertexKind};
use crate::walk::WalkDirection;
use crate::{Path, PathSpace};

/// From a path to one whose wavelengths and time are given.
///
/// Variables are those of [`EveryPerturbation`](crate::EveryPerturbation).
pub(crate) struct Retrace<'a> {
    /// Where the old path runs: at its time.
    pub(crate) from: &'a PathSpace<'a>,
    /// Where the new one does.
    pub(crate) to: &'a PathSpace<'a>,
    /// How a variable moves; `None`: not at all.
    pub(crate) step: Option<Uniform>,
}

/// The last vertex that is traced from the eye: 0 where the emitter is found so, else 1.
fn last(path: &Path) -> usize {
    let first = path.at(0);
    let joined = path.edges() > 1 && !path.is_specular(1) && !first.is_environment();
    usize::from(joined)
}

/// Can the path be traced again so?
pub(crate) fn suits(path: &Path) -> bool {
    path.edges() > 0 && (path.at(0).is_hittable() || last(path) > 0)
}

impl Retrace<'_> {
    /// Makes the new path, whose wavelengths and time are there, of the old one, which suits. Returns the ratio of the
    /// densities back and there, but for those of wavelengths and time.
    pub(crate) fn trace<D: Draws + ?Sized>(
        &self,
        x: &Path,
        y: &mut Path,
        draws: &mut D,
    ) -> Option<f64> {
        let (space, n, last) = (self.to, x.len(), last(x));
        y.resize(n);
        self.leave_lens(x, y, draws)?;
        for i in (last + 1..n - 1).rev() {
            self.scatter(x.at(i), y.at_mut(i), draws)?;
            if !space.follow(y, i, WalkDirection::ToLight, draws) {
                return None;
            }
        }
        let mut spread = 1.0;
        let lit = if last == 0 {
            x.at(0).is_environment() == y.at(0).is_environment() && space.refresh(y, 0)
        } else {
            y.copy(0, x, 0..1);
            spread = self.move_emitter(y.at_mut(0), draws);
            spread > 0.0 && space.join(y, 0)
        };
        if !(lit && space.evaluate(y)) {
            return None;
        }
        Some(spread * (density(self.from, x, last) / density(space, y, last)))
    }

    fn coordinate<D: Draws + ?Sized>(&self, at: f64, draws: &mut D) -> f64 {
        self.step.map_or(at, |step| step.mutate(at, draws))
    }

    /// Both numbers of a pair in the unit square.
    fn pair<D: Draws + ?Sized>(&self, at: DVec2, draws: &mut D) -> DVec2 {
        DVec2::new(self.coordinate(at.x, draws), self.coordinate(at.y, draws))
    }

    /// Another point of the lens, another raster point, and the ray through both.
    fn leave_lens<D: Draws + ?Sized>(&self, x: &Path, y: &mut Path, draws: &mut D) -> Option<()> {
        let (space, n) = (self.to, x.len());
        let camera = space.scene.camera();
        y.copy(n - 1, x, n - 1..n);
        let lens = y.at_mut(n - 1);
        if self.is_at_another_time() {
            let before = self.from.scene.camera();
            lens.vertex.position = camera.carried(before, lens.vertex.position);
        }
        if let (true, Some(step)) = (space.has_aperture(), self.step) {
            let mut by = || 2.0 * step.fraction() * (draws.uniform() - 0.5);
            let by = DVec2::new(by(), by());
            lens.vertex.position = camera.moved_on_lens(lens.vertex.position, by)?;
        }
        let (min, max) = (space.settings.window_min, space.settings.window_max);
        let raster = match self.step {
            Some(_) => {
                let at = (x.raster - min) / (max - min);
                space.settings.raster(self.pair(at, draws))
            }
            None => x.raster,
        };
        space.look_through(y, raster, draws).then_some(())
    }

    /// Scatters as the other vertex does, or near to it.
    fn scatter<D: Draws + ?Sized>(
        &self,
        old: &PathVertex,
        new: &mut PathVertex,
        draws: &mut D,
    ) -> Option<()> {
        if new.kind != VertexKind::Surface {
            return None;
        }
        new.specular = old.specular;
        new.transmitted = old.specular && old.transmitted;
        let wi = if old.specular {
            let wo = new.vertex.frame.to_local(new.toward_eye);
            new.bsdf.delta(wo, new.transmitted, Mode::Radiance)?.wi
        } else {
            self.turn(old.wi, draws)
        };
        new.toward_light = new.vertex.frame.to_world(wi);
        Some(())
    }

    /// A direction of the same hemisphere.
    fn turn<D: Draws + ?Sized>(&self, w: DVec3, draws: &mut D) -> DVec3 {
        if self.step.is_none() {
            return w;
        }
        let azimuth = libm::atan2(w.y, w.x) / TAU;
        let at = DVec2::new(w.z.abs().min(1.0), azimuth - azimuth.floor());
        let to = self.pair(at, draws);
        let (z, phi) = (to.x, TAU * to.y);
        let across = (1.0 - z * z).max(0.0).sqrt();
        DVec3::new(
            across * libm::cos(phi),
            across * libm::sin(phi),
            z.copysign(w.z),
        )
    }

    /// Another point of the same triangle, wherever that is by now. A square's point beyond the diagonal
    /// stands for the one opposite, so that steps that go round are symmetric in the triangle. Returns by how
    /// much the triangle has grown: 0 where it is gone.
    fn move_emitter<D: Draws + ?Sized>(&self, emitter: &mut PathVertex, draws: &mut D) -> f64 {
        if emitter.kind != VertexKind::Emitter(EmitterPoint::Surface) {
            return 1.0;
        }
        let vertex = &mut emitter.vertex;
        let (before, world) = (self.from.scene.world(), self.to.scene.world());
        let (instance, primitive) = (vertex.instance, vertex.primitive);
        let corners = before.triangle(instance, primitive);
        let [a, b, c] = corners.map(|corner| corner.as_dvec3());
        let at = weights([b - a, c - a], vertex.position - a);
        let mut to = self.pair(at.clamp(DVec2::ZERO, DVec2::ONE), draws);
        if to.x + to.y > 1.0 {
            to = 1.0 - to;
        }
        let mut grown = 1.0;
        if self.is_at_another_time() {
            let area = |world: &World| world.triangle_area(instance, primitive);
            grown = factor(Factor::Growth, area(world) / area(before));
            // Of no area there is no point that anything finds; NaN is none either.
            if grown.is_nan() || grown <= 0.0 {
                return 0.0;
            }
        }
        let surface = world.surface_at(instance, primitive, to.x as f32, to.y as f32);
        vertex.position = surface.position.as_dvec3();
        vertex.normal = surface.geometric_normal.as_dvec3();
        vertex.frame = Frame::from_z(vertex.normal);
        vertex.surface = surface;
        if self.to.scene.has_alpha() {
            emitter.opacity = f64::from(self.to.scene.opacity(vertex));
        }
        grown
    }

    /// Is the new path at another time?
    fn is_at_another_time(&self) -> bool {
        !std::ptr::eq(self.from.scene, self.to.scene)
    }
}

/// The weights of two edges that make up a vector in their plane.
fn weights([u, v]: [DVec3; 2], w: DVec3) -> DVec2 {
    let normal = u.cross(v);
    let twice = normal.length_squared();
    DVec2::new(w.cross(v).dot(normal), u.cross(w).dot(normal)) / twice
}
