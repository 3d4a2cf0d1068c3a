//! Replicas side by side, whose supports are not nested, on a toy whose picture is known.

use kaustik_film::{Layout, Quantum};
use kaustik_mcmc::{
    Exponential, Ladder, LevelKernel, Mean, Metropolis, SteppingStone, SwapGraph, Target,
    generator, target,
};
use kaustik_pss::{Coordinates, Stream};
use kaustik_spectrum::Xyz;

use super::*;

const PIXELS: usize = 10;

/// What a walk from the camera finds on the left, what a walk from the light finds on the right, joined paths
/// here and there, and a narrow peak for each side.
fn classes(u: f64) -> [f64; 6] {
    let bump = |at: f64, width: f64| libm::exp(-((u - at) / width) * ((u - at) / width));
    let left = if u < 0.55 { 1.0 } else { 0.0 };
    let right = if u >= 0.35 { 1.0 } else { 0.0 };
    [
        left * 8.0 * bump(0.15, 0.02),
        if u > 0.95 { 0.5 } else { 0.0 },
        left * (0.7 + u),
        0.0,
        right * (10.0 * bump(0.8, 0.015) + 0.3),
        if (0.3..0.5).contains(&u) { 0.6 } else { 0.0 },
    ]
}

fn toy() -> impl Target<Value = Contributions> {
    target(|coordinates: &mut dyn Coordinates| -> Contributions {
        let u = coordinates.get(Stream::Camera, 0);
        let mut out = Contributions::default();
        for (class, value) in Class::ALL.into_iter().zip(classes(u)) {
            out.push([u, 0.5].into(), Xyz([value as f32 / 3.0; 3]), class);
        }
        out
    })
}

/// Integrals by the midpoint rule: the normalisers, and the picture.
fn exact(set: &ReplicaSet) -> ([f64; 3], [f64; PIXELS]) {
    let points = 200_000;
    let (mut b, mut pixels) = ([1.0, 0.0, 0.0], [0.0; PIXELS]);
    for i in 0..points {
        let u = (f64::from(i) + 0.5) / f64::from(points);
        let l = classes(u);
        for (b, row) in b.iter_mut().zip(set.rows()).skip(1) {
            *b += row.iter().zip(&l).map(|(d, l)| d * l).sum::<f64>() / f64::from(points);
        }
        pixels[(u * PIXELS as f64) as usize] += l.iter().sum::<f64>() / f64::from(points);
    }
    (b, pixels)
}

/// One long run: bridges from the stones given, what the stepping stone says, and the picture by the bridges.
struct Ran {
    bridged: [f64; 3],
    stepped: [f64; 3],
    picture: [f64; PIXELS],
}

fn run(index: u64, below: [usize; 3], rough: [f64; 3]) -> Ran {
    let (toy, set) = (toy(), ReplicaSet::sides());
    let family = ReplicaFamily::<3>::new(&set, ScalarTarget::Xyz);
    let sizes = Exponential::new(1.0 / 128.0, 1.0 / 8.0);
    let kernels = [1.0, 0.0, 0.0].map(|large| LevelKernel::new(&toy, large, sizes));
    let mut rng = generator(81, index);
    let starts = std::array::from_fn(|level| {
        loop {
            let chain = Metropolis::start(&toy, &family, level, sizes, &mut rng);
            if chain.density() > 0.0 {
                break (chain.state().clone(), chain.value().clone());
            }
        }
    });
    let graph = SwapGraph::new(&set.pairs(3)).unwrap();
    let mut ladder = Ladder::new(starts, &family)
        .with_graph(graph)
        .with_stepping_stone(SteppingStone::on(below));
    let layout = Layout::new(PIXELS as u32, 1);
    let films = [(); 3].map(|()| Film::with_layout(&layout, Quantum::from_mean(1.0)).unwrap());
    let mut deposit = ReplicaDeposit {
        films: &films,
        scale: Scale {
            width: PIXELS as f64,
            height: 1.0,
        },
        weights: ReplicaWeights::new(rough, 2.0, false),
        shares: ReplicaShares::on(below),
        each: [1.0; 3],
        each_specific: 1.0,
    };
    const SWEEPS: u32 = 40_000;
    for _ in 0..SWEEPS {
        ladder.sweep(&kernels, &family, &mut rng, &mut deposit);
    }
    ladder.flush(&mut deposit);
    let bridged = deposit.shares.bridged();
    let mut picture = [0.0; PIXELS];
    for (film, scale) in films.iter().zip(bridged) {
        let factor = scale * film.quantum().value() / f64::from(SWEEPS);
        for (i, sum) in film.sums().enumerate() {
            picture[i / 3] += sum as f64 * factor;
        }
    }
    Ran {
        bridged,
        stepped: ladder.stepping_stone().normalisers(1.0).values(),
        picture,
    }
}

/// How many standard errors lie between the mean of runs and what is right.
fn off(values: impl Iterator<Item = f64>, wanted: f64) -> f64 {
    let mean: Mean = values.collect();
    (mean.mean() - wanted) / mean.standard_error()
}

#[test]
fn sides_are_bridged_by_the_uniform_replica() {
    const RUNS: u64 = 12;
    let (b, pixels) = exact(&ReplicaSet::sides());
    let rough = [1.0, b[1] * 1.6, b[2] * 0.5];
    let runs: Vec<Ran> = (0..RUNS).map(|i| run(i, [0, 0, 0], rough)).collect();
    for k in 1..3 {
        let bridged = off(runs.iter().map(|r| r.bridged[k]), b[k] / rough[k]);
        let stepped = off(runs.iter().map(|r| r.stepped[k]), b[k]);
        // Student's t with 11 degrees of freedom: 5.5 is one in 10,000
        assert!(
            bridged.abs() < 5.5 && stepped.abs() < 5.5,
            "{bridged} {stepped}"
        );
    }
    for (pixel, wanted) in pixels.into_iter().enumerate() {
        let off = off(runs.iter().map(|r| r.picture[pixel]), wanted);
        assert!(off.abs() < 5.5, "pixel {pixel}: {off}");
    }
}

/// The test of the test: eq. 10 from one side to the other, whose support it does not cover, loses light.
#[test]
fn a_stepping_stone_on_the_other_side_is_wrong() {
    const RUNS: u64 = 12;
    let (b, _) = exact(&ReplicaSet::sides());
    let runs: Vec<Ran> = (0..RUNS).map(|i| run(i, [0, 0, 1], b)).collect();
    let stepped = off(runs.iter().map(|r| r.stepped[2]), b[2]);
    assert!(stepped < -20.0, "{stepped}");
}
