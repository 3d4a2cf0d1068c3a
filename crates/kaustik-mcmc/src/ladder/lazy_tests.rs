//! Exact: ladders of lazy points whose levels have different step sizes.

use kaustik_pss::{Coordinates, Stream};

use super::*;
use crate::Point;
use crate::testing::{Enumerator, GridStep, Law, PointKey, point_key};
use crate::toys::{CELLS, Cells, cell, lazy, mutations};
use crate::{Ignore, Move, PointKernel};

const TOLERANCE: f64 = 1e-12;

fn densities(&(first, second): &Cells) -> [f64; 2] {
    let part = |table: [f64; CELLS]| second.map_or(0.7, |i| table[i]);
    [
        [0.6, 1.0, 0.4][first] * part([1.0, 0.2, 0.5]),
        [1.0, 0.5, 0.9][first] * part([0.0, 1.0, 0.3]),
    ]
}

type Lazy = Ladder<Point<GridStep>, Cells, 2>;

fn key(ladder: &Lazy) -> ([Cells; 2], [PointKey; 2], u64) {
    let [a, b] = ladder.replicas();
    let keys = [point_key(a.state()), point_key(b.state())];
    ([*a.value(), *b.value()], keys, ladder.turn() % 2)
}

/// Exchanges as it should, or forgets to pay.
struct Careless {
    kernel: f64,
    settle: bool,
}

impl Kernel<Point<GridStep>> for Careless {
    type Value = Cells;

    fn propose<D: Draws + ?Sized>(
        &self,
        point: &mut Point<GridStep>,
        current: &Cells,
        proposed: &mut Cells,
        draws: &mut D,
    ) -> Move {
        PointKernel::new(lazy(), self.kernel).propose(point, current, proposed, draws)
    }

    fn accept(&self, point: &mut Point<GridStep>) {
        point.commit();
    }

    fn reject(&self, point: &mut Point<GridStep>) {
        point.roll_back();
    }

    fn exchange<D: Draws + ?Sized>(
        &self,
        a: &mut Point<GridStep>,
        b: &mut Point<GridStep>,
        draws: &mut D,
    ) {
        if self.settle {
            PointKernel::new(lazy(), 0.0).exchange(a, b, draws);
        } else {
            std::mem::swap(&mut a.streams, &mut b.streams);
            std::mem::swap(&mut a.clock, &mut b.clock);
        }
    }
}

/// |law of both complete points - product of the targets|_1 after some sweeps from it.
fn lazy_defect<N: Kernel<Point<GridStep>, Value = Cells>>(
    kernels: &[N; 2],
    schedule: Schedule,
    sweeps: usize,
) -> f64 {
    let start = |(): &(), draws: &mut Enumerator| {
        Ladder::start(&lazy(), &densities, mutations(), draws).with_schedule(schedule)
    };
    let mut law = Law::certain(())
        .then(CELLS, start, key)
        .weighted(|ladder| ladder.replicas().iter().map(Metropolis::density).product());
    for _ in 0..sweeps {
        let sweep = |ladder: &Lazy, draws: &mut Enumerator| {
            let mut ladder = ladder.clone();
            ladder.sweep(kernels, &densities, draws, &mut Ignore);
            ladder
        };
        law = law.then(CELLS, sweep, key);
    }
    let read = |ladder: &Lazy, draws: &mut Enumerator| {
        let mut ladder = ladder.clone();
        ladder.replicas.each_mut().map(|replica| {
            let mut u = replica.state.current(draws);
            [Stream::Camera, Stream::Light].map(|s| cell(u.get(s, 0)))
        })
    };
    let complete = law.then(CELLS, read, |cells| *cells);
    let exact = |[first, second]: [usize; 2], level: usize| {
        densities(&(first, (first != 2).then_some(second)))[level]
    };
    let points: Vec<_> = (0..CELLS * CELLS).map(|i| [i % CELLS, i / CELLS]).collect();
    let total: [f64; 2] = [0, 1].map(|level| points.iter().map(|&p| exact(p, level)).sum());
    complete
        .iter()
        .map(|(cells, p)| (p - exact(cells[0], 0) / total[0] * exact(cells[1], 1) / total[1]).abs())
        .sum()
}

#[test]
fn lazy_points_of_different_steps_keep_the_product() {
    for (large, schedule) in [
        ([0.0, 0.0], Schedule::Full),
        ([0.0, 0.0], Schedule::Permutation),
        ([1.0, 0.0], Schedule::Alternating),
    ] {
        let kernels = large.map(|large| PointKernel::new(lazy(), large));
        let defect = lazy_defect(&kernels, schedule, 3);
        assert!(defect < TOLERANCE, "{schedule:?}: {defect:e}");
    }
}

#[test]
fn an_exchange_that_does_not_settle_is_caught() {
    let kernels = |settle| [0.0, 0.0].map(|kernel| Careless { kernel, settle });
    assert!(lazy_defect(&kernels(true), Schedule::Full, 3) < TOLERANCE);
    let defect = lazy_defect(&kernels(false), Schedule::Full, 3);
    assert!(defect > 1e-5, "{defect:e}");
}
