//! Which segment of an uneven table a wavelength falls into, without a search.
//!
//! For each whole nanometre of the visible range the guide holds the last knot at or below it; a
//! look-up starts there and steps over the few knots that share the nanometre. The knots
//! themselves stay as measured: resampling them would round off their corners.

use crate::cmf::{KNOTS, NM_MAX, NM_MIN};

/// The last knot at or below each whole nanometre from 360 to 830, 0 where there is none.
#[derive(Clone, Debug)]
pub(crate) struct Guide([u16; KNOTS]);

impl Guide {
    /// Knots that a table may have.
    pub(crate) const MOST: usize = u16::MAX as usize;

    /// For knots that ascend strictly; at most [`Guide::MOST`] of them.
    pub(crate) const fn new(knots: &[f32]) -> Self {
        let mut out = [0; KNOTS];
        let (mut cell, mut knot) = (0, 0);
        while cell < KNOTS {
            let nm = NM_MIN + cell as f32;
            while knot + 1 < knots.len() && knots[knot + 1] <= nm {
                knot += 1;
            }
            out[cell] = knot as u16;
            cell += 1;
        }
        Self(out)
    }

    /// The knot to the left and how far the wavelength is to the next, 0 to 1. Wavelengths before
    /// the first knot or after the last give those knots, with 0.
    #[inline]
    pub(crate) fn find(&self, knots: &[f32], nm: f32) -> (usize, f32) {
        let start = nm.clamp(NM_MIN, NM_MAX) - NM_MIN;
        let mut i = usize::from(self.0[(start as usize).min(KNOTS - 1)]);
        while i > 0 && knots[i] > nm {
            i -= 1; // only below the visible range
        }
        while i + 1 < knots.len() && knots[i + 1] <= nm {
            i += 1;
        }
        match knots.get(i + 1) {
            Some(next) if nm > knots[i] => (i, (nm - knots[i]) / (next - knots[i])),
            _ => (i, 0.0),
        }
    }
}
