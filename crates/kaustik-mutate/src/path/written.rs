//! Paths written down and read again (feature `serde`).
//!
//! Of a vertex all numbers that count are kept, to the bit; its scattering function follows from them and the scene.

use glam::{DVec2, DVec3, Vec2, Vec3};
use kaustik_bsdf::{Bsdf, Frame};
use kaustik_geometry::Surface;
use kaustik_scene::{EmitterPoint, Interior, Vertex};
use kaustik_spectrum::{Spectrum, Wavelengths, Xyz};
use serde::{Deserialize, Serialize};

use super::Path;
use crate::PathSpace;
use crate::vertex::{Edge, PathVertex, Place};

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

type Three = [f64; 3];

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum WrittenPlace {
    Area,
    Punctual(u32),
    Environment(Three),
    Surface,
    Lens,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct WrittenVertex {
    place: WrittenPlace,
    /// Position, its error, both normals.
    surface: [[f32; 3]; 4],
    uv: [[f32; 2]; 2],
    color: [f32; 4],
    /// Position, normal, frame.
    vertex: [Three; 5],
    /// Instance, primitive, material.
    indices: [u32; 3],
    solids: Vec<u32>,
    /// `back`, `toward_light`, `toward_eye`, `wi`, `wo`, `ng`.
    directions: [Three; 6],
    value: [f32; 4],
    /// `front`, `specular`, `transmitted`, `dispersive`.
    flags: [bool; 4],
    /// Both cosines and the opacity.
    factors: Three,
    edge: ([f64; 2], [f32; 4]),
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
            let fits = match vertex.place {
                Place::Emitter(_) => i == 0,
                Place::Surface => i > 0 && i < path.edges(),
                Place::Lens => i == path.edges(),
            };
            if !fits {
                return None;
            }
            path.slots.push(vertex);
        }
        let sound = self.serves(path.raster) && self.evaluate(&mut path);
        let same = path.density.to_bits() == written.density.to_bits()
            && path.colour.0.map(f32::to_bits) == written.colour.map(f32::to_bits);
        (sound && same).then_some(path)
    }

    fn vertex(&self, written: &WrittenVertex, wavelengths: &Wavelengths) -> Option<PathVertex> {
        let mut vertex = written.vertex()?;
        match vertex.place {
            Place::Emitter(point) => self
                .scene
                .has_emitter(point, &vertex.vertex)
                .then_some(())?,
            Place::Surface => {
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
            Place::Lens => {}
        }
        Some(vertex)
    }
}

/// What counts of a vertex: slots are used again and again, and hold leftovers of other paths where their kind of vertex has
/// no use for a number.
fn bare(slot: &PathVertex) -> PathVertex {
    match slot.place {
        Place::Surface => PathVertex {
            transmitted: slot.specular && slot.transmitted,
            ..*slot
        },
        Place::Emitter(point) => PathVertex {
            place: slot.place,
            vertex: match point {
                EmitterPoint::Surface => slot.vertex,
                _ => Vertex::default(),
            },
            toward_eye: slot.toward_eye,
            value: slot.value,
            specular: slot.specular,
            cos_eye: slot.cos_eye,
            opacity: slot.opacity,
            edge: slot.edge,
            ..PathVertex::default()
        },
        Place::Lens => PathVertex {
            place: slot.place,
            vertex: Vertex {
                position: slot.vertex.position,
                ..Vertex::default()
            },
            toward_light: slot.toward_light,
            specular: slot.specular,
            cos_light: slot.cos_light,
            ..PathVertex::default()
        },
    }
}

impl From<&PathVertex> for WrittenVertex {
    fn from(slot: &PathVertex) -> Self {
        let slot = bare(slot);
        let Vertex { surface, frame, .. } = &slot.vertex;
        Self {
            place: match slot.place {
                Place::Emitter(EmitterPoint::Surface) => WrittenPlace::Area,
                Place::Emitter(EmitterPoint::Punctual(index)) => WrittenPlace::Punctual(index),
                Place::Emitter(EmitterPoint::Environment(toward)) => {
                    WrittenPlace::Environment(toward.to_array())
                }
                Place::Surface => WrittenPlace::Surface,
                Place::Lens => WrittenPlace::Lens,
            },
            surface: [
                surface.position,
                surface.position_error,
                surface.geometric_normal,
                surface.shading_normal,
            ]
            .map(|v| v.to_array()),
            uv: surface.uv.map(|uv| uv.to_array()),
            color: surface.color,
            vertex: [
                slot.vertex.position,
                slot.vertex.normal,
                frame.x,
                frame.y,
                frame.z,
            ]
            .map(|v| v.to_array()),
            indices: [
                slot.vertex.instance,
                slot.vertex.primitive,
                slot.vertex.material,
            ],
            solids: slot.interior.solids().to_vec(),
            directions: [
                slot.back,
                slot.toward_light,
                slot.toward_eye,
                slot.wi,
                slot.wo,
                slot.ng,
            ]
            .map(|v| v.to_array()),
            value: lanes(slot.value),
            flags: [
                surface.front,
                slot.specular,
                slot.transmitted,
                slot.dispersive,
            ],
            factors: [slot.cos_light, slot.cos_eye, slot.opacity],
            edge: (
                [slot.edge.squared, slot.edge.passed],
                lanes(slot.edge.absorption),
            ),
        }
    }
}

impl WrittenVertex {
    /// Without its scattering function; `None` where numbers are no numbers, or indices no indices.
    fn vertex(&self) -> Option<PathVertex> {
        let numbers = self.vertex.iter().chain(&self.directions).flatten();
        let finite = numbers.chain(&self.factors).all(|x| x.is_finite())
            && self.surface.iter().flatten().all(|x| x.is_finite());
        if !finite {
            return None;
        }
        let [position, position_error, geometric_normal, shading_normal] =
            self.surface.map(Vec3::from);
        let [at, normal, x, y, z] = self.vertex.map(DVec3::from);
        let [instance, primitive, material] = self.indices;
        let [back, toward_light, toward_eye, wi, wo, ng] = self.directions.map(DVec3::from);
        let [front, specular, transmitted, dispersive] = self.flags;
        let [cos_light, cos_eye, opacity] = self.factors;
        let ([squared, passed], absorption) = self.edge;
        let mut interior = Interior::VACUUM;
        self.solids.iter().for_each(|&solid| interior.enter(solid));
        Some(PathVertex {
            place: match self.place {
                WrittenPlace::Area => Place::Emitter(EmitterPoint::Surface),
                WrittenPlace::Punctual(index) => Place::Emitter(EmitterPoint::Punctual(index)),
                WrittenPlace::Environment(toward) => {
                    Place::Emitter(EmitterPoint::Environment(DVec3::from(toward)))
                }
                WrittenPlace::Surface => Place::Surface,
                WrittenPlace::Lens => Place::Lens,
            },
            vertex: Vertex {
                surface: Surface {
                    position,
                    position_error,
                    geometric_normal,
                    shading_normal,
                    uv: self.uv.map(Vec2::from),
                    color: self.color,
                    front,
                },
                position: at,
                normal,
                frame: Frame { x, y, z },
                instance,
                primitive,
                material,
            },
            bsdf: Bsdf::black(),
            interior,
            back,
            toward_light,
            toward_eye,
            wi,
            wo,
            ng,
            value: Spectrum::from_fn(|lane| self.value[lane]),
            specular,
            transmitted,
            dispersive,
            cos_light,
            cos_eye,
            opacity,
            edge: Edge {
                squared,
                passed,
                absorption: Spectrum::from_fn(|lane| absorption[lane]),
            },
        })
    }
}

fn lanes(spectrum: Spectrum) -> [f32; Spectrum::LANES] {
    std::array::from_fn(|lane| spectrum[lane])
}
