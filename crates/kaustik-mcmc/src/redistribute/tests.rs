//! Redistribution by enumeration: the mean deposit is the integrand, in every channel.

use proptest::prelude::*;

use super::*;
use crate::testing::{Enumerator, GridStep, Law, assert_deposits};
use crate::{Mean, Move, Point, PointKernel, Step, Target, target};
use kaustik_pss::{Coordinates, Stream};

/// One step up or down a ring; where the chain is and where it was.
struct Ring(usize);

impl Kernel<[usize; 2]> for Ring {
    type Value = usize;

    fn propose<D: Draws + ?Sized>(
        &self,
        state: &mut [usize; 2],
        _: &usize,
        proposed: &mut usize,
        draws: &mut D,
    ) -> Move {
        let up = draws.index(&[0.7, 0.3]) == 1;
        let by = if up { 1 } else { self.0 - 1 };
        *state = [(state[0] + by) % self.0, state[0]];
        *proposed = state[0];
        Move::new(3, if up { 7.0 / 3.0 } else { 3.0 / 7.0 })
    }

    fn reject(&self, state: &mut [usize; 2]) {
        *state = [state[1]; 2];
    }
}

const STATES: usize = 4;

/// Two channels of the integrand; the density of a state is their sum.
type Channels = [[f64; 2]; STATES];

fn density(f: &Channels, state: usize) -> f64 {
    f[state][0] + f[state][1]
}

/// What one start chosen with probabilities `p` deposits on each state.
fn deposits<D: Draws>(
    f: &Channels,
    p: &[f64; STATES],
    plan: &Redistribution,
    draws: &mut D,
) -> Channels {
    let family = |state: &usize| [density(f, *state)];
    let mut film = [[0.0; 2]; STATES];
    let mut deposit = |deposit: Deposit<'_, usize>| {
        assert!(deposit.proposed >= 0.0 && deposit.stayed >= 0.0 && deposit.density > 0.0);
        for channel in 0..2 {
            film[*deposit.value][channel] +=
                deposit.weight() * f[*deposit.value][channel] / deposit.density;
        }
    };
    let total: f64 = p.iter().sum();
    let start = draws.index(p);
    let weight = density(f, start) / (p[start] / total);
    let begin = (&[start; 2], &start, weight);
    let mut redistributor = Redistributor::new();
    redistributor.run(plan, begin, &Ring(STATES), &family, draws, &mut deposit);
    film
}

/// The exact mean of [`deposits`].
fn mean(f: &Channels, p: &[f64; STATES], plan: &Redistribution) -> Channels {
    let law = Law::certain(()).then(
        1,
        |(): &(), draws: &mut Enumerator| deposits(f, p, plan, draws),
        |film| film.map(|channels| channels.map(f64::to_bits)),
    );
    std::array::from_fn(|i| std::array::from_fn(|c| law.mean(|film| film[i][c])))
}

fn defect(a: &Channels, b: &Channels) -> f64 {
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    pairs.map(|(a, b)| (a - b).abs()).sum()
}

const COLOURS: Channels = [[1.0, 0.2], [0.0, 0.0], [0.1, 2.0], [0.5, 0.5]];
const STARTS: [f64; STATES] = [1.0, 0.5, 2.0, 1.5];

/// 2.15 over the mean: with m = 2 between 0.2 and 3.2 chains a start.
fn plan(unit: f64) -> Redistribution {
    Redistribution::new(2, unit).unwrap()
}

#[test]
fn the_mean_deposit_is_the_integrand_in_every_channel() {
    for unit in [0.8, 2.0, 20.0] {
        for plan in [plan(unit), plan(unit).plain(), plan(unit).most_chains(1)] {
            let found = mean(&COLOURS, &STARTS, &plan);
            assert!(defect(&found, &COLOURS) < 1e-12, "{plan:?}: {found:?}");
        }
    }
    // a cap that is no whole number of the weight, at more than one chain
    let capped = plan(0.3).most_chains(2);
    assert!(defect(&mean(&COLOURS, &STARTS, &capped), &COLOURS) < 1e-12);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]
    #[test]
    fn the_mean_deposit_is_any_integrand(
        f in prop::array::uniform4(prop::array::uniform2(
            prop_oneof![1 => Just(0.0), 3 => 0.01..1.0f64])),
        p in prop::array::uniform4(0.2..1.0f64),
        share in 1.0..3.0f64,
        plain in any::<bool>(),
        most in 1..4u32,
    ) {
        let plan = plan(share * 2.0).most_chains(most);
        let plan = if plain { plan.plain() } else { plan };
        assert_deposits(1, &f, |draws, film| {
            for (sum, found) in film.iter_mut().zip(deposits(&f, &p, &plan, draws)) {
                (0..2).for_each(|channel| sum[channel] += found[channel]);
            }
        });
    }
}

/// The channels of the start, wherever the deposit falls (Batty's Algorithm 2): the density
/// stays right, its channels do not.
#[test]
fn the_colour_of_the_start_is_caught() {
    let smeared = Law::certain(()).then(
        1,
        |(): &(), draws: &mut Enumerator| {
            let family = |state: &usize| [density(&COLOURS, *state)];
            let start = draws.index(&STARTS);
            let i = density(&COLOURS, start);
            let mut film = [[0.0; 2]; STATES];
            let mut deposit = |deposit: Deposit<'_, usize>| {
                for channel in 0..2 {
                    film[*deposit.value][channel] += deposit.weight() * COLOURS[start][channel] / i;
                }
            };
            let begin = (&[start; 2], &start, i / (STARTS[start] / 5.0));
            Redistributor::new().run(&plan(2.0), begin, &Ring(4), &family, draws, &mut deposit);
            film
        },
        |film| film.map(|channels| channels.map(f64::to_bits)),
    );
    let mean: Channels =
        std::array::from_fn(|i| std::array::from_fn(|c| smeared.mean(|film| film[i][c])));
    assert!(defect(&mean, &COLOURS) > 0.5, "{mean:?}");
    for state in 0..STATES {
        assert!((density(&mean, state) - density(&COLOURS, state)).abs() < 1e-12);
    }
}

/// The filter drops staying alone, after more than `patience` rejections in a row.
#[test]
fn impatience_drops_what_stays_too_long() {
    // from the only bright state every proposal is dark: all is staying
    let family = |state: &usize| [if *state == 2 { 3.0 } else { 0.0 }];
    let mut rng = crate::generator(1, 0);
    for (patience, kept) in [(None, 6), (Some(0), 1), (Some(2), 3), (Some(9), 6)] {
        let mut plan = Redistribution::new(6, 0.5).unwrap();
        if let Some(patience) = patience {
            plan = plan.patience(patience);
        }
        let mut sum = 0.0;
        let mut deposit = |d: Deposit<'_, usize>| {
            assert!(!d.is_proposal && d.proposed <= 0.0 && *d.value == 2);
            sum += d.weight();
        };
        let mut redistributor = Redistributor::new();
        let begin = (&[2, 2], &2, 3.0);
        let chains = redistributor.run(&plan, begin, &Ring(4), &family, &mut rng, &mut deposit);
        let statistics = redistributor.statistics();
        assert_eq!(
            (chains, statistics.chains, statistics.chain.steps),
            (1, 1, 6)
        );
        assert!(
            (sum - 0.5 * f64::from(kept)).abs() < 1e-12,
            "{patience:?}: {sum}"
        );
        assert!((sum + statistics.dropped - 3.0).abs() < 1e-12);
    }
    // what proposals are given is kept: on a flat density nothing else is given
    let flat = |_: &usize| [1.0];
    let plan = Redistribution::new(6, 0.5).unwrap().patience(0);
    let (mut sum, mut proposals) = (0.0, 0);
    let mut deposit = |d: Deposit<'_, usize>| {
        sum += d.proposed;
        proposals += u32::from(d.is_proposal);
    };
    struct Still;
    impl Kernel<()> for Still {
        type Value = usize;
        fn propose<D: Draws + ?Sized>(
            &self,
            (): &mut (),
            v: &usize,
            p: &mut usize,
            _: &mut D,
        ) -> Move {
            *p = *v;
            Move::small()
        }
    }
    Redistributor::new().run(&plan, (&(), &1, 3.0), &Still, &flat, &mut rng, &mut deposit);
    assert!((sum - 3.0).abs() < 1e-12 && proposals == 6);
}

/// What is not deposited is what was dropped, and no more.
#[test]
fn dropped_weight_is_accounted_for() {
    let family = |state: &usize| [[2.0, 1.0, 0.0, 0.5][*state]];
    let mut rng = crate::generator(3, 0);
    let mut redistributor = Redistributor::new();
    let plan = Redistribution::new(50, 0.1).unwrap().patience(0);
    let (mut sum, mut held) = (0.0, 0.0);
    let mut deposit = |d: Deposit<'_, usize>| {
        sum += d.weight();
        held += d.held;
        assert!((d.unit - 0.1).abs() < 1e-15);
    };
    let begin = (&[0, 0], &0, 100.0);
    redistributor.run(&plan, begin, &Ring(4), &family, &mut rng, &mut deposit);
    let dropped = redistributor.statistics().dropped;
    assert!((held - dropped).abs() < 1e-9, "{held} {dropped}");
    assert!(
        (sum + dropped - 100.0).abs() < 1e-9 && dropped > 10.0,
        "{sum} {dropped}"
    );
}

/// The plain form deposits after the step: the start gets nothing if the chain leaves it.
#[test]
fn plain_deposits_fall_where_the_step_ends() {
    let flat = |_: &usize| [1.0];
    let mut rng = crate::generator(4, 0);
    let mut deposits = Vec::new();
    let mut deposit = |d: Deposit<'_, usize>| deposits.push((*d.value, d.proposed, d.stayed));
    let plan = Redistribution::new(1, 0.5).unwrap().plain();
    struct Next;
    impl Kernel<()> for Next {
        type Value = usize;
        fn propose<D: Draws + ?Sized>(
            &self,
            (): &mut (),
            current: &usize,
            proposed: &mut usize,
            _: &mut D,
        ) -> Move {
            *proposed = current + 1;
            Move::small()
        }
    }
    let begin = (&(), &1, 0.5);
    Redistributor::new().run(&plan, begin, &Next, &flat, &mut rng, &mut deposit);
    assert_eq!(deposits.len(), 1);
    let (value, proposed, stayed) = deposits[0];
    assert!(value == 2 && (proposed - 0.5).abs() < 1e-15 && stayed <= 0.0);
}

#[test]
fn bad_starts_and_plans_are_refused_and_counted() {
    assert_eq!(Redistribution::new(0, 1.0), Err(RedistributionError::Steps));
    for unit in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = Redistribution::new(3, unit).unwrap_err();
        assert!(refused.to_string().contains("finite and positive"));
    }
    let dark: Mean = [0.0, 0.0].into_iter().collect();
    assert!(Redistribution::pilot(3, &dark).is_err());
    let seen: Mean = [1.0, 5.0].into_iter().collect();
    assert!((Redistribution::pilot(3, &seen).unwrap().unit() - 1.0).abs() < 1e-15);

    let family = |state: &usize| [[1.0, 0.0, f64::NAN, -1.0][*state]];
    let mut rng = crate::generator(2, 0);
    let mut redistributor = Redistributor::new();
    let mut run = |state: usize, weight| {
        let mut none = |_: Deposit<'_, usize>| panic!("a deposit");
        let begin = (&[state; 2], &state, weight);
        redistributor.run(&plan(1.0), begin, &Ring(4), &family, &mut rng, &mut none)
    };
    let bad = [
        (0, f64::NAN),
        (0, f64::INFINITY),
        (0, -1.0),
        (1, 1.0),
        (2, 1.0),
        (3, 1.0),
    ];
    for (state, weight) in bad {
        assert_eq!(run(state, weight), 0);
    }
    assert_eq!(run(0, 0.0) + run(1, 0.0), 0);
    assert_eq!(redistributor.statistics().bad_starts, 6);
    assert_eq!(redistributor.statistics().starts, 2);
}

/// Defective proposals are counted, rejected and never deposited on.
#[test]
fn defects_get_nothing() {
    let family = |state: &usize| [[1.0, f64::NAN, f64::INFINITY, -1.0][*state]];
    let mut rng = crate::generator(2, 0);
    let mut redistributor = Redistributor::new();
    let mut sum = 0.0;
    let mut deposit = |d: Deposit<'_, usize>| {
        assert_eq!(*d.value, 0);
        sum += d.weight();
    };
    let begin = (&[0, 0], &0, 100.0);
    let plan = Redistribution::new(10, 1.0).unwrap();
    redistributor.run(&plan, begin, &Ring(4), &family, &mut rng, &mut deposit);
    assert!((sum - 100.0).abs() < 1e-9);
    assert_eq!(redistributor.statistics().chain.defects, 100);
}

/// On lazy points: each chain begins at the whole start, coordinates that sleep included.
#[test]
fn lazy_points_are_redistributed_without_bias() {
    const CELLS: usize = 4;
    let cell = |x: f64| (x * CELLS as f64) as usize;
    let f = |v: &[usize; 2]| [1.0, 0.2, 0.0, 0.7][v[0]] * [0.5, 1.0, 0.3, 0.0, 0.8][v[1]];
    let toy = target(move |u: &mut dyn Coordinates| {
        let first = cell(u.get(Stream::Camera, 0));
        let second = if first == 3 {
            4
        } else {
            cell(u.get(Stream::Light, 0))
        };
        [first, second]
    });
    let family = |v: &[usize; 2]| [f(v)];
    let law = Law::certain(()).then(
        CELLS,
        |(): &(), draws: &mut Enumerator| {
            let mut point = Point::new(GridStep::symmetric(CELLS, 1));
            let mut value = [0; 2];
            let mut first = point.propose(Step::Large, draws);
            toy.evaluate(&mut first, &mut value);
            first.decide(1.0);
            let mut film = [[0.0; 5]; CELLS];
            let mut deposit =
                |d: Deposit<'_, [usize; 2]>| film[d.value[0]][d.value[1]] += d.weight();
            let kernel = PointKernel::new(&toy, 0.0);
            let plan = Redistribution::new(2, 0.25).unwrap();
            let begin = (&point, &value, f(&value));
            Redistributor::new().run(&plan, begin, &kernel, &family, draws, &mut deposit);
            film
        },
        |film| film.map(|row| row.map(f64::to_bits)),
    );
    for first in 0..CELLS {
        for second in 0..5 {
            let reached = (first == 3) == (second == 4);
            let p = if second == 4 { 0.25 } else { 0.0625 };
            let exact = if reached {
                p * f(&[first, second])
            } else {
                0.0
            };
            let found = law.mean(|film| film[first][second]);
            assert!(
                (found - exact).abs() < 1e-12,
                "{first} {second}: {found} {exact}"
            );
        }
    }
}

/// Numbers of chains of starts of these weights, rounded together from this share.
fn chains_together(share: f64, weights: &[f64], unit: f64) -> Vec<u32> {
    let plan = Redistribution::new(1, unit).unwrap();
    let mut redistributor = Redistributor::new();
    redistributor.carry(Some(share));
    let mut draws = crate::generator(1, 0);
    let mut nothing = |_: Deposit<'_, usize>| {};
    let mut run = |&weight: &f64| {
        let start = (&[0; 2], &0, weight);
        redistributor.run(
            &plan,
            start,
            &Ring(STATES),
            &|_: &usize| [1.0],
            &mut draws,
            &mut nothing,
        )
    };
    weights.iter().map(&mut run).collect()
}

proptest! {
    /// Every run of starts has as many chains as it should, to one; and each start the right number in the
    /// mean over the share (stratified: to one part in as many shares as there are, for each of the two ends
    /// of its interval).
    #[test]
    fn starts_that_are_rounded_together_have_the_chains_due_to_them(weights in prop::collection::vec(0.0..3.0f64, 1..30), unit in 0.2..5.0f64) {
        const SHARES: usize = 200;
        let mut sums = vec![0.0; weights.len()];
        for i in 0..SHARES {
            let chains = chains_together((i as f64 + 0.5) / SHARES as f64, &weights, unit);
            let (mut due, mut taken) = (0.0, 0.0);
            for ((sum, weight), n) in sums.iter_mut().zip(&weights).zip(chains) {
                (*sum, due, taken) = (*sum + f64::from(n), due + weight / unit, taken + f64::from(n));
                prop_assert!((due - taken).abs() < 1.0 + 1e-9, "{due} {taken}");
            }
        }
        for (sum, weight) in sums.iter().zip(&weights) {
            let mean = sum / SHARES as f64;
            prop_assert!((mean - weight / unit).abs() < 2.0 / SHARES as f64, "{mean} {}", weight / unit);
        }
    }
}

#[test]
fn what_is_no_share_is_not_carried() {
    let mut redistributor = Redistributor::<[usize; 2], usize>::new();
    for share in [f64::NAN, 1.0, -0.1, f64::INFINITY] {
        redistributor.carry(Some(share));
        assert_eq!(redistributor.carried(), None);
    }
    redistributor.carry(Some(0.25));
    assert_eq!(
        redistributor.carried().map(f64::to_bits),
        Some(0.25_f64.to_bits())
    );
}
