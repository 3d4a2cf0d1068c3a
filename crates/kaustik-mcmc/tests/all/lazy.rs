//! Lazy points have the law of eager arrays: exactly, jointly over all steps.
//!
//! The same random programs are run on both: small and large steps, changes of mutation,
//! settling, refreshing, exchanging. What is compared is the joint law of what evaluations
//! saw at the start, before the last step, *and* the complete point at the end, over all
//! branches.

use std::collections::BTreeMap;

use kaustik_mcmc::testing::{Enumerator, Grid, GridStep, Law, PointKey, point_key};
use kaustik_mcmc::{Draws, Mutation, Point, Step, acceptance, decide};
use kaustik_pss::{Coordinates, Stream};
use proptest::prelude::*;

const CELLS: usize = 3;
const ADDRESSES: [(Stream, u32); 3] =
    [(Stream::Camera, 0), (Stream::Camera, 3), (Stream::Light, 1)];

/// A complete point, in cells.
type Eager = [usize; 3];
/// What an evaluation saw: unread coordinates are `None`.
type Seen = [Option<usize>; 3];

/// Reads the first coordinate, and then others by its cell: both, the second alone, none.
fn evaluate(mut get: impl FnMut(usize) -> usize) -> Seen {
    let first = get(0);
    let mut read = |i, when| if when { Some(get(i)) } else { None };
    [Some(first), read(1, first < 2), read(2, first == 0)]
}

fn evaluate_lazy(u: &mut dyn Coordinates) -> Seen {
    evaluate(|i| cell(u.get(ADDRESSES[i].0, ADDRESSES[i].1)))
}

fn cell(x: f64) -> usize {
    (x * CELLS as f64) as usize
}

/// A density by what was seen.
fn density(masses: &[f64], seen: &Seen) -> f64 {
    seen.iter()
        .enumerate()
        .map(|(i, c)| c.map_or(0.7, |c| masses[3 * i + c]))
        .product()
}

#[derive(Clone, Debug)]
enum Action {
    Small,
    Large,
    Mutation(GridStep),
    Settle,
    Refresh,
}

fn actions() -> impl Strategy<Value = Vec<Action>> {
    let action = prop_oneof![
        4 => Just(Action::Small),
        1 => Just(Action::Large),
        1 => mutation().prop_map(Action::Mutation),
        1 => Just(Action::Settle),
        1 => Just(Action::Refresh),
    ];
    prop::collection::vec(action, 1..6)
}

/// Stays sometimes, so that no parity hides anything.
fn mutation() -> impl Strategy<Value = GridStep> {
    (0.05..0.9f64).prop_map(|stay| {
        GridStep::new(
            CELLS,
            &[(0, stay), (1, 0.5 - stay / 2.0), (-1, 0.5 - stay / 2.0)],
        )
    })
}

fn masses() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(prop_oneof![1 => Just(0.0), 6 => 0.05..1.0f64], 9)
}

/// A state, what its evaluation saw, and what was seen at the start and before the last step.
#[derive(Clone)]
struct Told<S> {
    state: S,
    now: Seen,
    history: Vec<Seen>,
}

impl<S> Told<S> {
    fn new(state: S, now: Seen) -> Self {
        Self {
            state,
            now,
            history: vec![now],
        }
    }

    fn remember(&mut self) {
        self.history.truncate(1);
        self.history.push(self.now);
    }
}

/// Joint law of the history and the complete point.
type Joint = BTreeMap<(Vec<Seen>, Eager), f64>;

fn lazy(masses: &[f64], first: &GridStep, actions: &[Action]) -> Joint {
    let key = |told: &Told<Point<GridStep>>| -> (Vec<Seen>, Seen, PointKey) {
        (told.history.clone(), told.now, point_key(&told.state))
    };
    let start = |(): &(), draws: &mut Enumerator| {
        let mut state = Point::new(first.clone());
        let mut proposal = state.propose(Step::Large, draws);
        let now = evaluate_lazy(&mut proposal);
        assert!(proposal.decide(1.0));
        Told::new(state, now)
    };
    let mut law = Law::certain(()).then(CELLS, start, key);
    for action in actions {
        let act = |told: &Told<Point<GridStep>>, draws: &mut Enumerator| {
            let mut told = told.clone();
            match action {
                Action::Small => step_lazy(&mut told, masses, Step::Small, draws),
                Action::Large => step_lazy(&mut told, masses, Step::Large, draws),
                Action::Mutation(mutation) => told.state.set_mutation(mutation.clone(), draws),
                Action::Settle => told.state.settle(draws),
                Action::Refresh => told.state.refresh(),
            }
            told
        };
        law = law.then(CELLS, act, key);
    }
    joint(&law, complete)
}

fn complete(told: &Told<Point<GridStep>>, draws: &mut Enumerator) -> (Vec<Seen>, Eager) {
    let mut point = told.state.clone();
    let mut u = point.current(draws);
    (
        told.history.clone(),
        ADDRESSES.map(|(s, i)| cell(u.get(s, i))),
    )
}

fn step_lazy(told: &mut Told<Point<GridStep>>, masses: &[f64], step: Step, draws: &mut Enumerator) {
    let mut proposal = told.state.propose(step, draws);
    let seen = evaluate_lazy(&mut proposal);
    let a = acceptance(density(masses, &told.now), density(masses, &seen), 1.0);
    let accepted = proposal.decide(a);
    told.remember();
    if accepted {
        told.now = seen;
    }
}

fn joint<S>(
    law: &Law<S>,
    mut complete: impl FnMut(&S, &mut Enumerator) -> (Vec<Seen>, Eager),
) -> Joint {
    let complete = law.then(CELLS, |told, draws| complete(told, draws), Clone::clone);
    complete
        .iter()
        .map(|(outcome, p)| (outcome.clone(), p))
        .collect()
}

/// The same on arrays: every coordinate moves in every accepted step.
fn eager(masses: &[f64], first: &GridStep, actions: &[Action]) -> Joint {
    let start = |(): &(), draws: &mut Enumerator| {
        let state: Eager = std::array::from_fn(|_| cell(draws.uniform()));
        let now = evaluate(|i| state[i]);
        Told::new(state, now)
    };
    let law = Law::certain(()).then(CELLS, start, |told| (told.now, told.state));
    eager_from(law, masses, first, actions)
}

fn eager_from(
    mut law: Law<Told<Eager>>,
    masses: &[f64],
    first: &GridStep,
    actions: &[Action],
) -> Joint {
    let key = |told: &Told<Eager>| (told.history.clone(), told.now, told.state);
    let mut mutation = first.clone();
    for action in actions {
        let act = |told: &Told<Eager>, draws: &mut Enumerator| {
            let mut told = told.clone();
            let proposal = match action {
                Action::Small => told.state.map(|c| moved(&mutation, c, draws)),
                Action::Large => told.state.map(|_| cell(draws.uniform())),
                Action::Mutation(_) | Action::Settle => return told,
                Action::Refresh => {
                    for (c, seen) in told.state.iter_mut().zip(told.now) {
                        *c = seen.unwrap_or_else(|| cell(draws.uniform()));
                    }
                    return told;
                }
            };
            let seen = evaluate(|i| proposal[i]);
            let a = acceptance(density(masses, &told.now), density(masses, &seen), 1.0);
            told.remember();
            if decide(a, draws) {
                (told.state, told.now) = (proposal, seen);
            }
            told
        };
        law = law.then(CELLS, act, key);
        if let Action::Mutation(next) = action {
            mutation = next.clone();
        }
    }
    joint(&law, |told, _| (told.history.clone(), told.state))
}

fn moved(mutation: &GridStep, cell_now: usize, draws: &mut Enumerator) -> usize {
    cell(mutation.mutate((cell_now as f64 + 0.5) / CELLS as f64, draws))
}

/// Total variation, twice.
fn distance<K: Ord + Clone>(a: &BTreeMap<K, f64>, b: &BTreeMap<K, f64>) -> f64 {
    let one = |a: &BTreeMap<K, f64>, b: &BTreeMap<K, f64>, both: bool| -> f64 {
        let terms = a.iter().map(|(k, p)| match b.get(k) {
            Some(q) if both => (p - q).abs(),
            Some(_) => 0.0,
            None => *p,
        });
        terms.sum()
    };
    one(a, b, true) + one(b, a, false)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn lazy_is_eager_under_any_program(masses in masses(), first in mutation(), actions in actions()) {
        let (lazy, eager) = (lazy(&masses, &first, &actions), eager(&masses, &first, &actions));
        let distance = distance(&lazy, &eager);
        prop_assert!(distance < 1e-12, "{distance:e} over {} outcomes", eager.len());
    }
}

/// Sleepers of several ages, every action at least once: the program that faults fail on.
#[test]
fn lazy_is_eager_with_sleepers_of_several_ages() {
    let masses = [0.6, 1.0, 0.4, 1.0, 0.3, 0.0, 0.2, 0.9, 0.5];
    let near = GridStep::new(CELLS, &[(0, 0.6), (1, 0.2), (-1, 0.2)]);
    let far = GridStep::new(CELLS, &[(0, 0.1), (1, 0.45), (-1, 0.45)]);
    let change = || Action::Mutation(far.clone());
    let programs = [
        vec![Action::Small, Action::Small, Action::Small, Action::Small],
        vec![Action::Small, Action::Large, Action::Small, Action::Small],
        vec![
            Action::Small,
            Action::Small,
            change(),
            Action::Small,
            Action::Small,
        ],
        vec![
            Action::Small,
            Action::Small,
            Action::Refresh,
            Action::Small,
            Action::Small,
        ],
        vec![
            Action::Small,
            Action::Settle,
            Action::Small,
            Action::Large,
            Action::Small,
        ],
    ];
    for program in programs {
        let distance = distance(
            &lazy(&masses, &near, &program),
            &eager(&masses, &near, &program),
        );
        assert!(distance < 1e-12, "{program:?}: {distance:e}");
    }
}

/// Two small steps of one point, then an exchange with a point of another mutation, then two
/// small steps of that: what slept through the first pair is paid in its own coin.
#[test]
fn exchanged_lazy_points_are_exchanged_eager_ones() {
    let masses = [0.6, 1.0, 0.4, 1.0, 0.3, 0.5, 0.2, 0.9, 0.5];
    let near = GridStep::new(CELLS, &[(0, 0.6), (1, 0.2), (-1, 0.2)]);
    let far = GridStep::new(CELLS, &[(0, 0.1), (1, 0.45), (-1, 0.45)]);
    let grid = Grid::new(CELLS, &ADDRESSES);
    let key =
        |told: &Told<Point<GridStep>>| (told.history.clone(), told.now, point_key(&told.state));
    let start = |(): &(), _: &mut Enumerator| {
        let now = evaluate_lazy(&mut grid.recorded(0));
        Told::new(grid.point(0, near.clone()), now)
    };
    let small = |told: &Told<Point<GridStep>>, draws: &mut Enumerator| {
        let mut told = told.clone();
        step_lazy(&mut told, &masses, Step::Small, draws);
        told
    };
    let exchange = |told: &Told<Point<GridStep>>, draws: &mut Enumerator| {
        let mut told = told.clone();
        let mut other = grid.point(5, far.clone());
        other.exchange(&mut told.state, draws);
        told.state = other; // its mutation is the other one
        told
    };
    let mut law = Law::certain(())
        .then(CELLS, start, key)
        .then(CELLS, small, key);
    law = law.then(CELLS, small, key).then(CELLS, exchange, key);
    law = law.then(CELLS, small, key).then(CELLS, small, key);
    let found = joint(&law, complete);

    // A change of mutation is all that an exchange is to the coordinates that go along.
    let program = [
        Action::Small,
        Action::Small,
        Action::Mutation(far.clone()),
        Action::Small,
        Action::Small,
    ];
    let origin = Law::certain(Told::new([0; 3], evaluate(|_| 0)));
    let wanted = eager_from(origin, &masses, &near, &program);
    assert!(
        distance(&found, &wanted) < 1e-12,
        "{:e}",
        distance(&found, &wanted)
    );
}
