//! Weighted visits of many short chains against known integrals.
//!
//! A two-dimensional integrand with a narrow peak, a dead corner and a step, seen through
//! ten pixel columns. Each replica is one chain of 40 steps that starts in a pool of 16
//! samples: so short that nothing but exactness helps.
//!
//! The figure is the mean squared z-score of ten pixels. An unbiased form keeps it within
//! [0.3, 2] for all but one seed in thirty; seeds are fixed.

use kaustik_mcmc::{
    Exponential, Mean, Metropolis, Point, PointKernel, Pool, Step, Target, Visit, acceptance,
    generator, sample, sample_generator,
};
use kaustik_pss::{Coordinates, Stream};

const PIXELS: usize = 10;
const STEPS: usize = 40;
const SEEDS: u64 = 16;
const LARGE: f64 = 0.3;
const LENGTH: f64 = STEPS as f64;

type Image = [f64; PIXELS];

/// The scalar target I, where it is, and the contribution F to that pixel.
#[derive(Clone, Copy, Default)]
struct Sample {
    pixel: usize,
    target: f64,
    contribution: f64,
}

fn at(x: f64, y: f64) -> Sample {
    let r2 = (x - 0.63) * (x - 0.63) + (y - 0.4) * (y - 0.4);
    let bright = if x > 0.8 { 1.0 } else { 0.05 } + 6.0 * (-r2 / (2.0 * 0.05 * 0.05)).exp();
    let target = if x < 0.2 && y < 0.3 { 0.0 } else { bright };
    Sample {
        pixel: (x * PIXELS as f64) as usize,
        target,
        contribution: target * (0.5 + y),
    }
}

struct Toy;

impl Target for Toy {
    type Value = Sample;

    fn evaluate(&self, u: &mut dyn Coordinates, value: &mut Sample) {
        *value = at(u.get(Stream::Camera, 0), u.get(Stream::Camera, 1));
    }
}

fn family(value: &Sample) -> [f64; 1] {
    [value.target]
}

/// The image and the normaliser b, by the midpoint rule (edges lie between midpoints).
fn truth() -> (Image, f64) {
    const N: usize = 1000;
    let (mut image, mut b) = ([0.0; PIXELS], 0.0);
    for i in 0..N * N {
        let middle = |i: usize| (i as f64 + 0.5) / N as f64;
        let sample = at(middle(i % N), middle(i / N));
        image[sample.pixel] += sample.contribution / (N * N) as f64;
        b += sample.target / (N * N) as f64;
    }
    (image, b)
}

type Chain = Metropolis<Point<Exponential>, Sample, 1>;

fn pool(replica: u64) -> Pool {
    let mut value = Sample::default();
    Pool::new((0..SEEDS).map(|i| {
        let rng = sample_generator(31, replica, i);
        sample(&Toy, &family, rng, &mut value).map_or(0.0, |d| d[0])
    }))
}

/// A chain from the pool, and the pool's b; `None` for a dark pool.
fn start(replica: u64, rng: &mut kaustik_mcmc::Pcg64Dxsm) -> Option<(Chain, f64)> {
    let pool = pool(replica);
    let start = pool.choose(rng)?;
    let mut rebuilt = sample_generator(31, replica, start.index);
    let mutation = Exponential::new(1.0 / 256.0, 1.0 / 8.0);
    let chain = Metropolis::rebuild(&Toy, &family, 0, mutation, &start, &mut rebuilt);
    Some((chain.ok()?, pool.normaliser().mean()))
}

/// One replica's image, each visit put in by `splat(visit, b, image)`.
fn replica(n: u64, splat: impl Fn(&Visit<'_, Sample, 1>, f64) -> f64) -> Image {
    let mut image = [0.0; PIXELS];
    let mut rng = generator(32, n);
    let Some((mut chain, b)) = start(n, &mut rng) else {
        return image; // a dark pool stands for zero
    };
    let kernel = PointKernel::new(Toy, LARGE);
    let mut record = |visit: Visit<'_, Sample, 1>| {
        image[visit.value.pixel] += splat(&visit, b) * visit.value.contribution / LENGTH;
    };
    for _ in 0..STEPS {
        chain.step(&kernel, &family, &mut rng, &mut record);
    }
    chain.flush(&mut record);
    image
}

/// The mean squared z-score over the pixels: 1 if unbiased.
fn chi2(replicas: u64, image: impl Fn(u64) -> Image) -> f64 {
    let (truth, _) = truth();
    let mut means = [Mean::new(); PIXELS];
    for n in 0..replicas {
        image(n)
            .iter()
            .zip(&mut means)
            .for_each(|(x, mean)| mean.push(*x));
    }
    let z = means
        .iter()
        .zip(truth)
        .map(|(m, t)| (m.mean() - t) / m.standard_error());
    z.map(|z| z * z).sum::<f64>() / PIXELS as f64
}

/// Expected values (Kelemen sec. 1.2).
fn expected(visit: &Visit<'_, Sample, 1>, b: f64) -> f64 {
    visit.weight * b / visit.density()
}

/// The split form of Kelemen eqs. 1 and 2, with any constant b0.
fn split(b0: f64) -> impl Fn(&Visit<'_, Sample, 1>, f64) -> f64 {
    move |visit, b| (visit.weight * b / b0 + visit.independent) / (visit.density() / b0 + LARGE)
}

fn unbiased(replicas: u64) {
    let (_, b) = truth();
    let forms: [(&str, f64); 4] = [
        ("plain", chi2(replicas, |n| replica(n, expected))),
        ("split right b0", chi2(replicas, |n| replica(n, split(b)))),
        (
            "split 0.5 b",
            chi2(replicas, |n| replica(n, split(0.5 * b))),
        ),
        (
            "split 1.7 b",
            chi2(replicas, |n| replica(n, split(1.7 * b))),
        ),
    ];
    for (name, chi2) in forms {
        assert!((0.3..2.0).contains(&chi2), "{name}: {chi2}; all {forms:?}");
    }
}

#[test]
fn expected_values_and_the_split_form_are_unbiased() {
    unbiased(100_000);
}

#[test]
#[ignore = "long"]
fn expected_values_and_the_split_form_are_unbiased_long() {
    unbiased(2_000_000);
}

#[test]
fn wrong_forms_are_caught() {
    const N: u64 = 40_000;
    let (_, b) = truth();
    let foreign = chi2(N, |n| replica(n, |v, _| expected(v, b)));
    assert!(foreign > 10.0, "true b with seeds of a pool: {foreign}");
    let no_share = chi2(N, |n| {
        replica(n, |v, pool| {
            (v.weight * pool + v.independent * b) / v.density().max(1e-9)
        })
    });
    assert!(no_share > 10.0, "weights without p_L: {no_share}");
    let together = |v: &Visit<'_, Sample, 1>, pool: f64| {
        (v.weight + v.independent) / (v.density() / pool + LARGE)
    };
    let together = chi2(N, |n| replica(n, together));
    assert!(
        together > 10.0,
        "Kelemen eqs. 1 and 2 with the pool's b in the weights: {together}"
    );
    let only_accepted = |v: &Visit<'_, Sample, 1>, pool: f64| {
        (v.weight * pool / b + v.independent * v.weight.min(1.0)) / (v.density() / b + LARGE)
    };
    let only_accepted = chi2(N, |n| replica(n, only_accepted));
    assert!(
        only_accepted > 10.0,
        "large proposals counted with a: {only_accepted}"
    );
}

/// The same through the proposal guard, step by step, as a foreign program would; with
/// `share` false, the old sample's weight lacks p_L after a large step (Kelemen sec. 5).
fn guarded(n: u64, b0: f64, share: bool) -> Image {
    let mut image = [0.0; PIXELS];
    let pool = pool(n);
    let mut rng = generator(34, n);
    let Some(seed) = pool.choose(&mut rng) else {
        return image;
    };
    let scale = pool.normaliser().mean() / b0;
    let mut point = Point::new(Exponential::new(1.0 / 256.0, 1.0 / 8.0));
    let mut rebuilt = sample_generator(31, n, seed.index);
    let mut current = Sample::default();
    let mut first = point.propose(Step::Large, &mut rebuilt);
    Toy.evaluate(&mut first, &mut current);
    first.decide(1.0);
    assert_eq!(current.target.to_bits(), seed.density.to_bits());
    for _ in 0..STEPS {
        let large = kaustik_mcmc::Draws::bernoulli(&mut rng, LARGE);
        let step = if large { Step::Large } else { Step::Small };
        let mut proposal = point.propose(step, &mut rng);
        let mut proposed = Sample::default();
        Toy.evaluate(&mut proposal, &mut proposed);
        let a = acceptance(current.target, proposed.target, 1.0);
        let mut add = |s: &Sample, weight: f64, p: f64| {
            image[s.pixel] += weight * s.contribution / (s.target / b0 + p) / LENGTH;
        };
        let old_share = if share || !large { LARGE } else { 0.0 };
        add(&current, (1.0 - a) * scale, old_share);
        add(&proposed, a * scale + f64::from(u8::from(large)), LARGE);
        if proposal.decide(a) {
            current = proposed;
        }
    }
    image
}

#[test]
fn the_guard_alone_gives_the_same_estimator() {
    let (_, b) = truth();
    let right = chi2(100_000, |n| guarded(n, b, true));
    assert!((0.3..2.0).contains(&right), "{right}");
    let wrong = chi2(100_000, |n| guarded(n, b, false));
    assert!(
        wrong > 4.0,
        "old weight without p_L on large steps: {wrong}"
    );
}
