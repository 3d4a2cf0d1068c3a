use glam::DVec2;
use kaustik_scene::EmitterPoint;
use kaustik_spectrum::{WavelengthSampling, Wavelengths, Xyz};

use crate::vertex::{PathVertex, VertexKind};

#[cfg(feature = "serde")]
mod written;
#[cfg(feature = "serde")]
pub use written::WrittenPath;

/// A light path, from the emitter to the lens, with what it brings to the image.
///
/// The memory is reused from mutation to mutation: behind the vertices lie slots used before.
#[derive(Debug)]
pub struct Path {
    slots: Vec<PathVertex>,
    len: usize,
    /// The number in [0, 1) that the wavelengths are made of.
    pub(crate) wavelength_u: f64,
    pub(crate) wavelengths: Wavelengths,
    /// From 0, when the shutter opens, to 1: vertices lie where surfaces are then. 0 where nothing moves.
    pub(crate) time: f64,
    pub(crate) raster: DVec2,
    /// `We` at the lens, the Dirac parts of the camera left out; where the lens has an area, per unit of area.
    pub(crate) importance: f64,
    pub(crate) density: f64,
    pub(crate) colour: Xyz,
}

impl Clone for Path {
    fn clone(&self) -> Self {
        Self {
            slots: self.slots[..self.len].to_vec(),
            ..*self
        }
    }

    /// Into the memory that is there: a chain returns to its start without asking for more.
    fn clone_from(&mut self, other: &Self) {
        self.resize(other.len);
        self.copy(0, other, 0..other.len);
        let slots = std::mem::take(&mut self.slots);
        *self = Self { slots, ..*other };
    }
}

impl Default for Path {
    /// No path: its density is 0.
    fn default() -> Self {
        Self {
            slots: Vec::new(),
            len: 0,
            wavelength_u: 0.5,
            wavelengths: Wavelengths::sample(0.5, WavelengthSampling::Hero),
            time: 0.0,
            raster: DVec2::ZERO,
            importance: 0.0,
            density: 0.0,
            colour: Xyz::ZERO,
        }
    }
}

impl Path {
    /// The scalar of the path's contribution, in this crate's measure: what a chain's density is. 0 is no
    /// path.
    #[inline]
    pub fn density(&self) -> f64 {
        self.density
    }

    /// The colour, scaled so that its scalar is 1.
    #[inline]
    pub fn colour(&self) -> Xyz {
        self.colour
    }

    /// Where in the image: the unit square over the whole of it, x to the right, y down.
    #[inline]
    pub fn raster(&self) -> DVec2 {
        self.raster
    }

    /// The number in [0, 1) that the wavelengths are made of.
    #[inline]
    pub fn wavelength_u(&self) -> f64 {
        self.wavelength_u
    }

    /// The instant at which light takes this path, in [0, 1): a share of the time for which the shutter is
    /// open. 0 where nothing moves.
    #[inline]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Number of edges; 0 is no path.
    #[inline]
    pub fn edges(&self) -> usize {
        self.len.saturating_sub(1)
    }

    /// World position of a vertex, 0 at the emitter; of the environment the unit direction in which it lies, of a
    /// punctual light the origin.
    pub fn position(&self, vertex: usize) -> [f64; 3] {
        let vertex = self.at(vertex);
        match vertex.kind {
            VertexKind::Emitter(EmitterPoint::Environment(toward)) => toward.to_array(),
            VertexKind::Emitter(EmitterPoint::Punctual(_)) => [0.0; 3],
            _ => vertex.vertex.position.to_array(),
        }
    }

    /// Does the vertex scatter into a Dirac direction?
    #[inline]
    pub fn is_specular(&self, vertex: usize) -> bool {
        self.at(vertex).specular
    }

    #[inline]
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Makes room for so many vertices, whatever is in them.
    #[inline]
    pub(crate) fn resize(&mut self, len: usize) {
        if self.slots.len() < len {
            self.slots.resize_with(len, PathVertex::default);
        }
        self.len = len;
    }

    #[inline]
    pub(crate) fn vertices(&self) -> &[PathVertex] {
        &self.slots[..self.len]
    }

    #[inline]
    pub(crate) fn at(&self, i: usize) -> &PathVertex {
        &self.slots[..self.len][i]
    }

    #[inline]
    pub(crate) fn at_mut(&mut self, i: usize) -> &mut PathVertex {
        &mut self.slots[..self.len][i]
    }

    /// Two neighbours, the first nearer the light.
    #[inline]
    pub(crate) fn pair(&mut self, i: usize) -> (&mut PathVertex, &mut PathVertex) {
        let (low, high) = self.slots[..self.len].split_at_mut(i + 1);
        (&mut low[i], &mut high[0])
    }

    /// Copies vertices `from` of another path to here, from vertex `to` on.
    #[inline]
    pub(crate) fn copy(&mut self, to: usize, other: &Self, from: std::ops::Range<usize>) {
        let len = from.len();
        self.slots[to..to + len].copy_from_slice(&other.slots[from]);
    }

    /// Moves the vertices from `from` on to the front, so that they begin at `to`.
    #[inline]
    pub(crate) fn shift(&mut self, from: usize, to: usize) {
        self.slots.copy_within(from..self.len, to);
        self.len -= from - to;
    }

    /// Takes over the wavelengths and the time.
    #[inline]
    pub(crate) fn tune(&mut self, other: &Self) {
        self.time = other.time;
        self.wavelength_u = other.wavelength_u;
        self.wavelengths = other.wavelengths;
    }
}
