//! What a render tells about itself.

pub(crate) mod energy;
mod merge;
mod replica;

pub use energy::EnergyStatistics;
pub use merge::{MergeStatistics, MergedPart, Parts};
pub use replica::{ReplicaLevel, ReplicaStatistics};

use std::fmt;

use kaustik_film::Counters;
use kaustik_mcmc::Statistics;
use kaustik_path::RayCounts;
use serde::{Deserialize, Serialize, Serializer};

/// What a render tells about itself; goes into the image file and into `--stats`.
#[derive(Clone, Debug, Serialize)]
pub struct RenderStatistics {
    /// Name of the method.
    pub method: String,
    /// Seed.
    pub seed: u64,
    /// Independent chains or streams.
    pub ladders: u32,
    /// Samples or mutations.
    pub steps: u64,
    /// How many of them the budget allows, in the units that the method takes them in; `None` by time, and of merges. A state may
    /// hold more.
    pub planned: Option<u64>,
    /// Samples or mutations a pixel.
    pub per_pixel: f64,
    /// Wall-clock seconds of sampling.
    pub seconds: f64,
    /// Wall-clock seconds of the pilot before it.
    pub pilot_seconds: f64,
    /// Share of the start's samples that were to be made: 1, or a power of 1/2 where there was no time for all
    /// ([`StartShare`](crate::StartShare)). Of an average of renders the smallest.
    pub start_share: f64,
    /// Contributions that were not finite, left out.
    pub nonfinite: u64,
    /// Where the first of them arose, by ladder, at most [`MOST_PLACES`](Self::MOST_PLACES): with seed and settings all
    /// that [`replay`](fn@crate::replay) needs.
    pub nonfinite_places: Vec<StepId>,
    /// Rays of all steps, the pilot's and the meter's left out; of methods that count them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rays: Option<RayCounts>,
    /// What the films left out.
    pub film: Counters,
    /// Of a chain method.
    pub chain: Option<ChainStatistics>,
    /// Of direct light rendered apart; its samples are among the steps.
    pub direct: Option<DirectStatistics>,
    /// Of replica exchange.
    pub replicas: Option<ReplicaStatistics>,
    /// Of each kind of mutation of paths.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mutations: Vec<MutationStatistics>,
    /// Of energy redistribution.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy: Option<EnergyStatistics>,
    /// Of chains of photons.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub photons: Option<PhotonStatistics>,
    /// Of the stages of a multi-stage method, the one at work last.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub stages: Vec<StageStatistics>,
    /// Of parts that were merged.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub merged: Option<MergeStatistics>,
}

/// What chains of photons tell about themselves.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PhotonStatistics {
    /// Iterations so far.
    pub iterations: u64,
    /// Regions that the target goes by; 0 without any.
    pub regions: usize,
    /// Standard deviation of the power of photons of uniform light paths over its mean, at the wavelengths of the first
    /// iteration. The spatial target takes all photons for equally bright (G Eq. 5).
    pub power_spread: f64,
    /// The levels of a ladder, the uniform one first.
    pub levels: Vec<PhotonLevel>,
}

/// One level of the ladders of a photon method.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PhotonLevel {
    /// What its chain follows: `uniform`, `visibility`, `density`, `inverse-kernel` or `full`.
    pub target: &'static str,
    /// The target's integral, in the last iteration.
    pub normaliser: f64,
    /// Its standard error.
    pub error: f64,
    /// Mean acceptance of small steps.
    pub acceptance: f64,
    /// Their size: `m` of Hachisuka and Jensen's mutation.
    pub step_size: f64,
}

/// One stage of a multi-stage method.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StageStatistics {
    /// Cells of its map along the longer side of the picture; 1 where there is no picture to go by yet.
    pub width: u32,
    /// Its mutations.
    pub mutations: u64,
    /// The integral of its target: the scalar contribution, which stages after the first divide by what the
    /// picture so far has there.
    pub normalisation: f64,
    /// Its standard error.
    pub normalisation_error: f64,
    /// Mean acceptance of small steps.
    pub small_acceptance: f64,
    /// Mean acceptance of large steps.
    pub large_acceptance: f64,
}

/// What one kind of mutation of paths did.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MutationStatistics {
    /// Its name among the settings.
    pub name: &'static str,
    /// Proposals made.
    pub proposed: u64,
    /// Their mean acceptance.
    pub acceptance: f64,
}

impl RenderStatistics {
    /// Most places of contributions that were not finite.
    pub const MOST_PLACES: usize = 32;
}

/// A sample or step among all of a render. Is written as `LADDER:STEP`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct StepId {
    /// Which chain or stream; [`LAMPS`](Self::LAMPS), written as `lamps`, of emitters seen directly beside chains;
    /// [`METER`](Self::METER), written as `meter`, of samples of the brightness beside them.
    #[serde(serialize_with = "ladder")]
    pub ladder: u32,
    /// Its step, counted from 0.
    pub step: u64,
}

impl StepId {
    /// Stands for a ladder of samples that belong to none: those of emitters and surroundings seen directly beside
    /// chains ([`Direct::Lamps`](crate::Direct::Lamps)).
    pub const LAMPS: u32 = u32::MAX;
    /// Stands for the samples beside chains that measure the brightness of the picture as a whole.
    pub const METER: u32 = u32::MAX - 1;
}

impl fmt::Display for StepId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.ladder {
            Self::LAMPS => write!(f, "lamps:{}", self.step),
            Self::METER => write!(f, "meter:{}", self.step),
            ladder => write!(f, "{ladder}:{}", self.step),
        }
    }
}

fn ladder<S: Serializer>(ladder: &u32, to: S) -> Result<S::Ok, S::Error> {
    match *ladder {
        StepId::LAMPS => to.serialize_str("lamps"),
        StepId::METER => to.serialize_str("meter"),
        ladder => to.serialize_u32(ladder),
    }
}

/// What became of direct light that was rendered apart from the chains.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct DirectStatistics {
    /// The longest paths that count as direct light, in edges.
    pub max_edges: u32,
    /// Number of independent samples of them.
    pub samples: u64,
}

/// What chains tell about themselves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ChainStatistics {
    /// Mean acceptance of small steps.
    pub small_acceptance: f64,
    /// Mean acceptance of large steps.
    pub large_acceptance: f64,
    /// Estimate of the integral of the scalar contribution (the setting `target`: X + Y + Z, or luminance) that scales
    /// the image; without what samples beside the chains see to. Of photon methods the integral of the last target of the
    /// last iteration, which scales that one alone.
    pub normalisation: f64,
    /// Its standard error; of photon methods given that iteration's points and wavelengths.
    pub normalisation_error: f64,
    /// Share of `normalisation`, in [0, 1], that comes from samples taken only to measure brightness (the
    /// meter); the rest comes from samples that the method takes anyway. For `relt`: the same for the
    /// specific replica's light.
    pub metered: f64,
    /// The constant in the weights.
    pub b0: f64,
    /// Longest stay in one state, in steps.
    pub longest_stay: u64,
    /// Proposals whose density was not valid.
    pub defects: u64,
}

impl ChainStatistics {
    pub(crate) fn new<const K: usize>(
        statistics: &Statistics<K>,
        [b, error]: [f64; 2],
        b0: f64,
    ) -> Self {
        Self {
            small_acceptance: statistics.small().rate(),
            large_acceptance: statistics.large().rate(),
            normalisation: b,
            normalisation_error: error,
            metered: 0.0,
            b0,
            longest_stay: statistics.longest_stay,
            defects: statistics.defects,
        }
    }
}
