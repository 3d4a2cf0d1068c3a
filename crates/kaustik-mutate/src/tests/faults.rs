//! With any factor of its densities left out, a kernel does not keep the measure.

use std::collections::BTreeSet;

use kaustik_mcmc::generator;
use kaustik_mcmc::testing::PairedTest;

use super::kinds::{
    BIDIRECTIONAL, BLIND, CAUSTIC, EVERY, Kind, LENS, MULTICHAIN, SUBPATH, TIME, WAVELENGTHS,
    changes, with_pieces,
};
use super::stage::scene;
use crate::factor::Factor::{self, *};
use crate::factor::planted::met;

/// Each factor of each kernel, with the scene where it shows.
const FAULTS: &[(Kind, &[(Factor, &str)])] = &[
    (
        LENS,
        &[
            (Raster, "diffuse"),
            (CosToLight, "diffuse"),
            (DistanceToLight, "diffuse"),
            (CosBeforeRunToLight, "ceiling"),
            (PassedToLight, "veil"),
            (MeetingToLight, "pane"),
        ],
    ),
    (
        MULTICHAIN,
        &[
            (Raster, "wide-gallery"),
            (CosToLight, "gallery"),
            (DistanceToLight, "gallery"),
            (CosBeforeRunToLight, "gallery"),
            (PassedToLight, "veil-mirror"),
            (MeetingToLight, "pane"),
        ],
    ),
    (
        CAUSTIC,
        &[
            (CosToEye, "diffuse"),
            (DistanceToEye, "diffuse"),
            (CosBeforeRunToEye, "gallery"),
            (PassedToEye, "veil"),
            (MeetingToEye, "pane"),
            (ShadingNormal, "leaning-aquarium"),
            (Range, "gallery"),
        ],
    ),
    (
        BIDIRECTIONAL,
        &[
            (Raster, "diffuse"),
            (RasterPdf, "diffuse"),
            (CosToLight, "diffuse"),
            (DistanceToLight, "diffuse"),
            (CosBeforeRunToLight, "ceiling"),
            (PassedToLight, "veil"),
            (MeetingToLight, "pane"),
            (DirectionToLight, "glossy"),
            (DiracToLight, "varnish"),
            (CosToEye, "diffuse"),
            (DistanceToEye, "diffuse"),
            (CosBeforeRunToEye, "aquarium"),
            (PassedToEye, "veil"),
            (MeetingToEye, "pane"),
            (DirectionToEye, "glossy"),
            (DiracToEye, "aquarium"),
            (Index, "aquarium"),
            (ShadingNormal, "leaning-aquarium"),
            (EmitterPoint, "aquarium"),
            (EmitterOdds, "lamps"),
            (Emission, "diffuse"),
            (CutWeight, "diffuse"),
            (CutsOfPath, "diffuse"),
            (Addition, "diffuse"),
            (Splits, "diffuse"),
            (OtherWays, "diffuse"),
        ],
    ),
    (
        SUBPATH,
        &[
            (Raster, "diffuse"),
            (CosToLight, "diffuse"),
            (DistanceToLight, "diffuse"),
            (CosBeforeRunToLight, "ceiling"),
            (PassedToLight, "veil"),
            (MeetingToLight, "pane"),
            (DiracToLight, "glass"),
        ],
    ),
    (WAVELENGTHS, &[]),
    (
        TIME,
        &[
            (Growth, "moving"),
            (DistanceToLight, "moving"),
            (CosToLight, "moving"),
            (PassedToLight, "moving-veil"),
            (MeetingToLight, "moving-pane"),
        ],
    ),
    (
        EVERY,
        &[
            (Raster, "diffuse"),
            (CosToLight, "diffuse"),
            (DistanceToLight, "diffuse"),
            (CosBeforeRunToLight, "ceiling"),
            (PassedToLight, "veil"),
            (MeetingToLight, "pane"),
            (Growth, "moving"),
        ],
    ),
];

/// Factors that a kernel asks for and that cancel there and back: it keeps the string of scatterings, and
/// with it the media; or makes as many points of the lens and of the raster there as back. `TIME` keeps what is
/// seen where.
const EVEN: &[(Kind, &[Factor])] = &[
    (CAUSTIC, &[Index]),
    (BIDIRECTIONAL, &[LensPdf]),
    (SUBPATH, &[RasterPdf, LensPdf]),
    (TIME, &[Raster]),
];

/// Tries faults and returns those that were not found.
fn missed(kind: Kind, faults: &[(Factor, &str)], starts: u64) -> Vec<String> {
    let test = PairedTest {
        starts,
        steps: 20,
        seed: 11,
    };
    let mut missed = Vec::new();
    for (factor, name) in faults {
        let found = changes(&scene(name), kind, Some(*factor), &test);
        let (chi, p) = (found.chi_square(), found.p_value());
        println!(
            "{} without {factor:?} on {name}: chi2 {chi:.1} p {p:.1e} moved {:.2}",
            kind.0, found.moved
        );
        if p.is_nan() || p > 1e-6 {
            missed.push(format!("{} {factor:?} {name} {chi}", kind.0));
        }
    }
    missed
}

/// What a kernel has of its own, beside the factors of geometry: how many ways lead to a path, and what each may choose.
const OWN: [Factor; 4] = [OtherWays, CutsOfPath, EmitterOdds, Range];

#[test]
fn a_factor_left_out_is_found() {
    for (kind, faults) in FAULTS {
        let first = faults.iter().take(2);
        let own = faults
            .iter()
            .skip(2)
            .filter(|(factor, _)| OWN.contains(factor));
        let faults: Vec<_> = first.chain(own).copied().collect();
        let missed = missed(*kind, &faults, 160_000);
        assert!(missed.is_empty(), "{missed:?}");
    }
}

#[test]
#[ignore = "long"]
fn each_factor_left_out_is_found() {
    let all = FAULTS
        .iter()
        .flat_map(|(kind, faults)| missed(*kind, faults, 400_000));
    let missed: Vec<String> = all.collect();
    assert!(missed.is_empty(), "{missed:?}");
}

/// A kernel that is not at the time of its path.
#[test]
fn a_kernel_at_another_time_is_found() {
    let test = PairedTest {
        starts: 40_000,
        steps: 8,
        seed: 11,
    };
    for kind in BLIND {
        let found = changes(&scene("moving"), kind, None, &test);
        let (chi, p) = (found.chi_square(), found.p_value());
        println!("{}: chi2 {chi:.1} p {p:.1e}", kind.0);
        assert!(p < 1e-6, "{}: {chi} {p}", kind.0);
    }
}

/// What a kernel asks for in any scene is in the table, or is known to cancel.
#[test]
fn every_factor_is_tried() {
    let scenes = [
        "gallery",
        "varnish",
        "leaning-glass",
        "lens",
        "veil",
        "moving",
        "moving-veil",
        "pane",
        "lamps",
    ]
    .map(scene);
    for (kind, faults) in FAULTS {
        let mut found = BTreeSet::new();
        for scene in &scenes {
            with_pieces(scene, *kind, None, |start, step| {
                for n in 0..3_000 {
                    let mut rng = generator(1, n);
                    let (mut path, weight) = start(&mut rng);
                    if weight > 0.0 {
                        found.extend(met(|| (0..4).for_each(|_| step(&mut path, &mut rng))));
                    }
                }
            });
        }
        let tried = faults.iter().map(|(factor, _)| *factor);
        let even = EVEN.iter().filter(|(other, _)| other.0 == kind.0);
        let known: BTreeSet<Factor> = tried
            .chain(even.flat_map(|(_, even)| even.iter().copied()))
            .collect();
        assert_eq!(found, known, "{}", kind.0);
    }
}
