//! A varnish with a normal of its own: its samples, its density, its energy, and what takes the place of reciprocity.

use crate::catalogue::Case;
use crate::chi_square::{bound, directions, p_value};
use crate::consistency::{adjoint, sample_agrees};
use crate::energy::throughput;
use crate::support::{Random, at};
use glam::DVec3;
use kaustik_bsdf::{Bsdf, LayerParameters, Lobe, Mode, PrincipledParameters};
use kaustik_spectrum::Spectrum;

/// Of the base: black, so that what is left is the varnish; plastic; a mirror.
fn bases() -> [PrincipledParameters; 3] {
    let black = PrincipledParameters {
        base_color: Spectrum::ZERO,
        metallic: 1.0,
        roughness: 0.0,
        ..Default::default()
    };
    let plastic = PrincipledParameters {
        base_color: Spectrum::new([0.9, 0.5, 0.3, 0.1]),
        metallic: 0.0,
        roughness: 0.5,
        ..Default::default()
    };
    let mirror = PrincipledParameters {
        base_color: Spectrum::ONE,
        ..black
    };
    [black, plastic, mirror]
}

fn tilt(angle: f64) -> DVec3 {
    DVec3::new(
        libm::sin(angle) * 0.6,
        libm::sin(angle) * 0.8,
        libm::cos(angle),
    )
}

fn varnished(base: &PrincipledParameters, roughness: f64, normal: Option<DVec3>) -> Bsdf {
    let layers = LayerParameters {
        clearcoat: 1.0,
        clearcoat_roughness: roughness,
        clearcoat_normal: normal,
        ..Default::default()
    };
    Bsdf::layered(base, &layers)
}

fn cases(roughnesses: &[f64]) -> Vec<Case> {
    let mut cases = Vec::new();
    for (index, base) in bases().iter().enumerate() {
        for &roughness in roughnesses {
            for angle in [0.1, 0.4, 0.9] {
                cases.push(Case {
                    name: format!("base {index}, roughness {roughness}, tilt {angle}"),
                    bsdf: varnished(base, roughness, Some(tilt(angle))),
                    lossless: false,
                    eta: 1.0,
                    width: 1.0,
                });
            }
        }
    }
    cases
}

/// Rough ones, whose lobes the cells of the test resolve wherever they point.
#[test]
fn samples_follow_the_density() {
    let cases = cases(&[0.6, 1.0]);
    let tests = cases.len() * 5;
    for (index, case) in cases.iter().enumerate() {
        for (seed, wo) in directions(case).into_iter().enumerate() {
            let mode = [Mode::Radiance, Mode::Importance][seed % 2];
            let p = p_value(
                case,
                &case.bsdf,
                wo,
                mode,
                20_000,
                (5 * index + seed) as u64,
            );
            assert!(p > bound(tests), "{} from {wo}: p = {p}", case.name);
        }
    }
}

/// Smooth ones as well, which have a small width instead: nothing Dirac is drawn but by what they cover.
#[test]
fn samples_agree_with_eval_and_pdf_and_modes_are_adjoint() {
    let mut random = Random::new(7);
    for (index, case) in cases(&[0.0, 0.1, 0.6]).iter().enumerate() {
        // Nine of each base: the second is rough.
        let dirac_below = !(9..18).contains(&index);
        let (mut drawn, mut met) = (0, 0);
        for wo in directions(case) {
            for mode in [Mode::Radiance, Mode::Importance] {
                for _ in 0..60 {
                    let (uc, u) = (random.uniform(), [random.uniform(), random.uniform()]);
                    let Some(s) = case.bsdf.sample(wo, uc, u, mode) else {
                        continue;
                    };
                    drawn += 1;
                    assert!(
                        sample_agrees(&case.bsdf, wo, &s, mode),
                        "{} {wo} {s:?}",
                        case.name
                    );
                    assert!(!s.delta || dirac_below, "{}", case.name);
                    if !s.delta {
                        met += 1;
                        assert!(adjoint(&case.bsdf, wo, s.wi), "{} {wo} {s:?}", case.name);
                    }
                }
                let wi = random.direction();
                assert!(adjoint(&case.bsdf, wo, wi), "{} {wo} {wi}", case.name);
            }
        }
        assert!(drawn > 50 && met > 0, "{}: {drawn} {met}", case.name);
        assert!(case.bsdf.is_connectable(), "{}", case.name);
    }
}

/// Light that leaves by the cosine of the varnish's own normal is the same both ways: reciprocal about its own normal.
#[test]
fn it_is_reciprocal_about_its_own_normal() {
    let mut random = Random::new(3);
    let normal = tilt(0.4);
    let bsdf = varnished(&bases()[0], 0.6, Some(normal));
    let mut met = 0;
    for _ in 0..2000 {
        let (wo, wi) = (random.direction(), random.direction());
        let own = |a: DVec3, b: DVec3| {
            let f = f64::from(bsdf.eval(a, b, Mode::Radiance).hero());
            f * b.z.abs() / DVec3::new(b.x, b.y, b.z.abs()).dot(normal)
        };
        let (there, back) = (own(wo, wi), own(wi, wo));
        assert!(
            (there - back).abs() <= 1e-4 * there.abs().max(1e-9),
            "{wo} {wi}"
        );
        met += u32::from(there > 0.0);
    }
    assert!(met > 300, "{met}");
}

/// No radiance is made, whatever the tilt; untilted, a rough varnish is what it is without a normal of its own.
#[test]
fn no_light_is_made() {
    for case in cases(&[0.0, 0.3, 1.0]) {
        for z in [0.05, 0.3, 0.6, 0.9, 1.0, -0.4] {
            let wo = at(z, 0.1);
            let all = throughput(&case.bsdf, 1.0, wo, Mode::Radiance, 1 << 14);
            assert!(all < 1.006, "{} at {z}: {all}", case.name);
        }
    }
    let base = bases()[1];
    let straight = varnished(&base, 0.4, Some(DVec3::Z));
    let plain = varnished(&base, 0.4, None);
    for (wo, wi) in [(at(0.7, 0.1), at(0.5, 0.6)), (at(-0.7, 0.1), at(-0.9, 0.3))] {
        for mode in [Mode::Radiance, Mode::Importance] {
            let (a, b) = (straight.eval(wo, wi, mode), plain.eval(wo, wi, mode));
            assert!(
                (0..4).all(|i| (a[i] - b[i]).abs() <= 1e-5 * b[i]),
                "{a:?} {b:?}"
            );
        }
    }
}

/// The highlight is where the varnish's own normal mirrors the light.
#[test]
fn the_highlight_follows_the_normal() {
    let normal = tilt(0.3);
    let bsdf = varnished(&bases()[0], 0.0, Some(normal));
    let wo = at(0.9, 0.0);
    let mirrored = normal * (2.0 * wo.dot(normal)) - wo;
    let plain = DVec3::new(-wo.x, -wo.y, wo.z);
    let at = |wi: DVec3| bsdf.eval(wo, wi, Mode::Radiance).hero();
    assert!(
        at(mirrored) > 1e3 * at(plain).max(1e-6),
        "{} {}",
        at(mirrored),
        at(plain)
    );
}
