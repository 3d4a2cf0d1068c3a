//! Lazy points have the law of eager ones (Kelemen sec. 4).

use kaustik_mcmc::{
    Draws, Exponential, Ignore, Mean, Metropolis, Mutation, PointKernel, acceptance, decide,
    generator, target,
};
use kaustik_pss::{Coordinates, Stream};

const DIMENSIONS: usize = 8;
const STEPS: usize = 40;
const LARGE: f64 = 0.05;
/// Length and density of a point, and the last coordinate that it reads.
type Value = (usize, f64, f64);

/// A target of variable length: the first coordinate decides how many are read.
fn evaluate(mut get: impl FnMut(u32) -> f64) -> Value {
    let first = get(0);
    let length = 1 + (first * (DIMENSIONS - 1) as f64) as usize;
    let (mut density, mut last) = (0.4 + (6.0 * first).sin().powi(2), first);
    for i in 1..=length as u32 {
        last = get(i);
        density *= 0.3 + 1.4 * (1.0 - (2.0 * last - 1.0).abs());
    }
    (length, density, last)
}

fn density(value: &Value) -> [f64; 1] {
    [value.1]
}

const MOMENTS: usize = 9;

/// What is compared: moments of a chain of STEPS steps.
type Moments = [f64; MOMENTS];

fn moments(path: &[(Value, bool)]) -> Moments {
    let (first, last) = (path[0].0, path[path.len() - 1].0);
    let mean =
        |f: &dyn Fn(&(Value, bool)) -> f64| path.iter().map(f).sum::<f64>() / path.len() as f64;
    // how far the last coordinate is from what it was when the length was last the same
    let lag = |by: usize| {
        let pairs = path.iter().zip(&path[by..]);
        let same = pairs.filter(|(a, b)| a.0.0 == b.0.0);
        same.map(|(a, b)| (a.0.2 - b.0.2).abs()).sum::<f64>()
    };
    [
        mean(&|s| f64::from(u8::from(s.1))),
        mean(&|s| s.0.0 as f64),
        mean(&|s| s.0.2),
        last.0 as f64,
        last.2,
        last.2 * last.2,
        first.2 * last.2, // correlation over the whole chain
        lag(1),
        lag(4),
    ]
}

fn lazy<M: Mutation + Clone>(mutation: &M, chain: u64) -> Moments {
    let mut rng = generator(21, chain);
    let target = target(|u: &mut dyn Coordinates| evaluate(|i| u.get(Stream::Camera, i)));
    let kernel = PointKernel::new(&target, LARGE);
    let mut chain = Metropolis::start(&target, &density, 0, mutation.clone(), &mut rng);
    let mut path = Vec::with_capacity(STEPS);
    for _ in 0..STEPS {
        let accepted = chain.step(&kernel, &density, &mut rng, &mut Ignore);
        path.push((*chain.value(), accepted));
    }
    moments(&path)
}

/// The same chain on arrays: every coordinate moves in every accepted step.
fn eager(mutation: &impl Mutation, chain: u64) -> Moments {
    let mut rng = generator(22, chain);
    let mut fresh = || -> [f64; DIMENSIONS] { std::array::from_fn(|_| rng.uniform()) };
    let mut current = fresh();
    let mut value = evaluate(|i| current[i as usize]);
    let mut path = Vec::with_capacity(STEPS);
    for _ in 0..STEPS {
        let proposal: [f64; DIMENSIONS] = if rng.bernoulli(LARGE) {
            std::array::from_fn(|_| rng.uniform())
        } else {
            current.map(|x| mutation.mutate(x, &mut rng))
        };
        let proposed = evaluate(|i| proposal[i as usize]);
        let accepted = decide(acceptance(value.1, proposed.1, 1.0), &mut rng);
        if accepted {
            (current, value) = (proposal, proposed);
        }
        path.push((value, accepted));
    }
    moments(&path)
}

/// The largest |z| of the differences of all moments.
fn worst(a: impl Fn(u64) -> Moments, b: impl Fn(u64) -> Moments, chains: u64) -> f64 {
    let (mut left, mut right) = ([Mean::new(); MOMENTS], [Mean::new(); MOMENTS]);
    for chain in 0..chains {
        a(chain).iter().zip(&mut left).for_each(|(x, m)| m.push(*x));
        b(chain)
            .iter()
            .zip(&mut right)
            .for_each(|(x, m)| m.push(*x));
    }
    let z = |(a, b): (&Mean, &Mean)| {
        (a.mean() - b.mean()).abs() / a.standard_error().hypot(b.standard_error())
    };
    left.iter().zip(&right).map(z).fold(0.0, f64::max)
}

fn sizes() -> [Exponential; 2] {
    [
        Exponential::default(),
        Exponential::new(1.0 / 61.0, 16.0 / 61.0),
    ]
}

/// 18 comparisons: |z| > 3.6 has a chance of 0.6 % in all.
#[test]
fn lazy_is_eager() {
    for mutation in sizes() {
        let z = worst(|c| lazy(&mutation, c), |c| eager(&mutation, c), 20_000);
        assert!(z < 3.6, "{mutation:?}: {z}");
    }
}

#[test]
#[ignore = "long"]
fn lazy_is_eager_long() {
    for mutation in sizes() {
        let z = worst(|c| lazy(&mutation, c), |c| eager(&mutation, c), 1_000_000);
        assert!(z < 3.6, "{mutation:?}: {z}");
    }
}

/// Claims to forget at once, so that sleepers are drawn anew instead of replayed.
#[derive(Clone)]
struct Forgetful(Exponential);

impl Mutation for Forgetful {
    fn mutate<D: Draws + ?Sized>(&self, x: f64, draws: &mut D) -> f64 {
        self.0.mutate(x, draws)
    }

    fn mixed_after(&self) -> u64 {
        0
    }
}

#[test]
fn sleepers_that_are_not_replayed_are_caught() {
    let [small, _] = sizes();
    let z = worst(|c| lazy(&Forgetful(small), c), |c| eager(&small, c), 20_000);
    assert!(z > 5.0, "{z}");
}
