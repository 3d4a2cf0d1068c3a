//! Normalisers of chains against plain counts of the same targets.

use kaustik_estimate::{PhotonLevels, PhotonTargetKind};
use kaustik_mcmc::{Mean, SampleGenerators};
use rayon::prelude::*;

use super::start::Pilot;
use super::{PhotonChains, Space, Stage, Tracer};
use crate::{Method, small};

const SIZE: [u32; 2] = [16; 2];
const LEVELS: usize = PhotonTargetKind::ALL.len();
const ITERATIONS: usize = 3;
const SEEDS: u64 = 32;
/// Light paths that a plain count takes.
const PLAIN: usize = 50_000;

/// What chains tell of a target's normaliser, as a share of what a plain count does, and the relative errors of both.
#[derive(Clone, Copy)]
struct Told {
    share: f64,
    errors: [f64; 2],
}

/// Of each iteration and level, under the targets that the iteration had; the plain count is of the level `other` makes of it.
fn told(words: &str, seed: u64, other: fn(usize) -> usize) -> [[Told; LEVELS]; ITERATIONS] {
    let mut settings = small::settings(Method::PhotonSpatial, SIZE);
    settings.seed = seed;
    settings.options.photon.photons = Some(60_000);
    settings.options.pilot = 20_000;
    let scene = small::scene(words, SIZE);
    let mut stage = Stage::new(&scene, &settings);
    let mut spare = None;
    let levels = PhotonLevels(PhotonTargetKind::ALL);
    let mut chains = None;
    std::array::from_fn(|iteration| {
        stage.begin(None);
        let chains = chains.get_or_insert_with(|| {
            PhotonChains::new(&stage, &settings, levels, Space::World).expect("chains")
        });
        let spare = spare.get_or_insert_with(|| stage.film(&settings).expect("a film"));
        assert!(chains.trace(&stage, spare, None));
        // Far from the streams of ladders and starts.
        let generators = SampleGenerators::new(seed, u64::MAX / 2 + iteration as u64);
        let pilot = Pilot {
            target: chains.target(&stage),
            levels,
            generators,
        };
        let mut plain: [Mean; LEVELS] = std::array::from_fn(|_| Mean::new());
        for densities in pilot.samples(PLAIN) {
            for (mean, density) in plain.iter_mut().zip(densities) {
                mean.push(density);
            }
        }
        std::array::from_fn(|level| {
            let ([value, error], plain) = (chains.normalisers[level], plain[other(level)]);
            Told {
                share: value / plain.mean(),
                errors: [error / value, plain.standard_error() / plain.mean()],
            }
        })
    })
}

/// Over the seeds: the mean share less one in its standard errors, how uncertain it is, and by how much shares spread, in the errors that
/// are told of them.
fn over_seeds(words: &str, other: fn(usize) -> usize) -> Vec<[f64; 3]> {
    let seeds: Vec<_> = (0..SEEDS)
        .into_par_iter()
        .map(|seed| told(words, seed, other))
        .collect();
    let cases = (0..ITERATIONS).flat_map(|i| (1..LEVELS).map(move |level| (i, level)));
    let case = |(iteration, level): (usize, usize)| {
        let all = seeds.iter().map(|seed| seed[iteration][level]);
        let shares: Mean = all.clone().map(|told| told.share).collect();
        let squares: Mean = all
            .map(|told| told.errors[0].powi(2) + told.errors[1].powi(2))
            .collect();
        let error = shares.standard_error();
        let spread = (shares.variance() / squares.mean()).sqrt();
        [(shares.mean() - 1.0) / error, error, spread]
    };
    cases.map(case).collect()
}

/// Each from the chain below, the other from the uniform distribution alone; targets change from one iteration to the next.
#[test]
fn normalisers_agree_with_plain_counts() {
    for [off, error, spread] in over_seeds("cornell", |level| level) {
        assert!(off.abs() < 4.0 && error < 0.02, "{off} errors of {error}");
        // Errors are told from the spread of a few ladders.
        assert!((0.5..2.0).contains(&spread), "{spread}");
    }
    // What is the normaliser of another target is found.
    for [off, ..] in over_seeds("cornell", |level| level.saturating_sub(1)) {
        assert!(off.abs() > 8.0, "{off}");
    }
}

/// The light of all pixels after an iteration whose chains take visibility's normaliser for so many times what it is.
fn light(rough: f64) -> f64 {
    let mut settings = small::settings(Method::PhotonVisibility, SIZE);
    settings.options.photon.photons = Some(60_000);
    let scene = small::scene("cornell", SIZE);
    let mut stage = Stage::new(&scene, &settings);
    stage.begin(None);
    let levels = PhotonLevels([PhotonTargetKind::Uniform, PhotonTargetKind::Visibility]);
    let mut chains = PhotonChains::new(&stage, &settings, levels, Space::World).expect("chains");
    chains.rough[1] *= rough;
    let mut spare = stage.film(&settings).expect("a film");
    assert!(chains.trace(&stage, &mut spare, None));
    chains.sums.iter().map(|xyz| xyz[1]).sum()
}

/// Where a trillionth of all light paths is visible a visit stands for a trillionth of a photon: any rough normaliser gives the
/// same picture.
#[test]
fn visits_that_stand_for_little_are_not_rounded_away() {
    let ratio = light(1e-12) / light(1.0);
    assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
}
