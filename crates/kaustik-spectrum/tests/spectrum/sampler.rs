//! Wavelengths follow their density, and the checker notices when they do not.

use kaustik_spectrum::{WavelengthSampling, Wavelengths};
use proptest::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF};

const SAMPLES: usize = 1_000_000;
const BINS: usize = 235;
/// Sidak's share of 0.01 for the five laws tested below: four lanes and the single wavelength.
const ALPHA: f64 = 0.002_008;

/// Additive recurrences are too even for a chi-square test; a permuted congruential generator is not.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        let old = self.0;
        self.0 = old
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let mixed = ((old >> 22) ^ old) >> (22 + (old >> 61));
        f64::from(mixed as u32) / f64::from(u32::MAX) * (1.0 - 1e-12)
    }
}

/// p-value of samples against the law that `WavelengthSampling::cdf` states, 2 nm bins pooled to at least five
/// expected.
fn p_value(sampling: WavelengthSampling, mut nm: impl FnMut() -> f32) -> f64 {
    let mut counts = vec![0u32; BINS];
    for _ in 0..SAMPLES {
        counts[(((nm() - 360.0) / 2.0) as usize).min(BINS - 1)] += 1;
    }
    let (mut chi, mut cells) = (0.0, 0u32);
    let (mut seen, mut expected) = (0.0, 0.0);
    for (bin, &count) in counts.iter().enumerate() {
        let low = 360.0 + 2.0 * bin as f64;
        seen += f64::from(count);
        expected += (sampling.cdf(low + 2.0) - sampling.cdf(low)) * SAMPLES as f64;
        if expected >= 5.0 {
            chi += (seen - expected) * (seen - expected) / expected;
            cells += 1;
            (seen, expected) = (0.0, 0.0);
        }
    }
    assert!(
        seen + expected < 10.0,
        "what is left over at the end: {seen} for {expected}"
    );
    let law = ChiSquared::new(f64::from(cells - 1)).expect("more than one cell");
    1.0 - law.cdf(chi)
}

#[test]
fn every_lane_follows_the_density() {
    for lane in 0..4 {
        let mut random = Random(17 + lane as u64);
        let p = p_value(WavelengthSampling::Hero, || {
            Wavelengths::sample(random.next(), WavelengthSampling::Hero).nm()[lane]
        });
        assert!(p > ALPHA, "lane {lane}: {p}");
    }
    let mut random = Random(23);
    let p = p_value(WavelengthSampling::Single, || {
        Wavelengths::sample(random.next(), WavelengthSampling::Single).nm()[3]
    });
    assert!(p > ALPHA, "single: {p}");
}

/// The pdf off by up to 3 %, red against blue: what a wrong table or a lost Jacobian would do at least.
#[test]
fn a_wrong_sampler_is_rejected() {
    let mut random = Random(17);
    let p = p_value(WavelengthSampling::Hero, || {
        let u = random.next();
        let bent = u + 0.03 * u * (1.0 - u);
        Wavelengths::sample(bent, WavelengthSampling::Hero).nm()[0]
    });
    assert!(p < 1e-6, "{p}");
}

#[test]
fn the_density_integrates_to_its_distribution() {
    for sampling in [WavelengthSampling::Hero, WavelengthSampling::Single] {
        let mut sum = 0.0;
        for i in 0..4700 {
            let nm = 360.0 + 0.1 * f64::from(i);
            sum += 0.1 * sampling.pdf(nm + 0.05);
            let cdf = sampling.cdf(nm + 0.1);
            assert!((sum - cdf).abs() < 1e-6, "{sampling:?} {nm}: {sum} {cdf}");
        }
        assert!((sum - 1.0).abs() < 1e-9);
    }
}

proptest! {
    #[test]
    fn the_map_is_the_inverse_of_the_distribution(u in 0.0..1.0_f64) {
        let w = Wavelengths::sample(u, WavelengthSampling::Hero);
        for (lane, nm) in w.nm().into_iter().enumerate() {
            prop_assert!((360.0..=830.0).contains(&nm));
            let back = WavelengthSampling::Hero.cdf(f64::from(nm));
            let wanted = (u + 0.25 * lane as f64).fract();
            prop_assert!((back - wanted).abs() < 1e-6, "{} {}", back, wanted);
            let pdf = WavelengthSampling::Hero.pdf(f64::from(nm)) as f32;
            prop_assert!((w.pdf(lane) / pdf - 1.0).abs() < 1e-3);
            prop_assert!(w.pdf(lane) > 0.0);
        }
    }

    #[test]
    fn the_map_is_continuous(u in 0.0..0.9999_f64) {
        let nm = |u| Wavelengths::sample(u, WavelengthSampling::Hero).nm()[0];
        let (a, b) = (nm(u), nm(u + 1e-7));
        prop_assert!(b >= a && b - a < 0.1, "{} {}", a, b);
    }
}

#[test]
fn the_ends_of_the_unit_interval() {
    for u in [
        0.0,
        f64::MIN_POSITIVE,
        0.25,
        0.5,
        0.75,
        1.0 - f64::EPSILON / 2.0,
        1.0,
    ] {
        for sampling in [WavelengthSampling::Hero, WavelengthSampling::Single] {
            let w = Wavelengths::sample(u, sampling);
            assert!(
                w.nm().iter().all(|nm| (360.0..=830.0).contains(nm)),
                "{u} {w:?}"
            );
            assert!(w.t().min() >= 0.0 && w.t().max() <= 1.0);
            assert!((0..4).all(|lane| w.pdf(lane) > 0.0));
        }
    }
    let hero = Wavelengths::sample(0.0, WavelengthSampling::Hero).nm()[0];
    assert!((hero - 360.0).abs() < 1e-3);
}

#[test]
fn a_single_wavelength_fills_all_lanes() {
    let w = Wavelengths::sample(0.5, WavelengthSampling::Single);
    assert_eq!(w.nm(), [550.0; 4]);
    assert_eq!(w.pdf(2), 1.0 / 300.0);
}
