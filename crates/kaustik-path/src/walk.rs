//! A walk through the scene, from the camera or from a light, one edge at a time.

use glam::DVec3;
use kaustik_bsdf::{Bsdf, Lobe, Mode, Sample, shading};
use kaustik_geometry::Ray;
use kaustik_pss::{Coordinates, Stream};
use kaustik_scene::{EmissionSample, Interior, Scene, Vertex};
use kaustik_spectrum::{Spectrum, Wavelengths};

use crate::Class;
use crate::layout;
use crate::roulette;
use crate::trace::{Event, Side, note};

/// Where a walk stands.
#[derive(Clone, Debug)]
pub(crate) struct Walk<'w> {
    pub(crate) mode: Mode,
    pub(crate) wavelengths: &'w Wavelengths,
    /// The next edge starts here.
    pub(crate) ray: Ray,
    /// Direction of the next edge, unit.
    pub(crate) direction: DVec3,
    /// The solids around the walk.
    pub(crate) interior: Interior,
    /// Product of scattering over densities so far.
    pub(crate) throughput: Spectrum,
    /// Mean throughput at the start: what roulette measures by, so that the unit of light does not show.
    pub(crate) start: f32,
    /// Probability with which roulette has let it come so far.
    pub(crate) survived: f32,
    /// Refracted where the index depends on the wavelength: the hero counts alone.
    pub(crate) dispersive: bool,
    /// Has scattered into a Dirac direction.
    pub(crate) specular: bool,
    /// Has scattered into Dirac directions alone, or not at all.
    pub(crate) pure: bool,
    /// Stands at an end of the path, or has last scattered otherwise than into a Dirac direction: what a neighbour
    /// like it could be joined to.
    pub(crate) open: bool,
    /// Two neighbours so far could have been joined. From the lens by a mirror, a wall and glass to a lamp `open` is true, false,
    /// true, false and `joined` never true: light that nothing joins.
    pub(crate) joined: bool,
    /// Edges so far.
    pub(crate) edges: u32,
}

/// A vertex of a walk with its scattering function, in local directions.
#[derive(Clone, Debug)]
pub(crate) struct Scatter<'a> {
    pub(crate) vertex: &'a Vertex,
    pub(crate) bsdf: &'a Bsdf,
    /// Local direction to where the walk came from.
    pub(crate) wo: DVec3,
    /// Local geometric normal.
    pub(crate) ng: DVec3,
}

impl<'w> Walk<'w> {
    /// A walk that leaves an emitter with this throughput.
    pub(crate) fn from_emitter(
        emission: &EmissionSample,
        throughput: Spectrum,
        wavelengths: &'w Wavelengths,
    ) -> Self {
        let walk = Self {
            mode: Mode::Importance,
            wavelengths,
            ray: emission.ray,
            direction: emission.ray.direction.as_dvec3().normalize(),
            interior: emission.interior,
            throughput,
            start: throughput.mean(),
            survived: 1.0,
            dispersive: false,
            specular: false,
            pure: true,
            open: true,
            joined: false,
            edges: 0,
        };
        walk.tell_start();
        walk
    }

    /// The kind of path, if the walk is one from the camera and has run into an emitter.
    #[inline]
    pub(crate) fn implicit(&self) -> Class {
        match (self.specular, self.open || self.joined) {
            (false, _) => Class::L1,
            (true, false) => Class::L0,
            (true, true) => Class::L0Joined,
        }
    }

    /// Tells whoever looks where the walk begins.
    #[inline]
    pub(crate) fn tell_start(&self) {
        note(|| Event::Start {
            side: Side::of(self.mode),
            position: self.ray.origin.as_dvec3(),
            direction: self.direction,
            throughput: self.throughput,
        });
    }

    /// Takes the next edge and writes what it led to into `vertex`. Returns its length; `None`:
    /// the walk left the scene.
    #[inline]
    pub(crate) fn advance(
        &mut self,
        scene: &Scene,
        u: &mut dyn Coordinates,
        vertex: &mut Vertex,
    ) -> Option<f64> {
        let index = transparency(self.mode, self.edges);
        self.edges += 1;
        let segment = scene.advance(
            &self.ray,
            &mut self.interior,
            self.wavelengths,
            || u.get(Stream::Transparency, index),
            vertex,
        );
        self.throughput *= segment.factor();
        if segment.escapes() {
            note(|| Event::Escape {
                side: Side::of(self.mode),
                edge: self.edges,
                direction: self.direction,
            });
            return None;
        }
        note(|| self.reached(vertex, segment.distance));
        Some(segment.distance)
    }

    /// For whoever looks at the path.
    #[cold]
    fn reached(&self, vertex: &Vertex, distance: f64) -> Event {
        Event::Vertex {
            side: Side::of(self.mode),
            edge: self.edges,
            position: vertex.position,
            normal: vertex.normal,
            shading: vertex.frame.z,
            material: vertex.material,
            triangle: [vertex.instance, vertex.primitive],
            distance,
            throughput: self.throughput,
        }
    }

    /// The vertex just reached, with its scattering function, which is written into `bsdf`: that is large, and this is
    /// the innermost loop.
    #[inline]
    pub(crate) fn scatter<'a>(
        &self,
        scene: &Scene,
        vertex: &'a Vertex,
        bsdf: &'a mut Bsdf,
    ) -> Scatter<'a> {
        scene.write_bsdf(vertex, self.wavelengths, &self.interior, bsdf);
        Scatter {
            bsdf,
            wo: vertex.frame.to_local(-self.direction),
            ng: vertex.local_normal(),
            vertex,
        }
    }

    /// The stream of what the walk decides at its vertices, and the first of these coordinates at the vertex just
    /// reached.
    #[inline]
    fn bounce_coordinates(&self) -> (Stream, u32) {
        let (stream, head) = match self.mode {
            Mode::Radiance => (Stream::Camera, layout::CAMERA_HEAD),
            Mode::Importance => (Stream::Light, layout::LIGHT_HEAD),
        };
        (stream, layout::bounce(head, self.edges))
    }

    /// Draws the next direction and returns what was drawn, for weights; `None` when the walk ends
    /// here.
    #[inline]
    pub(crate) fn bounce(
        &mut self,
        scene: &Scene,
        scatter: &Scatter<'_>,
        u: &mut dyn Coordinates,
    ) -> Option<Sample> {
        let (stream, first) = self.bounce_coordinates();
        let uc = if scatter.bsdf.has_choice() {
            u.get(stream, first)
        } else {
            0.0
        };
        let direction = if scatter.bsdf.is_delta() {
            [0.0; 2]
        } else {
            u.get2(stream, first + 1)
        };
        let sample = scatter.bsdf.sample(scatter.wo, uc, direction, self.mode)?;
        let factor = shading::walk_factor(scatter.wo, sample.wi, scatter.ng, self.mode);
        self.throughput *= sample.weight * factor as f32;
        note(|| Event::Scatter {
            side: Side::of(self.mode),
            edge: self.edges,
            direction: scatter.vertex.frame.to_world(sample.wi),
            pdf: sample.pdf,
            delta: sample.delta,
            transmitted: sample.transmitted,
            throughput: self.throughput,
        });
        if self.throughput.is_zero() {
            return None;
        }
        let vertex = scatter.vertex;
        self.dispersive |= sample.dispersive;
        self.specular |= sample.delta;
        self.pure &= sample.delta;
        self.joined |= self.open && !sample.delta;
        self.open = !sample.delta;
        self.direction = vertex.frame.to_world(sample.wi);
        if sample.transmitted {
            scene.cross(vertex, self.direction, &mut self.interior);
        }
        self.ray = Ray::spawn(&vertex.surface, self.direction.as_vec3());
        Some(sample)
    }

    /// Russian roulette after a bounce; `false` when the walk ends.
    #[inline]
    pub(crate) fn survives(&mut self, u: &mut dyn Coordinates) -> bool {
        // Only radiance is divided by the square of the index inside a solid.
        let inside = self.mode == Mode::Radiance && !self.interior.is_vacuum();
        let survival = roulette::survival(self.edges, self.throughput.mean() / self.start, inside);
        self.survives_with(survival, u)
    }

    /// Roulette after a bounce, by the albedo: what goes on carries what the walk began with. `false` when the
    /// walk ends.
    #[inline]
    pub(crate) fn survives_by_albedo(&mut self, u: &mut dyn Coordinates) -> bool {
        self.survives_with(self.throughput.mean() / self.start, u)
    }

    /// Ends the walk but with this probability; one that is 1 or more asks for nothing.
    #[inline]
    fn survives_with(&mut self, survival: f32, u: &mut dyn Coordinates) -> bool {
        if survival >= 1.0 {
            return true;
        }
        let stops = self.stops(f64::from(survival), u);
        self.tell_roulette(survival, !stops);
        if stops {
            return false;
        }
        // A throughput that is no number goes on, to be counted where it arrives.
        self.throughput /= survival;
        self.survived *= survival;
        true
    }

    /// Does the coordinate of roulette end the walk at the vertex just reached, where it is to go on with this
    /// probability?
    #[inline]
    pub(crate) fn stops(&self, onward: f64, u: &mut dyn Coordinates) -> bool {
        let (stream, first) = self.bounce_coordinates();
        u.get(stream, first + layout::ROULETTE) >= onward
    }

    #[inline]
    fn tell_roulette(&self, survival: f32, survived: bool) {
        note(|| Event::Roulette {
            side: Side::of(self.mode),
            edge: self.edges,
            survival: f64::from(survival),
            survived,
        });
    }
}

/// Camera and light walks take turns in the stream of transparency.
#[inline]
fn transparency(mode: Mode, edge: u32) -> u32 {
    2 * edge + u32::from(mode == Mode::Importance)
}

/// The power heuristic with exponent 2 for a sample of density `p` that might as well have come
/// with density `q` (Veach 9.2.4); 1 when `q` is 0.
#[inline]
pub(crate) fn power_heuristic(p: f64, q: f64) -> f32 {
    let ratio = q / p;
    (1.0 / (1.0 + ratio * ratio)) as f32
}
