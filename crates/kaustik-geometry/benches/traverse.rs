//! Build and traversal times. Not gated: they are as noisy as the machine.
#![allow(
    missing_docs,
    unreachable_pub,
    reason = "criterion writes a public function"
)]

mod support;

use std::hint::black_box;

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use kaustik_geometry::{Ray, World};
use support::{Random, bounces, cave, cornell, primary, shadows, single};

fn rays(c: &mut Criterion, name: &str, world: &World, eye: Vec3, at: Vec3, size: usize) {
    let mut random = Random(1);
    let first = primary(eye, at, size);
    let second = bounces(world, &first, &mut random);
    let third = bounces(world, &second, &mut random);
    let segments = shadows(world, &second, &mut random);
    let mut group = c.benchmark_group(name);
    let mut closest = |name: &str, rays: &[Ray]| {
        group.throughput(Throughput::Elements(rays.len() as u64));
        group.bench_function(name, |b| {
            b.iter(|| {
                rays.iter()
                    .filter(|r| world.intersect(black_box(r)).is_some())
                    .count()
            });
        });
    };
    closest("primary", &first);
    closest("bounce", &third);
    group.throughput(Throughput::Elements(segments.len() as u64));
    group.bench_function("occluded", |b| {
        b.iter(|| {
            segments
                .iter()
                .filter(|r| world.occluded(black_box(r)))
                .count()
        });
    });
    group.throughput(Throughput::Elements(first.len() as u64));
    let hits: Vec<_> = first
        .iter()
        .filter_map(|r| Some((r, world.intersect(r)?)))
        .collect();
    group.bench_function("surface", |b| {
        b.iter(|| {
            hits.iter()
                .map(|(r, h)| world.surface(r, black_box(h)).position.x)
                .sum::<f32>()
        });
    });
    group.finish();
}

fn small(c: &mut Criterion) {
    let world = single(cornell());
    rays(
        c,
        "cornell, 32 triangles",
        &world,
        Vec3::new(0.0, 0.0, 3.4),
        Vec3::ZERO,
        100,
    );
}

fn large(c: &mut Criterion) {
    let world = single(cave(300_000));
    rays(
        c,
        "cave, 300k triangles",
        &world,
        Vec3::new(0.0, 0.0, 2.9),
        Vec3::ZERO,
        200,
    );
}

fn build(c: &mut Criterion) {
    let mesh = cave(100_000);
    let mut group = c.benchmark_group("build");
    group.sample_size(10);
    group.throughput(Throughput::Elements(mesh.triangle_count() as u64));
    group.bench_function("cave, 100k triangles", |b| {
        b.iter_batched(|| mesh.clone(), single, BatchSize::PerIteration);
    });
    group.finish();
}

criterion_group!(benches, small, large, build);
criterion_main!(benches);
