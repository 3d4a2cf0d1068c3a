//! Kelemen's mutation against its density (Kelemen sec. 6).

use kaustik_mcmc::{Draws, Exponential, Mutation, Uniform, generator};
use proptest::prelude::*;

fn distance(a: f64, b: f64) -> f64 {
    let d = (a - b).abs();
    d.min(1.0 - d)
}

/// chi-square of 32 bins of equal logarithm, the mean step, and the share of upward steps.
fn histogram(mutation: &impl Mutation, (s1, s2): (f64, f64), n: u32) -> (f64, f64, f64) {
    const BINS: usize = 32;
    let mut rng = generator(11, 0);
    let (mut bins, mut sum, mut up) = ([0.0; BINS], 0.0, 0.0);
    for _ in 0..n {
        let x = rng.uniform();
        let y = mutation.mutate(x, &mut rng);
        assert!((0.0..1.0).contains(&y));
        let d = distance(x, y);
        let bin = (d / s1).ln() / (s2 / s1).ln() * BINS as f64;
        bins[(bin.max(0.0) as usize).min(BINS - 1)] += 1.0;
        sum += d;
        up += f64::from(u8::from((y - x).rem_euclid(1.0) < 0.5));
    }
    let expected = f64::from(n) / BINS as f64;
    let chi2 = bins.iter().map(|b| (b - expected).powi(2) / expected).sum();
    (chi2, sum / f64::from(n), up / f64::from(n))
}

const SIZES: (f64, f64) = (1.0 / 1024.0, 1.0 / 64.0);

#[test]
fn steps_have_uniform_logarithm_and_the_stated_mean() {
    let mutation = Exponential::default();
    assert!((mutation.mean_size() - 0.005_283_3).abs() < 5e-8);
    let (chi2, mean, up) = histogram(&mutation, SIZES, 1_000_000);
    assert!(chi2 < 62.0, "chi2 of 31 degrees (p = 1e-3 at 61): {chi2}");
    assert!((mean - 0.005_283_3).abs() < 5.0 * 4e-6, "{mean}");
    assert!((up - 0.5).abs() < 2.5e-3, "{up}");
}

/// Steps with uniform size, not uniform logarithm.
struct Linear;

impl Mutation for Linear {
    fn mutate<D: Draws + ?Sized>(&self, x: f64, draws: &mut D) -> f64 {
        let step = SIZES.0 + (SIZES.1 - SIZES.0) * draws.uniform();
        let sign = if draws.bernoulli(0.5) { 1.0 } else { -1.0 };
        (x + sign * step).rem_euclid(1.0)
    }
}

#[test]
fn another_density_is_caught() {
    let (chi2, mean, _) = histogram(&Linear, SIZES, 10_000);
    assert!(
        chi2 > 1000.0 && (mean - 0.005_283_3).abs() > 1e-3,
        "{chi2} {mean}"
    );
}

/// Answers every draw with a given number.
struct Fixed(f64);

impl Draws for Fixed {
    fn uniform(&mut self) -> f64 {
        self.0
    }
    fn bernoulli(&mut self, p: f64) -> bool {
        self.0 < p
    }
    fn index(&mut self, _: &[f64]) -> usize {
        0
    }
}

#[test]
fn wraps_at_both_ends() {
    let mutation = Exponential::new(0.125, 0.5);
    let up = mutation.mutate(0.75, &mut Fixed(0.0)); // the largest step up
    assert!((up - 0.25).abs() < 1e-8);
    let down = mutation.mutate(0.25, &mut Fixed(0.5)); // the largest step down
    assert!((down - 0.75).abs() < 1e-8);
    // exactly 1 becomes 0 (K sec. 6 tests `> 1`)
    let one = Exponential::new(0.25, 0.25).mutate(0.75, &mut Fixed(0.0));
    assert!(one.abs() < 1e-15, "{one}");
    // a tiny negative number plus 1 would round to 1
    let below = Uniform::new(1e-9).mutate(0.0, &mut Fixed(0.5 - 1e-9));
    assert!((0.0..1.0).contains(&below) && below > 0.9);
}

proptest! {
    #[test]
    fn stays_in_the_unit_interval(x in 0.0..1.0f64, xi in 0.0..1.0f64, s in 1e-6..0.5f64, ratio in 1.0..100.0f64) {
        let x = x.min(1.0 - f64::EPSILON / 2.0);
        for y in [
            Exponential::new(s / ratio, s).mutate(x, &mut Fixed(xi)),
            Uniform::new(2.0 * s).mutate(x, &mut Fixed(xi)),
        ] {
            prop_assert!((0.0..1.0).contains(&y));
        }
    }

    #[test]
    fn steps_come_in_pairs_there_and_back(x in 0.0..1.0f64, xi in 0.0..0.5f64) {
        let mutation = Exponential::default();
        let y = mutation.mutate(x, &mut Fixed(xi));
        let back = mutation.mutate(y, &mut Fixed(xi + 0.5));
        prop_assert!(distance(x, back) < 1e-15);
    }

    #[test]
    fn odd_sizes_are_brought_back(a in prop::num::f64::NORMAL, b in prop::num::f64::NORMAL) {
        let (s1, s2) = Exponential::new(a, b).sizes();
        prop_assert!(0.0 < s1 && s1 <= s2 && s2 <= 0.5);
    }
}

/// |E cos(2 pi k d)| of a log-uniform step, by the midpoint rule.
fn damping(k: f64, s1: f64, s2: f64) -> f64 {
    const N: usize = 4000;
    let step = |i: usize| s2 * ((i as f64 + 0.5) / N as f64 * (s1 / s2).ln()).exp();
    let wave = |i| (std::f64::consts::TAU * k * step(i)).cos();
    ((0..N).map(wave).sum::<f64>() / N as f64).abs()
}

/// `mixed_after` promises that no wave is left beyond 2^-53.
#[test]
fn a_long_sleep_forgets() {
    for (s1, s2) in [
        SIZES,
        (1.0 / 61.0, 16.0 / 61.0),
        (1.0 / 96.0, 16.0 / 96.0),
        (0.25, 0.5),
        (0.03, 0.5),
        (0.1, 0.2),
        (0.2, 0.45),
    ] {
        let n = Exponential::new(s1, s2).mixed_after() as f64;
        for k in 1..=40 {
            let left = n * damping(f64::from(k), s1, s2).ln();
            assert!(left < -53.0 * 2f64.ln() * 0.999, "{s1} {s2} {k}: {left}");
        }
    }
    assert_eq!(Exponential::new(0.24, 0.25).mixed_after(), u64::MAX);
    for fraction in [0.01, 0.3, 0.7, 0.95, 1.0] {
        let n = Uniform::new(fraction).mixed_after() as f64;
        for k in 1..=40 {
            let x = std::f64::consts::PI * fraction * f64::from(k);
            assert!(n * (x.sin() / x).abs().ln() < -53.0 * 2f64.ln() * 0.999);
        }
    }
}
