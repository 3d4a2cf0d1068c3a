//! What a walk looks for.

use crate::Hit;

/// Decides which candidates count, and so how far the walk still has to look.
pub(crate) trait Goal {
    /// Whether it pays to visit the nearest first.
    const ORDERED: bool;

    /// Least `t` of interest, included.
    fn low(&self) -> f32;

    /// Greatest `t` of interest, included. May only shrink.
    fn high(&self) -> f32;

    /// Takes a hit with `low <= t <= high`. Whether the walk can stop.
    fn offer(&mut self, hit: Hit) -> bool;
}

/// The first hit in the order of [`Hit::precedes`] that the filter counts and that comes after a given one.
pub(crate) struct Closest<'a, F> {
    pub(crate) filter: F,
    pub(crate) after: Option<&'a Hit>,
    pub(crate) low: f32,
    pub(crate) high: f32,
    pub(crate) best: Option<Hit>,
}

impl<F: FnMut(&Hit) -> bool> Goal for Closest<'_, F> {
    const ORDERED: bool = true;

    #[inline(always)]
    fn low(&self) -> f32 {
        self.low
    }

    #[inline(always)]
    fn high(&self) -> f32 {
        self.high
    }

    #[inline(always)]
    fn offer(&mut self, hit: Hit) -> bool {
        let later = self.after.is_none_or(|after| after.precedes(&hit));
        if later && self.best.is_none_or(|best| hit.precedes(&best)) && (self.filter)(&hit) {
            self.high = hit.t;
            self.best = Some(hit);
        }
        false
    }
}

/// Any hit that the filter counts.
pub(crate) struct Any<F> {
    pub(crate) filter: F,
    pub(crate) low: f32,
    pub(crate) high: f32,
}

impl<F: FnMut(&Hit) -> bool> Goal for Any<F> {
    const ORDERED: bool = false;

    #[inline(always)]
    fn low(&self) -> f32 {
        self.low
    }

    #[inline(always)]
    fn high(&self) -> f32 {
        self.high
    }

    #[inline(always)]
    fn offer(&mut self, hit: Hit) -> bool {
        (self.filter)(&hit)
    }
}
