//! `eval`, `pdf` and `sample` tell the same story, in both modes and both directions.

use crate::catalogue::{Case, some};
use crate::chi_square::directions;
use crate::support::Random;
use glam::DVec3;
use kaustik_bsdf::{Bsdf, Lobe, Mode, Sample};
use kaustik_spectrum::Spectrum;

const MODES: [Mode; 2] = [Mode::Radiance, Mode::Importance];

fn close(a: Spectrum, b: Spectrum, relative: f32) -> bool {
    (0..4).all(|i| (a[i] - b[i]).abs() <= relative * a[i].abs().max(b[i].abs()) + 1e-12)
}

/// Does the sample agree with `eval` and `pdf`?
pub(crate) fn sample_agrees(lobe: &impl Lobe, wo: DVec3, s: &Sample, mode: Mode) -> bool {
    let unit = (s.wi.length() - 1.0).abs() < 1e-9;
    let side = s.transmitted == (s.wi.z * wo.z < 0.0);
    let finite = s.weight.is_finite() && s.weight.min() >= 0.0 && s.pdf > 0.0;
    if !(unit && side && finite) {
        return false;
    }
    if s.delta {
        return s.pdf <= 1.0 + 1e-12;
    }
    let pdf = lobe.pdf(wo, s.wi, mode);
    let value = lobe.eval(wo, s.wi, mode) * (s.wi.z.abs() as f32);
    let same = close(s.weight * (s.pdf as f32), value, 1e-4);
    let dispersive = s.dispersive == lobe.dispersive_between(wo, s.wi);
    (pdf / s.pdf - 1.0).abs() < 1e-6 && same && dispersive
}

#[test]
fn samples_agree_with_eval_and_pdf() {
    let mut random = Random::new(1);
    for case in some() {
        for wo in directions(&case) {
            for mode in MODES {
                for _ in 0..60 {
                    let (uc, u) = (random.uniform(), [random.uniform(), random.uniform()]);
                    let Some(s) = case.bsdf.sample(wo, uc, u, mode) else {
                        continue;
                    };
                    assert!(
                        sample_agrees(&case.bsdf, wo, &s, mode),
                        "{} {wo} {s:?}",
                        case.name
                    );
                }
            }
        }
    }
}

#[test]
fn delta_only_is_what_it_says() {
    let mut random = Random::new(2);
    for case in some() {
        let wo = directions(&case)[1];
        for _ in 0..60 {
            let (uc, u) = (random.uniform(), [random.uniform(), random.uniform()]);
            let Some(s) = case.bsdf.sample(wo, uc, u, Mode::Radiance) else {
                continue;
            };
            assert!(s.delta || !case.bsdf.is_delta(), "{}", case.name);
            let value = case.bsdf.eval(wo, s.wi, Mode::Radiance);
            assert!(!case.bsdf.is_delta() || value.is_zero(), "{}", case.name);
        }
    }
}

/// What [`Lobe::delta`] names is what `sample` draws: with that probability, to that direction, and
/// on average as bright.
#[test]
fn named_dirac_parts_are_those_drawn() {
    const N: usize = 4000;
    for case in some() {
        for (wo, mode) in directions(&case)
            .into_iter()
            .flat_map(|wo| MODES.map(|m| (wo, m)))
        {
            for transmitted in [false, true] {
                let named = case.bsdf.delta(wo, transmitted, mode);
                let (mut share, mut count) = (Spectrum::ZERO, 0.0);
                for i in 0..N {
                    let uc = (i as f64 + 0.5) / N as f64;
                    let sample = case.bsdf.sample(wo, uc, [0.3, 0.6], mode);
                    let Some(s) = sample.filter(|s| s.delta && s.transmitted == transmitted) else {
                        continue;
                    };
                    let named = named.unwrap_or_else(|| panic!("{}: not named", case.name));
                    assert!((s.wi - named.wi).length() < 1e-12, "{}", case.name);
                    assert_eq!(s.dispersive, named.dispersive, "{}", case.name);
                    share += s.weight * (1.0 / N as f32);
                    count += 1.0 / N as f64;
                }
                let (p, wanted) = named.map_or((0.0, Spectrum::ZERO), |d| (d.probability, d.share));
                assert!(
                    (p - count).abs() < 3.0 / N as f64,
                    "{}: {p} {count}",
                    case.name
                );
                let off = (0..4)
                    .map(|i| (share[i] - wanted[i]).abs())
                    .fold(0.0, f32::max);
                let most = wanted.max().max(1.0) / (p as f32).max(0.01);
                assert!(
                    off < 5.0 / N as f32 * most,
                    "{} {share:?} {wanted:?}",
                    case.name
                );
            }
        }
    }
}

/// Pairs of directions between which something happens, drawn by the lobe itself or evenly.
fn pairs(case: &Case, random: &mut Random) -> Vec<(DVec3, DVec3)> {
    let mut pairs = Vec::new();
    for wo in directions(case) {
        for _ in 0..40 {
            pairs.push((wo, random.direction()));
            let (uc, u) = (random.uniform(), [random.uniform(), random.uniform()]);
            if let Some(s) = case.bsdf.sample(wo, uc, u, Mode::Radiance) {
                pairs.push((wo, s.wi));
            }
        }
    }
    pairs
}

/// `eval` in one mode is `eval` in the other with the directions exchanged.
pub(crate) fn adjoint(lobe: &impl Lobe, wo: DVec3, wi: DVec3) -> bool {
    let there = lobe.eval(wo, wi, Mode::Importance);
    let back = lobe.eval(wi, wo, Mode::Radiance);
    // the facets of exchanged directions differ by rounding, which narrow lobes magnify
    close(there, back, 1e-4)
}

/// `f(wi -> wo) / n(wo)^2` is symmetric: the reciprocity of refraction (Veach 1997).
pub(crate) fn reciprocal(lobe: &impl Lobe, eta: f64, wo: DVec3, wi: DVec3) -> bool {
    let squared = |w: DVec3| if w.z < 0.0 { (eta * eta) as f32 } else { 1.0 };
    let there = lobe.eval(wo, wi, Mode::Radiance) / squared(wo);
    let back = lobe.eval(wi, wo, Mode::Radiance) / squared(wi);
    close(there, back, 1e-4)
}

#[test]
fn modes_are_adjoint_and_scattering_is_reciprocal() {
    let mut random = Random::new(3);
    for case in some() {
        for (wo, wi) in pairs(&case, &mut random) {
            assert!(adjoint(&case.bsdf, wo, wi), "{} {wo} {wi}", case.name);
            assert!(
                reciprocal(&case.bsdf, case.eta, wo, wi),
                "{} {wo} {wi}",
                case.name
            );
        }
    }
}

#[test]
fn densities_do_not_depend_on_the_mode() {
    let mut random = Random::new(4);
    for case in some() {
        for (wo, wi) in pairs(&case, &mut random) {
            let [a, b] = MODES.map(|mode| case.bsdf.pdf(wo, wi, mode));
            assert_eq!(a.to_bits(), b.to_bits(), "{}", case.name);
            // what can be evaluated can be drawn
            let value = case.bsdf.eval(wo, wi, Mode::Radiance);
            assert!(
                value.is_zero() || a > 0.0,
                "{} {wo} {wi}: {value:?}",
                case.name
            );
        }
    }
}

/// What is asked for at once is what is asked for one by one, to the bit.
#[test]
fn joins_get_what_they_would_get_one_by_one() {
    let mut random = Random::new(10);
    let mut seen = 0;
    for case in some() {
        let lobe = &case.bsdf;
        for ((wo, wi), mode) in
            (pairs(&case, &mut random).into_iter()).flat_map(|pair| MODES.map(|mode| (pair, mode)))
        {
            let value = lobe.eval(wo, wi, mode);
            let pdfs = [lobe.pdf(wo, wi, mode), lobe.pdf(wi, wo, mode.reversed())];
            assert_eq!(
                lobe.eval_pdf(wo, wi, mode),
                (value, pdfs[0]),
                "{}",
                case.name
            );
            if !value.is_zero() {
                seen += 1;
                assert_eq!(lobe.eval_pdfs(wo, wi, mode), (value, pdfs), "{}", case.name);
            }
        }
    }
    assert!(seen > 10_000, "{seen}");
}

#[test]
fn nothing_comes_through_what_is_said_to_be_opaque() {
    let mut random = Random::new(8);
    let (mut opaque, mut clear) = (0, 0);
    for case in some() {
        let through = |(wo, wi): (DVec3, DVec3)| {
            let across = DVec3::new(wi.x, wi.y, -wi.z.abs() * wo.z.signum());
            let uc = random.uniform();
            let u = [random.uniform(), random.uniform()];
            let sample = case.bsdf.sample(wo, uc, u, Mode::Radiance);
            let drawn = sample.is_some_and(|sample| sample.transmitted);
            let value = case.bsdf.eval(wo, across, Mode::Radiance);
            drawn || !value.is_zero()
        };
        let mut other = Random::new(9);
        let seen = pairs(&case, &mut other).into_iter().any(through);
        if case.bsdf.transmits() {
            clear += u32::from(seen);
        } else {
            opaque += 1;
            assert!(!seen, "{}", case.name);
        }
    }
    assert!(opaque > 10 && clear > 10, "{opaque} {clear}");
}

#[test]
fn both_sides_of_what_is_opaque_are_alike() {
    let mut random = Random::new(5);
    let flip = |w: DVec3| DVec3::new(w.x, w.y, -w.z);
    for case in some().into_iter().filter(|case| !case.refracts()) {
        if matches!(case.bsdf, Bsdf::Principled(_)) && case.name.contains("all of it") {
            continue;
        }
        for (wo, wi) in pairs(&case, &mut random) {
            let up = case.bsdf.eval(wo, wi, Mode::Radiance);
            let down = case.bsdf.eval(flip(wo), flip(wi), Mode::Radiance);
            assert!(close(up, down, 1e-6), "{} {wo} {wi}", case.name);
        }
    }
}

#[test]
fn refraction_of_many_wavelengths_belongs_to_the_hero() {
    let mut random = Random::new(6);
    let mut seen = 0;
    for case in some()
        .into_iter()
        .filter(|case| case.name.starts_with("flint"))
    {
        for wo in directions(&case) {
            for _ in 0..50 {
                let (uc, u) = (random.uniform(), [random.uniform(), random.uniform()]);
                let Some(s) = case.bsdf.sample(wo, uc, u, Mode::Radiance) else {
                    continue;
                };
                assert_eq!(s.dispersive, s.transmitted, "{}", case.name);
                assert_eq!(case.bsdf.dispersive_between(wo, s.wi), s.transmitted);
                seen += usize::from(s.dispersive);
            }
        }
    }
    assert!(seen > 100);
}
