//! Independent samples before the chains: where these start, and what scales their picture.

use std::ops::Range;

use kaustik_estimate::PathTarget;
use kaustik_mcmc::{
    Family, Mean, Metropolis, Pool, SampleGenerators, generator, sample, sample_generator,
};
use kaustik_path::{Contributions, RayCounts};
use rayon::prelude::*;

use super::{Chain, Small};
use crate::engine::Nonfinite;
use crate::sampling::streams;
use crate::{RenderError, RenderSettings};

/// The constant in the weights needs to be no better than roughly right.
const CONSTANT_SHARE: u64 = 10;
/// Where light is hard to find at all, so many times the pool's samples look for it.
const PATIENCE: u64 = 10;

/// Densities of independent samples of a ladder, in parallel, in the order of their indices; NaN where
/// there is none.
pub(crate) fn pilot(
    target: PathTarget<'_>,
    family: &(impl Family<Contributions, 1> + Sync),
    settings: &RenderSettings,
    ladder: u64,
    samples: Range<u64>,
) -> Vec<f64> {
    let generators = SampleGenerators::new(settings.seed, ladder);
    (samples.start as usize..samples.end as usize)
        .into_par_iter()
        .with_min_len(256)
        .map_init(Contributions::default, |value, index| {
            let draws = generators.at(index as u64);
            sample(&target, family, draws, value).map_or(f64::NAN, |[density]| density)
        })
        .collect()
}

/// A rough estimate of b that knows nothing of the pool: samples of its own, a share of the pool's
/// number, and more until some see light. `None` if [`PATIENCE`] times as many as the pool's see none.
pub(super) fn rough_constant(
    target: PathTarget<'_>,
    family: &(impl Family<Contributions, 1> + Sync),
    settings: &RenderSettings,
) -> Option<f64> {
    let share = (settings.pilot() / CONSTANT_SHARE).max(1);
    let mut mean = Mean::new();
    for round in 0..PATIENCE * CONSTANT_SHARE {
        let samples = round * share..(round + 1) * share;
        pilot(target, family, settings, streams::CONSTANT, samples)
            .into_iter()
            .filter(|density| density.is_finite())
            .for_each(|density| mean.push(density));
        if mean.mean() > 0.0 {
            return Some(mean.mean());
        }
    }
    None
}

/// A chain for every ladder of this process. All ladders choose, so that a share of them starts as it
/// would among all. After a pool that saw nothing they start in the dark: what their large steps find
/// is as right as ever, while the film of the chains counts for nothing (b = 0) until a running
/// normaliser knows better.
pub(super) fn start_chains(
    target: PathTarget<'_>,
    family: &(impl Family<Contributions, 1> + Sync),
    pool: &Pool,
    settings: &RenderSettings,
) -> Result<Vec<Chain>, RenderError> {
    let mut choice = generator(settings.seed, streams::CHOICE);
    let range = settings.ladder_range();
    let mut chains = Vec::new();
    for ladder in 0..settings.options.ladders {
        let start = pool.choose(&mut choice);
        if !range.contains(&ladder) {
            continue;
        }
        let mut own = generator(settings.seed, u64::from(ladder));
        let small = Small::new(settings.options.small_step);
        let metropolis = match start {
            Some(start) => {
                let mut draws = sample_generator(settings.seed, streams::PILOT, start.index);
                Metropolis::rebuild(&target, family, 0, small, &start, &mut draws)?
            }
            None => Metropolis::start(&target, family, 0, small, &mut own),
        };
        chains.push(Chain {
            ladder,
            nonfinite: Nonfinite::default(),
            rays: RayCounts::default(),
            metropolis,
            draws: own,
        });
    }
    Ok(chains)
}
