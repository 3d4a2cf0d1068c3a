//! How long a call takes; by hand, in release: `cargo test --release ... speed -- --ignored --nocapture`.

use crate::catalogue::{facets, grey, principled};
use crate::support::{Random, at};
use kaustik_bsdf::{Bsdf, Lobe, Mode};
use std::hint::black_box;
use std::time::Instant;

fn nanoseconds(mut f: impl FnMut(usize) -> f64) -> f64 {
    const CALLS: usize = 400_000;
    let mut best = f64::INFINITY;
    for _ in 0..5 {
        let start = Instant::now();
        let sum: f64 = (0..CALLS).map(&mut f).sum();
        black_box(sum);
        best = best.min(start.elapsed().as_secs_f64() / CALLS as f64 * 1e9);
    }
    best
}

#[test]
#[ignore = "a measurement, not a check"]
fn speed() {
    let mut random = Random::new(3);
    let numbers: Vec<[f64; 3]> = (0..1024)
        .map(|_| std::array::from_fn(|_| random.uniform()))
        .collect();
    let directions: Vec<_> = (0..1024).map(|_| random.direction()).collect();
    let mut all = vec![("lambertian".to_string(), Bsdf::lambertian(grey(0.5)))];
    for alpha in [0.0, 0.2] {
        all.extend(
            facets(alpha, true)
                .into_iter()
                .map(|case| (case.name, case.bsdf)),
        );
    }
    all.extend(
        facets(0.2, false)
            .into_iter()
            .map(|case| (case.name, case.bsdf)),
    );
    all.push(("coated".into(), Bsdf::coated(grey(0.5), 1.5)));
    all.push(("phong".into(), Bsdf::phong(grey(0.4), grey(0.4), 50.0)));
    all.extend(
        principled(0.5)
            .into_iter()
            .map(|case| (case.name, case.bsdf)),
    );
    let wo = at(0.6, 0.1);
    for (name, bsdf) in all {
        let bsdf = black_box(bsdf);
        let sample = nanoseconds(|i| {
            let [uc, a, b] = numbers[i & 1023];
            bsdf.sample(wo, uc, [a, b], Mode::Radiance)
                .map_or(0.0, |s| s.pdf)
        });
        let eval =
            nanoseconds(|i| f64::from(bsdf.eval(wo, directions[i & 1023], Mode::Radiance).hero()));
        let pdf = nanoseconds(|i| bsdf.pdf(wo, directions[i & 1023], Mode::Radiance));
        println!("{name:40} sample {sample:6.1}  eval {eval:6.1}  pdf {pdf:6.1} ns");
    }
}
