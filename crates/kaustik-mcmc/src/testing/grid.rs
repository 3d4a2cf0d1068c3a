use kaustik_pss::{Coordinates, Recorded, Recording, Stream};

use super::{Enumerator, Script, TransitionMatrix};
use crate::mutation::wrap;
use crate::{Draws, Family, Metropolis, Mutation, Point, Step, Target};

/// The middle of the cell that `x` lies in: equal positions have equal bits.
fn middle(cells: usize, x: f64) -> f64 {
    let n = cells as f64;
    ((x * n).floor() + 0.5) / n
}

/// A mutation whose steps are whole cells of a grid on the circle: the discrete stand-in
/// of a continuous one, for enumeration.
#[derive(Clone, Debug, PartialEq)]
pub struct GridStep {
    cells: usize,
    /// Cells to move.
    steps: Vec<i32>,
    /// Their relative probabilities.
    weights: Vec<f64>,
}

impl GridStep {
    /// Moves by `reach` cells of a grid of `cells`, up or down with equal probability:
    /// symmetric. `reach` is below `cells`.
    pub fn symmetric(cells: usize, reach: i32) -> Self {
        Self::new(cells, &[(reach, 0.5), (-reach, 0.5)])
    }

    /// Moves by given numbers of cells with given relative probabilities: symmetric only
    /// if these are. Moves are smaller than the grid.
    pub fn new(cells: usize, steps: &[(i32, f64)]) -> Self {
        Self {
            cells,
            steps: steps.iter().map(|step| step.0).collect(),
            weights: steps.iter().map(|step| step.1).collect(),
        }
    }
}

impl Mutation for GridStep {
    fn mutate<D: Draws + ?Sized>(&self, x: f64, draws: &mut D) -> f64 {
        let by = f64::from(self.steps[draws.index(&self.weights)]);
        middle(self.cells, wrap(x + by / self.cells as f64))
    }
}

/// Any mutation, brought to the middle of the cell that it ends in: how the law of a
/// continuous one is enumerated.
///
/// If the mutation is symmetric on the circle and the same everywhere, this is symmetric on
/// the grid; with one proviso: no step may end exactly on the border of two cells. (From the
/// middle of a cell, with `cells` answers to each uniform number, that is a matter of odd
/// sizes.)
///
/// Take an even number of cells: mutations that read the sign off the first bit of a uniform number have no middle
/// answer then. And see to it that steps leave a cell at all: a chain that never moves is in balance.
#[derive(Clone, Debug, PartialEq)]
pub struct OnGrid<M> {
    cells: usize,
    mutation: M,
}

impl<M: Mutation> OnGrid<M> {
    /// `mutation` on a grid of `cells`.
    pub fn new(cells: usize, mutation: M) -> Self {
        Self { cells, mutation }
    }
}

#[deny(clippy::missing_trait_methods)]
impl<M: Mutation> Mutation for OnGrid<M> {
    fn mutate<D: Draws + ?Sized>(&self, x: f64, draws: &mut D) -> f64 {
        middle(self.cells, self.mutation.mutate(x, draws))
    }

    fn mutate_at<D: Draws + ?Sized>(
        &self,
        stream: Stream,
        index: u32,
        x: f64,
        draws: &mut D,
    ) -> f64 {
        let to = self.mutation.mutate_at(stream, index, x, draws);
        middle(self.cells, to)
    }

    /// That of the mutation itself: one that is too small is a fault to be found.
    fn mixed_after(&self) -> u64 {
        self.mutation.mixed_after()
    }

    fn mixed_after_at(&self, stream: Stream, index: u32) -> u64 {
        self.mutation.mixed_after_at(stream, index)
    }
}

/// Finitely many points of the cube: some coordinates, each in the middle of one of so
/// many cells. Its states are numbered from 0, the first coordinate runs fastest.
///
/// This is how a chain on [`Point`]s becomes a matrix: [`matrix`](Self::matrix).
///
/// ```
/// use kaustik_mcmc::testing::{Grid, GridStep, assert_detailed_balance};
/// use kaustik_mcmc::{Ignore, PointKernel, target};
/// use kaustik_pss::{Coordinates, Stream};
///
/// let product = target(|u: &mut dyn Coordinates| {
///     u.get(Stream::Camera, 0) * u.get(Stream::Light, 3)
/// });
/// let density = |value: &f64| [(value - 0.2).max(0.0)]; // zero in a corner
///
/// let grid = Grid::new(5, &[(Stream::Camera, 0), (Stream::Light, 3)]);
/// let kernel = PointKernel::new(&product, 0.3);
/// let step = GridStep::symmetric(5, 1);
/// let matrix = grid.matrix(&product, &density, 0, &step, |chain, draws| {
///     chain.step(&kernel, &density, draws, &mut Ignore);
/// });
/// assert_detailed_balance(&matrix, &grid.densities(&product, &density, 0));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    cells: usize,
    addresses: Vec<(Stream, u32)>,
}

impl Grid {
    /// The points whose coordinates at `addresses` are in the middles of `cells` cells.
    pub fn new(cells: usize, addresses: &[(Stream, u32)]) -> Self {
        Self {
            cells,
            addresses: addresses.to_vec(),
        }
    }

    /// The cells of a coordinate.
    pub fn cells(&self) -> usize {
        self.cells
    }

    /// How many points there are: `cells` to the number of coordinates.
    pub fn states(&self) -> usize {
        self.cells.pow(self.addresses.len() as u32)
    }

    /// A point, to be read.
    pub fn recorded(&self, state: usize) -> Recorded {
        let addresses = self.addresses.iter().zip(self.values(state));
        addresses.map(|(&(s, i), x)| (s, i, x)).collect()
    }

    /// The number of the point that `u` is at.
    pub fn state(&self, u: &mut dyn Coordinates) -> usize {
        let cell = |x: f64| (x * self.cells as f64) as usize;
        let addresses = self.addresses.iter().rev();
        addresses.fold(0, |state, &(s, i)| state * self.cells + cell(u.get(s, i)))
    }

    /// A point that has read all its coordinates, and with them is at a state of the grid.
    pub fn point<M: Mutation>(&self, state: usize, mutation: M) -> Point<M> {
        let mut point = Point::new(mutation);
        let mut values = Script::new(self.values(state));
        let mut first = point.propose(Step::Large, &mut values);
        for &(s, i) in &self.addresses {
            first.get(s, i);
        }
        first.leave_open();
        point.commit();
        point
    }

    /// A chain at a state of the grid: as if an evaluation had arrived there. Coordinates that
    /// this evaluation does not read are at the state too, and unread.
    pub fn chain<T, F, M, const K: usize>(
        &self,
        state: usize,
        target: &T,
        family: &F,
        level: usize,
        mutation: M,
    ) -> Metropolis<Point<M>, T::Value, K>
    where
        T: Target,
        F: Family<T::Value, K> + ?Sized,
        M: Mutation,
    {
        let mut value = T::Value::default();
        let mut source = self.recorded(state);
        let mut reading = Recording::new(&mut source);
        target.evaluate(&mut reading, &mut value);
        let read = reading.finish();
        let mut point = self.point(state, mutation);
        for &(s, i) in self
            .addresses
            .iter()
            .filter(|(s, i)| read.value(*s, *i).is_none())
        {
            point.streams[s as usize][i as usize].seen = -1; // never
        }
        Metropolis::at(point, value, family, level)
    }

    /// The density of each state: the law that a chain at this level must keep.
    pub fn densities<T, F, const K: usize>(&self, target: &T, family: &F, level: usize) -> Vec<f64>
    where
        T: Target,
        F: Family<T::Value, K> + ?Sized,
    {
        let mut value = T::Value::default();
        let mut density = |state| {
            target.evaluate(&mut self.recorded(state), &mut value);
            family.densities(&value)[level]
        };
        (0..self.states()).map(&mut density).collect()
    }

    /// The exact transition matrix of what `step` does to a chain. Coordinates that its
    /// last evaluation did not read are brought up to date at the end; so this is the
    /// matrix of the *eager* chain, as one step from everywhere sees it. (On what only
    /// several steps show, see [`Law`](super::Law).)
    ///
    /// # Panics
    /// If the value of a chain is not that of the point where it is: the point was not committed when a proposal was
    /// accepted, or not rolled back when it was rejected.
    pub fn matrix<T, F, M, const K: usize>(
        &self,
        target: &T,
        family: &F,
        level: usize,
        mutation: &M,
        mut step: impl FnMut(&mut Metropolis<Point<M>, T::Value, K>, &mut Enumerator),
    ) -> TransitionMatrix
    where
        T: Target<Value: Clone>,
        F: Family<T::Value, K> + ?Sized,
        M: Mutation + Clone,
    {
        let start = |state| self.chain(state, target, family, level, mutation.clone());
        let starts: Vec<_> = (0..self.states()).map(start).collect();
        let densities: Vec<[f64; K]> = starts.iter().map(|chain| chain.densities).collect();
        TransitionMatrix::of(self.states(), self.cells, |from, draws| {
            let mut chain = starts[from].clone();
            step(&mut chain, draws);
            let to = self.state(&mut chain.state.current(draws));
            let (has, is) = (chain.densities, densities[to]);
            assert!(
                has.map(f64::to_bits) == is.map(f64::to_bits),
                "a step from {from}: the chain's value has densities {has:?}, its point (state {to}) {is:?}; \
                 does the kernel commit and roll back?"
            );
            to
        })
    }

    /// The coordinates of a state.
    fn values(&self, state: usize) -> impl Iterator<Item = f64> + '_ {
        let cells = self.cells;
        let mut rest = state;
        self.addresses.iter().map(move |_| {
            let cell = rest % cells;
            rest /= cells;
            (cell as f64 + 0.5) / cells as f64
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::point_key;
    use crate::{Exponential, Uniform};

    const ADDRESSES: [(Stream, u32); 3] =
        [(Stream::Camera, 1), (Stream::Light, 0), (Stream::Time, 4)];

    #[test]
    fn states_are_points_and_points_are_states() {
        let grid = Grid::new(3, &ADDRESSES);
        assert_eq!((grid.states(), grid.cells()), (27, 3));
        for state in 0..27 {
            assert_eq!(grid.state(&mut grid.recorded(state)), state);
            let mut point = grid.point(state, GridStep::symmetric(3, 1));
            assert_eq!(grid.state(&mut point.current(&mut Script::new([]))), state);
            // all read, none in debt
            assert_eq!(point_key(&point).len(), 3);
            assert!(point_key(&point).iter().all(|c| c.3 == 0 && c.4));
        }
    }

    #[test]
    fn shipped_mutations_are_symmetric_on_a_grid() {
        let symmetric = |cells: usize, matrix: &TransitionMatrix| {
            super::super::assert_detailed_balance(matrix, &vec![1.0; cells]);
        };
        fn matrix<M: Mutation>(cells: usize, mutation: M) -> TransitionMatrix {
            let mutation = OnGrid::new(cells, mutation);
            TransitionMatrix::of(cells, cells, |from, draws| {
                let x = (from as f64 + 0.5) / cells as f64;
                (mutation.mutate(x, draws) * cells as f64) as usize
            })
        }
        symmetric(16, &matrix(16, Exponential::new(0.05, 0.41)));
        symmetric(15, &matrix(15, Uniform::new(1.0)));
        symmetric(16, &matrix(16, Uniform::new(0.37)));
    }
}
