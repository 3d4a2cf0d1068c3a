//! Six narrow modes in the plane: a single chain stays in one, a ladder travels.
//!
//! The modes have weights 1 to 6, widths of half a percent of the square, and nothing between
//! them. Levels are powers of the same density, from flat (where every step is independent) to
//! the whole. What is printed: how much of the time each mode was visited, against its true
//! share, and how often states went up and down the ladder.
//!
//! `cargo run --release -p kaustik-mcmc --example not_light [-- picture.svg]`

#![expect(clippy::print_stdout, reason = "an example shows what it found")]

use std::fmt::Write;
use std::path::PathBuf;

use kaustik_mcmc::{
    Coordinates, Exponential, Ladder, Metropolis, PointKernel, Schedule, Stream, Visit, generator,
    target,
};

const MODES: usize = 6;
const LEVELS: usize = 6;
const SWEEPS: usize = 30_000;
const WIDTH: f64 = 0.005;
/// Powers of the density, level by level.
const POWERS: [f64; LEVELS] = [0.0, 0.004, 0.02, 0.08, 0.3, 1.0];

type Place = [f64; 2];
type Shares = [f64; MODES];

fn main() -> std::io::Result<()> {
    let place = target(|u: &mut dyn Coordinates| -> Place { u.get2(Stream::Camera, 0) });
    let family = |at: &Place| POWERS.map(|power| density(at).powf(power));
    // small steps as wide as the level's modes
    let sizes = POWERS.map(|power| {
        let width = (WIDTH / power.sqrt()).min(0.25);
        Exponential::new(width / 4.0, 2.0 * width)
    });

    let mut rng = generator(1, 0);
    let alone = PointKernel::new(&place, 0.0);
    let mut chain = Metropolis::start(&place, &family, LEVELS - 1, sizes[LEVELS - 1], &mut rng);
    let mut single = Shares::default();
    for _ in 0..SWEEPS * LEVELS {
        let mut record = |visit: Visit<'_, Place, LEVELS>| {
            single[nearest(visit.value)] += visit.weight / (SWEEPS * LEVELS) as f64;
        };
        chain.step(&alone, &family, &mut rng, &mut record);
    }

    let kernels: [_; LEVELS] =
        std::array::from_fn(|level| PointKernel::new(&place, if level == 0 { 1.0 } else { 0.0 }));
    let (mut shares, mut dots) = (Shares::default(), Vec::new());
    let mut ladder =
        Ladder::start(&place, &family, sizes, &mut rng).with_schedule(Schedule::Alternating);
    for sweep in 0..SWEEPS {
        let mut record = |visit: Visit<'_, Place, LEVELS>| {
            if visit.level == LEVELS - 1 {
                shares[nearest(visit.value)] += visit.weight / SWEEPS as f64;
            }
        };
        ladder.sweep(&kernels, &family, &mut rng, &mut record);
        if sweep % 20 == 0 {
            dots.extend((0..LEVELS).map(|level| (level, *ladder.replicas()[level].value())));
        }
    }

    println!(
        "mode          {:?}",
        std::array::from_fn::<_, MODES, _>(|i| i + 1)
    );
    println!(
        "true share    {:.3?}",
        std::array::from_fn::<_, MODES, _>(share)
    );
    println!("single chain  {single:.3?}");
    println!("ladder        {shares:.3?}");
    let statistics = ladder.statistics();
    println!(
        "exchanges rejected, level by level: {:.2?}",
        statistics
            .local_barriers()
            .iter()
            .flatten()
            .collect::<Vec<_>>()
    );
    println!(
        "{} round trips in {SWEEPS} sweeps; with these rejections at most {:.0}",
        statistics.round_trips,
        statistics.ideal_round_trip_rate().unwrap_or_default() * SWEEPS as f64
    );
    ladder.flush(&mut |_: Visit<'_, Place, LEVELS>| {});
    let b = ladder.stepping_stone().normalisers(1.0).estimates()[LEVELS - 1];
    let exact = std::f64::consts::PI * WIDTH * WIDTH;
    println!(
        "integral {:.3e} +- {:.1e}, exact {exact:.3e}",
        b.value, b.standard_error
    );
    let path = std::env::args_os()
        .nth(1)
        .map_or_else(|| std::env::temp_dir().join("not_light.svg"), PathBuf::from);
    std::fs::write(&path, plot(&dots))?;
    println!("picture: {}", path.display());
    Ok(())
}

/// The share of a mode in the whole: 1/21 to 6/21.
fn share(mode: usize) -> f64 {
    (mode + 1) as f64 / 21.0
}

/// Where a mode is: on a ring.
fn centre(mode: usize) -> Place {
    let angle = std::f64::consts::TAU * mode as f64 / MODES as f64;
    [0.5 + 0.35 * angle.cos(), 0.5 + 0.35 * angle.sin()]
}

/// Integrates to pi * WIDTH^2.
fn density(at: &Place) -> f64 {
    let floor = 1e-200; // a little everywhere, so that the walk up never starts at zero
    let bump = |mode| {
        let [x, y] = centre(mode);
        let square = ((at[0] - x).powi(2) + (at[1] - y).powi(2)) / (WIDTH * WIDTH);
        share(mode) * (-square).exp()
    };
    floor + (0..MODES).map(bump).sum::<f64>()
}

fn nearest(at: &Place) -> usize {
    let distance = |mode| {
        let [x, y] = centre(mode);
        (at[0] - x).hypot(at[1] - y)
    };
    (0..MODES)
        .min_by(|&a, &b| distance(a).total_cmp(&distance(b)))
        .unwrap_or_default()
}

/// States of all levels, side by side.
fn plot(dots: &[(usize, Place)]) -> String {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} 110\" font-size=\"8\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        110 * LEVELS
    );
    for (level, power) in POWERS.iter().enumerate() {
        let left = 110 * level + 5;
        let _ = writeln!(
            svg,
            "<rect x=\"{left}\" y=\"5\" width=\"100\" height=\"100\" fill=\"none\" stroke=\"grey\"/>\
             <text x=\"{}\" y=\"14\">power {power}</text>",
            left + 3
        );
    }
    for (level, [x, y]) in dots {
        let left = (110 * level + 5) as f64;
        let _ = writeln!(
            svg,
            "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"0.6\" fill=\"navy\" fill-opacity=\"0.4\"/>",
            left + 100.0 * x,
            5.0 + 100.0 * y
        );
    }
    svg + "</svg>\n"
}
