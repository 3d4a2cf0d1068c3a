use kaustik_pss::{Coordinates, Stream};
use proptest::prelude::*;

use super::*;
use crate::testing::strategies::{GridDensity, grid_densities, mutations, targets};
use crate::testing::{
    Enumerator, Grid, GridStep, TransitionMatrix, assert_deposits, assert_stationary,
    expected_deposits,
};
use crate::{Ladder, LevelKernel, generator, target};

const CELLS: usize = 3;
const FIRST: (Stream, u32) = (Stream::Camera, 0);
const SECOND: (Stream, u32) = (Stream::Light, 2);
/// Steps of a tour.
const STEPS: u32 = 2;

type Value = [f64; 2];

/// Reads the second coordinate but where the first is in its first cell.
fn both() -> impl Target<Value = Value> {
    target(|u: &mut dyn Coordinates| {
        let x = u.get(FIRST.0, FIRST.1);
        let reads = cell(x) > 0;
        [
            x,
            if reads {
                u.get(SECOND.0, SECOND.1)
            } else {
                0.5
            },
        ]
    })
}

fn first() -> impl Target<Value = Value> {
    target(|u: &mut dyn Coordinates| [u.get(FIRST.0, FIRST.1), 0.5])
}

fn cell(x: f64) -> usize {
    (x * CELLS as f64) as usize
}

fn grid() -> Grid {
    Grid::new(CELLS, &[FIRST, SECOND])
}

/// A tour, then a small step, which would see what the tour leaves behind; the law to be kept. `ratio` is done to the
/// quotient of the surrogate's densities.
fn composite(
    density: impl Fn(&Value) -> f64,
    surrogate: &[f64],
    mutation: &GridStep,
    ratio: impl Fn(f64) -> f64,
) -> (TransitionMatrix, Vec<f64>) {
    let (grid, target, cheap) = (grid(), both(), first());
    let family = |value: &Value| [density(value)];
    let touring = Touring {
        target: &target,
        surrogate: &cheap,
        density: &|value: &Value| [surrogate[cell(value[0])]],
        still: &[Stream::Light],
        steps: STEPS,
    };
    let kernel = PointKernel::new(&target, 0.0);
    let matrix = grid.matrix(&target, &family, 0, mutation, |chain, draws| {
        let mut tour = a_chain(mutation);
        let ended = chain.tour(&touring, &mut tour, draws, &mut Ignore);
        let ended = ended.map(&ratio);
        chain.conclude_tour(ended, &target, &mut tour, &family, draws, &mut Ignore);
        chain.step(&kernel, &family, draws, &mut Ignore);
    });
    (matrix, grid.densities(&target, &family, 0))
}

/// For tours; where it is does not matter.
fn a_chain(mutation: &GridStep) -> Metropolis<Point<GridStep>, Value, 1> {
    let nowhere = Point::new(mutation.clone());
    Metropolis::at(nowhere, [0.0; 2], &|_: &Value| [0.0], 0)
}

/// The surrogate's density and more.
fn above(surrogate: &[f64], more: &GridDensity, value: &Value) -> f64 {
    surrogate[cell(value[0])] + 0.3 * more.at(*value)
}

/// From a start of the target's law: what a tour's visits say of the surrogate's light in each cell. `weight` is done to
/// theirs, from the surrogate's density over the chain's at the start.
fn visits(
    surrogate: &[f64],
    more: &GridDensity,
    mutation: &GridStep,
    draws: &mut Enumerator,
    deposits: &mut [[f64; 1]],
    weight: impl Fn(f64, f64) -> f64,
) {
    struct Sums<'a, W>(&'a mut [[f64; 1]], W);
    impl<W: Fn(f64) -> f64> TourRecorder<Value> for Sums<'_, W> {
        fn record_tour(&mut self, visit: Visit<'_, Value, 1>) {
            self.0[cell(visit.value[0])][0] += (self.1)(visit.weight);
        }
    }
    let (grid, target, cheap) = (grid(), both(), first());
    let family = |value: &Value| [above(surrogate, more, value)];
    let touring = Touring {
        target: &target,
        surrogate: &cheap,
        density: &|value: &Value| [surrogate[cell(value[0])]],
        still: &[Stream::Light],
        steps: STEPS,
    };
    let law = grid.densities(&target, &family, 0);
    let start = draws.index(&law);
    let mut chain = grid.chain(start, &target, &family, 0, mutation.clone());
    let share = surrogate[cell(chain.value()[0])] / chain.density();
    let mut sums = Sums(deposits, |w| weight(w, share));
    chain.tour(&touring, &mut a_chain(mutation), draws, &mut sums);
}

/// What [`visits`] are to say.
fn wanted(surrogate: &[f64], more: &GridDensity) -> Vec<[f64; 1]> {
    let family = |value: &Value| [above(surrogate, more, value)];
    let all: f64 = grid().densities(&both(), &family, 0).iter().sum();
    let steps = f64::from(STEPS);
    let wanted = surrogate.iter().map(|s| [steps * s * CELLS as f64 / all]);
    wanted.collect()
}

fn step() -> GridStep {
    GridStep::new(CELLS, &[(0, 0.2), (1, 0.4), (-1, 0.4)])
}

/// A chain under a density that the surrogate does not know all of.
fn example() -> (GridDensity, [f64; 3]) {
    let densities = vec![0.2, 0.9, 0.4, 1.0, 0.1, 2.0, 0.7, 0.3, 0.5];
    let more = GridDensity {
        cells: CELLS,
        densities,
    };
    (more, [0.5, 2.0, 0.0])
}

#[test]
fn what_the_surrogate_does_not_know_must_be_paid_for() {
    let (density, surrogate) = example();
    let (p, pi) = composite(|v| density.at(*v), &surrogate, &step(), |r| r);
    assert_stationary(&p, &pi);
    let faulty = |ratio: fn(f64) -> f64| {
        let (p, pi) = composite(|v| density.at(*v), &surrogate, &step(), ratio);
        std::panic::catch_unwind(|| assert_stationary(&p, &pi)).is_err()
    };
    assert!(faulty(|_| 1.0) && faulty(|r| 1.0 / r));
}

#[test]
fn the_weight_of_the_start_must_not_be_missing() {
    let (more, surrogate) = example();
    let wanted = wanted(&surrogate, &more);
    let found = expected_deposits(CELLS, CELLS, |draws, deposits| {
        visits(&surrogate, &more, &step(), draws, deposits, |w, share| {
            w / share
        });
    });
    let off = |(found, wanted): (&[f64; 1], &[f64; 1])| (found[0] - wanted[0]).abs() > 0.01;
    assert!(found.iter().zip(&wanted).any(off), "{found:?} {wanted:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn tours_leave_the_target_as_it_is(
        density in grid_densities(CELLS..CELLS + 1),
        surrogate in targets(CELLS),
        mutation in mutations(CELLS),
    ) {
        let (p, pi) = composite(|v| density.at(*v), &surrogate, &mutation, |r| r);
        prop_assume!(pi.iter().any(|mass| *mass > 0.0));
        assert_stationary(&p, &pi);
    }

    #[test]
    fn visits_of_tours_are_of_the_surrogates_law(
        more in grid_densities(CELLS..CELLS + 1),
        surrogate in targets(CELLS),
        mutation in mutations(CELLS),
    ) {
        let wanted = wanted(&surrogate, &more);
        assert_deposits(CELLS, &wanted, |draws, deposits| {
            visits(&surrogate, &more, &mutation, draws, deposits, |w, _| w);
        });
    }
}

/// Coordinates that stand still are what they were, those of the others are not; the target is evaluated once, the surrogate
/// for each step and the start.
#[test]
fn a_tour_costs_one_evaluation() {
    use std::cell::Cell;
    let (dear, cheap) = (Cell::new(0_u32), Cell::new(0_u32));
    let whole = target(|u: &mut dyn Coordinates| {
        dear.set(dear.get() + 1);
        [u.get(FIRST.0, FIRST.1), u.get(SECOND.0, SECOND.1)]
    });
    let part = target(|u: &mut dyn Coordinates| {
        cheap.set(cheap.get() + 1);
        [u.get(FIRST.0, FIRST.1), 0.5]
    });
    let sizes = crate::Exponential::new(1.0 / 64.0, 1.0 / 4.0);
    let family = |v: &Value| [1.0, v[0]];
    let kernels = [1.0, 0.0].map(|large| LevelKernel::new(&whole, large, sizes));
    let mut rng = generator(71, 0);
    let mut ladder = Ladder::start(&whole, &family, [sizes; 2], &mut rng);
    let mut tour = Metropolis::at(Point::new(sizes), [0.0; 2], &|_: &Value| [0.0], 0);
    let touring = Touring {
        target: &whole,
        surrogate: &part,
        density: &|v: &Value| [if v[0] < 0.8 { v[0] } else { 0.0 }],
        still: &[Stream::Light],
        steps: 5,
    };
    let (mut moved, mut stayed) = (0, 0);
    for sweep in 0..400 {
        ladder.sweep(&kernels, &family, &mut rng, &mut Ignore);
        dear.set(0);
        cheap.set(0);
        let before = *ladder.replicas()[1].value();
        let steps = ladder.replicas()[1].statistics().steps;
        let went = ladder.step_by_tour(1, &touring, &mut tour, &family, &mut rng, &mut Ignore);
        let after = *ladder.replicas()[1].value();
        assert_eq!(before[1].to_bits(), after[1].to_bits(), "sweep {sweep}");
        assert_eq!(went, before[0].to_bits() != after[0].to_bits());
        assert_eq!(ladder.replicas()[1].statistics().steps, steps + 1);
        if before[0] < 0.8 {
            assert_eq!((dear.get() <= 1, cheap.get()), (true, 6));
            moved += u32::from(went);
        } else {
            assert_eq!((dear.get(), cheap.get(), went), (0, 0, false));
            stayed += 1;
        }
    }
    assert!(moved > 150 && stayed > 50, "{moved} {stayed}");
}
