//! Primary-sample-space Metropolis in a program that keeps its own loop and its own types:
//! no trait of ours is implemented, the proposal guard is all.
//!
//! `cargo run --release -p kaustik-mcmc --example foreign_renderer`

#![expect(clippy::print_stdout, reason = "an example shows what it found")]

use kaustik_mcmc::{Draws, Exponential, Mean, Point, Step, acceptance, generator};
use kaustik_pss::{Coordinates, Stream};

/// The foreign renderer: brightness at a raster position, here a bright disc on grey.
fn trace(x: f64, y: f64) -> f64 {
    let inside = (x - 0.3).hypot(y - 0.6) < 0.1;
    if inside { 5.0 } else { 0.1 }
}

fn main() {
    const STEPS: u32 = 1_000_000;
    const LARGE: f64 = 0.3;
    let mut rng = generator(1, 0);
    let mut point = Point::new(Exponential::default());
    let mut columns = [0.0; 8];
    let (mut normaliser, mut current) = (Mean::new(), (0.0, 0.0));

    for step in 0..STEPS {
        let large = step == 0 || rng.bernoulli(LARGE);
        let mut proposal = point.propose(if large { Step::Large } else { Step::Small }, &mut rng);
        let [x, y] = proposal.get2(Stream::Camera, 0);
        let proposed = (x, trace(x, y));
        if large {
            normaliser.push(proposed.1);
        }
        let a = acceptance(current.1, proposed.1, 1.0);
        for ((x, _), weight) in [(current, 1.0 - a), (proposed, a)] {
            columns[(x * 8.0) as usize] += weight;
        }
        if proposal.decide(a) {
            current = proposed;
        }
    }

    let b = normaliser.mean();
    let image = columns.map(|weight| 8.0 * b * weight / f64::from(STEPS));
    let exact: f64 = 0.1 + std::f64::consts::PI * 0.01 * 4.9;
    println!("columns {image:.3?}");
    println!(
        "mean {b:.4} +- {:.4}, exact {exact:.4}",
        normaliser.standard_error()
    );
}
