//! Kernels of one's own on points, and several sizes of steps in one chain.

use kaustik_mcmc::testing::{Grid, GridStep, OnGrid, assert_detailed_balance};
use kaustik_mcmc::{
    Draws, Ignore, Kernel, Mixture, Move, Mutation, Point, PointKernel, SizedKernel, Step, Target,
    Uniform, target,
};
use kaustik_pss::{Coordinates, Stream};

const CELLS: usize = 4;
const ADDRESSES: [(Stream, u32); 2] = [(Stream::Camera, 0), (Stream::Light, 0)];

/// Reads the second coordinate on one side of the first alone, so that it sleeps on the other.
fn sleepy(u: &mut dyn Coordinates) -> f64 {
    let x = u.get(Stream::Camera, 0);
    if x < 0.5 {
        x * (0.01 + u.get(Stream::Light, 0).powi(4))
    } else {
        0.3
    }
}

fn density(value: &f64) -> [f64; 1] {
    [*value]
}

/// What anyone can write with what is public: small steps alone.
struct Small<T>(T);

impl<T: Target, M: Mutation> Kernel<Point<M>> for Small<T> {
    type Value = T::Value;

    fn propose<D: Draws + ?Sized>(
        &self,
        point: &mut Point<M>,
        _: &T::Value,
        proposed: &mut T::Value,
        draws: &mut D,
    ) -> Move {
        let mut proposal = point.propose(Step::Small, draws);
        self.0.evaluate(&mut proposal, proposed);
        proposal.leave_open();
        Move::small()
    }

    fn accept(&self, point: &mut Point<M>) {
        point.commit();
    }

    fn reject(&self, point: &mut Point<M>) {
        point.roll_back();
    }
}

#[test]
fn a_kernel_of_ones_own_moves_points() {
    let target = target(sleepy);
    let grid = Grid::new(CELLS, &ADDRESSES);
    let mutation = GridStep::symmetric(CELLS, 1);
    let matrix = |own: bool| {
        grid.matrix(&target, &density, 0, &mutation, |chain, draws| {
            if own {
                chain.step(&Small(&target), &density, draws, &mut Ignore);
            } else {
                let kernel = PointKernel::new(&target, 0.0);
                chain.step(&kernel, &density, draws, &mut Ignore);
            }
        })
    };
    let (own, library) = (matrix(true), matrix(false));
    assert_detailed_balance(&own, &grid.densities(&target, &density, 0));
    for from in 0..grid.states() {
        for to in 0..grid.states() {
            let difference = own.probability(from, to) - library.probability(from, to);
            assert!(difference.abs() < 1e-15, "{from} to {to}");
        }
    }
}

/// A mixture of kernels with steps of one and of two cells is half of each.
#[test]
fn kernels_in_a_mixture_have_their_own_sizes() {
    let target = target(sleepy);
    let grid = Grid::new(CELLS, &ADDRESSES);
    let [near, far] = [1, 2].map(|cells| SizedKernel {
        kernel: PointKernel::new(&target, 0.1),
        mutation: GridStep::symmetric(CELLS, cells),
    });
    let both = Mixture::new([near.clone(), far.clone()], [0.5, 0.5]);
    let start = GridStep::symmetric(CELLS, 1);
    let pi = grid.densities(&target, &density, 0);
    let mixed = grid.matrix(&target, &density, 0, &start, |chain, draws| {
        chain.step(&both, &density, draws, &mut Ignore);
    });
    assert_detailed_balance(&mixed, &pi);
    let [near, far] = [near, far].map(|kernel| {
        grid.matrix(&target, &density, 0, &start, |chain, draws| {
            chain.step(&kernel, &density, draws, &mut Ignore);
        })
    });
    let mut apart = 0.0_f64;
    for from in 0..grid.states() {
        for to in 0..grid.states() {
            let (near, far) = (near.probability(from, to), far.probability(from, to));
            let half = 0.5 * (near + far);
            assert!((mixed.probability(from, to) - half).abs() < 1e-14);
            apart = apart.max((near - far).abs());
        }
    }
    assert!(apart > 0.1, "the two are of different sizes");
    let twice = grid.matrix(&target, &density, 0, &start, |chain, draws| {
        for _ in 0..2 {
            chain.step(&both, &density, draws, &mut Ignore);
        }
    });
    assert!(
        twice.stationarity_defect(&pi) < 1e-12,
        "debts are paid in between"
    );
}

/// A walk that says after so many steps that it has forgotten where it came from.
#[derive(Clone)]
struct Forgets {
    walk: Uniform,
    after: u64,
}

impl Mutation for Forgets {
    fn mutate<D: Draws + ?Sized>(&self, x: f64, draws: &mut D) -> f64 {
        self.walk.mutate(x, draws)
    }

    fn mixed_after(&self) -> u64 {
        self.after
    }
}

/// Coordinates that are drawn anew too soon are found on a grid too.
#[test]
fn mixing_that_is_claimed_too_soon_is_found() {
    let target = target(sleepy);
    let grid = Grid::new(CELLS, &ADDRESSES);
    let kernel = PointKernel::new(&target, 0.0);
    let pi = grid.densities(&target, &density, 0);
    let defect = |after| {
        let walk = Uniform::new(0.7);
        let mutation = OnGrid::new(CELLS, Forgets { walk, after });
        let matrix = grid.matrix(&target, &density, 0, &mutation, |chain, draws| {
            chain.step(&kernel, &density, draws, &mut Ignore);
        });
        matrix.stationarity_defect(&pi)
    };
    assert!(defect(u64::MAX) < 1e-12);
    assert!(defect(0) > 1e-3, "{}", defect(0));
}
