use kaustik_bsdf::Passing;
use kaustik_spectrum::{Spectrum, Wavelengths};

use crate::Passed;

/// How light gets past one surface without being scattered: by its holes (alpha), and straight through it where it is a
/// smooth pane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Opening {
    /// Share of the surface that is there, in [0, 1].
    pub(super) opacity: f32,
    /// What passes where it is; `None`: it is no pane.
    pub(super) pane: Option<Passing>,
}

impl Opening {
    /// Probability that a ray passes: the mean share over the wavelengths.
    #[inline]
    fn chance(&self) -> f64 {
        1.0 - self.stop()
    }

    /// Probability that a ray ends here.
    #[inline]
    fn stop(&self) -> f64 {
        let opacity = f64::from(self.opacity);
        match self.pane {
            None => opacity,
            Some(pane) => opacity * pane.meeting(),
        }
    }

    /// What is left of what has passed so far.
    #[inline]
    pub(super) fn dim(&self, passed: Passed) -> Passed {
        let chance = self.chance();
        if chance <= 0.0 {
            return Passed::NOTHING;
        }
        Passed {
            chance: passed.chance * chance,
            share: passed.share * self.share(),
        }
    }

    /// Share of light that passes.
    #[inline]
    fn share(&self) -> Spectrum {
        let beside = Spectrum::splat(1.0 - self.opacity);
        match self.pane {
            None => beside,
            Some(pane) => beside + pane.share * self.opacity,
        }
    }
}

/// What has become of a segment's light at surfaces that let some of it pass so far.
///
/// One number `u` for the whole segment, asked for at the first such surface, stops it where
/// the chance to have come so far falls to u.
pub(crate) struct Passage<'w, U> {
    pub(super) wavelengths: &'w Wavelengths,
    ask: Option<U>,
    threshold: f64,
    passed: f64,
    /// What light carries that has come so far, or has met a pane: one over the chance of it, times the share.
    pub(crate) weight: Spectrum,
    /// Has light gone through a pane?
    pub(crate) through_pane: bool,
    /// Has light gone through a surface that only some rays pass: a pane, or one of partial alpha?
    pub(crate) by_chance: bool,
}

impl<'w, U: FnOnce() -> f64> Passage<'w, U> {
    /// At the start of a segment.
    #[inline]
    pub(crate) fn new(wavelengths: &'w Wavelengths, u: U) -> Self {
        Self {
            wavelengths,
            ask: Some(u),
            threshold: 0.0,
            passed: 1.0,
            weight: Spectrum::ONE,
            through_pane: false,
            by_chance: false,
        }
    }

    /// Does the segment end at a surface like this?
    pub(super) fn is_stopped_by(&mut self, opening: &Opening) -> bool {
        let stops = self.falls_at(opening);
        if let Some(pane) = opening.pane {
            // Light that is neither scattered nor swallowed has passed already.
            self.weight *= match stops {
                true => Spectrum::splat((1.0 / pane.meeting()) as f32),
                false => opening.share() * (1.0 / opening.chance()) as f32,
            };
            self.through_pane |= !stops;
        }
        self.by_chance |= !stops && opening.opacity > 0.0;
        stops
    }

    fn falls_at(&mut self, opening: &Opening) -> bool {
        let stop = opening.stop();
        if stop >= 1.0 {
            return true;
        }
        if stop <= 0.0 {
            return false;
        }
        if let Some(u) = self.ask.take() {
            self.threshold = u();
        }
        self.passed *= 1.0 - stop;
        self.passed <= self.threshold
    }
}
