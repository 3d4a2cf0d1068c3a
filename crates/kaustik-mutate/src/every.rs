//! A perturbation of every variable of a path at once (Kelemen et al. 2002, sec. 7: what mutations in
//! the primary sample space are compared with).

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use kaustik_bsdf::{Frame, Lobe, Mode};
use kaustik_geometry::Ray;
use kaustik_mcmc::{Draws, Mutation, Uniform};
use kaustik_scene::EmitterPoint;
use kaustik_spectrum::Wavelengths;

use crate::lens::density;
use crate::vertex::{PathVertex, Place};
use crate::walk::Way;
use crate::{Path, PathSpace};

/// Perturbs every variable of a path by a fraction of its domain, and traces the whole path again with the same
/// string of scatterings.
///
/// | variable | domain | measure |
/// |---|---|---|
/// | wavelengths | [0, 1) | their number |
/// | point of the lens | square around it | area; beyond the rim the proposal is impossible |
/// | raster point | the window | area |
/// | direction at a vertex that does not scatter into Dirac directions | the hemisphere that it lies in | solid angle: its cosine and its azimuth |
/// | point of a surface that emits | its triangle | area |
///
/// Steps are uniform over the fraction ([`Uniform`]) and go round at the ends of a domain. Nothing is sampled
/// by importance: each variable moves symmetrically in the measure above, and what is left of the ratio is the
/// geometry of what is traced, as of [`LensPerturbation`](crate::LensPerturbation). An emitter infinitely far
/// away, and one behind a Dirac scattering, is found by the last direction; a punctual light stays where it is.
#[derive(Clone, Copy, Debug)]
pub struct EveryPerturbation<'a> {
    /// Where the paths run.
    pub space: &'a PathSpace<'a>,
    /// The share of its domain that a variable can reach, in (0, 1].
    pub fraction: f64,
}

/// The last vertex that is traced from the eye: 0 where the emitter is found so, else 1.
fn last(path: &Path) -> usize {
    let first = path.at(0);
    let joined = path.edges() > 1 && !path.is_specular(1) && !first.is_environment();
    usize::from(joined)
}

impl EveryPerturbation<'_> {
    /// Is the path of the kind that this perturbation moves?
    pub fn suits(&self, path: &Path) -> bool {
        path.edges() > 0 && (path.at(0).is_hittable() || last(path) > 0)
    }

    pub(crate) fn perturb<D: Draws + ?Sized>(
        &self,
        x: &Path,
        y: &mut Path,
        draws: &mut D,
    ) -> Option<f64> {
        if !self.suits(x) {
            return None;
        }
        let (space, n, last) = (self.space, x.len(), last(x));
        y.resize(n);
        y.wavelength = self.step(x.wavelength, draws);
        y.wavelengths = Wavelengths::sample(y.wavelength, space.settings.wavelengths);
        self.leave_lens(x, y, draws)?;
        for i in (last + 1..n - 1).rev() {
            self.scatter(x.at(i), y.at_mut(i), draws)?;
            if !space.follow(y, i, Way::ToLight, draws) {
                return None;
            }
        }
        let lit = if last == 0 {
            x.at(0).is_environment() == y.at(0).is_environment() && space.refresh(y, 0)
        } else {
            y.copy(0, x, 0..1);
            self.move_emitter(y.at_mut(0), draws);
            space.join(y, 0)
        };
        if !(lit && space.evaluate(y)) {
            return None;
        }
        Some(density(space, x, last) / density(space, y, last))
    }

    fn step<D: Draws + ?Sized>(&self, at: f64, draws: &mut D) -> f64 {
        Uniform::new(self.fraction).mutate(at, draws)
    }

    /// Both numbers of a pair in the unit square.
    fn pair<D: Draws + ?Sized>(&self, at: DVec2, draws: &mut D) -> DVec2 {
        DVec2::new(self.step(at.x, draws), self.step(at.y, draws))
    }

    /// Another point of the lens, another raster point, and the ray through both.
    fn leave_lens<D: Draws + ?Sized>(&self, x: &Path, y: &mut Path, draws: &mut D) -> Option<()> {
        let (space, n) = (self.space, x.len());
        let camera = space.scene.camera();
        y.copy(n - 1, x, n - 1..n);
        let lens = y.at_mut(n - 1);
        if space.has_aperture() {
            let radius = (1.0 / (std::f64::consts::PI * camera.pdf_lens())).sqrt();
            let reach = 2.0 * radius * self.fraction;
            let frame = Frame::from_z(camera.forward());
            let across = frame.x * (draws.uniform() - 0.5) + frame.y * (draws.uniform() - 0.5);
            lens.vertex.position += across * reach;
            if (lens.vertex.position - camera.position()).length() > radius {
                return None;
            }
        }
        let (min, max) = (space.settings.window_min, space.settings.window_max);
        let raster = min + self.pair((x.raster - min) / (max - min), draws) * (max - min);
        let ray = camera.ray_from(lens.vertex.position, raster);
        lens.vertex.position = ray.origin;
        lens.toward_light = ray.direction;
        let ray = Ray::new(ray.origin.as_vec3(), ray.direction.as_vec3());
        let made = space.refresh(y, n - 1) && space.step_to_light(y, n - 2, &ray, draws);
        made.then_some(())
    }

    /// Scatters as the other vertex does, or near to it.
    fn scatter<D: Draws + ?Sized>(
        &self,
        old: &PathVertex,
        new: &mut PathVertex,
        draws: &mut D,
    ) -> Option<()> {
        if new.place != Place::Surface {
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

    /// Another point of the same triangle. A square's point beyond the diagonal stands for the one opposite, so
    /// that steps that go round are symmetric in the triangle.
    fn move_emitter<D: Draws + ?Sized>(&self, emitter: &mut PathVertex, draws: &mut D) {
        if emitter.place != Place::Emitter(EmitterPoint::Surface) {
            return;
        }
        let vertex = &mut emitter.vertex;
        let world = self.space.scene.world();
        let corners = world.triangle(vertex.instance, vertex.primitive);
        let [a, b, c] = corners.map(|corner| corner.as_dvec3());
        let at = weights([b - a, c - a], vertex.position - a);
        let mut to = self.pair(at.clamp(DVec2::ZERO, DVec2::ONE), draws);
        if to.x + to.y > 1.0 {
            to = 1.0 - to;
        }
        let surface = world.surface_at(vertex.instance, vertex.primitive, to.x as f32, to.y as f32);
        vertex.position = surface.position.as_dvec3();
        vertex.normal = surface.geometric_normal.as_dvec3();
        vertex.surface = surface;
        if self.space.scene.has_alpha() {
            emitter.opacity = f64::from(self.space.scene.opacity(vertex));
        }
    }
}

/// The weights of two edges that make up a vector in their plane.
fn weights([u, v]: [DVec3; 2], w: DVec3) -> DVec2 {
    let normal = u.cross(v);
    let twice = normal.length_squared();
    DVec2::new(w.cross(v).dot(normal), u.cross(w).dot(normal)) / twice
}
