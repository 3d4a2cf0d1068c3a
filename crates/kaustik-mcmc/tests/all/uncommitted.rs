//! A kernel on points that does not commit or roll back is found.

use kaustik_mcmc::testing::{Grid, GridStep, assert_detailed_balance};
use kaustik_mcmc::{
    Coordinates, Draws, Ignore, Kernel, Move, Mutation, Point, PointKernel, Stream, Target, target,
};

use crate::kit::complaint;

/// Moves points as a [`PointKernel`] does, but may forget what comes after the decision.
struct Forgetful<T> {
    kernel: PointKernel<T>,
    accepts: bool,
    rejects: bool,
}

impl<T: Target, M: Mutation> Kernel<Point<M>> for Forgetful<T> {
    type Value = T::Value;

    fn propose<D: Draws + ?Sized>(
        &self,
        state: &mut Point<M>,
        current: &T::Value,
        proposed: &mut T::Value,
        draws: &mut D,
    ) -> Move {
        self.kernel.propose(state, current, proposed, draws)
    }

    fn accept(&self, state: &mut Point<M>) {
        if self.accepts {
            Kernel::<Point<M>>::accept(&self.kernel, state);
        }
    }

    fn reject(&self, state: &mut Point<M>) {
        if self.rejects {
            Kernel::<Point<M>>::reject(&self.kernel, state);
        }
    }
}

/// A kernel that never commits leaves its point where it was, in perfect balance: its value tells.
#[test]
fn a_point_that_is_not_where_its_value_is_is_named() {
    let target = target(|u: &mut dyn Coordinates| u.get(Stream::Camera, 0));
    let family = |x: &f64| [*x];
    let grid = Grid::new(5, &[(Stream::Camera, 0)]);
    let matrix = |accepts, rejects| {
        let kernel = Forgetful {
            kernel: PointKernel::new(&target, 0.3),
            accepts,
            rejects,
        };
        let step = GridStep::symmetric(5, 1);
        grid.matrix(&target, &family, 0, &step, |chain, draws| {
            chain.step(&kernel, &family, draws, &mut Ignore);
        })
    };
    assert_detailed_balance(&matrix(true, true), &grid.densities(&target, &family, 0));
    let apart = complaint(|| drop(matrix(false, true)));
    assert!(apart.contains("does the kernel commit"), "{apart}");
}
