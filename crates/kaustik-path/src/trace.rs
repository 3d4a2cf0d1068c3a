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

/// A part of the building of a path. Positions and unit directions in the world; vertices of a walk are counted by the
/// edge that leads to them, from 1; throughputs and values at the wavelengths of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// A point of the primary sample space is evaluated: what follows is of it.
    Begin,
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
        /// The new direction; not a unit vector where the walk ends.
        direction: DVec3,
        /// Its density per solid angle; 1 of a Dirac direction.
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
    /// Light falls on the image.
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
            Self::Begin => true,
            Self::Start {
                position,
                direction,
                throughput,
                ..
            } => position.is_finite() && direction.is_finite() && throughput.is_finite(),
            Self::Vertex {
                position,
                normal,
                shading,
                distance,
                throughput,
                ..
            } => {
                let vectors = [position, normal, shading].map(|v| v.is_finite());
                vectors == [true; 3] && distance.is_finite() && throughput.is_finite()
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
                let points = points.is_none_or(|points| points.iter().all(|p| p.is_finite()));
                points && weight.is_finite() && value.is_finite()
            }
            Self::Light { value, .. } => value.is_finite(),
            Self::Splat { raster, xyz, .. } => {
                raster.is_finite() && xyz.0.iter().all(|v| v.is_finite())
            }
        }
    }
}

/// More events than any path worth looking at has; what comes after them is not written down.
const MOST: usize = 1 << 20;

thread_local! {
    static LISTENING: Cell<bool> = const { Cell::new(false) };
    static EVENTS: RefCell<Vec<Event>> = const { RefCell::new(Vec::new()) };
}

/// Runs `work` and writes down what the builders do in it on this thread, at most a million events.
pub fn trace<T>(work: impl FnOnce() -> T) -> (T, Vec<Event>) {
    EVENTS.take();
    LISTENING.set(true);
    let result = work();
    LISTENING.set(false);
    (result, EVENTS.take())
}

/// Tells whoever listens.
#[inline(always)]
pub(crate) fn note(event: impl FnOnce() -> Event) {
    if LISTENING.get() {
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
