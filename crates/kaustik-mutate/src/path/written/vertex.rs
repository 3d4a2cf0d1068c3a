//! A vertex written down.

use glam::{DVec3, Vec2, Vec3};
use kaustik_bsdf::{Bsdf, Frame};
use kaustik_geometry::Surface;
use kaustik_scene::{EmitterPoint, Interior, Vertex};
use kaustik_spectrum::Spectrum;
use serde::{Deserialize, Serialize};

use crate::vertex::{Edge, PathVertex, VertexKind};

/// What counts of a [`PathVertex`], but for its scattering function. States keep the fields in this order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct WrittenVertex {
    kind: WrittenKind,
    surface: WrittenSurface,
    position: [f64; 3],
    normal: [f64; 3],
    frame: WrittenFrame,
    instance: u32,
    primitive: u32,
    material: u32,
    solids: Vec<u32>,
    back: [f64; 3],
    toward_light: [f64; 3],
    toward_eye: [f64; 3],
    wi: [f64; 3],
    wo: [f64; 3],
    ng: [f64; 3],
    value: [f32; Spectrum::LANES],
    /// Of the surface.
    front: bool,
    specular: bool,
    transmitted: bool,
    dispersive: bool,
    cos_light: f64,
    cos_eye: f64,
    opacity: f64,
    edge: WrittenEdge,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum WrittenKind {
    Area,
    Punctual(u32),
    Environment([f64; 3]),
    Surface,
    Lens,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct WrittenSurface {
    position: [f32; 3],
    position_error: [f32; 3],
    geometric_normal: [f32; 3],
    shading_normal: [f32; 3],
    uv: [[f32; 2]; 2],
    color: [f32; 4],
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct WrittenFrame {
    x: [f64; 3],
    y: [f64; 3],
    z: [f64; 3],
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct WrittenEdge {
    squared: f64,
    passed: f64,
    transmittance: [f32; Spectrum::LANES],
}

impl From<&PathVertex> for WrittenVertex {
    fn from(slot: &PathVertex) -> Self {
        let slot = bare(slot);
        let vertex = &slot.vertex;
        Self {
            kind: WrittenKind::from(slot.kind),
            surface: WrittenSurface::from(&vertex.surface),
            position: vertex.position.to_array(),
            normal: vertex.normal.to_array(),
            frame: WrittenFrame::from(&vertex.frame),
            instance: vertex.instance,
            primitive: vertex.primitive,
            material: vertex.material,
            solids: slot.interior.solids().to_vec(),
            back: slot.back.to_array(),
            toward_light: slot.toward_light.to_array(),
            toward_eye: slot.toward_eye.to_array(),
            wi: slot.wi.to_array(),
            wo: slot.wo.to_array(),
            ng: slot.ng.to_array(),
            value: lanes(slot.value),
            front: vertex.surface.front,
            specular: slot.specular,
            transmitted: slot.transmitted,
            dispersive: slot.dispersive,
            cos_light: slot.cos_light,
            cos_eye: slot.cos_eye,
            opacity: slot.opacity,
            edge: WrittenEdge::from(&slot.edge),
        }
    }
}

/// What counts of a vertex: slots are used again and again, and hold leftovers of other paths where their kind of
/// vertex has no use for a number.
fn bare(slot: &PathVertex) -> PathVertex {
    match slot.kind {
        VertexKind::Surface => PathVertex {
            transmitted: slot.specular && slot.transmitted,
            ..*slot
        },
        VertexKind::Emitter(point) => PathVertex {
            kind: slot.kind,
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
        VertexKind::Lens => PathVertex {
            kind: slot.kind,
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

impl WrittenVertex {
    /// The vertex, without its scattering function; `None` where numbers are no numbers.
    pub(super) fn without_bsdf(&self) -> Option<PathVertex> {
        if !self.is_finite() {
            return None;
        }
        let mut interior = Interior::VACUUM;
        self.solids.iter().for_each(|&solid| interior.enter(solid));
        Some(PathVertex {
            kind: self.kind.kind(),
            vertex: Vertex {
                surface: self.surface.surface(self.front),
                position: self.position.into(),
                normal: self.normal.into(),
                frame: self.frame.frame(),
                instance: self.instance,
                primitive: self.primitive,
                material: self.material,
            },
            bsdf: Bsdf::black(),
            interior,
            back: self.back.into(),
            toward_light: self.toward_light.into(),
            toward_eye: self.toward_eye.into(),
            wi: self.wi.into(),
            wo: self.wo.into(),
            ng: self.ng.into(),
            value: spectrum(&self.value),
            specular: self.specular,
            transmitted: self.transmitted,
            dispersive: self.dispersive,
            cos_light: self.cos_light,
            cos_eye: self.cos_eye,
            opacity: self.opacity,
            edge: self.edge.edge(),
        })
    }

    /// Are positions, directions and factors all numbers?
    fn is_finite(&self) -> bool {
        let Self { surface, frame, .. } = self;
        let on_surface = [
            surface.position,
            surface.position_error,
            surface.geometric_normal,
            surface.shading_normal,
        ];
        let vectors = [
            self.position,
            self.normal,
            frame.x,
            frame.y,
            frame.z,
            self.back,
            self.toward_light,
            self.toward_eye,
            self.wi,
            self.wo,
            self.ng,
            [self.cos_light, self.cos_eye, self.opacity],
        ];
        on_surface.as_flattened().iter().all(|x| x.is_finite())
            && vectors.as_flattened().iter().all(|x| x.is_finite())
    }
}

impl From<VertexKind> for WrittenKind {
    fn from(kind: VertexKind) -> Self {
        match kind {
            VertexKind::Emitter(EmitterPoint::Surface) => Self::Area,
            VertexKind::Emitter(EmitterPoint::Punctual(index)) => Self::Punctual(index),
            VertexKind::Emitter(EmitterPoint::Environment(toward)) => {
                Self::Environment(toward.to_array())
            }
            VertexKind::Surface => Self::Surface,
            VertexKind::Lens => Self::Lens,
        }
    }
}

impl WrittenKind {
    fn kind(&self) -> VertexKind {
        match *self {
            Self::Area => VertexKind::Emitter(EmitterPoint::Surface),
            Self::Punctual(index) => VertexKind::Emitter(EmitterPoint::Punctual(index)),
            Self::Environment(toward) => {
                VertexKind::Emitter(EmitterPoint::Environment(DVec3::from(toward)))
            }
            Self::Surface => VertexKind::Surface,
            Self::Lens => VertexKind::Lens,
        }
    }
}

impl From<&Surface> for WrittenSurface {
    fn from(surface: &Surface) -> Self {
        Self {
            position: surface.position.to_array(),
            position_error: surface.position_error.to_array(),
            geometric_normal: surface.geometric_normal.to_array(),
            shading_normal: surface.shading_normal.to_array(),
            uv: surface.uv.map(|uv| uv.to_array()),
            color: surface.color,
        }
    }
}

impl WrittenSurface {
    fn surface(&self, front: bool) -> Surface {
        Surface {
            position: Vec3::from(self.position),
            position_error: Vec3::from(self.position_error),
            geometric_normal: Vec3::from(self.geometric_normal),
            shading_normal: Vec3::from(self.shading_normal),
            uv: self.uv.map(Vec2::from),
            color: self.color,
            front,
        }
    }
}

impl From<&Frame> for WrittenFrame {
    fn from(frame: &Frame) -> Self {
        let [x, y, z] = [frame.x, frame.y, frame.z].map(|axis| axis.to_array());
        Self { x, y, z }
    }
}

impl WrittenFrame {
    fn frame(&self) -> Frame {
        let [x, y, z] = [self.x, self.y, self.z].map(DVec3::from);
        Frame { x, y, z }
    }
}

impl From<&Edge> for WrittenEdge {
    fn from(edge: &Edge) -> Self {
        Self {
            squared: edge.squared,
            passed: edge.passed,
            transmittance: lanes(edge.transmittance),
        }
    }
}

impl WrittenEdge {
    fn edge(&self) -> Edge {
        Edge {
            squared: self.squared,
            passed: self.passed,
            transmittance: spectrum(&self.transmittance),
        }
    }
}

fn lanes(spectrum: Spectrum) -> [f32; Spectrum::LANES] {
    std::array::from_fn(|lane| spectrum[lane])
}

fn spectrum(lanes: &[f32; Spectrum::LANES]) -> Spectrum {
    Spectrum::from_fn(|lane| lanes[lane])
}
