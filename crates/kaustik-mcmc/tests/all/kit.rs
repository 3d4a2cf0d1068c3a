//! The testing kit finds what it should, and says where.

use std::panic::catch_unwind;

use kaustik_mcmc::testing::{
    Enumerator, PairedTest, RankTest, TransitionMatrix, assert_deposits, assert_detailed_balance,
    assert_invariant, assert_reversible, assert_stationary,
};
use kaustik_mcmc::{Draws, Exponential, Mutation, Uniform, acceptance, decide};

/// What a failing assertion says.
pub(crate) fn complaint(run: impl FnOnce() + std::panic::UnwindSafe) -> String {
    let panic = catch_unwind(run).expect_err("nothing was found");
    panic.downcast_ref::<String>().expect("a message").clone()
}

const PI: [f64; 4] = [0.4, 0.0, 0.1, 0.5];

/// Either neighbour on a ring; `slip` multiplies the acceptance from state 2 to 3.
fn ring(slip: f64) -> TransitionMatrix {
    TransitionMatrix::of(4, 1, |from, draws| {
        let to = (from + [1, 3][draws.index(&[1.0, 1.0])]) % 4;
        let slip = if (from, to) == (2, 3) { slip } else { 1.0 };
        if decide(slip * acceptance(PI[from], PI[to], 1.0), draws) {
            to
        } else {
            from
        }
    })
}

#[test]
fn a_slip_of_two_percent_is_named() {
    assert_detailed_balance(&ring(1.0), &PI);
    assert_stationary(&ring(1.0), &PI);
    let balance = complaint(|| assert_detailed_balance(&ring(0.98), &PI));
    assert!(
        balance.contains("4.900000e-2 flows from state 2"),
        "{balance}"
    );
    assert!(balance.contains("but 5.000000e-2 from 3"), "{balance}");
    let stationary = complaint(|| assert_stationary(&ring(0.98), &PI));
    assert!(
        stationary.contains("|pi P - pi|_1 = 2.000e-3"),
        "{stationary}"
    );
    assert!(
        stationary.contains("state 2 has mass 1.000000e-1, but 1.010000e-1"),
        "{stationary}"
    );
}

#[test]
fn a_law_must_be_a_law() {
    for bad in [
        vec![1.0; 3],
        vec![0.0; 4],
        vec![1.0, -1.0, 1.0, 1.0],
        vec![f64::NAN; 4],
    ] {
        complaint(|| assert_stationary(&ring(1.0), &bad));
    }
}

/// What does nothing is reversible with respect to everything, and so has not been tested.
#[test]
fn a_kernel_that_stays_is_no_proof() {
    let stays = |test: RankTest| {
        move || assert_reversible(&test, |rng| rng.uniform(), |_, _| (), |x: &f64| [*x])
    };
    let frozen = complaint(stays(RankTest::default()));
    assert!(frozen.contains("moved 0.0 %"), "{frozen}");
    for test in [
        RankTest {
            length: 1,
            ..RankTest::default()
        },
        RankTest {
            thin: 0,
            ..RankTest::default()
        },
        RankTest {
            chains: 0,
            ..RankTest::default()
        },
    ] {
        let nothing = complaint(stays(test));
        assert!(nothing.contains("nothing to rank"), "{nothing}");
    }
}

/// Matrices compose as the programs do.
#[test]
fn compositions_are_those_of_programs() {
    let step =
        |from: usize, draws: &mut Enumerator| (from + draws.index(&[1.0, 2.0, 0.0, 3.0])) % 4;
    let p = TransitionMatrix::of(4, 1, step);
    let twice = TransitionMatrix::of(4, 1, |from, draws| {
        let middle = step(from, draws);
        step(middle, draws)
    });
    let lazy = TransitionMatrix::of(4, 1, |from, draws| {
        if draws.bernoulli(0.25) {
            step(from, draws)
        } else {
            from
        }
    });
    let mixed = TransitionMatrix::mixture(&[(1.0, &p), (3.0, &TransitionMatrix::identity(4))]);
    for from in 0..4 {
        for to in 0..4 {
            assert!((p.power(2).probability(from, to) - twice.probability(from, to)).abs() < 1e-15);
            assert!((mixed.probability(from, to) - lazy.probability(from, to)).abs() < 1e-15);
        }
    }
    assert_eq!(p.then(&p), p.power(2));
}

/// Equal-deposition chains (Batty's Algorithm 2) on three places in two channels, written
/// out: an independent start, a number of chains, steps, deposits.
#[derive(Clone, Copy)]
struct Redistribution {
    unit: f64,
    colour_of_start: bool,
    full_weight: bool,
    round_down: bool,
}

const F: [[f64; 2]; 3] = [[1.0, 2.0], [0.0, 0.0], [4.0, 0.5]];
const LENGTH: usize = 2;

impl Redistribution {
    const RIGHT: Self = Self {
        unit: 0.7,
        colour_of_start: false,
        full_weight: false,
        round_down: false,
    };

    fn run(&self, draws: &mut Enumerator, deposits: &mut [[f64; 2]]) {
        let light = |place: usize| F[place][0] + F[place][1];
        let start = draws.index(&[1.0; 3]);
        let energy = 3.0 * light(start); // f over its density
        if energy <= 0.0 {
            return;
        }
        let wanted = energy / (LENGTH as f64 * self.unit);
        let more = !self.round_down && draws.bernoulli(wanted.fract());
        for _ in 0..wanted as usize + usize::from(more) {
            let mut current = start;
            for _ in 0..LENGTH {
                let proposed = (current + [1, 2][draws.index(&[1.0, 1.0])]) % 3;
                let a = acceptance(light(current), light(proposed), 1.0);
                let weights = if self.full_weight {
                    [0.0, 1.0]
                } else {
                    [1.0 - a, a]
                };
                for (place, weight) in [current, proposed].into_iter().zip(weights) {
                    let colour = if self.colour_of_start { start } else { place };
                    if light(place) > 0.0 && weight > 0.0 {
                        for c in 0..2 {
                            deposits[place][c] += weight * self.unit * F[colour][c] / light(colour);
                        }
                    }
                }
                if decide(a, draws) {
                    current = proposed;
                }
            }
        }
    }

    fn check(self) {
        assert_deposits(1, &F, |draws, deposits| self.run(draws, deposits));
    }
}

#[test]
fn deposits_are_exact_in_every_channel_or_named() {
    let right = Redistribution {
        unit: 7.0,
        ..Redistribution::RIGHT
    };
    for unit in [3.9, 7.0, 50.0] {
        Redistribution { unit, ..right }.check();
    }
    let smeared = complaint(move || {
        Redistribution {
            colour_of_start: true,
            ..right
        }
        .check();
    });
    assert!(smeared.contains("channel 1"), "{smeared}");
    complaint(move || {
        Redistribution {
            full_weight: true,
            ..right
        }
        .check();
    });
    complaint(move || {
        Redistribution {
            round_down: true,
            ..right
        }
        .check();
    });
}

/// The density 2 x by two kernels; `up` is the chance of an upward step of which the ratio
/// knows nothing.
fn linear(up: f64, scale: f64) -> impl Fn(&mut f64, &mut kaustik_mcmc::Pcg64Dxsm) {
    move |x, rng| {
        let step = 0.3 * rng.uniform();
        let y = *x + if rng.bernoulli(up) { step } else { -step };
        let inside = (0.0..1.0).contains(&y);
        let a = if inside {
            acceptance(*x, y.powf(scale) * x.powf(1.0 - scale), 1.0)
        } else {
            0.0
        };
        if decide(a, rng) {
            *x = y;
        }
    }
}

fn rank(step: impl Fn(&mut f64, &mut kaustik_mcmc::Pcg64Dxsm)) -> f64 {
    let test = RankTest {
        length: 8,
        thin: 3,
        chains: 20_000,
        ..RankTest::default()
    };
    test.run(|rng| rng.uniform().sqrt(), step, |x| [*x, (x - 0.6).abs()])
        .p_value()
}

#[test]
fn ranks_find_a_wrong_target_and_a_lopsided_step() {
    assert!(rank(linear(0.5, 1.0)) > 1e-4);
    for (up, scale) in [(0.55, 1.0), (0.5, 0.8)] {
        let p = rank(linear(up, scale));
        assert!(p < 1e-5, "{up} {scale}: {p}");
    }
    // keeps its target but turns round and round: a matter of direction alone
    let test = RankTest {
        chains: 10_000,
        ..RankTest::default()
    };
    let turning = test.run(|rng| rng.uniform(), |x, _| *x = (*x + 0.05) % 1.0, |x| [*x]);
    assert!(turning.p_value() < 1e-5);
    assert!(turning.to_string().contains("ranks"));
}

/// Ties everywhere: a statistic of two values, ranks still uniform.
#[test]
fn ranks_with_ties_are_uniform() {
    let test = RankTest {
        chains: 20_000,
        ..RankTest::default()
    };
    let ranks = test.run(
        |rng| rng.index(&[1.0, 3.0]),
        |state, rng| {
            let to = 1 - *state;
            let masses = [1.0, 3.0];
            if decide(acceptance(masses[*state], masses[to], 1.0), rng) {
                *state = to;
            }
        },
        |state| [*state as f64, 1.0],
    );
    assert!(ranks.p_value() > 1e-4, "{ranks}");
}

/// P-values of a correct kernel are uniform: here is what a false alarm costs.
#[test]
fn p_values_of_a_correct_kernel_are_uniform() {
    let step = linear(0.5, 1.0);
    let p = |seed| {
        let test = RankTest {
            length: 5,
            thin: 1,
            chains: 400,
            seed,
        };
        test.run(|rng| rng.uniform().sqrt(), &step, |x| [*x])
            .p_value()
    };
    let small = (0..1000).filter(|&seed| p(seed) < 0.1).count();
    assert!((65..140).contains(&small), "{small} of 1000 below 0.1");
}

/// A walk of one or more turns in the plane, as a path is: its length changes too.
/// f(path) = (1 - q)^... with density by birth and death of the last vertex.
#[derive(Clone, Debug)]
struct Path(Vec<f64>);

/// What of the moves is wrong.
#[derive(Clone, Copy, PartialEq)]
enum Slip {
    Nothing,
    /// The chance of birth and death is left out of the ratio.
    Selection,
    /// Births are proposed by x^2 but counted as uniform.
    Jacobian,
}

/// The target: product of (1 + x) / 4 over the vertices; a vertex more costs that factor.
fn weight(path: &Path) -> f64 {
    path.0.iter().map(|x| (1.0 + x) / 4.0).product()
}

fn change_length(path: &mut Path, slip: Slip, rng: &mut kaustik_mcmc::Pcg64Dxsm) {
    // short paths are lengthened more often
    let birth = |n: usize| if n == 1 { 1.0 } else { 0.4 };
    let n = path.0.len();
    let (mut next, ratio) = (
        path.clone(),
        match slip {
            Slip::Selection => [1.0; 2],
            _ => [
                (1.0 - birth(n + 1)) / birth(n),
                if n > 1 {
                    birth(n - 1) / (1.0 - birth(n))
                } else {
                    0.0
                },
            ],
        },
    );
    let density = |x: f64| {
        if slip == Slip::Jacobian {
            1.0
        } else {
            0.5 / x.sqrt()
        }
    }; // of u^2
    let ratio = if rng.bernoulli(birth(n)) {
        let u = 1.0 - rng.uniform();
        next.0.push(u * u);
        ratio[0] / density(u * u)
    } else {
        let x = next.0.pop().expect("a vertex");
        ratio[1] * density(x)
    };
    if decide(acceptance(weight(path), weight(&next), ratio), rng) {
        *path = next;
    }
}

fn perturb(path: &mut Path, rng: &mut kaustik_mcmc::Pcg64Dxsm) {
    let steps = Exponential::new(0.01, 0.5);
    let next = Path(path.0.iter().map(|x| steps.mutate(*x, rng)).collect());
    if decide(acceptance(weight(path), weight(&next), 1.0), rng) {
        *path = next;
    }
}

fn paths(slip: Slip) {
    // a length by coin throws, uniform vertices: density 2^-n
    let start = |rng: &mut kaustik_mcmc::Pcg64Dxsm| {
        let mut path = Path(vec![rng.uniform()]);
        while rng.bernoulli(0.5) {
            path.0.push(rng.uniform());
        }
        let w = weight(&path) * 2f64.powi(path.0.len() as i32);
        (path, w)
    };
    let functions = |path: &Path| {
        let n = path.0.len();
        let bin = |at: usize| f64::from(u8::from(n == at));
        let (first, last) = (path.0[0], path.0[n - 1]);
        [
            bin(1),
            bin(2),
            bin(3),
            n as f64,
            first,
            first * first,
            last,
            last * last,
            first * last,
        ]
    };
    let test = PairedTest::default();
    assert_invariant(
        &test,
        start,
        |path, rng| change_length(path, slip, rng),
        functions,
    );
    if slip == Slip::Nothing {
        assert_invariant(&test, start, perturb, functions);
    }
}

#[test]
fn missing_factors_of_a_path_kernel_are_found() {
    paths(Slip::Nothing);
    for slip in [Slip::Selection, Slip::Jacobian] {
        let says = complaint(move || paths(slip));
        assert!(says.contains("chi2 a function"), "{says}");
    }
}

/// A kernel that never moves keeps everything; that is no proof.
#[test]
fn nothing_moved_is_a_failure() {
    let start = |rng: &mut kaustik_mcmc::Pcg64Dxsm| (rng.uniform(), 1.0);
    let says = complaint(|| assert_invariant(&PairedTest::default(), start, |_, _| {}, |x| [*x]));
    assert!(says.contains("moved 0.0 %"), "{says}");
}

/// What is no number is no proof either.
#[test]
fn what_became_nan_is_a_failure() {
    let start = |rng: &mut kaustik_mcmc::Pcg64Dxsm| (rng.uniform(), 1.0);
    let step = |x: &mut f64, rng: &mut kaustik_mcmc::Pcg64Dxsm| *x = rng.uniform();
    for nan in [0, 1] {
        let functions = |x: &f64| {
            let mut both = [*x, *x];
            both[nan] = f64::NAN;
            both
        };
        let changes = PairedTest::default().run(start, step, functions);
        assert!(changes.p_value().is_nan(), "{nan}");
        let says =
            complaint(move || assert_invariant(&PairedTest::default(), start, step, functions));
        assert!(says.contains("not kept"), "{says}");
    }
    let says = complaint(|| {
        let weightless = |rng: &mut kaustik_mcmc::Pcg64Dxsm| (rng.uniform(), f64::NAN);
        assert_invariant(&PairedTest::default(), weightless, |_, _| {}, |x| [*x]);
    });
    assert!(says.contains("weight NaN"), "{says}");
    // a law that is none keeps no balance
    let matrix = TransitionMatrix::of(
        2,
        1,
        |x, draws| {
            if draws.bernoulli(0.5) { 1 - x } else { x }
        },
    );
    for law in [[0.0, 0.0], [f64::NAN, 1.0], [f64::INFINITY, 1.0]] {
        assert!(matrix.balance_defect(&law).is_nan(), "{law:?}");
        assert!(matrix.worst_state(&law).defect().is_nan(), "{law:?}");
    }
    assert!(matrix.balance_defect(&[1.0, 1.0]) < 1e-15);
}

/// A false alarm in 100,000: two hundred seeds raise none.
#[test]
fn correct_kernels_raise_no_alarm() {
    for seed in 0..200 {
        let step = |x: &mut f64, rng: &mut kaustik_mcmc::Pcg64Dxsm| {
            let y = Uniform::new(0.4).mutate(*x, rng);
            if decide(acceptance(*x, y, 1.0), rng) {
                *x = y;
            }
        };
        let exact = |rng: &mut kaustik_mcmc::Pcg64Dxsm| rng.uniform().sqrt();
        let rank = RankTest {
            chains: 300,
            length: 6,
            seed,
            ..RankTest::default()
        };
        assert_reversible(&rank, exact, step, |x| [*x]);
        let paired = PairedTest {
            starts: 400,
            steps: 3,
            seed,
        };
        let start = |rng: &mut kaustik_mcmc::Pcg64Dxsm| {
            let x = rng.uniform();
            (x, x)
        };
        assert_invariant(&paired, start, step, |x| [*x, x * x]);
    }
}
