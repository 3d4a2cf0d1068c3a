//! Delayed rejection as an exact transition matrix, and its weights as exact means.

use std::collections::BTreeMap;

use kaustik_pss::{Coordinates, Stream};
use proptest::prelude::*;

use super::{SecondStage, second_acceptance};
use crate::testing::{Enumerator, GridStep, Law, TransitionMatrix, point_key};
use crate::{
    Draws, Exponential, Ignore, Kernel, Metropolis, Move, Point, PointKernel, Visit, acceptance,
    decide, generator, target,
};

/// On a ring: anywhere, with chance `large`, and after a rejection a neighbour; otherwise
/// a neighbour at once. The second stage goes up with chance `up`.
#[derive(Clone, Copy)]
struct Ring {
    states: usize,
    large: f64,
    up: f64,
}

impl Ring {
    fn neighbour<D: Draws + ?Sized>(&self, state: &mut [usize; 2], up: f64, draws: &mut D) -> bool {
        let up = draws.index(&[1.0 - up, up]) == 1;
        let by = if up { 1 } else { self.states - 1 };
        *state = [(state[0] + by) % self.states, state[0]];
        up
    }
}

impl Kernel<[usize; 2]> for Ring {
    type Value = usize;

    fn propose<D: Draws + ?Sized>(
        &self,
        state: &mut [usize; 2],
        _: &usize,
        proposed: &mut usize,
        draws: &mut D,
    ) -> Move {
        let large = draws.index(&[1.0 - self.large, self.large]) == 1;
        if large {
            *state = [draws.index(&vec![1.0; self.states]), state[0]];
        } else {
            self.neighbour(state, 0.5, draws);
        }
        *proposed = state[0];
        if large { Move::large() } else { Move::small() }
    }

    fn reject(&self, state: &mut [usize; 2]) {
        *state = [state[1]; 2];
    }
}

impl SecondStage<[usize; 2]> for Ring {
    fn propose_again<D: Draws + ?Sized>(
        &self,
        state: &mut [usize; 2],
        _: &usize,
        proposed: &mut usize,
        draws: &mut D,
    ) -> Move {
        let up = self.neighbour(state, self.up, draws);
        *proposed = state[0];
        let odds = (1.0 - self.up) / self.up;
        Move::new(Move::SECOND, if up { odds } else { 1.0 / odds })
    }
}

type Chain = Metropolis<[usize; 2], usize, 1>;

fn chain_at(from: usize, family: &impl Fn(&usize) -> [f64; 1]) -> Chain {
    Metropolis::at([from; 2], from, family, 0)
}

fn matrix(pi: &[f64], kernel: Ring) -> TransitionMatrix {
    TransitionMatrix::of(pi.len(), 1, |from, draws| {
        let family = |state: &usize| [pi[*state]];
        let mut chain = chain_at(from, &family);
        chain.step_delayed(&kernel, &family, draws, &mut Ignore);
        assert_eq!(chain.state()[0], *chain.value());
        chain.state()[0]
    })
}

/// The exact mean weights that one step from `from` reports for each state, and the least
/// weight of a visit.
fn weights(pi: &[f64], kernel: Ring, from: usize) -> (Vec<f64>, f64) {
    let family = |state: &usize| [pi[*state]];
    let mut least = f64::INFINITY;
    let law = Law::certain(()).then(
        1,
        |(): &(), draws: &mut Enumerator| {
            let mut weights = vec![0.0; pi.len()];
            let mut chain = chain_at(from, &family);
            let mut record = |visit: Visit<'_, usize, 1>| {
                least = least.min(visit.weight);
                weights[*visit.value] += visit.weight;
            };
            chain.step_delayed(&kernel, &family, draws, &mut record);
            chain.flush(&mut record);
            weights
        },
        |weights| weights.iter().map(|w| w.to_bits()).collect::<Vec<_>>(),
    );
    let means = (0..pi.len()).map(|i| law.mean(|w| w[i])).collect();
    (means, least)
}

fn targets() -> impl Strategy<Value = Vec<f64>> {
    let density = prop_oneof![1 => Just(0.0), 4 => 1e-3..1.0f64];
    prop::collection::vec(density, 3..8).prop_filter("all zero", |pi| pi.iter().sum::<f64>() > 0.0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn keeps_the_target_in_detailed_balance(
        pi in targets(), large in 0.0..=1.0f64, up in 0.05..0.95f64,
    ) {
        for up in [0.5, up] {
            let p = matrix(&pi, Ring { states: pi.len(), large, up });
            prop_assert!(p.balance_defect(&pi) < 1e-14, "{}", p.balance_defect(&pi));
            prop_assert!(p.stationarity_defect(&pi) < 1e-12);
        }
    }

    /// The mean weights of a step are the law of the next state.
    #[test]
    fn weights_are_expected_visits(pi in targets(), large in 0.0..=1.0f64, up in 0.05..0.95f64) {
        let kernel = Ring { states: pi.len(), large, up };
        let p = matrix(&pi, kernel);
        for from in (0..pi.len()).filter(|from| pi[*from] > 0.0) {
            let (means, least) = weights(&pi, kernel, from);
            prop_assert!(least >= 0.0);
            for (to, mean) in means.iter().enumerate() {
                prop_assert!((mean - p.probability(from, to)).abs() < 1e-13);
            }
        }
    }
}

const UNEVEN: [f64; 5] = [1.0, 0.0, 3.0, 0.5, 2.0];

/// One step by hand, with a given second acceptance.
fn by_hand(second: impl Fn(f64, f64, f64) -> f64) -> TransitionMatrix {
    TransitionMatrix::of(5, 1, |from, draws| {
        let first = draws.index(&[1.0; 5]);
        if decide(acceptance(UNEVEN[from], UNEVEN[first], 1.0), draws) {
            return first;
        }
        let again = (from + [1, 4][draws.index(&[1.0, 1.0])]) % 5;
        let a = second(UNEVEN[from], UNEVEN[first], UNEVEN[again]);
        if decide(a, draws) { again } else { from }
    })
}

#[test]
fn forgetting_the_rejected_proposal_is_caught() {
    let right = by_hand(|x, y, z| second_acceptance(x, y, z, 1.0));
    let plain = by_hand(|x, _, z| acceptance(x, z, 1.0));
    // the way back through its own rejection, with the chances but not the densities
    let chances = by_hand(|x, y, z| {
        let rejects = |from: f64| 1.0 - acceptance(from, y, 1.0);
        (rejects(z) / rejects(x)).min(1.0)
    });
    assert!(right.balance_defect(&UNEVEN) < 1e-15);
    for wrong in [plain, chances] {
        assert!(wrong.balance_defect(&UNEVEN) > 1e-2);
        assert!(wrong.stationarity_defect(&UNEVEN) > 1e-2);
    }
}

#[test]
fn second_acceptances_are_those_worked_out_by_hand() {
    let cases = [
        ((4.0, 1.0, 2.0, 1.0), 1.0 / 3.0),
        ((4.0, 1.0, 2.0, 1.5), 0.5),
        ((4.0, 0.0, 2.0, 1.0), 0.5), // nothing was learnt from a dark proposal
        ((4.0, 1.0, 1.0, 1.0), 0.0),
        ((4.0, 1.0, 0.5, 1.0), 0.0),
        ((4.0, 1.0, 9.0, 1.0), 1.0),
        ((0.0, 0.0, 1.0, 1.0), 1.0),
        ((4.0, 1.0, f64::NAN, 1.0), 0.0),
        ((4.0, 1.0, 2.0, f64::NAN), 0.0),
    ];
    for ((x, y, z, ratio), expected) in cases {
        let a = second_acceptance(x, y, z, ratio);
        assert!((a - expected).abs() < 1e-15, "{x} {y} {z} {ratio}: {a}");
    }
}

const CELLS: usize = 4;

fn cell(x: f64) -> usize {
    (x * CELLS as f64) as usize
}

/// On lazy points, over three steps: coordinates that the rejected large step read must not
/// be remembered.
#[test]
fn lazy_points_keep_the_target() {
    let toy = target(|u: &mut dyn Coordinates| -> [usize; 2] {
        let first = cell(u.get(Stream::Camera, 0));
        // the second is read in half of the places
        [
            first,
            if first < 2 {
                cell(u.get(Stream::Light, 0))
            } else {
                9
            },
        ]
    });
    let density = |v: &[usize; 2]| {
        let second = [1.0, 0.2, 0.0, 0.5];
        [[0.6, 1.0, 0.3, 0.8][v[0]] * second.get(v[1]).unwrap_or(&0.4)]
    };
    let kernel = PointKernel::new(&toy, 0.5);
    let key = |c: &Metropolis<Point<GridStep>, [usize; 2], 1>| (*c.value(), point_key(c.state()));
    let step = GridStep::symmetric(CELLS, 1);
    let mut law = Law::certain(())
        .then(
            CELLS,
            |(): &(), draws| Metropolis::start(&&toy, &density, 0, step.clone(), draws),
            key,
        )
        .weighted(|chain| chain.density());
    let place = |law: &Law<Metropolis<Point<GridStep>, [usize; 2], 1>>| {
        let mut places = BTreeMap::new();
        for (chain, p) in law.iter() {
            *places.entry(*chain.value()).or_insert(0.0) += p;
        }
        places
    };
    let exact = place(&law);
    for _ in 0..3 {
        law = law.then(
            CELLS,
            |chain, draws| {
                let mut chain = chain.clone();
                chain.step_delayed(&kernel, &density, draws, &mut Ignore);
                chain
            },
            key,
        );
    }
    let found = place(&law);
    let defect: f64 = exact.iter().map(|(v, p)| (p - found[v]).abs()).sum();
    assert!(defect < 1e-12, "{defect}");
}

/// What the second try is for: in a narrow place, where independent proposals fail, it moves.
#[test]
fn the_second_try_stays_near() {
    let toy = target(|u: &mut dyn Coordinates| u.get(Stream::Camera, 0));
    let narrow = |x: &f64| [if (x - 0.5).abs() < 0.1 { 1.0 } else { 0.0 }];
    let kernel = PointKernel::new(&toy, 1.0);
    let mut rng = generator(8, 0);
    let start = || Metropolis::start(&&toy, &narrow, 0, Exponential::default(), &mut rng);
    let mut chain = std::iter::repeat_with(start)
        .find(|chain| chain.density() > 0.0)
        .expect("one in five");
    let mut rng = generator(8, 1);
    let moves = (0..1000).filter(|_| chain.step_delayed(&kernel, &narrow, &mut rng, &mut Ignore));
    // alone, one of five proposals would be accepted; two independent ones: 0.36
    let moves = moves.count();
    assert!(moves > 900, "{moves} moves of 1000");
}

/// NaN, infinity and negative densities are counted and neither entered nor recorded.
#[test]
fn defects_are_kept_out_of_both_stages() {
    let toy = target(|u: &mut dyn Coordinates| u.get(Stream::Camera, 0));
    let family = |x: &f64| {
        [match cell(*x) {
            0 => f64::NAN,
            1 => f64::INFINITY,
            2 => -1.0,
            _ => *x,
        }]
    };
    let kernel = PointKernel::new(&toy, 0.9);
    let mut rng = crate::generator(5, 0);
    let mutation = crate::Uniform::new(0.6);
    let mut chain = Metropolis::start(&&toy, &family, 0, mutation, &mut rng);
    let mut record = |visit: Visit<'_, f64, 1>| assert!(*visit.value >= 0.75);
    for _ in 0..2000 {
        chain.step_delayed(&kernel, &family, &mut rng, &mut record);
    }
    let statistics = chain.statistics();
    let seconds = statistics.moves[Move::SECOND];
    assert_eq!(statistics.steps, 2000);
    assert!(
        statistics.defects > 2000,
        "both stages: {}",
        statistics.defects
    );
    assert_eq!(
        seconds.proposed,
        statistics.large().proposed - statistics.large().accepted
    );
    assert!(seconds.accepted > 100 && *chain.value() >= 0.75);
}
