//! Each mutation against its stated law: distribution, density, symmetry, mixing time.

use std::f64::consts::{PI, SQRT_2, TAU};

use kaustik_mcmc::{
    Draws, Exponential, Mutation, Power, Uniform, WrappedCauchy, WrappedNormal, generator,
};
use proptest::prelude::*;

fn distance(a: f64, b: f64) -> f64 {
    let d = (a - b).abs();
    d.min(1.0 - d)
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

/// The chance that a step is no longer than `d`, in closed form.
type Within = fn(d: f64, size: f64) -> f64;

fn exponential(d: f64, size: f64) -> f64 {
    ((16.0 * d / size).ln() / 16f64.ln()).clamp(0.0, 1.0)
}

fn uniform(d: f64, size: f64) -> f64 {
    (2.0 * d / size).min(1.0)
}

fn normal(d: f64, size: f64) -> f64 {
    let law = |x: f64| 0.5 * libm::erfc(-x / size / SQRT_2);
    (-9..=9)
        .map(|k| law(d + f64::from(k)) - law(f64::from(k) - d))
        .sum()
}

fn cauchy(d: f64, size: f64) -> f64 {
    ((PI * d).tan() / (PI * size).tanh()).atan() * 2.0 / PI
}

fn power(d: f64, size: f64) -> f64 {
    let law = |x: f64| x.powf(size / (1.0 + size));
    law(d) + 1.0 - law(1.0 - d)
}

/// A mutation of one size with its density.
trait Sized: Mutation {
    fn of(size: f64) -> Self;
    fn density(&self, d: f64) -> f64;
}

macro_rules! sized {
    ($($name:ident: $make:expr;)*) => {$(
        impl Sized for $name {
            fn of(size: f64) -> Self {
                let make: fn(f64) -> $name = $make;
                make(size)
            }
            fn density(&self, d: f64) -> f64 {
                $name::density(self, d)
            }
        }
    )*};
}

sized! {
    Exponential: |s| Exponential::new(s / 16.0, s);
    Uniform: Uniform::new;
    WrappedNormal: WrappedNormal::new;
    WrappedCauchy: WrappedCauchy::new;
    Power: Power::new;
}

/// chi-square per degree of freedom of 40 bins of equal logarithm, as a z-score, and that
/// of the number of upward steps.
fn misfit<M: Mutation>(mutation: &M, within: impl Fn(f64) -> f64, n: u32) -> (f64, f64) {
    const BINS: usize = 40;
    let edge = |i: usize| 0.5 * 2f64.powf((i as f64 - BINS as f64) / 2.5);
    let mut rng = generator(12, 0);
    let (mut bins, mut up) = ([0.0; BINS + 1], 0.0);
    for _ in 0..n {
        let x = rng.uniform();
        let y = mutation.mutate(x, &mut rng);
        assert!((0.0..1.0).contains(&y));
        let d = distance(x, y);
        let bin = (0..BINS).find(|i| d <= edge(*i)).unwrap_or(BINS);
        bins[bin] += 1.0;
        up += f64::from(u8::from((y - x).rem_euclid(1.0) < 0.5)) - 0.5;
    }
    let (mut chi2, mut degrees, mut below) = (0.0, -1.0, 0.0);
    for (i, count) in bins.iter().enumerate() {
        let upto = within(edge(i).min(0.5));
        let expected = f64::from(n) * (upto - below);
        below = upto;
        if expected > 5.0 {
            chi2 += (count - expected) * (count - expected) / expected;
            degrees += 1.0;
        } else if *count > 30.0 {
            chi2 += count * count; // where nothing should be
        }
    }
    let degrees = f64::max(degrees, 1.0);
    (
        (chi2 - degrees) / (2.0 * degrees).sqrt(),
        up / (0.5 * f64::from(n).sqrt()),
    )
}

fn check<M: Sized>(within: Within, sizes: &[f64]) {
    for &size in sizes {
        let mutation = M::of(size);
        let (z, up) = misfit(&mutation, |d| within(d, size), 400_000);
        assert!(z < 4.5 && up.abs() < 4.0, "{size}: {z} {up}");
        // the fault: a size that is wrong by 4 %
        let (z, _) = misfit(&M::of(1.04 * size), |d| within(d, size), 400_000);
        assert!(z > 8.0, "{size}: a wrong size goes unseen, {z}");
        // the density is the derivative of the law, over both directions
        for i in 1..50 {
            let (d, h) = (f64::from(i) / 100.0, 1e-6);
            let edge = [0.5 * size, size, size / 16.0]
                .iter()
                .any(|e| (e - d).abs() < 1e-3);
            let slope = (within(d + h, size) - within(d - h, size)) / (2.0 * h);
            let twice = 2.0 * mutation.density(d);
            let scale = 1.0 + slope.abs();
            assert!(
                edge || (slope - twice).abs() < 1e-4 * scale,
                "{size} {d}: {slope} {twice}"
            );
        }
    }
}

#[test]
fn an_exponential_step_has_its_law() {
    check::<Exponential>(exponential, &[0.01, 0.3]);
}

#[test]
fn a_uniform_step_has_its_law() {
    check::<Uniform>(uniform, &[0.01, 0.3]);
}

#[test]
fn a_normal_step_has_its_law() {
    check::<WrappedNormal>(normal, &[0.003, 0.1, 0.3]);
}

#[test]
fn a_cauchy_step_has_its_law() {
    check::<WrappedCauchy>(cauchy, &[0.003, 0.05, 0.2]);
}

#[test]
fn a_power_step_has_its_law() {
    check::<Power>(power, &[0.2, 0.5, 1.0]);
    assert!((mean(&Power::new(0.5)) - 0.25).abs() < 2e-3, "m / (1 + 2m)");
}

fn mean(mutation: &Power) -> f64 {
    // unwound: the length is what the upper half of the draws adds to 0
    (0..1000)
        .map(|i| mutation.mutate(0.0, &mut Fixed((f64::from(i) + 0.5) / 2000.0)))
        .sum::<f64>()
        / 1000.0
}

/// Steps up more often than down.
struct Drift(WrappedNormal);

impl Mutation for Drift {
    fn mutate<D: Draws + ?core::marker::Sized>(&self, x: f64, draws: &mut D) -> f64 {
        let xi = draws.uniform();
        self.0.mutate(x, &mut Fixed((xi * 0.99).min(xi)))
    }
}

#[test]
fn a_drift_of_one_per_cent_is_caught() {
    let (_, up) = misfit(&Drift(WrappedNormal::new(0.1)), |d| normal(d, 0.1), 400_000);
    assert!(up > 5.0, "{up}");
}

proptest! {
    /// The way back is the step of the other sign, to the last bit of rounding.
    #[test]
    fn steps_come_in_pairs(x in 0.0..1.0f64, draw in 0u64..1 << 52, size in 1e-3..1.0f64) {
        let xi = draw as f64 / (1u64 << 53) as f64; // as generators give them
        fn back<M: Sized>(size: f64, x: f64, xi: f64) -> (f64, f64) {
            let mutation = M::of(size);
            let y = mutation.mutate(x, &mut Fixed(xi));
            (y, mutation.mutate(y, &mut Fixed(xi + 0.5)))
        }
        for (y, again) in [
            back::<Exponential>(size, x, xi),
            back::<WrappedNormal>(size, x, xi),
            back::<WrappedCauchy>(size, x, xi),
            back::<Power>(size, x, xi),
        ] {
            prop_assert!((0.0..1.0).contains(&y) && (0.0..1.0).contains(&again));
            prop_assert!(distance(x, again) < 4e-15, "{} {} {}", x, y, again);
        }
    }

    #[test]
    fn odd_sizes_and_extreme_draws_stay_on_the_circle(
        size in prop::num::f64::ANY, x in 0.0..1.0f64, pick in 0usize..5,
    ) {
        let ulp = 1.0 / (1u64 << 53) as f64;
        let xi = [0.0, ulp, 0.5 - ulp, 0.5, 1.0 - ulp][pick];
        for y in [
            Exponential::new(size, size).mutate(x, &mut Fixed(xi)),
            Exponential::new(1e-3, size).mutate(x, &mut Fixed(xi)),
            Uniform::new(size).mutate(x, &mut Fixed(xi)),
            WrappedNormal::new(size).mutate(x, &mut Fixed(xi)),
            WrappedCauchy::new(size).mutate(x, &mut Fixed(xi)),
            Power::new(size).mutate(x, &mut Fixed(xi)),
        ] {
            prop_assert!((0.0..1.0).contains(&y), "{}", y);
        }
    }
}

/// What is no number is the smallest size, and not a step to one end.
#[test]
fn sizes_that_are_no_numbers_are_the_smallest() {
    let x = 0.3;
    for y in [
        Exponential::new(f64::NAN, f64::NAN).mutate(x, &mut Fixed(0.7)),
        Uniform::new(f64::NAN).mutate(x, &mut Fixed(0.7)),
        WrappedNormal::new(f64::NAN).mutate(x, &mut Fixed(0.7)),
        WrappedCauchy::new(f64::NAN).mutate(x, &mut Fixed(0.7)),
        Power::new(f64::NAN).mutate(x, &mut Fixed(0.7)),
    ] {
        assert!((y - x).abs() < 1e-3, "{y}");
    }
    assert!(Uniform::new(f64::NAN).mixed_after() > 1);
}

/// ln |E cos(2 pi k D)| by the midpoint rule over the quantiles of an unwound step.
fn damping(step: impl Fn(f64) -> f64, k: u32) -> f64 {
    const N: u32 = 200_000;
    let wave = |i: u32| (TAU * f64::from(k) * step((f64::from(i) + 0.5) / f64::from(N))).cos();
    ((0..N).map(wave).sum::<f64>() / f64::from(N)).abs().ln()
}

/// `mixed_after` steps leave no wave, and for the sharp bounds half as many leave one.
#[test]
fn a_long_sleep_forgets() {
    fn check<M: Sized>(sizes: &[f64], sharp: bool) {
        for &size in sizes {
            let mutation = M::of(size);
            let step = |q: f64| mutation.mutate(0.0, &mut Fixed(0.5 * q));
            let n = mutation.mixed_after() as f64;
            for k in 1..=12 {
                let left = n * damping(step, k);
                assert!(left < -53.0 * 2f64.ln() * 0.99, "{size} {k}: {left}");
                if k == 1 && sharp {
                    assert!(
                        left > -53.0 * 2f64.ln() * 1.5,
                        "{size}: {left} is far too long"
                    );
                }
            }
        }
    }
    check::<WrappedNormal>(&[0.01, 0.1, 0.2], true);
    check::<WrappedCauchy>(&[0.01, 0.1, 0.3], true);
    check::<Power>(&[0.05, 0.3, 1.0, 5.0], false);
    check::<Uniform>(&[0.05, 0.5, 0.9], false);
}

/// The same bits everywhere.
#[test]
fn values_are_pinned() {
    let mut rng = generator(13, 0);
    let mut at = |m: &dyn Fn(f64, &mut kaustik_mcmc::Pcg64Dxsm) -> f64| m(0.3, &mut rng).to_bits();
    let found = [
        at(&|x, r| Exponential::default().mutate(x, r)),
        at(&|x, r| Uniform::new(0.1).mutate(x, r)),
        at(&|x, r| WrappedNormal::new(0.1).mutate(x, r)),
        at(&|x, r| WrappedCauchy::new(0.1).mutate(x, r)),
        at(&|x, r| Power::new(0.1).mutate(x, r)),
    ];
    assert_eq!(found, PINNED);
}

const PINNED: [u64; 5] = [
    4_598_956_554_306_312_200,
    4_598_434_037_067_340_382,
    4_606_832_451_219_090_222,
    4_599_157_515_997_474_301,
    4_599_075_940_084_348_191,
];
