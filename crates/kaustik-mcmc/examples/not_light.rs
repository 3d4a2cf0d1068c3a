//! A rare event without light: the chance that a queue overflows.
//!
//! Arrivals and services are exponential; the queue starts empty and is watched for 60
//! events. Reaching length 30 is so rare that plain sampling hardly sees it. A chain whose
//! density grows with the longest queue met along the way walks there; the probability
//! follows from a few levels, each counted under the one before.
//!
//! `cargo run --release -p kaustik-mcmc --example not_light`

#![expect(clippy::print_stdout, reason = "an example shows what it found")]

use kaustik_mcmc::{Exponential, Metropolis, PointKernel, Visit, generator, target};
use kaustik_pss::{Coordinates, Stream};

fn main() {
    // dear: the longest queue of a run
    let queue = target(|u: &mut dyn Coordinates| -> u32 {
        let (mut length, mut longest) = (0i32, 0i32);
        for event in 0..60 {
            let arrival = u.get(Stream::Camera, event) < 0.4;
            length = (length + if arrival { 1 } else { -1 }).max(0);
            longest = longest.max(length);
        }
        longest as u32
    });
    // cheap: an indicator for each level; level k asks for a queue of 5 k
    const LEVELS: usize = 7;
    let reached = |longest: &u32| -> [f64; LEVELS] {
        std::array::from_fn(|level| f64::from(u8::from(*longest >= 5 * level as u32)))
    };

    const STEPS: u32 = 500_000;
    let mut probability = 1.0;
    let mut rng = generator(1, 0);
    let start = Exponential::new(1.0 / 64.0, 0.5);
    let mut chain = Metropolis::start(&queue, &reached, 0, start, &mut rng);
    for level in 0..LEVELS - 1 {
        let kernel = PointKernel::new(&queue, if level == 0 { 0.5 } else { 0.0 });
        let mut next = 0.0;
        let mut count = |visit: Visit<'_, u32, LEVELS>| {
            next += visit.weight * visit.densities[level + 1];
        };
        for _ in 0..STEPS {
            chain.step(&kernel, &reached, &mut rng, &mut count);
        }
        chain.flush(&mut count);
        probability *= next / f64::from(STEPS);
        println!("P(queue >= {:2}) = {probability:.3e}", 5 * (level + 1));
        // walk on until the next level is reached, and stay there
        let mut ignore = |_: Visit<'_, u32, LEVELS>| {};
        while chain.densities()[level + 1] <= 0.0 {
            chain.step(&kernel, &reached, &mut rng, &mut ignore);
        }
        chain.flush(&mut ignore);
        chain.set_level(level + 1);
    }
    println!("exact              {:.3e}", exact());
}

/// The same by dynamic programming over (events, length), absorbing at 30.
fn exact() -> f64 {
    let mut p = [0.0f64; 31];
    p[0] = 1.0;
    for _ in 0..60 {
        let mut next = [0.0; 31];
        next[30] = p[30];
        for (length, mass) in p.iter().enumerate().take(30) {
            next[length + 1] += 0.4 * mass;
            next[length.saturating_sub(1)] += 0.6 * mass;
        }
        p = next;
    }
    p[30]
}
