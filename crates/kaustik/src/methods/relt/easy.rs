//! Implicit specular light that no chain need follow.

use std::fmt;

use kaustik_mcmc::Mean;

use super::climb::effective;
use super::noise;
use super::start::PoolSample;

/// Where of its scouts in the lit part of the image more than this share are effective ones, independent samples know its light as well as a chain
/// does: the heuristic shares it best.
const EASY: f64 = 1e-2;
/// Where its light would be less than this share of the noise of independent samples, a chain that follows it takes time from
/// what has the rest.
const LITTLE: f64 = 0.1;

/// Why implicit specular light is left to independent samples.
#[derive(Clone, Copy, Debug)]
pub(super) enum Easy {
    /// So large a share of walks from the camera find it.
    Found(f64),
    /// It has so small a share of the noise.
    Quiet(f64),
}

impl fmt::Display for Easy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Found(share) => {
                write!(
                    f,
                    "{:.0} % of walks from the camera find its light where the picture is lit",
                    100.0 * share
                )
            }
            Self::Quiet(share) => {
                write!(
                    f,
                    "independent samples have {:.1} % of their noise from its light",
                    100.0 * share
                )
            }
        }
    }
}

impl Easy {
    /// Judges what scouts have found, so many of them, and independent samples; `None` if a chain is worth its steps.
    pub(super) fn judge((finds, sent): &(Vec<f64>, u64), pool: &[PoolSample]) -> Option<Self> {
        let sent = (*sent).max(1) as f64;
        let sent_there = sent * noise::lit(pool);
        let found = effective(finds.iter().copied()) / sent_there;
        if found > EASY {
            return Some(Self::Found(found));
        }
        let specular = finds.iter().sum::<f64>() / sent;
        let other: Mean = pool.iter().map(|sample| sample.light.other).collect();
        let part = specular / (specular + other.mean());
        let noise = noise::of_finds(finds, sent_there, part)?;
        let share = noise / (noise + noise::of_samples(pool));
        (share < LITTLE).then_some(Self::Quiet(share))
    }
}
