//! The weight of each kind of strategy, from what runs along the subpaths.
//!
//! A weight is `1 / (1 + fewer + more)`: the strategies with fewer vertices from the light, and those
//! with more, relative to the one at hand. Either is the density with which the other side would make
//! the joined vertex, times what the vertex knows of its rivals ([`Running::rivals`]), over the
//! odds with which this very join is made.

use kaustik_scene::EmissionPdf;
use kaustik_spectrum::Spectrum;

use super::joined::Joined;
use super::running::Running;
use super::{Form, Heuristic};

/// What weights depend on besides the path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weights {
    pub(super) form: Form,
    pub(super) heuristic: Heuristic,
}

/// A path's value, its weight included, before anything is known of what stands in its way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weighted {
    pub(super) weight: f64,
    pub(super) value: Spectrum,
}

impl Weighted {
    /// `scale` is all that the value is still to be multiplied by, the weight included; `None` if nothing is left.
    #[inline]
    pub(super) fn new(value: Spectrum, scale: f64, weight: f64) -> Option<Self> {
        let value = value * scale as f32;
        (!value.is_zero()).then_some(Self { weight, value })
    }
}

/// A point of an emitter that next event found.
#[derive(Clone, Copy, Debug)]
pub(super) struct DirectEnd {
    /// Density per solid angle with which it was found; `None` where no ray can run into it.
    pub(super) pdf: Option<f64>,
    /// How much more often next event chooses the emitter from there than light walks do.
    pub(super) odds: f64,
    /// Density of the direction from it.
    pub(super) emission_pdf: f64,
    /// Square of the distance; 1 at infinity.
    pub(super) squared: f64,
}

/// A point of the lens.
#[derive(Clone, Copy, Debug)]
pub(super) struct LensEnd {
    /// Density with which a walk from it would reach the vertex, per area perpendicular to the edge.
    pub(super) raster: f64,
    /// Square of the distance.
    pub(super) squared: f64,
    /// Cosine at the lens.
    pub(super) cos: f64,
    /// Density of the point; `None` where no ray can run into the lens.
    pub(super) pdf: Option<f64>,
}

impl Weights {
    /// s = 0: an emitter that the eye's walk ran into after `edges` edges. One that is seen directly
    /// has no rival. `choice` tells how much more often next event chooses the emitter, from the vertex before, than light walks do.
    #[inline]
    pub(super) fn implicit(
        &self,
        edges: u32,
        pdf: &EmissionPdf,
        choice: impl FnOnce() -> f64,
        running: &Running,
    ) -> f64 {
        if edges == 1 {
            return 1.0;
        }
        let emitter = self.form.at_emitter();
        let rivals = running.rivals(self.heuristic, emitter.odds() * choice(), pdf.direction);
        let more = self.heuristic.of(pdf.position * emitter.onward) * rivals;
        self.heuristic.weight(0.0, more)
    }

    /// s = 1: the vertex `z` of the eye.
    #[inline]
    pub(super) fn direct(&self, z: &Joined<'_>, end: &DirectEnd) -> f64 {
        let [pdf, back] = z.pdfs;
        let heuristic = self.heuristic;
        let emitter = self.form.at_emitter();
        let odds = z.vertex.onward.odds() * emitter.odds();
        let scattered = |found| heuristic.of(pdf / (found * odds * emitter.onward));
        let fewer = end.pdf.map_or(0.0, scattered);
        let area = end.emission_pdf * z.cos() / (end.squared * end.odds);
        let rivals = z.vertex.rivals(heuristic, back);
        heuristic.weight(fewer, heuristic.of(area / odds) * rivals)
    }

    /// s >= 2, t >= 2: `y` of the light and `z` of the eye, at the square of a distance.
    #[inline]
    pub(super) fn joined(&self, y: &Joined<'_>, z: &Joined<'_>, squared: f64) -> f64 {
        let heuristic = self.heuristic;
        let scale = 1.0 / (z.vertex.onward.odds() * y.vertex.onward.odds() * squared);
        let by_eye = z.pdfs[0] * y.cos();
        let by_light = y.pdfs[0] * z.cos();
        let fewer = heuristic.of(by_eye * scale) * y.vertex.rivals(heuristic, y.pdfs[1]);
        let more = heuristic.of(by_light * scale) * z.vertex.rivals(heuristic, z.pdfs[1]);
        heuristic.weight(fewer, more)
    }

    /// t = 1: `y` of the light.
    #[inline]
    pub(super) fn lens_joined(&self, y: &Joined<'_>, end: &LensEnd) -> f64 {
        let heuristic = self.heuristic;
        let lens = self.form.at_lens();
        let odds = y.vertex.onward.odds() * lens.odds();
        let [pdf, back] = y.pdfs;
        let fewer = heuristic.of(end.raster * y.cos() / odds) * y.vertex.rivals(heuristic, back);
        let more = end.pdf.map_or(0.0, |position| {
            let area = pdf * end.cos / end.squared;
            heuristic.of(area / (odds * position * lens.onward))
        });
        heuristic.weight(fewer, more)
    }

    /// t = 0: a lens that the light's walk ran into; `position` is the density of its point, `back` that
    /// of the direction in which the camera would send a walk.
    #[inline]
    pub(super) fn lens_hit(&self, running: &Running, position: f64, back: f64) -> f64 {
        let lens = self.form.at_lens();
        let rivals = running.rivals(self.heuristic, lens.odds(), back);
        let fewer = self.heuristic.of(position * lens.onward) * rivals;
        self.heuristic.weight(fewer, 0.0)
    }
}
