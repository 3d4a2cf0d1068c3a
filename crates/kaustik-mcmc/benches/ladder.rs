//! What exchanges cost: they ask for no evaluation and should be lost beside one.
//!
//! States are `()` and values numbers, so that only the exchange itself is seen: densities
//! compared, a coin thrown, visits reported, values swapped. Goal: a full sweep of K = 4
//! within 100 ns.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use kaustik_mcmc::{
    Draws, Exponential, Ignore, Kernel, Ladder, Move, PointKernel, Resampling, Schedule, Visit,
    generator, target,
};
use kaustik_pss::{Coordinates, Stream};

/// Draws a new number.
struct Fresh;

impl Kernel<()> for Fresh {
    type Value = f64;

    fn propose<D: Draws + ?Sized>(
        &self,
        (): &mut (),
        _: &f64,
        proposed: &mut f64,
        draws: &mut D,
    ) -> Move {
        *proposed = draws.uniform();
        Move::large()
    }
}

fn family(x: &f64) -> [f64; 4] {
    [1.0, 0.2 + x, 0.1 + x * x, 0.05 + x * x * x]
}

fn exchanges(c: &mut Criterion) {
    let mut group = c.benchmark_group("exchange, K = 4");
    let kernels = [Fresh, Fresh, Fresh, Fresh];
    for schedule in [
        Schedule::RandomPair,
        Schedule::Alternating,
        Schedule::Full,
        Schedule::Permutation,
    ] {
        group.bench_function(format!("{schedule:?}"), |b| {
            let mut rng = generator(1, 0);
            let starts = [0.1, 0.4, 0.6, 0.9].map(|x| ((), x));
            let mut ladder = Ladder::new(starts, &family).with_schedule(schedule);
            let mut weight = 0.0;
            let mut record = |visit: Visit<'_, f64, 4>| weight += visit.weight;
            b.iter(|| ladder.exchange(&kernels, &mut rng, &mut record));
            black_box(weight);
        });
    }
    group.finish();
}

fn sweeps(c: &mut Criterion) {
    let mut group = c.benchmark_group("sweep, K = 4");
    let mut rng = generator(2, 0);
    let kernels = [Fresh, Fresh, Fresh, Fresh];
    for schedule in [Schedule::Off, Schedule::Full] {
        group.bench_function(format!("numbers, {schedule:?}"), |b| {
            let starts = [0.1, 0.4, 0.6, 0.9].map(|x| ((), x));
            let mut ladder = Ladder::new(starts, &family).with_schedule(schedule);
            b.iter(|| ladder.sweep(&kernels, &family, &mut rng, &mut Ignore));
        });
        group.bench_function(format!("points of 20 coordinates, {schedule:?}"), |b| {
            let target = target(|u: &mut dyn Coordinates| {
                (0..20).map(|i| u.get(Stream::Camera, i)).sum::<f64>() / 20.0
            });
            let kernels = [1.0, 0.0, 0.0, 0.0].map(|large| PointKernel::new(&target, large));
            let sizes = [Exponential::default(); 4];
            let mut ladder =
                Ladder::start(&target, &family, sizes, &mut rng).with_schedule(schedule);
            b.iter(|| ladder.sweep(&kernels, &family, &mut rng, &mut Ignore));
        });
    }
    group.finish();
}

fn resampling(c: &mut Criterion) {
    let mut group = c.benchmark_group("resample 10,000");
    let mut rng = generator(3, 0);
    let weights: Vec<f64> = (0..10_000).map(|_| rng.uniform()).collect();
    let (mut copies, mut sums) = (Vec::new(), Vec::new());
    for scheme in [Resampling::Systematic, Resampling::Multinomial] {
        group.bench_function(format!("{scheme:?}"), |b| {
            b.iter(|| scheme.copies(&weights, &mut copies, &mut sums, &mut rng));
        });
    }
    group.finish();
}

criterion_group!(benches, exchanges, sweeps, resampling);
criterion_main!(benches);
