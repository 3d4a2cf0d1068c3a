//! How weight is spread: lengths of chains, what their steps deposit, filters.

use std::fmt;

use crate::Mean;

/// How weight is spread.
#[doc(alias = "energy redistribution")]
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Written"))]
pub struct Redistribution {
    pub(super) steps: u32,
    pub(super) unit: f64,
    most: u32,
    pub(super) patience: Option<u64>,
    plain: bool,
}

impl Redistribution {
    /// Chains of `steps` steps, each of which deposits `unit`; at most 1,000 chains a
    /// start, expected-value deposits, no filter.
    ///
    /// `unit` (the deposition energy e_d of the paper) may be any constant: it decides how
    /// many chains there are, not what they estimate. See [`pilot`](Self::pilot).
    ///
    /// # Errors
    ///
    /// If there are no steps, or the unit is not finite and positive.
    pub fn new(steps: u32, unit: f64) -> Result<Self, RedistributionError> {
        if steps == 0 {
            return Err(RedistributionError::Steps);
        }
        if !(unit.is_finite() && unit > 0.0) {
            return Err(RedistributionError::Unit { unit });
        }
        Ok(Self {
            steps,
            unit,
            most: 1000,
            patience: None,
            plain: false,
        })
    }

    /// As [`new`](Self::new), with the unit that makes about one chain a start: the mean
    /// weight of pilot samples over `steps` (Batty's Algorithm 1).
    ///
    /// The pilot must be other samples than the starts, or the unit is no constant.
    ///
    /// # Errors
    ///
    /// As for [`new`](Self::new): also if the pilot has seen nothing.
    pub fn pilot(steps: u32, weights: &Mean) -> Result<Self, RedistributionError> {
        Self::new(steps, weights.mean() / f64::from(steps))
    }

    /// At most so many chains a start (at least 1). The deposits of a start that would have
    /// more are made larger instead, so that nothing is lost.
    #[must_use]
    pub fn most_chains(self, most: u32) -> Self {
        Self {
            most: most.max(1),
            ..self
        }
    }

    /// Deposits the whole unit where the chain is after each step, instead of the expected
    /// values.
    #[must_use]
    pub fn plain(self) -> Self {
        Self {
            plain: true,
            ..self
        }
    }

    /// The consecutive-sample filter (Batty sec. 4.2): while a chain has stayed in one state
    /// for more than `patience` rejections, nothing is deposited for its staying. What
    /// proposals are given is kept.
    ///
    /// **Biased**: weight is lost, mostly in small dense places (a stress test lost a
    /// quarter of all); [`crate::RedistributionStatistics::dropped`] says how much. Off by
    /// default. The authors use 10 or 20.
    #[must_use]
    pub fn patience(self, patience: u64) -> Self {
        Self {
            patience: Some(patience),
            ..self
        }
    }

    /// The weight of a step, unless a start has too many chains.
    pub fn unit(&self) -> f64 {
        self.unit
    }

    /// The number of steps of a chain.
    pub fn steps(&self) -> u32 {
        self.steps
    }

    /// The mean number of chains of a start of weight `weight` and the unit of their
    /// deposits. The product of both and the number of steps is the weight.
    pub(super) fn share(&self, weight: f64) -> (f64, f64) {
        let steps = f64::from(self.steps);
        let mean = weight / (steps * self.unit);
        let most = f64::from(self.most);
        if mean > most {
            (most, weight / (steps * most))
        } else {
            (mean, self.unit)
        }
    }
}

/// Why weight cannot be spread so.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum RedistributionError {
    /// A chain must have steps.
    Steps,
    /// The unit is not finite and positive: a pilot, perhaps, that saw nothing.
    Unit {
        /// What it was.
        unit: f64,
    },
}

impl fmt::Display for RedistributionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Steps => write!(f, "chains of no steps deposit nothing"),
            Self::Unit { unit } => write!(
                f,
                "the weight that a step deposits must be finite and positive, not {unit:e}"
            ),
        }
    }
}

impl std::error::Error for RedistributionError {}

#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct Written {
    steps: u32,
    unit: f64,
    most: u32,
    patience: Option<u64>,
    plain: bool,
}

#[cfg(feature = "serde")]
impl TryFrom<Written> for Redistribution {
    type Error = RedistributionError;

    fn try_from(written: Written) -> Result<Self, RedistributionError> {
        Ok(Self {
            patience: written.patience,
            plain: written.plain,
            ..Self::new(written.steps, written.unit)?.most_chains(written.most)
        })
    }
}

impl Redistribution {
    /// What a step deposits on its proposal and on the state that it began in.
    pub(super) fn split(&self, a: f64, accepted: bool, unit: f64) -> (f64, f64) {
        match (self.plain, accepted) {
            (false, _) => (a * unit, (1.0 - a) * unit),
            (true, true) => (unit, 0.0),
            (true, false) => (0.0, unit),
        }
    }
}
