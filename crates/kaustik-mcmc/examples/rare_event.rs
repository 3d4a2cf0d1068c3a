//! A rare event: the chance that a queue overflows, by population annealing and by a ladder.
//!
//! Sixty events, each an arrival with chance 0.4, otherwise a departure. Reaching length 30 is
//! so rare that plain sampling would need 10^10 runs to see it ten times. Levels ask for 0, 5,
//! 10, ... 30; particles climb them, and the product of the fractions that survive is an
//! unbiased estimate. A ladder that starts there refines it. Exact: dynamic programming.
//!
//! `cargo run --release -p kaustik-mcmc --example rare_event [-- picture.svg]`

#![expect(clippy::print_stdout, reason = "an example shows what it found")]

use std::fmt::Write;
use std::path::PathBuf;

use kaustik_mcmc::{
    Coordinates, Exponential, Ignore, Ladder, PointKernel, Population, Resampling, Stream, anneal,
    generator, target,
};

const LEVELS: usize = 7;
const EVENTS: u32 = 60;
const PARTICLES: usize = 4000;
const SWEEPS: usize = 30_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // dear: the longest queue of a run
    let queue = target(|u: &mut dyn Coordinates| -> u32 {
        let (mut length, mut longest) = (0u32, 0);
        for event in 0..EVENTS {
            let arrival = u.get(Stream::Camera, event) < 0.4;
            length = if arrival {
                length + 1
            } else {
                length.saturating_sub(1)
            };
            longest = longest.max(length);
        }
        longest
    });
    // cheap: an indicator for each level
    let reached = |longest: &u32| -> [f64; LEVELS] {
        std::array::from_fn(|level| f64::from(u8::from(*longest >= length(level))))
    };

    let sizes = Exponential::new(1.0 / 256.0, 0.25);
    let kernels: [_; LEVELS] =
        std::array::from_fn(|level| PointKernel::new(&queue, if level == 0 { 1.0 } else { 0.0 }));
    let mut rng = generator(1, 0);
    let scheme = Resampling::Systematic;
    let mut population = Population::start(PARTICLES, &queue, &reached, &sizes, scheme, &mut rng);
    let annealed = anneal(
        &mut population,
        4,
        &kernels,
        &reached,
        &mut rng,
        &mut Ignore,
    );
    let rough = annealed.normalisers.clone();
    let stages = annealed.stages;

    let mut ladder: Ladder<_, _, LEVELS> = annealed.into_ladder(&reached)?;
    for _ in 0..SWEEPS {
        ladder.sweep(&kernels, &reached, &mut rng, &mut Ignore);
    }
    ladder.flush(&mut Ignore);
    let running = ladder.stepping_stone().normalisers(1.0);

    println!("queue   exact      annealing              families   ladder");
    let exact: [f64; LEVELS] = std::array::from_fn(exact);
    for level in 0..LEVELS {
        let (a, b) = (rough.estimates()[level], running.estimates()[level]);
        println!(
            ">= {:2}   {:.3e}  {:.3e} +- {:6.2} %  {:5}      {:.3e} +- {:6.2} %",
            length(level),
            exact[level],
            a.value,
            100.0 * a.relative_error(),
            stages[level].map_or(0, |stage| stage.founders),
            b.value,
            100.0 * b.relative_error(),
        );
    }
    let statistics = ladder.statistics();
    println!(
        "{} round trips of the ladder; rejection rates of neighbours add up to {:.2}",
        statistics.round_trips,
        statistics.barrier().unwrap_or_default()
    );
    let path = std::env::args_os().nth(1).map_or_else(
        || std::env::temp_dir().join("rare_event.svg"),
        PathBuf::from,
    );
    std::fs::write(&path, plot(&exact, &rough.values(), &running.values()))?;
    println!("picture: {}", path.display());
    Ok(())
}

fn length(level: usize) -> u32 {
    5 * level as u32
}

/// Dynamic programming over (events, length), absorbing at the length of the level.
fn exact(level: usize) -> f64 {
    let top = length(level) as usize;
    let mut p = vec![0.0f64; top + 1];
    p[0] = 1.0;
    for _ in 0..EVENTS {
        let mut next = vec![0.0; top + 1];
        next[top] = p[top];
        for (length, mass) in p.iter().enumerate().take(top) {
            next[length + 1] += 0.4 * mass;
            next[length.saturating_sub(1)] += 0.6 * mass;
        }
        p = next;
    }
    p[top]
}

/// Probabilities on a logarithmic scale: a line for what is exact, rings for the annealing,
/// dots for the ladder.
fn plot(exact: &[f64], annealing: &[f64], ladder: &[f64]) -> String {
    let x = |level: usize| 50.0 + 50.0 * level as f64;
    let y = |p: f64| 20.0 - 20.0 * p.max(1e-12).log10();
    let mut svg = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 400 260\" font-size=\"11\">\n\
         <rect width=\"400\" height=\"260\" fill=\"white\"/>\n",
    );
    let line: Vec<String> = exact
        .iter()
        .enumerate()
        .map(|(k, &p)| format!("{:.1},{:.1}", x(k), y(p)))
        .collect();
    let _ = writeln!(
        svg,
        "<polyline fill=\"none\" stroke=\"grey\" points=\"{}\"/>",
        line.join(" ")
    );
    for k in 0..exact.len() {
        let _ = writeln!(
            svg,
            "<circle cx=\"{0:.1}\" cy=\"{1:.1}\" r=\"5\" fill=\"none\" stroke=\"crimson\"/>\
             <circle cx=\"{0:.1}\" cy=\"{2:.1}\" r=\"2\" fill=\"navy\"/>\
             <text x=\"{0:.1}\" y=\"255\" text-anchor=\"middle\">{3}</text>",
            x(k),
            y(annealing[k]),
            y(ladder[k]),
            length(k)
        );
    }
    for decade in (0..=10).step_by(2) {
        let at = y(10f64.powi(-decade));
        let _ = writeln!(svg, "<text x=\"5\" y=\"{at:.1}\">1e-{decade}</text>");
    }
    svg + "</svg>\n"
}
