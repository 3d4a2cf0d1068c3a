//! Weighted visits are unbiased from the first step: exactly, over all pools, starts and
//! chains of two steps.

use kaustik_mcmc::testing::{Enumerator, GridStep, Script, assert_deposits, strategies};
use kaustik_mcmc::{
    Draws, Metropolis, Point, PointKernel, Pool, Step, Target, Visit, acceptance, sample, target,
};
use kaustik_pss::{Coordinates, Stream};
use proptest::prelude::*;

const CELLS: usize = 3;
const SAMPLES: usize = 2;
const STEPS: usize = 2;
const LARGE: f64 = 0.3;
/// Places of deposits: one for each cell.
type Sums = [[f64; 2]];

fn line() -> impl Target<Value = usize> {
    target(|u: &mut dyn Coordinates| (u.get(Stream::Camera, 0) * CELLS as f64) as usize)
}

/// What is wanted of a cell, in two channels; zero only if the density is.
fn wanted(density: &[f64], cell: usize) -> [f64; 2] {
    [2.0 * density[cell], density[cell] * (1.0 + cell as f64)]
}

fn integrals(density: &[f64]) -> Vec<[f64; 2]> {
    let cells = 0..CELLS;
    cells
        .map(|cell| wanted(density, cell).map(|f| f / CELLS as f64))
        .collect()
}

/// A pool, and the numbers of a start from it. From a dark pool any start will do: its b is
/// zero, and with it all that the chain's weights bring. Independent proposals still count;
/// a run that ended here would lose their part.
fn pool(density: &[f64], draws: &mut Enumerator) -> (Pool, Script) {
    let mut numbers = Vec::new();
    let densities: Vec<f64> = (0..SAMPLES)
        .map(|_| {
            let u = draws.uniform();
            numbers.push(u);
            let mut cell = 0;
            let densities = sample(
                &line(),
                &|c: &usize| [density[*c]],
                Script::new([u]),
                &mut cell,
            );
            densities.map_or(0.0, |d| d[0])
        })
        .collect();
    let pool = Pool::new(densities);
    let start = pool.choose(draws).map_or(0, |start| start.index);
    (pool, Script::new([numbers[start as usize]]))
}

fn mutation() -> GridStep {
    GridStep::new(CELLS, &[(0, 0.2), (1, 0.4), (-1, 0.4)])
}

/// Runs a chain from a pool and hands each visit, with the pool's mean density, to `splat`:
/// what F at the visited cell is to be multiplied with.
fn run(
    density: &[f64],
    draws: &mut Enumerator,
    sums: &mut Sums,
    splat: impl Fn(&Visit<'_, usize, 1>, f64) -> f64,
) {
    let family = |cell: &usize| [density[*cell]];
    let (pool, mut start) = pool(density, draws);
    let b = pool.normaliser().mean();
    let kernel = PointKernel::new(line(), LARGE);
    let mut chain = Metropolis::start(&line(), &family, 0, mutation(), &mut start);
    let mut record = |visit: Visit<'_, usize, 1>| {
        let weight = splat(&visit, b) / STEPS as f64;
        for (sum, f) in sums[*visit.value]
            .iter_mut()
            .zip(wanted(density, *visit.value))
        {
            *sum += weight * f;
        }
    };
    for step in 0..STEPS {
        chain.step(&kernel, &family, draws, &mut record);
        if step == 0 {
            chain.flush(&mut record); // splits a report, loses nothing
        }
    }
    chain.flush(&mut record);
}

/// Expected values.
fn expected(visit: &Visit<'_, usize, 1>, b: f64) -> f64 {
    visit.weight * b / visit.density()
}

/// The split form, films M and L together.
fn split(b0: f64) -> impl Fn(&Visit<'_, usize, 1>, f64) -> f64 {
    move |visit, b| (visit.weight * b / b0 + visit.independent) / (visit.density() / b0 + LARGE)
}

/// A cell without light, two faint ones, and a constant ten times too large.
#[test]
fn the_split_form_is_unbiased_where_light_is_faint() {
    let density = [0.0, 0.001, 0.001];
    assert_deposits(CELLS, &integrals(&density), |draws, sums| {
        run(&density, draws, sums, split(0.01));
    });
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn expected_values_are_unbiased(density in strategies::targets(CELLS)) {
        assert_deposits(CELLS, &integrals(&density), |draws, sums| run(&density, draws, sums, expected));
    }

    #[test]
    fn the_split_form_is_unbiased_for_every_b0(density in strategies::targets(CELLS), b0 in 0.01..10.0f64) {
        assert_deposits(CELLS, &integrals(&density), |draws, sums| run(&density, draws, sums, split(b0)));
    }

    /// Independent proposals alone are plain Monte Carlo.
    #[test]
    fn independent_proposals_are_unbiased(density in strategies::targets(CELLS)) {
        assert_deposits(CELLS, &integrals(&density), |draws, sums| {
            run(&density, draws, sums, |visit, _| visit.independent / LARGE);
        });
    }
}

/// The same by the proposal guard, as a program with a loop of its own would.
#[test]
fn the_guard_alone_is_unbiased() {
    let density = [0.2, 0.0, 1.5];
    let b0 = 0.4;
    assert_deposits(CELLS, &integrals(&density), |draws, sums| {
        let (pool, mut start) = pool(&density, draws);
        let scale = pool.normaliser().mean() / b0;
        let mut point = Point::new(mutation());
        let mut current = 0;
        let mut first = point.propose(Step::Large, &mut start);
        line().evaluate(&mut first, &mut current);
        assert!(first.decide(1.0));
        for _ in 0..STEPS {
            let large = draws.bernoulli(LARGE);
            let step = if large { Step::Large } else { Step::Small };
            let mut proposal = point.propose(step, draws);
            let mut proposed = 0;
            line().evaluate(&mut proposal, &mut proposed);
            let a = acceptance(density[current], density[proposed], 1.0);
            let independent = f64::from(u8::from(large));
            for (cell, weight) in [
                (current, (1.0 - a) * scale),
                (proposed, a * scale + independent),
            ] {
                if density[cell] <= 0.0 {
                    continue; // a dark start stands for nothing
                }
                let share = weight / (density[cell] / b0 + LARGE) / STEPS as f64;
                for (sum, f) in sums[cell].iter_mut().zip(wanted(&density, cell)) {
                    *sum += share * f;
                }
            }
            if proposal.decide(a) {
                current = proposed;
            }
        }
    });
}

/// Expected acceptance is what acceptance is in the mean; so are the other sums.
#[test]
fn statistics_are_right_in_the_mean() {
    let density = [0.2, 0.0, 1.5];
    let family = |cell: &usize| [density[*cell]];
    let kernel = PointKernel::new(line(), LARGE);
    let grid = kaustik_mcmc::testing::Grid::new(CELLS, &[(Stream::Camera, 0)]);
    let means = kaustik_mcmc::testing::expected_deposits::<1>(CELLS, 8, |draws, sums| {
        let mut chain = grid.chain(0, &line(), &family, 0, mutation());
        for _ in 0..STEPS {
            chain.step(&kernel, &family, draws, &mut kaustik_mcmc::Ignore);
        }
        let statistics = chain.statistics();
        let [small, large] = [statistics.small(), statistics.large()];
        let independent = &statistics.independent[0];
        let found = [
            small.proposed as f64,
            small.accepted as f64,
            small.expected,
            large.proposed as f64,
            large.accepted as f64,
            large.expected,
            independent.count() as f64,
            independent.mean() * independent.count() as f64,
        ];
        sums.iter_mut().zip(found).for_each(|(sum, x)| sum[0] = x);
    });
    let near = |i: usize, x: f64| assert!((means[i][0] - x).abs() < 1e-12, "{i}: {means:?} {x}");
    near(0, STEPS as f64 * (1.0 - LARGE));
    near(3, STEPS as f64 * LARGE);
    near(6, STEPS as f64 * LARGE);
    near(
        7,
        STEPS as f64 * LARGE * density.iter().sum::<f64>() / CELLS as f64,
    );
    near(1, means[2][0]);
    near(4, means[5][0]);
    assert!(means[1][0] > 0.5 && means[4][0] > 0.1, "{means:?}");
}
