//! Small steps of primary samples.

use kaustik_mcmc::{Draws, Exponential, Mutation, Uniform};
use serde::{Deserialize, Serialize};

use crate::SmallStep;

/// Either kind of small step.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) enum Small {
    Kelemen(Exponential),
    Uniform(Uniform),
}

impl Mutation for Small {
    #[inline(always)]
    fn mutate<D: Draws + ?Sized>(&self, x: f64, draws: &mut D) -> f64 {
        match self {
            Self::Kelemen(mutation) => mutation.mutate(x, draws),
            Self::Uniform(mutation) => mutation.mutate(x, draws),
        }
    }

    fn mixed_after(&self) -> u64 {
        match self {
            Self::Kelemen(mutation) => mutation.mixed_after(),
            Self::Uniform(mutation) => mutation.mixed_after(),
        }
    }
}

impl Small {
    pub(crate) fn new(step: SmallStep) -> Self {
        match step {
            SmallStep::Kelemen(s1, s2) => Self::Kelemen(Exponential::new(s1, s2)),
            SmallStep::Uniform(fraction) => Self::Uniform(Uniform::new(fraction)),
        }
    }
}
