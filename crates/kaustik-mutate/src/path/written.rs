//! Paths written down and read again (feature `serde`).
//!
//! Of a vertex all numbers that count are kept, to the bit; its scattering function follows from them and the scene.

mod vertex;

use glam::DVec2;
use kaustik_spectrum::{Wavelengths, Xyz};
use serde::{Deserialize, Serialize};

use super::Path;
use crate::PathSpace;
use crate::vertex::{PathVertex, VertexKind};
use vertex::WrittenVertex;

/// A [`Path`] that needs no scene: to be kept, and to become a path again by [`PathSpace::read`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WrittenPath {
    wavelength_u: f64,
    time: f64,
    raster: [f64; 2],
    importance: f64,
    density: f64,
    colour: [f32; 3],
    vertices: Vec<WrittenVertex>,
}

impl Path {
    /// What is to be kept of it.
    pub fn written(&self) -> WrittenPath {
        WrittenPath {
            wavelength_u: self.wavelength_u,
            time: self.time,
            raster: self.raster.to_array(),
            importance: self.importance,
            density: self.density,
            colour: self.colour.0,
            vertices: self.slots[..self.len]
                .iter()
                .map(WrittenVertex::from)
                .collect(),
        }
    }
}

impl PathSpace<'_> {
    /// The path that was written, to the bit; `None` if it is none of this space: it has other lengths or vertices, or
    /// brings other light than it says.
    pub fn read(&self, written: &WrittenPath) -> Option<Path> {
        let time = written.time;
        // What stands still knows no other time, and there is one way to write it.
        let sound = if self.scene.moves() {
            (0.0..1.0).contains(&time)
        } else {
            time.to_bits() == 0
        };
        let here = || self.at(time, |space| space.read_here(written));
        sound.then(here).flatten()
    }

    /// In a scene that stands at the path's time.
    fn read_here(&self, written: &WrittenPath) -> Option<Path> {
        let u = written.wavelength_u;
        let mut path = Path {
            slots: Vec::with_capacity(written.vertices.len()),
            len: written.vertices.len(),
            wavelength_u: u,
            wavelengths: Wavelengths::sample(u, self.settings.wavelengths),
            time: written.time,
            raster: DVec2::from(written.raster),
            importance: written.importance,
            density: 0.0,
            colour: Xyz(written.colour),
        };
        if !(0.0..1.0).contains(&u) || !self.lengths().contains(&path.edges()) {
            return None;
        }
        for (i, vertex) in written.vertices.iter().enumerate() {
            let vertex = self.vertex(vertex, &path.wavelengths)?;
            let fits = match vertex.kind {
                VertexKind::Emitter(_) => i == 0,
                VertexKind::Surface => i > 0 && i < path.edges(),
                VertexKind::Lens => i == path.edges(),
            };
            if !fits {
                return None;
            }
            path.slots.push(vertex);
        }
        let sound = self.serves(path.raster)
            && self.evaluate(&mut path)
            && path.density.is_finite()
            && path.colour.is_finite();
        let same = path.density.to_bits() == written.density.to_bits()
            && path.colour.0.map(f32::to_bits) == written.colour.map(f32::to_bits);
        (sound && same).then_some(path)
    }

    fn vertex(&self, written: &WrittenVertex, wavelengths: &Wavelengths) -> Option<PathVertex> {
        let mut vertex = written.without_bsdf()?;
        match vertex.kind {
            VertexKind::Emitter(point) => self
                .scene
                .has_emitter(point, &vertex.vertex)
                .then_some(())?,
            VertexKind::Surface => {
                let there = (self.scene).has_vertex(&vertex.vertex, &vertex.interior);
                there.then_some(())?;
                let PathVertex {
                    vertex,
                    interior,
                    bsdf,
                    ..
                } = &mut vertex;
                self.scene.write_bsdf(vertex, wavelengths, interior, bsdf);
            }
            VertexKind::Lens => {}
        }
        Some(vertex)
    }
}
