//! What objects cost where generics could stand: `dyn Draws`, `dyn Family`, `dyn Recorder`.
//!
//! Goal: within 10 per cent of generics. (A target's and a kernel's coordinates are an object
//! in any case.) All variants take the same steps (the same bits) in
//! turns of a fraction of a millisecond, so that whatever else the machine does falls on all of
//! them; said are the least and the median time of many turns.

#![expect(clippy::print_stdout, reason = "a table is what this prints")]

use std::hint::black_box;
use std::time::Instant;

use kaustik_mcmc::{
    Draws, Exponential, Family, Ladder, Metropolis, Pcg64Dxsm, Point, PointKernel, Recorder,
    Target, Visit, generator, target,
};
use kaustik_pss::{Coordinates, Stream};

const COORDINATES: u32 = 40;
const STEPS: u32 = 100;
const TURNS: usize = 2001;

/// The least that a target can do: there is nothing to hide behind.
fn bare() -> impl Target<Value = f64> {
    target(|u: &mut dyn Coordinates| {
        (0..COORDINATES / 2)
            .map(|i| u.get(Stream::Camera, i) + u.get(Stream::Light, i))
            .sum()
    })
}

/// A target of some microseconds, as long as a light path of a few vertices in a small scene.
fn dear() -> impl Target<Value = f64> {
    target(|u: &mut dyn Coordinates| {
        (0..COORDINATES / 2)
            .map(|i| {
                let x = u.get(Stream::Camera, i) + u.get(Stream::Light, i);
                let wave = (0..4).fold(x, |x, _| libm::sin(9.0 * libm::exp(x)));
                0.5 * (wave + 1.0)
            })
            .sum()
    })
}

fn densities(x: &f64) -> [f64; 4] {
    let x = x / f64::from(COORDINATES);
    [1.0, x, x * x, x * x * x]
}

/// What a turn moves.
type Chain = Metropolis<Point<Exponential>, f64, 4>;
type Rungs = Ladder<Point<Exponential>, f64, 4>;

/// A named turn: it moves the state by [`STEPS`] steps and adds what it saw to a sum.
type Variant<'a, S> = (&'a str, &'a dyn Fn(&mut S, &mut Pcg64Dxsm, &mut f64));

/// Says the least and median nanoseconds of each variant.
fn race<S: Clone>(name: &str, start: impl Fn(&mut Pcg64Dxsm) -> S, variants: &[Variant<'_, S>]) {
    let mut times = vec![Vec::with_capacity(TURNS); variants.len()];
    let mut rng = generator(1, 0);
    let first = start(&mut rng);
    let mut runs = vec![(first, rng, 0.0); variants.len()];
    for turn in 0..TURNS {
        for i in 0..variants.len() {
            let i = (i + turn) % variants.len(); // nobody always goes first
            let (state, rng, sum) = &mut runs[i];
            let began = Instant::now();
            (variants[i].1)(state, rng, sum);
            times[i].push(began.elapsed().as_nanos() as f64 / f64::from(STEPS));
        }
    }
    let sums: Vec<u64> = runs.iter().map(|run| run.2.to_bits()).collect();
    assert!(sums.iter().all(|sum| *sum == sums[0]), "other bits");
    let mut base = [f64::NAN; 2];
    for (times, (variant, _)) in times.iter_mut().zip(variants) {
        times.sort_by(f64::total_cmp);
        let [least, median] = [times[0], times[TURNS / 2]];
        if base[0].is_nan() {
            base = [least, median];
        }
        println!(
            "{name:<8} {variant:<22} least {least:8.1} ns {:5.3}, median {median:8.1} ns {:5.3}",
            least / base[0],
            median / base[1]
        );
    }
}

fn chains(name: &str, target: &impl Target<Value = f64>) {
    let kernel = PointKernel::new(target, 0.1);
    let run = |state: &mut Chain, rng: &mut Pcg64Dxsm, sum: &mut f64, object: [bool; 3]| {
        let mut record = |visit: Visit<'_, f64, 4>| *sum += visit.weight * visit.value;
        for _ in 0..STEPS {
            step(state, &kernel, rng, &mut record, object);
        }
    };
    race(
        name,
        |rng| Metropolis::start(target, &densities, 2, Exponential::default(), rng),
        &[
            ("generic", &|s, r, w| run(s, r, w, [false; 3])),
            ("dyn Draws", &|s, r, w| run(s, r, w, [true, false, false])),
            ("dyn Family", &|s, r, w| run(s, r, w, [false, true, false])),
            ("dyn Recorder", &|s, r, w| {
                run(s, r, w, [false, false, true]);
            }),
            ("all three dyn", &|s, r, w| run(s, r, w, [true; 3])),
        ],
    );
}

/// One step, with objects where they are asked for.
fn step(
    chain: &mut Chain,
    kernel: &PointKernel<&impl Target<Value = f64>>,
    rng: &mut Pcg64Dxsm,
    record: &mut impl FnMut(Visit<'_, f64, 4>),
    object: [bool; 3],
) {
    let draws: &mut dyn Draws = black_box(rng);
    match object {
        [false, false, false] => chain.step(kernel, &densities, rng, record),
        [true, false, false] => chain.step(kernel, &densities, draws, record),
        [false, true, false] => chain.step(kernel, family(), rng, record),
        [false, false, true] => chain.step(kernel, &densities, rng, recorder(record)),
        _ => chain.step(kernel, family(), draws, recorder(record)),
    };
}

fn family() -> &'static dyn Family<f64, 4> {
    black_box(&densities)
}

fn recorder(record: &mut dyn Recorder<f64, 4>) -> &mut dyn Recorder<f64, 4> {
    black_box(record)
}

fn ladders() {
    let target = bare();
    let kernels = [1.0, 0.0, 0.0, 0.0].map(|large| PointKernel::new(&target, large));
    let generic = |ladder: &mut Rungs, rng: &mut Pcg64Dxsm, sum: &mut f64| {
        let mut record = |visit: Visit<'_, f64, 4>| *sum += visit.weight * visit.value;
        for _ in 0..STEPS {
            ladder.sweep(&kernels, &densities, rng, &mut record);
        }
    };
    let objects = |ladder: &mut Rungs, rng: &mut Pcg64Dxsm, sum: &mut f64| {
        let mut record = |visit: Visit<'_, f64, 4>| *sum += visit.weight * visit.value;
        let draws: &mut dyn Draws = black_box(rng);
        for _ in 0..STEPS {
            ladder.sweep(&kernels, family(), draws, recorder(&mut record));
        }
    };
    race(
        "sweep",
        |rng| Ladder::start(&target, &densities, [Exponential::default(); 4], rng),
        &[("generic", &generic), ("all three dyn", &objects)],
    );
}

fn main() {
    chains("step", &bare());
    chains("dear", &dear());
    ladders();
}
