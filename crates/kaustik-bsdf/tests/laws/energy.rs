//! No light is made; lossless surfaces lose none.

use crate::catalogue::{Case, facets, grey, some};
use crate::support::{at, spread};
use glam::DVec3;
use kaustik_bsdf::{Bsdf, Interface, Lobe, Mode, PrincipledParameters};

/// Mean of the sampled weights over an even spread of numbers, in energy: radiance weights are
/// brought from radiance to energy by the squared index. The hero's lane.
pub(crate) fn throughput(bsdf: &impl Lobe, eta: f64, wo: DVec3, mode: Mode, samples: usize) -> f64 {
    let mut sum = 0.0;
    for i in 0..samples {
        let [uc, a, b] = spread(i);
        let Some(sample) = bsdf.sample(wo, uc, [a, b], mode) else {
            continue;
        };
        let ahead = match (mode, sample.transmitted) {
            (Mode::Radiance, true) if wo.z > 0.0 => eta,
            (Mode::Radiance, true) => 1.0 / eta,
            _ => 1.0,
        };
        sum += f64::from(sample.weight.hero()) * ahead * ahead;
    }
    sum / samples as f64
}

const COSINES: [f64; 9] = [0.01, 0.05, 0.12, 0.25, 0.4, 0.6, 0.75, 0.9, 1.0];

fn check(case: &Case, mode: Mode) {
    for z in COSINES.into_iter().flat_map(|z| [z, -z]) {
        let wo = at(z, 0.1);
        let off = |samples| {
            let got = throughput(&case.bsdf, case.eta, wo, mode, samples) - 1.0;
            if case.lossless { got.abs() } else { got }
        };
        // if in doubt, more samples; how near it is in truth the long tests say
        let fine = off(4096) < 0.006 || off(1 << 17) < 0.005;
        assert!(fine, "{} at {z} in {mode:?}: {}", case.name, off(1 << 17));
    }
}

#[test]
fn no_light_is_made_and_lossless_surfaces_lose_none() {
    for (i, case) in some().into_iter().enumerate() {
        check(
            &case,
            if i % 2 == 0 {
                Mode::Radiance
            } else {
                Mode::Importance
            },
        );
    }
}

/// A rough glass surface cannot be seen in a uniform space, at a finer grid.
#[test]
#[ignore = "long"]
fn rough_glass_disappears() {
    let mut worst = (0.0, String::new());
    for eta in [1.1f32, 1.2, 1.33, 1.5, 2.0, 2.4] {
        for alpha in [0.01, 0.03, 0.1, 0.25, 0.5, 0.75, 1.0] {
            let bsdf = Bsdf::dielectric(Interface::clear(grey(eta)), alpha, true);
            for step in 1..=10 {
                for z in [f64::from(step) * 0.1, f64::from(step) * -0.1] {
                    let got =
                        throughput(&bsdf, f64::from(eta), at(z, 0.3), Mode::Radiance, 1 << 18);
                    let off = (got - 1.0).abs();
                    if off > worst.0 {
                        worst = (off, format!("eta {eta} alpha {alpha} z {z}: {got}"));
                    }
                }
            }
        }
    }
    println!("worst {} {}", worst.0, worst.1);
    assert!(worst.0 < 0.003, "{}", worst.1);
}

/// The same for what reflects everything.
#[test]
#[ignore = "long"]
fn white_facets_disappear() {
    let mut worst = (0.0, String::new());
    for step in 1..=12 {
        let alpha = (f64::from(step) / 12.0) * (f64::from(step) / 12.0);
        for case in facets(alpha, true)
            .into_iter()
            .filter(|case| case.lossless && !case.refracts())
        {
            for z in COSINES {
                let off = throughput(&case.bsdf, 1.0, at(z, 0.3), Mode::Radiance, 1 << 18) - 1.0;
                if off.abs() > worst.0 {
                    worst = (off.abs(), format!("{} z {z}: {off}", case.name));
                }
            }
        }
    }
    println!("worst {} {}", worst.0, worst.1);
    assert!(worst.0 < 0.003, "{}", worst.1);
}

/// Brushed facets give back only what they may: over a fine grid, no light is made.
#[test]
#[ignore = "long"]
fn brushed_metal_makes_no_light() {
    let mut worst = (f64::NEG_INFINITY, String::new());
    for roughness in [0.0, 0.1, 0.2, 0.35, 0.5, 0.7, 0.9] {
        for anisotropy in [0.1, 0.25, 0.4, 0.6, 0.8, 1.0] {
            let metal = PrincipledParameters {
                roughness,
                anisotropy,
                ..Default::default()
            };
            let bsdf = Bsdf::principled(&metal);
            for z in COSINES {
                for turns in [0.0, 0.06, 0.125, 0.19, 0.25] {
                    let got = throughput(&bsdf, 1.0, at(z, turns), Mode::Radiance, 1 << 14) - 1.0;
                    if got > worst.0 {
                        worst = (got, format!("{roughness} {anisotropy} {z} {turns}"));
                    }
                }
            }
        }
    }
    println!("worst {} at {}", worst.0, worst.1);
    assert!(worst.0 < 0.005, "{} at {}", worst.0, worst.1);
}

/// Nor does a white body under a brushed cover, from any azimuth: it gets what the cover leaves there.
#[test]
fn brushed_plastic_makes_no_light() {
    let mut worst = (f64::NEG_INFINITY, String::new());
    for roughness in [0.0, 0.2, 0.35, 0.6] {
        for anisotropy in [0.25, 0.6, 1.0] {
            let plastic = PrincipledParameters {
                roughness,
                anisotropy,
                metallic: 0.0,
                ..Default::default()
            };
            let bsdf = Bsdf::principled(&plastic);
            for z in [0.05, 0.12, 0.25, 0.6] {
                for turns in [0.0, 0.06, 0.125, 0.19, 0.25] {
                    let got = throughput(&bsdf, 1.0, at(z, turns), Mode::Radiance, 1 << 12) - 1.0;
                    if got > worst.0 {
                        worst = (got, format!("{roughness} {anisotropy} {z} {turns}"));
                    }
                }
            }
        }
    }
    println!("worst {} at {}", worst.0, worst.1);
    assert!(worst.0 < 0.02, "{} at {}", worst.0, worst.1);
}
