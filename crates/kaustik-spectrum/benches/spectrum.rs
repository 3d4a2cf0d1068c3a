//! Times of what a path or a texel asks for. `cargo bench -p kaustik-spectrum`.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use kaustik_spectrum::{
    Glass, Illuminant, Metal, Tabulated, WavelengthSampling, Wavelengths, solve_reflectance,
    uplift_reflectance,
};

/// 4096 pseudo-random numbers in [0, 1), so that branches and caches meet no pattern.
fn randoms() -> Vec<f64> {
    let mut state = 1_u64;
    (0..4096)
        .map(|_| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        })
        .collect()
}

fn bench(c: &mut Criterion) {
    let u = randoms();
    let w: Vec<_> = u
        .iter()
        .map(|&u| Wavelengths::sample(u, WavelengthSampling::Hero))
        .collect();
    let rgb: Vec<_> = (0..4096)
        .map(|i| [u[i], u[(i + 1) % 4096], u[(i + 2) % 4096]].map(|v| v as f32))
        .collect();
    let sigmoids: Vec<_> = rgb.iter().map(|&rgb| uplift_reflectance(rgb)).collect();
    let (glass, table) = (Glass::named("sf11"), Tabulated::named("cornell-white"));
    let (Some(glass), Some(table)) = (glass, table) else {
        return;
    };
    let mut i = 0;
    let mut next = move || {
        i = (i + 1) % 4096;
        i
    };
    let hero = |u| Wavelengths::sample(u, WavelengthSampling::Hero);
    let single = |u| Wavelengths::sample(u, WavelengthSampling::Single);
    let (look_up, solve) = (uplift_reflectance, solve_reflectance);
    let to_xyz = |w: &Wavelengths| w.to_xyz(black_box(w.t()));
    c.bench_function("sample hero", |b| b.iter(|| hero(black_box(u[next()]))));
    c.bench_function("sample single", |b| b.iter(|| single(black_box(u[next()]))));
    c.bench_function("to_xyz", |b| b.iter(|| to_xyz(&w[next()])));
    c.bench_function("sigmoid eval", |b| b.iter(|| sigmoids[next()].eval(&w[7])));
    c.bench_function("uplift look-up", |b| b.iter(|| look_up(rgb[next()])));
    c.bench_function("uplift solve", |b| b.iter(|| solve(rgb[next()])));
    c.bench_function("tabulated eval", |b| b.iter(|| table.eval(&w[next()])));
    c.bench_function("d65 eval", |b| b.iter(|| Illuminant::D65.eval(&w[next()])));
    c.bench_function("metal eta_k", |b| b.iter(|| Metal::Au.eta_k(&w[next()])));
    c.bench_function("sellmeier ior", |b| b.iter(|| glass.ior(&w[next()])));
}

criterion_group!(benches, bench);
criterion_main!(benches);
