use kaustik_spectrum::Spectrum;

use crate::matter::Passage;

/// The way to the next vertex of a walk.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    /// Share of light that what fills the space has left over; all of it where the ray leaves the scene.
    pub transmittance: Spectrum,
    /// One over the chance to pass each smooth pane on the way, times the share of light that passes; and one over the
    /// chance to meet the surface, if that is one. 1 without panes: holes stop the same share of rays as of light.
    pub weight: Spectrum,
    /// Length in scene units; infinite where the ray leaves the scene.
    pub distance: f64,
    /// Did it go through a smooth pane?
    pub through_pane: bool,
    /// Did it go through a surface that not all rays and not all light pass: a pane, or one of partial alpha? Where it did
    /// not, [`Scene::visibility`](crate::Scene::visibility) between its ends is 1.
    pub by_chance: bool,
}

impl Segment {
    pub(super) fn escaping<U: FnOnce() -> f64>(passage: &Passage<'_, U>) -> Self {
        Self {
            transmittance: Spectrum::ONE,
            weight: passage.weight,
            distance: f64::INFINITY,
            through_pane: passage.through_pane,
            by_chance: passage.by_chance,
        }
    }

    /// Does the ray leave the scene?
    #[inline]
    pub fn escapes(&self) -> bool {
        self.distance.is_infinite()
    }

    /// What a walk's throughput is multiplied by.
    #[inline]
    pub fn factor(&self) -> Spectrum {
        self.transmittance * self.weight
    }
}
