//! The mixture as an exact transition matrix.

use proptest::prelude::*;

use kaustik_pss::{Coordinates, Stream};

use crate::testing::TransitionMatrix;
use crate::{
    Draws, Ignore, Kernel, LevelKernel, Metropolis, Mixture, Move, Point, PointKernel, Step,
    Suitability, Uniform, generator, target,
};

/// Steps on a ring by `reach`, up with chance `up`; remembers where it was, by a mark of
/// its own, so that another kernel's undo would go wrong.
#[derive(Clone, Copy)]
struct Ring {
    states: usize,
    reach: usize,
    up: f64,
    mark: usize,
}

/// Where the chain is, where it was, and who has moved it.
type State = [usize; 3];

impl Kernel<State> for Ring {
    type Value = usize;

    fn propose<D: Draws + ?Sized>(
        &self,
        state: &mut State,
        _: &usize,
        proposed: &mut usize,
        draws: &mut D,
    ) -> Move {
        let up = draws.index(&[1.0 - self.up, self.up]) == 1;
        let by = if up {
            self.reach
        } else {
            self.states - self.reach
        };
        *state = [(state[0] + by) % self.states, state[0], self.mark];
        *proposed = state[0];
        let odds = (1.0 - self.up) / self.up;
        Move::new(usize::from(up), if up { odds } else { 1.0 / odds })
    }

    fn accept(&self, state: &mut State) {
        assert_eq!(state[2], self.mark, "another kernel's proposal");
        state[2] = usize::MAX;
    }

    fn reject(&self, state: &mut State) {
        assert_eq!(state[2], self.mark, "another kernel's proposal");
        *state = [state[1], state[1], usize::MAX];
    }
}

fn matrix(pi: &[f64], kernel: &impl Kernel<State, Value = usize>) -> TransitionMatrix {
    TransitionMatrix::of(pi.len(), 1, |from, draws| {
        let family = |state: &usize| [pi[*state]];
        let mut chain = Metropolis::at([from, from, usize::MAX], from, &family, 0);
        chain.step(kernel, &family, draws, &mut Ignore);
        assert_eq!(chain.state()[0], *chain.value());
        chain.state()[0]
    })
}

/// Three kernels on a ring of `states`, the middle one an inner mixture.
fn mixture<W: Suitability<usize, 3> + Copy>(
    states: usize,
    up: f64,
    weights: W,
) -> impl Kernel<State, Value = usize> {
    let ring = |reach, up, mark| Ring {
        states,
        reach,
        up,
        mark,
    };
    let inner = Mixture::new([ring(1, 0.3, 12), ring(2, up, 13)], [0.25, 0.75]);
    Mixture::new((ring(1, up, 10), inner, ring(2, 0.5, 11)), weights)
}

const TOLERANCE: f64 = 1e-14;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn keeps_the_target_whatever_the_choice_depends_on(
        pi in prop::collection::vec(prop_oneof![1 => Just(0.0), 4 => 1e-3..1.0f64], 3..7),
        fixed in prop::array::uniform3(0.01..1.0f64),
        table in prop::collection::vec(
            prop::array::uniform3(prop_oneof![1 => Just(0.0), 3 => 0.01..1.0f64]), 7),
        up in 0.1..0.9f64,
    ) {
        prop_assume!(pi.iter().sum::<f64>() > 0.0);
        let suits = |state: &usize| table[*state];
        let p = matrix(&pi, &mixture(pi.len(), up, fixed));
        prop_assert!(p.balance_defect(&pi) < TOLERANCE && p.stationarity_defect(&pi) < 1e-12);
        let p = matrix(&pi, &mixture(pi.len(), up, suits));
        prop_assert!(p.balance_defect(&pi) < TOLERANCE && p.stationarity_defect(&pi) < 1e-12);
    }
}

const UNEVEN: [f64; 5] = [1.0, 0.0, 3.0, 0.5, 2.0];

/// A choice by state that is not corrected for is a wrong kernel.
struct Uncorrected;

impl Kernel<State> for Uncorrected {
    type Value = usize;

    fn propose<D: Draws + ?Sized>(
        &self,
        state: &mut State,
        current: &usize,
        proposed: &mut usize,
        draws: &mut D,
    ) -> Move {
        let ring = |reach, mark| Ring {
            states: 5,
            reach,
            up: 0.5,
            mark,
        };
        let near = [0.9, 0.2, 0.4, 0.7, 0.5][*current];
        let far = draws.index(&[near, 1.0 - near]);
        [ring(1, 0), ring(2, 0)][far].propose(state, current, proposed, draws)
    }

    fn reject(&self, state: &mut State) {
        *state = [state[1], state[1], usize::MAX];
    }
}

#[test]
fn an_uncorrected_choice_is_caught() {
    let p = matrix(&UNEVEN, &Uncorrected);
    assert!(p.stationarity_defect(&UNEVEN) > 1e-2);
    assert!(p.balance_defect(&UNEVEN) > 1e-2);
}

#[test]
fn kinds_are_told_apart_and_bad_weights_are_defects() {
    let run = |weights: fn(&usize) -> [f64; 3]| {
        let family = |state: &usize| [UNEVEN[*state]];
        let mut chain = Metropolis::at([0, 0, usize::MAX], 0, &family, 0);
        let mut rng = crate::generator(3, 0);
        for _ in 0..200 {
            chain.step(&mixture(5, 0.4, weights), &family, &mut rng, &mut Ignore);
        }
        chain.statistics().clone()
    };
    let sound = run(|_| [1.0, 2.0, 3.0]);
    let proposed: Vec<u64> = sound.moves.iter().map(|m| m.proposed).collect();
    // component + 3 * (down or up); the inner mixture has kinds 0 to 3
    assert!(proposed[..6].iter().all(|n| *n > 0), "{proposed:?}");
    assert_eq!(proposed.iter().sum::<u64>(), 200);
    assert_eq!(sound.defects, 0);
    for bad in [
        |_: &usize| [f64::NAN, 1.0, 1.0],
        |_: &usize| [-1.0, 1.0, 1.0],
        |_: &usize| [f64::INFINITY, 1.0, 1.0],
        |_: &usize| [f64::MAX, f64::MAX, 1.0],
    ] {
        let statistics = run(bad);
        assert_eq!((statistics.defects, statistics.longest_stay), (200, 200));
    }
    let unsuited = run(|_| [0.0; 3]);
    assert_eq!((unsuited.defects, unsuited.longest_stay), (0, 200));
    // defective at the place proposed alone
    let there = run(|state| {
        if *state == 0 {
            [1.0, 1.0, 0.0]
        } else {
            [f64::NAN; 3]
        }
    });
    assert_eq!((there.defects, there.longest_stay), (200, 200));
}

/// What belongs to a level stays there when states come and go, also through a mixture.
#[test]
fn exchanges_and_entries_reach_the_components() {
    let read = crate::target(|u: &mut dyn Coordinates| u.get(Stream::Camera, 0));
    let mut rng = generator(9, 0);
    let mut points = [0.1, 0.4].map(|size| {
        let mut point = Point::new(Uniform::new(size));
        let mut first = point.propose(Step::Large, &mut rng);
        first.get(Stream::Camera, 0);
        first.decide(1.0);
        point
    });
    let before = points.each_ref().map(Point::record);
    let pair = [0.1, 0.4].map(|size| LevelKernel::new(&read, 0.0, Uniform::new(size)));
    let mixture = Mixture::new(pair.each_ref(), [1.0, 1.0]);
    let [a, b] = &mut points;
    mixture.exchange(a, b, &mut rng);
    assert_eq!(
        points.each_ref().map(|p| *p.mutation()),
        [0.1, 0.4].map(Uniform::new)
    );
    assert_eq!(
        points.each_ref().map(Point::record),
        [before[1].clone(), before[0].clone()]
    );

    let alone = Mixture::new((&pair[1], &pair[1]), [1.0, 1.0]);
    alone.enter(&mut points[0], &mut rng);
    assert_eq!(*points[0].mutation(), Uniform::new(0.4));
}

/// A mixture within another may suit nowhere: nothing moves then, and nobody else is told to take back.
#[test]
fn a_mixture_within_that_suits_nowhere_leads_nowhere() {
    let ring = |mark| Ring {
        states: 3,
        reach: 1,
        up: 0.5,
        mark,
    };
    let pi = [0.2, 0.5, 0.3];
    for nothing in [0.0, f64::NAN] {
        let inner = Mixture::new([ring(12), ring(13)], |_: &usize| [nothing; 2]);
        let kernel = Mixture::new((ring(10), inner, ring(11)), [0.3, 0.4, 0.3]);
        let p = matrix(&pi, &kernel);
        assert!(p.stationarity_defect(&pi) < TOLERANCE && p.balance_defect(&pi) < TOLERANCE);
        assert!((0..3).all(|state| p.probability(state, state) >= 0.4));
        assert!(p.probability(0, 1) > 0.1);
    }
}

#[test]
fn kinds_that_are_too_large_are_one() {
    let two: Mixture<_, _, 2> = Mixture::new((), [1.0; 2]);
    let three: Mixture<_, _, 3> = Mixture::new((), [1.0; 3]);
    for kind in [usize::MAX, usize::MAX / 2] {
        assert!(two.kind(1, kind) < Move::NONE && two.kind(1, kind) % 2 == 1);
        assert!(three.kind(2, kind) < Move::NONE && three.kind(2, kind) % 3 == 2);
    }
    assert_eq!(three.kind(2, 5), 17);
}

/// Where the choice goes by the state a uniform proposal is no independent sample any more: half of them could not be
/// chosen back, and are never seen.
#[test]
fn a_choice_by_state_leaves_nothing_independent() {
    let place = target(|u: &mut dyn Coordinates| u.get(Stream::Camera, 0));
    let family = |_: &f64| [1.0];
    let kernels = || (PointKernel::new(&place, 0.0), PointKernel::new(&place, 1.0));
    let suits = |x: &f64| if *x < 0.5 { [1.0, 0.0] } else { [0.5, 0.5] };
    let mut rng = generator(4, 1);
    let start = |rng: &mut _| Metropolis::start(&place, &family, 0, Uniform::new(0.3), rng);
    let (mut fixed, mut chosen) = (start(&mut rng), start(&mut rng));
    for _ in 0..1_000 {
        fixed.step(
            &Mixture::new(kernels(), [0.5; 2]),
            &family,
            &mut rng,
            &mut Ignore,
        );
        chosen.step(
            &Mixture::new(kernels(), suits),
            &family,
            &mut rng,
            &mut Ignore,
        );
    }
    assert!(fixed.statistics().independent[0].count() > 400);
    assert_eq!(chosen.statistics().independent[0].count(), 0);
}
