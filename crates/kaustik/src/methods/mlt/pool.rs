//! Independent samples before the chains: where these start, and what scales their picture.

use kaustik_estimate::RasterMap;
use kaustik_mcmc::{Mean, Metropolis, Pool, SampleGenerators, generator, sample_generator};
use kaustik_mutate::{Path, PathSpace, Seeds};
use rayon::prelude::*;

use super::{Chain, density, weight};
use crate::RenderSettings;
use crate::engine::Nonfinite;
use crate::sampling::streams;

/// Weights of independent samples, in parallel, in the order of their indices.
pub(super) fn weights(
    space: &PathSpace<'_>,
    map: &RasterMap,
    settings: &RenderSettings,
) -> Vec<f64> {
    let generators = SampleGenerators::new(settings.seed, streams::PILOT);
    (0..settings.pilot() as usize)
        .into_par_iter()
        .with_min_len(256)
        .map_init(
            || (Seeds::new(space), Path::default()),
            |(seeds, path), index| {
                let sampled = seeds.sample(path, &mut generators.at(index as u64));
                sampled * weight(map, path)
            },
        )
        .collect()
}

/// A chain for every ladder of this process; none if the pool saw nothing. All ladders choose, so that a
/// share of them starts as it would among all.
pub(super) fn start_chains(
    space: &PathSpace<'_>,
    map: &RasterMap,
    pool: &Pool,
    settings: &RenderSettings,
) -> Vec<Chain> {
    let mut choice = generator(settings.seed, streams::CHOICE);
    let range = settings.ladder_range();
    let mut seeds = Seeds::new(space);
    let mut chains = Vec::new();
    for ladder in 0..settings.options.ladders {
        let Some(start) = pool.choose(&mut choice) else {
            break;
        };
        if !range.contains(&ladder) {
            continue;
        }
        let mut path = Path::default();
        let mut draws = sample_generator(settings.seed, streams::PILOT, start.index);
        seeds.sample(&mut path, &mut draws);
        chains.push(Chain {
            ladder,
            nonfinite: Nonfinite::default(),
            draws: generator(settings.seed, u64::from(ladder)),
            fresh: generator(settings.seed, streams::fresh(ladder)),
            independent: Mean::new(),
            metropolis: Metropolis::at((), path, &density(map), 0),
        });
    }
    chains
}
