//! Who looks at each contribution: nobody in a render, a replay, the tests of the weights.

use glam::DVec3;
use kaustik_scene::camera::{LensHit, LensSample};
use kaustik_scene::{DirectSample, EmissionPdf};
use kaustik_spectrum::{Spectrum, Xyz};

use super::vertex::PathVertex;
use crate::next_event::end;
use crate::trace::{Event, note};

/// Told of every weighted path before its visibility is known.
pub(super) trait Witness {
    /// `light` and `eye` are the vertices on surfaces that the path is made of, from the ends
    /// inwards.
    fn see(&mut self, seen: &Seen<'_>);

    /// Told of every strategy `(s, t)` that brings light, of the probability with which roulette has let its subpaths come so far,
    /// and of the light.
    #[inline]
    fn lit(&mut self, _strategy: (u32, u32), _survived: f32, _light: impl FnOnce() -> Xyz) {}
}

/// A weighted path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen<'a> {
    /// Vertices from the light, the point on the emitter included.
    pub(super) s: u32,
    /// Vertices from the eye, the point on the lens included.
    pub(super) t: u32,
    pub(super) weight: f64,
    pub(super) value: Spectrum,
    pub(super) light: &'a [PathVertex],
    pub(super) eye: &'a [PathVertex],
    pub(super) joint: Joint<'a>,
}

/// What else the path is made of.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(
    not(test),
    expect(dead_code, reason = "read in full by the tests of the weights alone")
)]
pub(super) enum Joint<'a> {
    /// s = 0: the last vertex of the eye emits, or the walk left the scene.
    Emitter {
        pdf: EmissionPdf,
        /// In which the light travels.
        direction: DVec3,
    },
    /// s = 1.
    Direct(&'a DirectSample),
    /// t = 1.
    Lens(&'a LensSample),
    /// t = 0.
    LensHit(&'a LensHit),
    /// Two vertices on surfaces.
    Surfaces,
}

impl Seen<'_> {
    /// For whoever looks at the path.
    #[cold]
    fn event(&self) -> Event {
        let last = |vertices: &[PathVertex]| Some(vertices.last()?.vertex.position);
        let points = match self.joint {
            Joint::Emitter { .. } | Joint::LensHit(_) => None,
            Joint::Direct(sample) => last(self.eye).zip(end(sample)),
            Joint::Lens(sample) => last(self.light).zip(Some(sample.position)),
            Joint::Surfaces => last(self.eye).zip(last(self.light)),
        };
        Event::Join {
            s: self.s,
            t: self.t,
            points: points.map(|(from, to)| [from, to]),
            weight: self.weight,
            value: self.value,
        }
    }
}

impl Witness for () {
    #[inline]
    fn see(&mut self, seen: &Seen<'_>) {
        note(|| seen.event());
    }
}
