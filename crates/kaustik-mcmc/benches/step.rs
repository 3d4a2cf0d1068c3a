//! What a step costs beyond its evaluation, per coordinate.
//!
//! `mutation alone` is the floor: the random number and the exponential, on an array.
//! Goal: a lazy small step within 30 ns a coordinate, or 1.5 times the floor.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use kaustik_mcmc::{
    Exponential, Ignore, Independent, Metropolis, Mutation, PerCoordinate, PointKernel, Power,
    Uniform, WrappedCauchy, WrappedNormal, generator, target,
};
use kaustik_pss::{Coordinates, Stream};
use std::hint::black_box;

const COORDINATES: u32 = 40;

/// Reads 20 pairs from two streams and adds them up: the least a target can do.
fn read(u: &mut dyn Coordinates) -> f64 {
    (0..COORDINATES / 2)
        .map(|i| u.get(Stream::Camera, i) + u.get(Stream::Light, i))
        .sum()
}

fn floor(c: &mut Criterion) {
    let mut group = c.benchmark_group("floor");
    group.throughput(Throughput::Elements(COORDINATES.into()));
    let mut rng = generator(1, 0);
    group.bench_function("random numbers", |b| {
        let mut array = [0.5f64; COORDINATES as usize];
        b.iter(|| {
            for x in &mut array {
                *x = kaustik_mcmc::Draws::uniform(&mut rng);
            }
            black_box(&array);
        });
    });
    group.bench_function("mutation alone", |b| {
        let mutation = Exponential::default();
        let mut array = [0.5f64; COORDINATES as usize];
        b.iter(|| {
            for x in &mut array {
                *x = mutation.mutate(*x, &mut rng);
            }
            black_box(&array);
        });
    });
    group.bench_function("independent", |b| {
        let mut u = Independent::new(generator(2, 0));
        b.iter(|| black_box(read(&mut u)));
    });
    group.finish();
}

/// A lazy small step that is always accepted, with each mutation.
fn mutations(c: &mut Criterion) {
    let mut group = c.benchmark_group("mutation");
    group.throughput(Throughput::Elements(COORDINATES.into()));
    small(&mut group, "exponential", Exponential::default());
    small(&mut group, "uniform", Uniform::new(0.01));
    small(&mut group, "wrapped normal", WrappedNormal::new(0.01));
    small(&mut group, "wrapped Cauchy", WrappedCauchy::new(0.01));
    small(&mut group, "power", Power::new(0.1));
    let every_other = PerCoordinate::new(Exponential::default()).with(
        Stream::Camera,
        (0..COORDINATES).step_by(2),
        Exponential::new(0.01, 0.1),
    );
    small(&mut group, "exponential, per coordinate", every_other);
    group.finish();
}

fn small<M: Mutation>(
    group: &mut criterion::BenchmarkGroup<'_, criterion::measurement::WallTime>,
    name: &str,
    mutation: M,
) {
    let target = target(|u: &mut dyn Coordinates| read(u));
    let flat = |_: &f64| [1.0];
    let kernel = PointKernel::new(&target, 0.0);
    let mut rng = generator(4, 0);
    let mut chain = Metropolis::start(&target, &flat, 0, mutation, &mut rng);
    group.bench_function(name, |b| {
        b.iter(|| chain.step(&kernel, &flat, &mut rng, &mut Ignore));
    });
}

fn steps(c: &mut Criterion) {
    let mut group = c.benchmark_group("step");
    group.throughput(Throughput::Elements(COORDINATES.into()));
    let flat = |_: &f64| [1.0];
    let steep = |x: &f64| [(4.0 * (x - 20.0)).exp()];
    let target = target(|u: &mut dyn Coordinates| read(u));
    for (name, large, accept_all) in [
        ("small, accepted", 0.0, true),
        ("small, some rejected", 0.0, false),
        ("large", 1.0, true),
        ("Kelemen 0.3", 0.3, false),
    ] {
        group.bench_function(name, |b| {
            let kernel = PointKernel::new(&target, large);
            let mut rng = generator(3, 0);
            let mut chain = Metropolis::start(&target, &flat, 0, Exponential::default(), &mut rng);
            b.iter(|| {
                if accept_all {
                    chain.step(&kernel, &flat, &mut rng, &mut Ignore)
                } else {
                    chain.step(&kernel, &steep, &mut rng, &mut Ignore)
                }
            });
        });
    }
    group.finish();
}

criterion_group!(benches, floor, mutations, steps);
criterion_main!(benches);
