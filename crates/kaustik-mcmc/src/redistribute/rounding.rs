//! Whole numbers of chains from mean ones.

use crate::Draws;

/// How a redistributor rounds the number of chains of a start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(transparent))]
pub(super) struct Rounding {
    /// What starts so far have left over, in [0, 1); `None`: each start is rounded by itself.
    #[cfg_attr(
        feature = "serde",
        serde(deserialize_with = "crate::serial::left_over")
    )]
    carried: Option<f64>,
}

impl Rounding {
    pub(super) fn carry(&mut self, carried: Option<f64>) {
        // What is no such share (not a number, say) is none.
        self.carried = carried.filter(|share| (0.0..1.0).contains(share));
    }

    pub(super) fn carried(&self) -> Option<f64> {
        self.carried
    }

    /// A whole number whose mean is this one (finite, at least 0): over `draws`, or over what was carried first.
    pub(super) fn round<D: Draws + ?Sized>(&mut self, mean: f64, draws: &mut D) -> u32 {
        match &mut self.carried {
            None => {
                let whole = mean.floor();
                whole as u32 + u32::from(draws.bernoulli(mean - whole))
            }
            Some(share) => {
                let sum = *share + mean;
                let whole = sum.floor();
                *share = sum - whole;
                whole as u32
            }
        }
    }
}
