//! Kernels as exact transition matrices, chains as exact laws.

use kaustik_mcmc::testing::{Enumerator, GridStep, Law, PointKey, TransitionMatrix, point_key};
use kaustik_mcmc::{Draws, Ignore, Kernel, Metropolis, Move, Point, PointKernel, Target, target};
use kaustik_pss::{Coordinates, Stream};
use proptest::prelude::*;

const TOLERANCE: f64 = 1e-12;

/// A kernel on the states of a ring that steps up with probability `up`, else down.
struct Ring {
    states: usize,
    up: f64,
    /// Whether the ratio of proposal probabilities is reported.
    honest: bool,
    /// Whether a rejected state is taken back.
    undo: bool,
}

/// The state is where the chain is and where it was.
impl Kernel<[usize; 2]> for Ring {
    type Value = usize;

    fn propose<D: Draws + ?Sized>(
        &self,
        state: &mut [usize; 2],
        _: &usize,
        proposed: &mut usize,
        draws: &mut D,
    ) -> Move {
        let up = draws.bernoulli(self.up);
        state[1] = state[0];
        state[0] = (state[0] + if up { 1 } else { self.states - 1 }) % self.states;
        *proposed = state[0];
        let odds = (1.0 - self.up) / self.up;
        let ratio = if up { odds } else { 1.0 / odds };
        Move::new(Move::OWN, if self.honest { ratio } else { 1.0 })
    }

    fn reject(&self, state: &mut [usize; 2]) {
        if self.undo {
            state[0] = state[1];
        }
    }
}

/// One step of the library's chain as a matrix.
fn matrix(pi: &[f64], kernel: &Ring) -> TransitionMatrix {
    TransitionMatrix::of(pi.len(), 1, |from, draws| {
        let family = |state: &usize| [pi[*state]];
        let mut chain = Metropolis::at([from; 2], from, &family, 0);
        chain.step(kernel, &family, draws, &mut Ignore);
        chain.state()[0]
    })
}

fn targets() -> impl Strategy<Value = Vec<f64>> {
    let density = prop_oneof![1 => Just(0.0), 4 => 1e-3..1.0f64];
    prop::collection::vec(density, 3..9).prop_filter("all zero", |pi| pi.iter().sum::<f64>() > 0.0)
}

proptest! {
    #[test]
    fn symmetric_and_skewed_kernels_keep_the_target(pi in targets(), up in 0.05..0.95f64) {
        for up in [0.5, up] {
            let p = matrix(&pi, &Ring { states: pi.len(), up, honest: true, undo: true });
            prop_assert!(p.stationarity_defect(&pi) < TOLERANCE);
            prop_assert!(p.balance_defect(&pi) < TOLERANCE);
        }
    }
}

const UNEVEN: [f64; 5] = [1.0, 0.0, 3.0, 0.5, 2.0];

fn ring(up: f64) -> Ring {
    Ring {
        states: 5,
        up,
        honest: true,
        undo: true,
    }
}

#[test]
fn planted_faults_of_a_kernel_are_caught() {
    let asymmetric = Ring {
        honest: false,
        ..ring(0.7)
    };
    assert!(matrix(&UNEVEN, &asymmetric).balance_defect(&UNEVEN) > 1e-3);
    assert!(matrix(&UNEVEN, &asymmetric).stationarity_defect(&UNEVEN) > 1e-3);
    let no_undo = Ring {
        undo: false,
        ..ring(0.5)
    };
    assert!(matrix(&UNEVEN, &no_undo).stationarity_defect(&UNEVEN) > 1e-3);
    // a wrong acceptance: Barker's formula without its normaliser
    let wrong = TransitionMatrix::of(5, 1, |from, draws| {
        let to = (from + [1, 4][draws.index(&[1.0, 1.0])]) % 5;
        let a = UNEVEN[to] / (UNEVEN[from] + 1.0);
        if draws.bernoulli(a) { to } else { from }
    });
    assert!(wrong.stationarity_defect(&UNEVEN) > 1e-3);
}

const CELLS: usize = 4;

/// What a point of the toy below is made from; unread coordinates are `None`.
type Cells = (usize, Option<usize>, Option<usize>);

fn cell(x: f64) -> usize {
    (x * CELLS as f64) as usize
}

/// Variable length: the first coordinate decides which of two others are read.
fn toy() -> impl Target<Value = Cells> + Clone {
    target(|u: &mut dyn Coordinates| -> Cells {
        let first = cell(u.get(Stream::Camera, 0));
        let mut light = |i| Some(cell(u.get(Stream::Light, i)));
        match first {
            0 => (0, light(0), light(1)),
            1 => (1, light(0), None),
            2 => (2, None, light(1)),
            _ => (3, None, None),
        }
    })
}

/// Uneven, with zeros.
fn density(value: &Cells) -> [f64; 1] {
    let &(first, a, b) = value;
    let weights = [0.6, 1.0, 0.3, 0.8];
    let part = |x: Option<usize>, t: [f64; CELLS]| x.map_or(0.7, |i| t[i]);
    [weights[first] * part(a, [1.0, 0.2, 0.0, 0.5]) * part(b, [0.1, 0.9, 0.4, 1.0])]
}

type Chain = Metropolis<Point<GridStep>, Cells, 1>;

fn key<M>(chain: &Metropolis<Point<M>, Cells, 1>) -> (Cells, PointKey) {
    (*chain.value(), point_key(chain.state()))
}

/// Chains in exact stationarity: independent starts weighted by their density.
fn stationary(mutation: &GridStep) -> Law<Chain> {
    let start =
        |(): &(), draws: &mut _| Metropolis::start(&toy(), &density, 0, mutation.clone(), draws);
    Law::certain(())
        .then(CELLS, start, key)
        .weighted(|chain| chain.density())
}

/// |law of the complete current state - target|_1 over all CELLS^3 points.
fn defect(law: &Law<Chain>) -> f64 {
    let complete = law.then(
        CELLS,
        |chain, draws| {
            let mut point = chain.state().clone();
            let mut u = point.current(draws);
            [(Stream::Camera, 0), (Stream::Light, 0), (Stream::Light, 1)]
                .map(|(s, i)| cell(u.get(s, i)))
        },
        |cells| *cells,
    );
    let exact = |c: [usize; 3]| {
        let value = match c[0] {
            0 => (0, Some(c[1]), Some(c[2])),
            1 => (1, Some(c[1]), None),
            2 => (2, None, Some(c[2])),
            _ => (3, None, None),
        };
        density(&value)[0]
    };
    let points = || (0..CELLS.pow(3)).map(|i| [i % CELLS, i / CELLS % CELLS, i / CELLS / CELLS]);
    let total: f64 = points().map(exact).sum();
    let found: std::collections::BTreeMap<_, _> = complete.iter().collect();
    points()
        .map(|c| (found.get(&c).copied().unwrap_or(0.0) - exact(c) / total).abs())
        .sum()
}

/// Chains after `steps` steps of `step`, from stationarity.
fn run(
    mutation: &GridStep,
    steps: usize,
    mut step: impl FnMut(usize, &mut Chain, &mut Enumerator),
) -> Law<Chain> {
    let mut law = stationary(mutation);
    for n in 0..steps {
        law = law.then(
            CELLS,
            |chain, draws| {
                let mut chain = chain.clone();
                step(n, &mut chain, draws);
                chain
            },
            key,
        );
    }
    law
}

fn near() -> GridStep {
    GridStep::symmetric(CELLS, 1)
}

fn far() -> GridStep {
    GridStep::new(CELLS, &[(0, 0.7), (2, 0.3)])
}

#[test]
fn lazy_points_keep_the_target_over_several_steps() {
    for large in [0.0, 0.25] {
        let law = run(&near(), 4, |_, chain, draws| {
            chain.step(
                &PointKernel::new(toy(), large),
                &density,
                draws,
                &mut Ignore,
            );
        });
        assert!(defect(&law) < TOLERANCE, "{large}: {}", defect(&law));
    }
}

#[test]
fn a_settled_or_refreshed_change_of_mutation_keeps_the_target() {
    for refresh in [false, true] {
        let law = run(&near(), 4, |n, chain, draws| {
            chain.step(&PointKernel::new(toy(), 0.0), &density, draws, &mut Ignore);
            if refresh {
                chain.refresh();
            }
            let next = if n % 2 == 0 { far() } else { near() };
            chain.set_mutation(next, draws);
        });
        assert!(
            defect(&law) < TOLERANCE,
            "refresh {refresh}: {}",
            defect(&law)
        );
    }
}

/// A mutation whose sizes change under the point's feet: the debt is paid in new coin.
#[test]
fn an_unsettled_change_of_mutation_is_caught() {
    use std::cell::Cell;
    use std::rc::Rc;

    #[derive(Clone)]
    struct Switch(Rc<Cell<bool>>);

    impl kaustik_mcmc::Mutation for Switch {
        fn mutate<D: Draws + ?Sized>(&self, x: f64, draws: &mut D) -> f64 {
            if self.0.get() { far() } else { near() }.mutate(x, draws)
        }
    }

    let switch = Switch(Rc::new(Cell::new(false)));
    let all = |settle: bool| {
        switch.0.set(false);
        let kernel = PointKernel::new(toy(), 0.0);
        let start =
            |(): &(), draws: &mut _| Metropolis::start(&toy(), &density, 0, switch.clone(), draws);
        let mut law = Law::certain(())
            .then(CELLS, start, key)
            .weighted(|c| c.density());
        for n in 0..5 {
            let (old, new) = (n % 2 == 1, n % 2 == 0);
            law = law.then(
                CELLS,
                |chain, draws| {
                    let mut chain = chain.clone();
                    switch.0.set(old);
                    chain.step(&kernel, &density, draws, &mut Ignore);
                    if settle {
                        chain.settle(draws);
                    }
                    chain
                },
                key,
            );
            switch.0.set(new);
        }
        let moments =
            |c: &Metropolis<Point<Switch>, Cells, 1>| f64::from(u8::from(c.value().0 == 0));
        law.mean(moments)
    };
    let exact = stationary(&near()).mean(|c| f64::from(u8::from(c.value().0 == 0)));
    assert!(
        (all(true) - exact).abs() < TOLERANCE,
        "{} {exact}",
        all(true)
    );
    assert!((all(false) - exact).abs() > 1e-5, "{} {exact}", all(false));
}

/// Kernels around [`PointKernel`] with one fault each.
struct Faulty {
    undo: bool,
}

impl Kernel<Point<GridStep>> for Faulty {
    type Value = Cells;

    fn propose<D: Draws + ?Sized>(
        &self,
        state: &mut Point<GridStep>,
        current: &Cells,
        proposed: &mut Cells,
        draws: &mut D,
    ) -> Move {
        PointKernel::new(toy(), 0.0).propose(state, current, proposed, draws)
    }

    fn accept(&self, state: &mut Point<GridStep>) {
        PointKernel::new(toy(), 0.0).accept(state);
    }

    fn reject(&self, state: &mut Point<GridStep>) {
        let kernel = PointKernel::new(toy(), 0.0);
        if self.undo {
            kernel.reject(state);
        } else {
            kernel.accept(state);
        }
    }
}

#[test]
fn a_missing_undo_and_an_asymmetric_mutation_are_caught() {
    let step = |undo: bool| {
        move |_: usize, chain: &mut Chain, draws: &mut Enumerator| {
            chain.step(&Faulty { undo }, &density, draws, &mut Ignore);
        }
    };
    assert!(defect(&run(&near(), 2, step(true))) < TOLERANCE);
    assert!(defect(&run(&near(), 2, step(false))) > 1e-2);
    let drifting = GridStep::new(CELLS, &[(1, 0.8), (-1, 0.2)]);
    assert!(defect(&run(&drifting, 2, step(true))) > 1e-2);
}

/// Two coordinates sleep through two accepted steps.
fn with_sleepers(mutation: GridStep, rng: &mut impl Draws) -> Point<GridStep> {
    let mut point = Point::new(mutation);
    for (step, reads) in [
        (kaustik_mcmc::Step::Large, 3),
        (kaustik_mcmc::Step::Small, 1),
        (kaustik_mcmc::Step::Small, 1),
    ] {
        let mut proposal = point.propose(step, rng);
        (0..reads).for_each(|i| {
            proposal.get(Stream::Camera, i);
        });
        assert!(proposal.decide(1.0));
    }
    let owed = point_key(&point).iter().filter(|c| c.3 == 2).count();
    assert_eq!(owed, 2);
    point
}

fn assert_free_of_debt(point: &Point<GridStep>) {
    assert_eq!(point_key(point).len(), 3);
    assert!(point_key(point).iter().all(|coordinate| coordinate.3 == 0));
}

/// Points exchanged between two chains of different mutations, whose targets are the same,
/// so that every exchange may be accepted.
#[test]
fn exchanged_points_carry_no_debt() {
    let mut rng = kaustik_mcmc::generator(1, 0);
    let mut a = with_sleepers(near(), &mut rng);
    let mut b = with_sleepers(far(), &mut rng);
    a.exchange(&mut b, &mut rng);
    assert_eq!((a.mutation(), b.mutation()), (&near(), &far()));
    assert_free_of_debt(&a);
    assert_free_of_debt(&b);
}

#[test]
fn entering_pays_the_debt() {
    let mut rng = kaustik_mcmc::generator(2, 0);
    let mut point = with_sleepers(near(), &mut rng);
    let nothing = target(|_: &mut dyn Coordinates| 0.0);
    PointKernel::new(&nothing, 0.5).enter(&mut point, &mut rng);
    assert_free_of_debt(&point);
}
