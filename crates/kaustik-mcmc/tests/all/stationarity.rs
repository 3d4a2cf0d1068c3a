//! Every kernel and every composite of the crate, on a thousand targets each: exact.

use kaustik_mcmc::testing::strategies::{
    GridDensity, grid_densities, mutations, skewed_mutations, targets,
};
use kaustik_mcmc::testing::{
    Grid, GridStep, OnGrid, TransitionMatrix, assert_detailed_balance, assert_stationary,
};
use kaustik_mcmc::{
    Exponential, Ignore, Mutation, Point, PointKernel, Target, Uniform, acceptance, decide, target,
};
use kaustik_pss::{Coordinates, Stream};
use proptest::prelude::*;

const CASES: u32 = 1000;

const FIRST: (Stream, u32) = (Stream::Camera, 0);
const SECOND: (Stream, u32) = (Stream::Light, 2);

/// Reads both coordinates.
fn pair() -> impl Target<Value = [f64; 2]> + Clone {
    target(|u: &mut dyn Coordinates| [u.get(FIRST.0, FIRST.1), u.get(SECOND.0, SECOND.1)])
}

/// Reads the second coordinate only if the first is beyond its first cell; else it counts
/// as lying in its own first cell.
fn sometimes(cells: usize) -> impl Target<Value = [f64; 2]> + Clone {
    target(move |u: &mut dyn Coordinates| {
        let x = u.get(FIRST.0, FIRST.1);
        let reads = x * cells as f64 >= 1.0;
        [
            x,
            if reads {
                u.get(SECOND.0, SECOND.1)
            } else {
                0.0
            },
        ]
    })
}

/// What is read of a density may be zero everywhere though the density is not.
fn somewhere(pi: &[f64]) -> bool {
    pi.iter().any(|mass| *mass > 0.0)
}

/// Chances of a large step: none, some, always.
fn large() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), 0.05..0.95f64, Just(1.0)]
}

/// The matrix of the shipped point kernel on both coordinates, and its law.
fn point_kernel<T: Target<Value = [f64; 2]> + Clone>(
    cells: usize,
    target: &T,
    density: impl Fn([f64; 2]) -> f64,
    mutation: &(impl Mutation + Clone),
    large: f64,
) -> (TransitionMatrix, Vec<f64>) {
    let grid = Grid::new(cells, &[FIRST, SECOND]);
    let family = |value: &[f64; 2]| [density(*value)];
    let kernel = PointKernel::new(target, large);
    let matrix = grid.matrix(target, &family, 0, mutation, |chain, draws| {
        chain.step(&kernel, &family, draws, &mut Ignore);
    });
    (matrix, grid.densities(target, &family, 0))
}

/// One coordinate, a mutation of the library brought to the grid, both steps.
fn on_a_ring(pi: &[f64], mutation: impl Mutation + Clone, large: f64) -> TransitionMatrix {
    let cells = pi.len();
    let line = target(|u: &mut dyn Coordinates| u.get(FIRST.0, FIRST.1));
    let family = |x: &f64| [pi[(x * cells as f64) as usize]];
    let kernel = PointKernel::new(&line, large);
    let mutation = OnGrid::new(cells, mutation);
    Grid::new(cells, &[FIRST]).matrix(&line, &family, 0, &mutation, |chain, draws| {
        chain.step(&kernel, &family, draws, &mut Ignore);
    })
}

/// A small step, another mutation, a small step of it; and the law.
fn settled_change(
    density: &GridDensity,
    [near, far]: [GridStep; 2],
    refresh: bool,
) -> (TransitionMatrix, Vec<f64>) {
    let (grid, target) = (Grid::new(3, &[FIRST, SECOND]), sometimes(3));
    let family = |value: &[f64; 2]| [density.at(*value)];
    let kernel = PointKernel::new(&target, 0.0);
    let matrix = grid.matrix(&target, &family, 0, &near, |chain, draws| {
        chain.step(&kernel, &family, draws, &mut Ignore);
        if refresh {
            chain.refresh();
        }
        chain.set_mutation(far.clone(), draws);
        chain.step(&kernel, &family, draws, &mut Ignore);
    });
    (matrix, grid.densities(&target, &family, 0))
}

/// No mass but in one cell, which nothing leaves.
#[test]
fn a_step_that_stays_keeps_a_single_cell() {
    let density = GridDensity {
        cells: 2,
        densities: vec![0.0, 0.0, 0.001, 0.0],
    };
    let stays = GridStep::new(2, &[(0, 1.0)]);
    let (p, pi) = point_kernel(2, &pair(), |v| density.at(v), &stays, 0.0);
    assert_detailed_balance(&p, &pi);
    assert_stationary(&p, &pi);
}

/// From a step that moves to one that stays, with mass in two far cells.
#[test]
fn a_settled_change_to_a_step_that_stays_keeps_the_target() {
    let density = GridDensity {
        cells: 3,
        densities: vec![0.616, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.001],
    };
    let (moves, stays) = (GridStep::symmetric(3, 1), GridStep::new(3, &[(0, 1.0)]));
    let (p, pi) = settled_change(&density, [moves, stays], true);
    assert_stationary(&p, &pi);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(CASES))]

    #[test]
    fn point_kernel_is_reversible(
        (density, mutation) in grid_densities(2..6).prop_flat_map(|d| { let m = mutations(d.cells); (Just(d), m) }),
        large in large(),
    ) {
        let (p, pi) = point_kernel(density.cells, &pair(), |v| density.at(v), &mutation, large);
        assert_detailed_balance(&p, &pi);
        assert_stationary(&p, &pi);
    }

    #[test]
    fn point_kernel_is_reversible_where_the_dimension_varies(
        (density, mutation) in grid_densities(2..6).prop_flat_map(|d| { let m = mutations(d.cells); (Just(d), m) }),
        large in large(),
    ) {
        let target = sometimes(density.cells);
        let (p, pi) = point_kernel(density.cells, &target, |v| density.at(v), &mutation, large);
        prop_assume!(somewhere(&pi));
        assert_detailed_balance(&p, &pi);
        assert_stationary(&p, &pi);
    }

    #[test]
    fn exponential_steps_are_reversible(
        pi in prop::collection::vec(0u8..1, 2..9).prop_flat_map(|v| targets(2 * v.len())),
        s in 0.01..0.5f64, ratio in 1.0..60.0f64, large in large(),
    ) {
        let p = on_a_ring(&pi, Exponential::new(s / ratio, s), large);
        assert_detailed_balance(&p, &pi);
        assert_stationary(&p, &pi);
    }

    #[test]
    fn uniform_steps_are_reversible(pi in targets(3..14), fraction in 0.01..1.0f64, large in large()) {
        let p = on_a_ring(&pi, Uniform::new(fraction), large);
        assert_detailed_balance(&p, &pi);
        assert_stationary(&p, &pi);
    }

    /// Two small steps with a change of mutation between: sleepers wake with a debt.
    #[test]
    fn a_settled_change_of_mutation_keeps_the_target(
        density in grid_densities(3..4), near in mutations(3), far in mutations(3), refresh in any::<bool>(),
    ) {
        let (p, pi) = settled_change(&density, [near, far], refresh);
        prop_assume!(somewhere(&pi));
        assert_stationary(&p, &pi);
    }

    /// A scan of large and small steps with refreshes on a schedule.
    #[test]
    fn a_scan_keeps_the_target(density in grid_densities(3..4), mutation in mutations(3)) {
        let (grid, target) = (Grid::new(3, &[FIRST, SECOND]), sometimes(3));
        let family = |value: &[f64; 2]| [density.at(*value)];
        let [small, large] = [0.0, 1.0].map(|p| PointKernel::new(&target, p));
        let p = grid.matrix(&target, &family, 0, &mutation, |chain, draws| {
            chain.step(&large, &family, draws, &mut Ignore);
            chain.refresh();
            chain.step(&small, &family, draws, &mut Ignore);
        });
        let pi = grid.densities(&target, &family, 0);
        prop_assume!(somewhere(&pi));
        assert_stationary(&p, &pi);
        let part = |kernel: &PointKernel<_>| {
            grid.matrix(&target, &family, 0, &mutation, |chain, draws| {
                chain.step(kernel, &family, draws, &mut Ignore);
            })
        };
        assert_stationary(&part(&small).then(&part(&large)), &pi);
        assert_detailed_balance(&TransitionMatrix::mixture(&[(0.3, &part(&small)), (0.7, &part(&large))]), &pi);
    }

    /// Two points of two mutations, one after a small step and so perhaps with a sleeper,
    /// exchange as replicas do (RELT eq. 9).
    #[test]
    fn an_exchange_keeps_the_product(
        a in grid_densities(2..3), b in grid_densities(2..3), stay in 0.0..1.0f64,
    ) {
        let mutations = [GridStep::new(2, &[(0, stay), (1, 1.0 - stay)]), GridStep::symmetric(2, 1)];
        let (grid, target) = (Grid::new(2, &[FIRST, SECOND]), sometimes(2));
        let law = |k: usize, value: &[f64; 2]| if k == 0 { a.at(*value) } else { b.at(*value) };
        let pis = [0, 1].map(|k| grid.densities(&target, &|v: &[f64; 2]| [law(k, v)], 0));
        let n = grid.states();
        let pi: Vec<f64> = (0..n * n).map(|s| pis[0][s % n] * pis[1][s / n]).collect();
        prop_assume!(somewhere(&pi));
        let p = TransitionMatrix::of(n * n, 2, |from, draws| {
            let mut points = [grid.point(from % n, mutations[0].clone()), grid.point(from / n, mutations[1].clone())];
            let mut values = [[0.0; 2]; 2];
            for k in 0..2 {
                target.evaluate(&mut points[k].current(draws), &mut values[k]);
            }
            step_by_guard(&mut points[0], &mut values[0], |v| law(0, v), &target, draws);
            let [first, second] = &mut points;
            let ways = law(0, &values[1]) * law(1, &values[0]);
            let now = law(0, &values[0]) * law(1, &values[1]);
            if decide(acceptance(now, ways, 1.0), draws) {
                first.exchange(second, draws);
            }
            grid.state(&mut first.current(draws)) + n * grid.state(&mut second.current(draws))
        });
        assert_stationary(&p, &pi);
    }

    /// The test of the test.
    #[test]
    fn skewed_steps_are_caught(pi in prop::collection::vec(0.1..1.0f64, 5), mutation in skewed_mutations(5)) {
        let p = on_a_ring(&pi, mutation, 0.0);
        prop_assert!(p.balance_defect(&pi) > 1e-6);
    }
}

/// A small step through the proposal guard alone.
fn step_by_guard<M: Mutation>(
    point: &mut Point<M>,
    value: &mut [f64; 2],
    density: impl Fn(&[f64; 2]) -> f64,
    target: &impl Target<Value = [f64; 2]>,
    draws: &mut kaustik_mcmc::testing::Enumerator,
) {
    let mut proposed = [0.0; 2];
    let mut proposal = point.propose(kaustik_mcmc::Step::Small, draws);
    target.evaluate(&mut proposal, &mut proposed);
    if proposal.decide(acceptance(density(value), density(&proposed), 1.0)) {
        *value = proposed;
    }
}
