//! Exact: joint spaces small enough to be enumerated.

use proptest::prelude::*;

mod photon;

use super::*;
use crate::testing::{
    Enumerator, Law, TransitionMatrix, assert_detailed_balance, assert_stationary,
};
use crate::toys::{Ring, STATES};
use crate::{Ignore, Move, Visit, acceptance, generator};

const TOLERANCE: f64 = 1e-12;

/// densities[state][level]
type Table<const K: usize> = [[f64; K]; STATES];

fn states<const K: usize>() -> impl Iterator<Item = [usize; K]> {
    (0..STATES.pow(K as u32)).map(digits)
}

fn digits<const K: usize>(index: usize) -> [usize; K] {
    std::array::from_fn(|k| index / STATES.pow(k as u32) % STATES)
}

fn index<const K: usize>(state: [usize; K]) -> usize {
    state.iter().rev().fold(0, |sum, s| sum * STATES + s)
}

/// The product of all targets.
fn joint<const K: usize>(table: &Table<K>) -> Vec<f64> {
    let product = |s: [usize; K]| (0..K).map(|k| table[s[k]][k]).product();
    states().map(product).collect()
}

fn ladder<const K: usize>(table: &Table<K>, at: [usize; K]) -> Ladder<(), usize, K> {
    Ladder::new(at.map(|s| ((), s)), &|s: &usize| table[*s])
}

fn place<const K: usize>(ladder: &Ladder<(), usize, K>) -> usize {
    index(ladder.replicas().each_ref().map(|r| *r.value()))
}

const KERNELS: [Ring; 4] = [
    Ring { up: 0.5 },
    Ring { up: 0.7 },
    Ring { up: 0.2 },
    Ring { up: 0.6 },
];

fn kernels<const K: usize>() -> [Ring; K] {
    std::array::from_fn(|k| KERNELS[k])
}

/// One sweep or only its exchanges, at the given turn, as a matrix on joint states.
fn matrix<const K: usize>(
    table: &Table<K>,
    steps: bool,
    turn: u64,
    prepare: impl Fn(Ladder<(), usize, K>) -> Ladder<(), usize, K>,
) -> TransitionMatrix {
    let family = |s: &usize| table[*s];
    TransitionMatrix::of(STATES.pow(K as u32), 1, |from, draws| {
        let mut ladder = prepare(ladder(table, digits(from)));
        ladder.turn = turn;
        if steps {
            ladder.sweep(&kernels(), &family, draws, &mut Ignore);
        } else {
            ladder.exchange(&kernels(), draws, &mut Ignore);
        }
        place(&ladder)
    })
}

const SCHEDULES: [Schedule; 6] = [
    Schedule::Off,
    Schedule::RandomPair,
    Schedule::RandomMatching,
    Schedule::Alternating,
    Schedule::Full,
    Schedule::Permutation,
];

/// Each of these is one reversible kernel; exchanges one after the other are not.
const ELEMENTARY: [Schedule; 4] = [
    Schedule::RandomPair,
    Schedule::RandomMatching,
    Schedule::Alternating,
    Schedule::Permutation,
];

/// Level 0 positive everywhere, zeros above it, each level somewhere positive.
fn tables<const K: usize>() -> impl Strategy<Value = Table<K>> {
    let density = || prop_oneof![1 => Just(0.0), 3 => 1e-3..1.0f64];
    let all = prop::collection::vec(density(), STATES * K);
    all.prop_map(|flat| {
        let mut table = [[0.0; K]; STATES];
        for (s, row) in table.iter_mut().enumerate() {
            for (k, entry) in row.iter_mut().enumerate() {
                *entry = flat[s * K + k];
            }
            row[0] += 0.5;
        }
        table[K % STATES].iter_mut().for_each(|d| *d += 0.25);
        table
    })
}

const UNEVEN: Table<3> = [[1.0, 0.3, 0.0], [1.0, 2.0, 5.0], [1.0, 0.0, 0.4]];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn sweeps_keep_the_product_of_all_targets(
        table in tables::<3>(), schedule in prop::sample::select(&SCHEDULES[..]), turn in 0..2u64,
    ) {
        let p = matrix(&table, true, turn, |l| l.with_schedule(schedule));
        assert_stationary(&p, &joint(&table));
    }

    #[test]
    fn elementary_exchanges_are_in_detailed_balance(
        table in tables::<3>(), schedule in prop::sample::select(&ELEMENTARY[..]), turn in 0..2u64,
    ) {
        let p = matrix(&table, false, turn, |l| l.with_schedule(schedule));
        assert_detailed_balance(&p, &joint(&table));
    }

    #[test]
    fn any_graph_keeps_the_product(
        table in tables::<4>(), mask in 1u32..1 << 6,
        schedule in prop::sample::select(&SCHEDULES[1..5]), turn in 0..3u64,
    ) {
        let all = SwapGraph::<4>::complete();
        let pairs: Vec<_> = (0..6).filter(|i| mask >> i & 1 == 1)
            .map(|i| (all.pairs()[i][0], all.pairs()[i][1])).collect();
        let graph = SwapGraph::new(&pairs).expect("distinct pairs");
        let prepare = |l: Ladder<_, _, 4>| l.with_graph(graph.clone()).with_schedule(schedule);
        let p = matrix(&table, false, turn, prepare);
        assert_stationary(&p, &joint(&table));
    }
}

#[test]
fn ladders_of_four_levels_and_of_one_keep_the_product() {
    let table: Table<4> = [
        [1.0, 1.0, 0.5, 0.0],
        [1.0, 0.2, 0.1, 0.1],
        [1.0, 3.0, 4.0, 9.0],
    ];
    let pi = joint(&table);
    let p = matrix(&table, true, 0, |l| l);
    assert!(p.stationarity_defect(&pi) < TOLERANCE);
    let single: Table<1> = [[1.0], [0.0], [2.5]];
    for schedule in SCHEDULES {
        let p = matrix(&single, true, 0, |l| l.with_schedule(schedule));
        assert!(p.stationarity_defect(&joint(&single)) < TOLERANCE);
    }
}

#[test]
fn permutations_are_drawn_from_their_exact_law() {
    let table = UNEVEN;
    let p = matrix(&table, false, 0, |l| l.with_schedule(Schedule::Permutation));
    let pi = joint(&table);
    // from (0, 1, 2) all that is reached has its joint density
    let reached: f64 = (0..27)
        .filter(|&to| p.probability(index([0, 1, 2]), to) > 0.0)
        .map(|to| pi[to])
        .sum();
    for to in [[0, 1, 2], [2, 0, 1], [1, 0, 2]] {
        let found = p.probability(index([0, 1, 2]), index(to));
        assert!((found - pi[index(to)] / reached).abs() < 1e-15, "{to:?}");
    }
}

/// Exchanges decided by a formula with a fault.
fn faulty(formula: impl Fn([f64; 2], [f64; 2]) -> f64) -> f64 {
    let table = UNEVEN;
    let p = TransitionMatrix::of(27, 1, |from, draws| {
        let mut s: [usize; 3] = digits(from);
        for k in [0, 1] {
            let (u, v) = (table[s[k]], table[s[k + 1]]);
            let a = formula([u[k], v[k + 1]], [v[k], u[k + 1]]);
            if decide(a, draws) {
                s.swap(k, k + 1);
            }
        }
        index(s)
    });
    p.stationarity_defect(&joint(&table))
}

#[test]
fn faults_of_an_exchange_are_caught() {
    let r = |own: [f64; 2], crossed: [f64; 2]| crossed[0] * crossed[1] / (own[0] * own[1]);
    assert!(faulty(exchange_acceptance) < TOLERANCE);
    // RELT sec. 4.1 prints max{1, r}
    assert!(faulty(|o, c| r(o, c).max(1.0)) > 1e-2);
    // the exponent wrong by 2 %
    assert!(faulty(|o, c| r(o, c).powf(1.02).min(1.0)) > 1e-4);
    // one density forgotten, one taken from the wrong level
    assert!(faulty(|o, c| acceptance(o[0], c[0], 1.0)) > 1e-2);
    assert!(faulty(|o, c| exchange_acceptance([o[1], o[0]], [c[0], o[1]])) > 1e-2);
}

/// E of the weight reported at each level and state in one sweep from the product law, and
/// E of the sums for normalisers.
fn expected_visits(schedule: Schedule) -> ([[f64; STATES]; 3], [f64; 3]) {
    let table = UNEVEN;
    let family = |s: &usize| table[*s];
    let pi = joint(&table);
    let total: f64 = pi.iter().sum();
    let (mut weights, mut ratios) = ([[0.0; STATES]; 3], [0.0; 3]);
    for (from, mass) in pi.iter().enumerate().filter(|(_, mass)| **mass > 0.0) {
        let sweep = |(): &(), draws: &mut Enumerator| {
            let mut found = [[0.0; STATES]; 3];
            let mut record = |visit: Visit<'_, usize, 3>| {
                assert!(visit.density() > 0.0);
                found[visit.level][*visit.value] += visit.weight;
            };
            let mut ladder = ladder(&table, digits(from)).with_schedule(schedule);
            ladder.sweep(&kernels(), &family, draws, &mut record);
            ladder.flush(&mut record);
            (found, ladder.stepping_stone().normalisers(1.0).values())
        };
        let mut serial = 0;
        let law = Law::certain(()).then(1, sweep, |_| {
            serial += 1; // all runs apart
            serial
        });
        for ((found, values), p) in law.iter() {
            let p = p * mass / total;
            for (sum, x) in weights.iter_mut().flatten().zip(found.iter().flatten()) {
                *sum += p * x;
            }
            // b_1 / b_0 and b_2 / b_1 of one sweep
            ratios[1] += p * values[1];
            ratios[2] += p * if values[1] > 0.0 {
                values[2] / values[1]
            } else {
                0.0
            };
        }
    }
    (weights, ratios)
}

#[test]
fn every_level_is_visited_by_its_own_law() {
    let b: [f64; 3] = std::array::from_fn(|k| UNEVEN.iter().map(|row| row[k]).sum());
    for schedule in SCHEDULES {
        let (weights, ratios) = expected_visits(schedule);
        for (k, row) in weights.iter().enumerate() {
            for (s, weight) in row.iter().enumerate() {
                let exact = UNEVEN[s][k] / b[k];
                assert!(
                    (weight - exact).abs() < TOLERANCE,
                    "{schedule:?} {k} {s}: {weight}"
                );
            }
        }
        assert!((ratios[1] - b[1] / b[0]).abs() < TOLERANCE, "{schedule:?}");
    }
}

#[test]
fn a_stone_expects_the_ratio_of_normalisers() {
    // sums of one sweep at level 1: E[q_2 / q_1] under p_1 is b_2 over the support of q_1
    let table: Table<3> = [[1.0, 0.3, 0.2], [1.0, 2.0, 5.0], [1.0, 0.5, 0.0]];
    let family = |s: &usize| table[*s];
    let (pi, mut ratio, mut weight) = (joint(&table), 0.0, 0.0);
    let total: f64 = pi.iter().sum();
    for (from, mass) in pi.iter().enumerate() {
        let law = crate::testing::enumerate(1, |draws| {
            let mut ladder = ladder(&table, digits(from));
            ladder.sweep(&kernels(), &family, draws, &mut Ignore);
            ladder.flush(&mut Ignore);
            let [_, _, stone] = ladder.stepping_stone().sums();
            [stone.0.to_bits(), stone.1.to_bits()]
        });
        for (sums, p) in law {
            ratio += mass / total * p * f64::from_bits(sums[0]);
            weight += mass / total * p * f64::from_bits(sums[1]);
        }
    }
    assert!((weight - 1.0).abs() < TOLERANCE);
    assert!((ratio - 5.2 / 2.8).abs() < TOLERANCE, "{ratio}");
}

/// Draws from its level's target, so that steps forget everything.
struct Forgetful<const N: usize> {
    target: [f64; N],
}

impl<const N: usize> Kernel<()> for Forgetful<N> {
    type Value = usize;

    fn propose<D: Draws + ?Sized>(
        &self,
        (): &mut (),
        current: &usize,
        proposed: &mut usize,
        draws: &mut D,
    ) -> Move {
        *proposed = draws.index(&self.target);
        Move::new(2, self.target[*current] / self.target[*proposed])
    }
}

/// An easy ladder of eight levels: what alternating exchanges promise is kept.
#[test]
fn the_round_trip_rate_is_the_ideal_one() {
    const K: usize = 8;
    const N: usize = 16;
    let density = |s: usize, k: usize| libm::exp(-0.05 * (k * s) as f64);
    let family = |s: &usize| -> [f64; K] { std::array::from_fn(|k| density(*s, k)) };
    let kernels: [Forgetful<N>; K] = std::array::from_fn(|k| Forgetful {
        target: std::array::from_fn(|s| density(s, k)),
    });
    let rate = |schedule| {
        let mut ladder = Ladder::new([((), 0); K], &family).with_schedule(schedule);
        let mut rng = generator(5, 0);
        for _ in 0..100_000 {
            ladder.sweep(&kernels, &family, &mut rng, &mut Ignore);
        }
        let statistics = ladder.statistics();
        assert!(statistics.restarts.abs_diff(statistics.round_trips) <= K as u64);
        let barrier = statistics.barrier().expect("neighbours are tried");
        assert!(barrier > 0.3 && barrier < 3.0, "{barrier}");
        statistics.round_trip_rate() / statistics.ideal_round_trip_rate().expect("likewise")
    };
    let alternating = rate(Schedule::Alternating);
    assert!((0.97..1.03).contains(&alternating), "{alternating}");
    assert!(rate(Schedule::RandomMatching) < 0.7, "random turns diffuse");
}

#[test]
fn statistics_stay_with_levels_and_states_travel() {
    let table = [[1.0, 1.0], [1.0, 1.0], [1.0, 1.0]];
    let family = |s: &usize| table[*s];
    let mut ladder = ladder(&table, [0, 2]);
    let mut rng = generator(6, 0);
    ladder.exchange(&kernels(), &mut rng, &mut Ignore); // certain to be accepted
    assert_eq!(ladder.replicas().each_ref().map(|r| *r.value()), [2, 0]);
    assert_eq!(ladder.indices().lineages(), &[1, 0]);
    assert_eq!(ladder.replicas().each_ref().map(Metropolis::level), [0, 1]);
    ladder.step(&kernels(), &family, &mut rng, &mut Ignore);
    ladder.exchange(&kernels(), &mut rng, &mut Ignore);
    assert_eq!(ladder.statistics().swap(1, 0).accepted, 2);
    // lineage 0 has been up and is back
    assert_eq!(
        (
            ladder.statistics().restarts,
            ladder.statistics().round_trips
        ),
        (2, 1)
    );
    assert!(ladder.replicas().iter().all(|r| r.statistics().steps == 1));
    ladder.reset_statistics();
    assert_eq!(ladder.statistics(), &LadderStatistics::new());
}

/// The sum of all weights is the number of steps, level by level, however states travel.
#[test]
fn no_weight_is_lost_in_an_exchange() {
    let table = UNEVEN;
    let family = |s: &usize| table[*s];
    for schedule in SCHEDULES {
        let mut ladder = ladder(&table, [0, 1, 2]).with_schedule(schedule);
        let mut rng = generator(7, 0);
        let mut weights = [0.0; 3];
        let mut record = |visit: Visit<'_, usize, 3>| weights[visit.level] += visit.weight;
        for _ in 0..1000 {
            ladder.sweep(&kernels(), &family, &mut rng, &mut record);
        }
        ladder.flush(&mut record);
        assert!(
            weights.iter().all(|w| (w - 1000.0).abs() < 1e-9),
            "{weights:?}"
        );
    }
}

#[test]
fn schedules_try_the_pairs_they_say() {
    let table: Table<4> = [[1.0; 4]; STATES];
    let tried = |schedule, graph: SwapGraph<4>| {
        let mut ladder = ladder(&table, [0; 4])
            .with_graph(graph)
            .with_schedule(schedule);
        let mut rng = generator(13, 0);
        for _ in 0..6000 {
            ladder.exchange(&kernels(), &mut rng, &mut Ignore);
        }
        let statistics = ladder.statistics().clone();
        assert_eq!(statistics.rounds, 6000);
        move |a: usize, b: usize| statistics.swaps[a][b].proposed
    };
    let line = |schedule| {
        let tried = tried(schedule, SwapGraph::line());
        assert_eq!(tried(0, 2) + tried(0, 3) + tried(1, 3), 0);
        [tried(0, 1), tried(1, 2), tried(2, 3)]
    };
    let near = |n: u64, expected: u64| n.abs_diff(expected) < 200;
    assert_eq!(line(Schedule::Off), [0; 3]);
    assert_eq!(line(Schedule::Permutation), [0; 3]);
    assert_eq!(line(Schedule::Full), [6000; 3]);
    assert_eq!(line(Schedule::Alternating), [3000; 3]);
    let pairs = line(Schedule::RandomPair);
    assert!(pairs.iter().all(|n| near(*n, 2000)) && pairs.iter().sum::<u64>() == 6000);
    let [even, odd, also] = line(Schedule::RandomMatching);
    assert!(even == also && even + odd == 6000 && near(even, 3000));
    // a star has a matching for each of its three pairs
    let star = SwapGraph::new(&[(1, 0), (1, 2), (1, 3)]).expect("a graph");
    let star = tried(Schedule::Alternating, star);
    assert_eq!([star(0, 1), star(1, 2), star(1, 3)], [2000; 3]);
}

/// Levels may share one kernel by reference: the same bits.
#[test]
fn references_to_kernels_are_kernels() {
    let family = |s: &usize| UNEVEN[*s];
    let kernel = Ring { up: 0.7 };
    let (mut a, mut b) = (ladder(&UNEVEN, [0, 1, 1]), ladder(&UNEVEN, [0, 1, 1]));
    let (mut rng, mut same) = (generator(12, 0), generator(12, 0));
    for _ in 0..100 {
        a.sweep(&[kernel; 3], &family, &mut rng, &mut Ignore);
        b.sweep(&[&kernel; 3], &family, &mut same, &mut Ignore);
        assert_eq!(place(&a), place(&b));
    }
    assert_eq!(a.statistics(), b.statistics());
}

#[test]
#[should_panic(expected = "permutations of 6 levels")]
fn more_levels_than_can_be_permuted_are_refused() {
    let family = |_: &usize| [1.0; 6];
    let _ = Ladder::new([((), 0); 6], &family).with_schedule(Schedule::Permutation);
}
