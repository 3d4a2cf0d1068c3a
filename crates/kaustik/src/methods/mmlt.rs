//! Multiplexed Metropolis light transport (Hachisuka, Kaplanyan and Dachsbacher 2014):
//! a chain of [`PssmltEngine`](crate::methods::pssmlt::PssmltEngine) over [`Multiplexed`] paths.

use std::ops::Range;

use kaustik_mcmc::{Independent, SampleGenerators};
use kaustik_path::{
    Bidirectional, Contributions, Form, Multiplexed, RayCounts, TechniqueSpread, Techniques,
};
use kaustik_scene::Scene;
use rayon::prelude::*;

use crate::methods::builders::builder_settings;
use crate::sampling::streams;
use crate::{RenderError, RenderSettings, Strategies};

/// The most samples of the pilot: the probabilities need to be no better than roughly right.
const MOST_SAMPLES: u64 = 200_000;
/// It goes by so many rounds at most, each as long as all before it.
const ROUNDS: u32 = 7;
/// Light that is met but seldom comes late. Only after one in so many of the samples ...
const PATIENCE: u64 = 4;
/// ... a round that has changed no more than this share of the tries is the last.
const SETTLED: f64 = 0.05;
/// There is no further round after so many rays for each sample that the pilot may have: where walks hardly end, all
/// strategies of one sample take thousands.
const MOST_RAYS: u64 = 32;
/// What a thread takes at a time. Sums go by these, so that they do not depend on the threads.
const CHUNK: u64 = 64;

/// The builder, with probabilities by what its own samples saw.
pub(crate) fn builder(
    scene: &Scene,
    settings: &RenderSettings,
) -> Result<Multiplexed, RenderError> {
    if settings.max_depth > Techniques::MOST_EDGES {
        return Err(RenderError::Setting {
            what: "max-depth",
            found: settings.max_depth.to_string(),
            expected: format!("at most {} for {}", Techniques::MOST_EDGES, settings.method),
        });
    }
    let paths = Bidirectional {
        settings: builder_settings(settings),
        form: Form::Full,
        heuristic: settings.options.heuristic,
    };
    let lens = scene.camera().has_aperture();
    let even = Techniques::even(paths.settings.min_edges, settings.max_depth, lens);
    let strategies = settings.options.strategies == Strategies::Learned;
    if even.is_empty() {
        return Ok(Multiplexed::new(paths, even));
    }
    let most = settings.pilot().min(MOST_SAMPLES);
    let mut spread = TechniqueSpread::default();
    let mut rays = RayCounts::default();
    let mut learned = even.clone();
    for samples in rounds(most) {
        let is_enough = samples.end >= most / PATIENCE;
        look(scene, &paths, settings, samples, &mut spread, &mut rays);
        let better = even.learned(&spread, strategies);
        let is_settled = is_enough && !spread.is_empty() && better.differs_by(&learned) < SETTLED;
        learned = better;
        if is_settled || rays.closest + rays.any > MOST_RAYS * most {
            break;
        }
    }
    Ok(Multiplexed::new(paths, learned))
}

/// Indices of the samples of each round.
fn rounds(samples: u64) -> impl Iterator<Item = Range<u64>> {
    let ends = (0..ROUNDS).rev().map(move |left| samples >> left);
    ends.scan(0, |start, end| Some(std::mem::replace(start, end)..end))
}

/// How far the values of each strategy spread, as these samples see it, and what it took to see it.
fn look(
    scene: &Scene,
    paths: &Bidirectional,
    settings: &RenderSettings,
    samples: Range<u64>,
    spread: &mut TechniqueSpread,
    rays: &mut RayCounts,
) {
    let generators = SampleGenerators::new(settings.seed, streams::TECHNIQUES);
    let of_chunk = |value: &mut Contributions, chunk: u64| {
        let first = samples.start + chunk * CHUNK;
        let (mut spread, mut rays) = (TechniqueSpread::default(), RayCounts::default());
        for index in first..(first + CHUNK).min(samples.end) {
            let mut u = Independent::new(generators.at(index));
            spread.look(paths, scene, settings.options.target, &mut u, value);
            rays += value.rays();
        }
        (spread, rays)
    };
    let chunks = (samples.end - samples.start).div_ceil(CHUNK);
    let seen: Vec<(TechniqueSpread, RayCounts)> = (0..chunks)
        .into_par_iter()
        .map_init(Contributions::default, of_chunk)
        .collect();
    for (of_chunk, rays_of_chunk) in seen {
        spread.merge(&of_chunk);
        *rays += rays_of_chunk;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_follow_on_each_other_and_take_all_samples() {
        for samples in [1, 3, 64, 1_000, MOST_SAMPLES] {
            let rounds: Vec<_> = rounds(samples).collect();
            assert_eq!(rounds.len() as u32, ROUNDS);
            assert_eq!(
                (rounds[0].start, rounds[rounds.len() - 1].end),
                (0, samples)
            );
            assert!(rounds.windows(2).all(|pair| pair[0].end == pair[1].start));
        }
    }
}
