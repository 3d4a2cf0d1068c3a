//! Chains on paths: every set of mutations has the same picture.

use kaustik::{Method, RenderSettings};

use crate::support::{agree, scene, settings, tiles_of_seeds};

/// Each perturbation beside whole paths anew; the three that replica exchange was compared with; Kelemen's rival.
const SETS: [&str; 8] = [
    "bidirectional",
    "bidirectional,lens",
    "bidirectional,multichain",
    "bidirectional,caustic",
    "bidirectional,subpath",
    "bidirectional,wavelengths",
    "bidirectional,lens,caustic",
    "bidirectional,every:0.05",
];

/// What papers are measured by: the fast half is content with these.
const FEW: [&str; 2] = [SETS[6], SETS[7]];

/// `samples` a pixel of `bdpt`, so many mutations of each set, as pictures of so many seeds, known to a share of each tile.
fn assert_alike(
    (words, sets): (&str, &[&str]),
    side: u32,
    [samples, mutations]: [u64; 2],
    seeds: u64,
    share: f64,
    spared: usize,
) {
    let scene = scene(words, side);
    let truth = settings(Method::Bdpt, side, samples);
    let tiles = |settings: &RenderSettings, seeds| tiles_of_seeds(&scene, settings, seeds);
    let of_truth = tiles(&truth, 0..seeds);
    for set in sets {
        let mut settings = settings(Method::Mlt, side, mutations);
        settings.options.pilot = 50_000;
        let words_of_set = format!("mutations={set}");
        let known = settings.options.set(Method::Mlt, &words_of_set);
        known.expect("a set of mutations");
        let verdict = agree(&of_truth, &tiles(&settings, 0..seeds), |_| true, share);
        assert!(
            verdict.uncertain.len() <= spared,
            "{words}, {set}: {verdict:?}"
        );
        if verdict.rejected.is_empty() {
            continue;
        }
        // Few chains come to some caustics, so that means of few seeds are not normal: a fault is there again.
        let fresh = 100..100 + 2 * seeds;
        let again = [&truth, &settings].map(|settings| tiles(settings, fresh.clone()));
        let rejected = |tile: usize| verdict.rejected.contains(&tile);
        let second = agree(&again[0], &again[1], rejected, share);
        assert!(
            second.rejected.is_empty() && second.uncertain.is_empty(),
            "{words}, {set}: {verdict:?}, then {second:?}"
        );
    }
}

#[test]
fn sets_of_mutations_agree_roughly() {
    assert_alike(("cornell", &FEW), 16, [128, 256], 8, 0.15, 0);
}

#[test]
#[ignore = "long"]
fn all_sets_of_mutations_agree() {
    for words in [
        "cornell-indirect",
        "ring-and-sphere?light=0.8",
        "glass-cube?light=0.8",
    ] {
        assert_alike((words, &SETS), 32, [1_000, 4_000], 16, 0.05, 3);
    }
}
