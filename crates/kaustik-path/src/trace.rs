//! What happens while paths are built, written down for whoever wants to look at one.
//!
//! The builders themselves tell: what is seen is the path that was rendered, not another one made like it. In a render
//! nobody listens, and an event costs a look at one flag of the thread.

use std::cell::{Cell, RefCell};

use glam::{DVec2, DVec3};
use kaustik_bsdf::Mode;
use kaustik_spectrum::{Spectrum, Xyz};

use crate::Class;

/// Where a walk began.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// At the lens.
    Camera,
    /// At an emitter.
    Light,
}

impl Side {
    pub(crate) fn of(mode: Mode) -> Self {
        match mode {
            Mode::Radiance => Self::Camera,
            Mode::Importance => Self::Light,
        }
    }
}

/// What a whole path is to its chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Role {
    /// An independent sample; with the weight that it brings along.
    Sampled(f64),
    /// Where the chain is.
    Current,
    /// Where it may go.
    Proposed,
}

impl Role {
    fn is_finite(self) -> bool {
        match self {
            Self::Sampled(weight) => weight.is_finite(),
            Self::Current | Self::Proposed => true,
        }
    }
}

/// What a vertex is to a whole path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stand {
    /// A point that emits.
    Emitter,
    /// An emitter infinitely far away: its position is the unit direction toward it.
    Distant,
    /// Where light is scattered.
    Surface,
    /// The point on the lens.
    Lens,
}

/// A part of the building of a path. Positions and unit directions in the world; vertices of a walk are counted by the
/// edge that leads to them, from 1; throughputs and values at the wavelengths of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// Where the step lies in its render, as one of several numbers; each is counted from 0.
    Index {
        /// What is counted.
        of: &'static str,
        /// Its number.
        number: u64,
    },
    /// A point of the primary sample space is evaluated: what follows is of it.
    Begin,
    /// A light path of a chain of photons is built: what follows is of it.
    LightPath {
        /// What it is to its chain.
        role: Role,
    },
    /// A chain of photons reports the path that it leaves, or one that it did not go to: the deposits that
    /// follow are of that path.
    Visit {
        /// The chain among those of its ladder, counted from 0.
        level: u32,
        /// Steps that the visit stands for.
        weight: f64,
    },
    /// A walk leaves its end.
    Start {
        /// Which end.
        side: Side,
        /// The point on lens or emitter; for light from infinity a point before the scene.
        position: DVec3,
        /// Of the first edge.
        direction: DVec3,
        /// What the walk carries.
        throughput: Spectrum,
    },
    /// A walk reaches a surface.
    Vertex {
        /// Of which walk.
        side: Side,
        /// The edge that led here.
        edge: u32,
        /// Where.
        position: DVec3,
        /// Geometric normal of the surface's front.
        normal: DVec3,
        /// Shading normal, on the same side.
        shading: DVec3,
        /// Index of the material.
        material: u32,
        /// Which instance, and which triangle of it.
        triangle: [u32; 2],
        /// Length of the edge.
        distance: f64,
        /// What the walk carries, absorption along the edge included.
        throughput: Spectrum,
    },
    /// A walk leaves the scene.
    Escape {
        /// Of which walk.
        side: Side,
        /// The edge that leads out.
        edge: u32,
        /// Its direction.
        direction: DVec3,
    },
    /// A walk scatters at the vertex that it has reached.
    Scatter {
        /// Of which walk.
        side: Side,
        /// The edge that led to the vertex.
        edge: u32,
        /// The new direction.
        direction: DVec3,
        /// Its density per solid angle; of a Dirac direction the probability of its part of the scattering function.
        pdf: f64,
        /// Into a Dirac direction.
        delta: bool,
        /// Through the surface.
        transmitted: bool,
        /// What the walk carries then; the walk ends where that is zero.
        throughput: Spectrum,
    },
    /// Roulette ends a walk at this edge, or lets it carry more.
    Roulette {
        /// Of which walk.
        side: Side,
        /// The edge that led to the vertex.
        edge: u32,
        /// Probability of going on.
        survival: f64,
        /// Did it go on?
        survived: bool,
    },
    /// A strategy makes a path; what stands between the joined points is not known yet.
    Join {
        /// Vertices from the light, the point on the emitter included.
        s: u32,
        /// Vertices from the eye, the point on the lens included.
        t: u32,
        /// Joined points; `None` where the walk itself arrived, or the other end is at infinity.
        points: Option<[DVec3; 2]>,
        /// Share of the strategy in the path.
        weight: f64,
        /// Weighted throughput, without visibility.
        value: Spectrum,
    },
    /// A path brings light to the raster point of its camera walk.
    Light {
        /// Its kind.
        class: Class,
        /// Weighted, visibility and absorption included.
        value: Spectrum,
    },
    /// A whole path of a method that moves paths; its vertices follow.
    Path {
        /// What it is to its chain.
        role: Role,
        /// Where it falls: the unit square over the whole image.
        raster: DVec2,
        /// The chain's density, in the measure of `kaustik-mutate`.
        density: f64,
        /// Scaled so that its scalar is 1.
        colour: Xyz,
    },
    /// A vertex of a whole path, counted from 0 at the emitter.
    PathVertex {
        /// Its number.
        index: u32,
        /// What it is to the path.
        stand: Stand,
        /// Where.
        position: DVec3,
        /// Geometric normal of the surface's front; zero where there is no surface.
        normal: DVec3,
        /// Shading normal, on the same side; zero where there is no surface.
        shading: DVec3,
        /// Index of the material, where there is a surface.
        material: Option<u32>,
        /// Scatters into a Dirac direction.
        specular: bool,
        /// ... through the surface.
        transmitted: bool,
        /// Scattering function, share of a Dirac direction, or what is emitted; 1 at the lens.
        value: Spectrum,
    },
    /// A chain of whole paths has proposed one.
    Proposal {
        /// What made it.
        kernel: &'static str,
        /// The chance of proposing the way back over that of the way there; 0: there is no path to be proposed.
        ratio: f64,
        /// The probability with which it is accepted.
        acceptance: f64,
    },
    /// The chain has decided.
    Decision {
        /// Has it gone there?
        accepted: bool,
    },
    /// A walk from the light leaves a photon.
    Photon {
        /// Where.
        position: DVec3,
        /// Toward where it came from.
        direction: DVec3,
        /// Flux over density.
        power: Spectrum,
        /// Edges from the light.
        edges: u32,
        /// Measurement points that it counts at.
        met: u32,
    },
    /// Light falls on the image.
    Deposit {
        /// Where: the unit square over the whole image.
        raster: DVec2,
        /// How much, all weights included, in the unit of the method's film.
        xyz: Xyz,
        /// `false`: left out, because it is not finite or negative.
        kept: bool,
    },
    /// Light falls on the image, as a path builder says it.
    Splat {
        /// Where: the unit square over the whole image, x to the right, y down.
        raster: DVec2,
        /// How much: radiance over density.
        xyz: Xyz,
        /// The kind of path.
        class: Class,
        /// `false`: left out, because it is not finite or negative.
        kept: bool,
    },
}

impl Event {
    /// Are all of its numbers finite?
    pub fn is_finite(&self) -> bool {
        match self {
            Self::Begin | Self::Decision { .. } | Self::Index { .. } | Self::LightPath { .. } => {
                true
            }
            Self::Visit { weight, .. } => weight.is_finite(),
            Self::Path {
                role,
                raster,
                density,
                colour,
            } => role.is_finite() && raster.is_finite() && density.is_finite() && is_finite(colour),
            Self::PathVertex {
                position,
                normal,
                shading,
                value,
                ..
            } => are_finite(&[position, normal, shading]) && value.is_finite(),
            Self::Proposal {
                ratio, acceptance, ..
            } => ratio.is_finite() && acceptance.is_finite(),
            Self::Start {
                position,
                direction,
                throughput: spectrum,
                ..
            }
            | Self::Photon {
                position,
                direction,
                power: spectrum,
                ..
            } => are_finite(&[position, direction]) && spectrum.is_finite(),
            Self::Vertex {
                position,
                normal,
                shading,
                distance,
                throughput,
                ..
            } => {
                are_finite(&[position, normal, shading])
                    && distance.is_finite()
                    && throughput.is_finite()
            }
            Self::Escape { direction, .. } => direction.is_finite(),
            Self::Scatter {
                direction,
                pdf,
                throughput,
                ..
            } => direction.is_finite() && pdf.is_finite() && throughput.is_finite(),
            Self::Roulette { survival, .. } => survival.is_finite(),
            Self::Join {
                points,
                weight,
                value,
                ..
            } => {
                let points = points.is_none_or(|[from, to]| are_finite(&[&from, &to]));
                points && weight.is_finite() && value.is_finite()
            }
            Self::Light { value, .. } => value.is_finite(),
            Self::Deposit { raster, xyz, .. } | Self::Splat { raster, xyz, .. } => {
                raster.is_finite() && is_finite(xyz)
            }
        }
    }
}

fn are_finite(vectors: &[&DVec3]) -> bool {
    vectors.iter().all(|v| v.is_finite())
}

fn is_finite(colour: &Xyz) -> bool {
    colour.0.iter().all(|v| v.is_finite())
}

/// More events than any path worth looking at has; what comes after them is not written down.
const MOST: usize = 1 << 20;

thread_local! {
    static LISTENING: Cell<bool> = const { Cell::new(false) };
    static EVENTS: RefCell<Vec<Event>> = const { RefCell::new(Vec::new()) };
}

/// Nobody listens any longer when it goes, even if a panic takes it.
struct Listening;

impl Drop for Listening {
    fn drop(&mut self) {
        LISTENING.set(false);
    }
}

/// Runs `work` and writes down what the builders do in it on this thread, at most a million events. Within `work` it must
/// not be called again: the inner call would take the outer one's events.
pub fn trace<T>(work: impl FnOnce() -> T) -> (T, Vec<Event>) {
    EVENTS.take();
    LISTENING.set(true);
    let listening = Listening;
    let result = work();
    drop(listening);
    (result, EVENTS.take())
}

/// Does anybody listen on this thread?
#[inline(always)]
pub fn is_listening() -> bool {
    LISTENING.get()
}

/// Tells whoever listens.
#[inline(always)]
pub fn note(event: impl FnOnce() -> Event) {
    if is_listening() {
        write(event());
    }
}

#[cold]
#[inline(never)]
fn write(event: Event) {
    EVENTS.with_borrow_mut(|events| {
        if events.len() < MOST {
            events.push(event);
        }
    });
}
