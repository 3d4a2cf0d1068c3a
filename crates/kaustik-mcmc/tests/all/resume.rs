//! A run that is written down and read again at every step has the bits of one that is not.

use std::fmt::Debug;

use kaustik_mcmc::{
    AcceptanceAdaptation, Autocorrelation, Deposit, DiminishingAdaptation, Exponential, Halves,
    Independent, JumpAdaptation, Jumps, Ladder, LevelKernel, Mean, Metropolis, Mixture, Mutation,
    Pcg64Dxsm, PerCoordinate, Point, PointKernel, Pool, Population, Power, Redistribution,
    Redistributor, Resampling, RoughNormalisers, SampleGenerators, Schedule, Step, SteppingStone,
    Stratification, SwapGraph, Target, Uniform, Visit, WrappedCauchy, WrappedNormal, anneal,
    generator, target,
};
use kaustik_pss::{Coordinates, Stream};
use serde::Serialize;
use serde::de::DeserializeOwned;

const STEPS: usize = 1000;

pub(crate) fn written<T: Serialize>(state: &T) -> String {
    serde_json::to_string(state).expect("a state can be written")
}

fn again<T: Serialize + DeserializeOwned>(state: &T) -> T {
    serde_json::from_str(&written(state)).expect("what was written can be read")
}

/// Steps one state through and another through a file before each step; what steps tell and
/// what is left, to the last field (`Debug` shows all), must be the same.
fn assert_resumes<T>(make: impl Fn() -> T, step: impl Fn(&mut T, usize) -> Vec<u64>)
where
    T: Serialize + DeserializeOwned + Debug,
{
    assert_resumes_but(make, step, |state| format!("{state:?}"));
}

/// The same where some memory is not part of the state: `left` shows what is.
fn assert_resumes_but<T>(
    make: impl Fn() -> T,
    step: impl Fn(&mut T, usize) -> Vec<u64>,
    left: impl Fn(&T) -> String,
) where
    T: Serialize + DeserializeOwned,
{
    let (mut whole, mut parted) = (make(), make());
    let mut told = 0;
    for i in 0..STEPS {
        parted = again(&parted);
        let (one, other) = (step(&mut whole, i), step(&mut parted, i));
        assert_eq!(one, other, "step {i}");
        told += one.len();
        if i % 10 == 9 {
            assert_eq!(left(&whole), left(&parted), "after step {i}");
        }
    }
    assert!(told > 0, "nothing was told");
}

/// Walks of random length, what they read in a list: sleepers of all ages.
pub(crate) struct Walk;

impl Target for Walk {
    type Value = Vec<f64>;

    fn evaluate(&self, u: &mut dyn Coordinates, value: &mut Vec<f64>) {
        value.clear();
        let length = 1 + (u.get(Stream::Technique, 0) * 6.0) as u32;
        for i in 0..length {
            value.push(u.get(Stream::Camera, i) * u.get(Stream::Light, 2 * i));
        }
    }
}

#[expect(clippy::ptr_arg, reason = "a family of this very type of value")]
pub(crate) fn family(value: &Vec<f64>) -> [f64; 4] {
    let sum: f64 = value.iter().sum();
    [1.0, sum, sum * sum, (sum - 0.6).max(0.0)]
}

fn tell(told: &mut Vec<u64>) -> impl FnMut(Visit<'_, Vec<f64>, 4>) + '_ {
    |visit| {
        told.push(visit.level as u64);
        told.extend([visit.weight, visit.independent].map(f64::to_bits));
        told.extend(visit.densities.map(f64::to_bits));
        told.extend(visit.value.iter().map(|x| x.to_bits()));
    }
}

fn chain<M: Mutation>(mutation: M) -> (Metropolis<Point<M>, Vec<f64>, 4>, Pcg64Dxsm) {
    let mut rng = generator(41, 0);
    (
        Metropolis::start(&Walk, &family, 1, mutation, &mut rng),
        rng,
    )
}

fn assert_chain_resumes<M>(mutation: &M)
where
    M: Mutation + Clone + Serialize + DeserializeOwned + Debug,
{
    let kernel = PointKernel::new(Walk, 0.2);
    assert_resumes(
        || chain(mutation.clone()),
        |(chain, rng), _| {
            let mut told = Vec::new();
            chain.step(&kernel, &family, rng, &mut tell(&mut told));
            told
        },
    );
}

#[test]
fn a_chain_resumes_at_every_step() {
    assert_chain_resumes(&Exponential::new(0.01, 0.3));
    assert_chain_resumes(&Uniform::new(0.3));
    assert_chain_resumes(&WrappedNormal::new(0.1));
    assert_chain_resumes(&WrappedCauchy::new(0.1));
    assert_chain_resumes(&Power::new(0.2));
    let each = PerCoordinate::new(Exponential::default())
        .with(Stream::Camera, 1..3, Exponential::new(0.1, 0.2))
        .with_stream(Stream::Light, Exponential::new(0.01, 0.5));
    assert_chain_resumes(&each);
}

#[test]
fn mixtures_second_tries_and_all_else_a_chain_does_resume() {
    let delayed = PointKernel::new(Walk, 0.7);
    let suits = |value: &Vec<f64>| [1.0, value.len() as f64];
    let parts = (PointKernel::new(Walk, 0.0), PointKernel::new(Walk, 1.0));
    let mixed = Mixture::new(parts, suits);
    assert_resumes(
        || chain(Exponential::default()),
        |(chain, rng), i| {
            let mut told = Vec::new();
            let mut record = tell(&mut told);
            match i % 50 {
                7 => chain.settle(rng),
                17 => chain.refresh(),
                27 => chain.set_mutation(Exponential::new(0.001, 0.1), rng),
                37 => {
                    chain.flush(&mut record);
                    chain.restart(&Walk, &family, rng);
                }
                47 => {
                    chain.flush(&mut record);
                    chain.set_level(i % 3);
                }
                _ => {}
            }
            chain.step_delayed(&delayed, &family, rng, &mut record);
            chain.step(&mixed, &family, rng, &mut record);
            drop(record);
            told
        },
    );
}

#[test]
fn a_ladder_resumes_at_every_sweep_under_every_schedule() {
    let kernels = [1.0, 0.1, 0.0, 0.0].map(|large| PointKernel::new(Walk, large));
    let sizes = [0.5, 0.2, 0.05, 0.01].map(|s| Exponential::new(s / 16.0, s));
    let graph = SwapGraph::new(&[(2, 3), (0, 1), (3, 0), (1, 2)]).expect("a ring");
    for schedule in [
        Schedule::Off,
        Schedule::RandomPair,
        Schedule::RandomMatching,
        Schedule::Alternating,
        Schedule::Full,
        Schedule::Permutation,
    ] {
        let make = || {
            let mut rng = generator(42, 0);
            let ladder = Ladder::start(&Walk, &family, sizes, &mut rng)
                .with_graph(graph.clone())
                .with_stepping_stone(SteppingStone::on([0, 0, 1, 1]))
                .with_schedule(schedule);
            (ladder, rng)
        };
        assert_resumes(make, |(ladder, rng), _| {
            let mut told = Vec::new();
            ladder.sweep(&kernels, &family, rng, &mut tell(&mut told));
            let running = ladder.stepping_stone().normalisers(1.0);
            assert_eq!(again(&running), running);
            told.extend(running.values().map(f64::to_bits));
            told
        });
    }
}

#[test]
fn a_population_resumes_between_all_stages() {
    let sizes = [0.5, 0.2, 0.05, 0.01].map(|s| Exponential::new(s / 16.0, s));
    let kernels = sizes.map(|mutation| LevelKernel::new(Walk, 0.1, mutation));
    for scheme in [Resampling::Systematic, Resampling::Multinomial] {
        let make = || {
            let mut rng = generator(43, 0);
            let start = &sizes[0];
            let population = Population::start(12, &Walk, &family, start, scheme, &mut rng);
            (population, rng)
        };
        let step = |(population, rng): &mut (Population<_, _, 4>, Pcg64Dxsm), i: usize| {
            let mut told = Vec::new();
            let level = i / 3 % 3;
            if i.is_multiple_of(3) {
                match population.advance(level, &kernels[level], rng) {
                    Ok(stage) => {
                        assert_eq!(again(&stage), stage);
                        told.push(stage.normaliser.value.to_bits());
                        told.push(stage.relative_variance.to_bits());
                        told.push(stage.founders as u64);
                    }
                    Err(extinct) => told.push(extinct.level as u64),
                }
            }
            population.step(&kernels[level], &family, rng, &mut tell(&mut told));
            told
        };
        assert_resumes_but(make, step, written); // without the memory of the resampling
    }
    let mut rng = generator(44, 0);
    let mut population = Population::start(
        50,
        &Walk,
        &family,
        &sizes[0],
        Resampling::Systematic,
        &mut rng,
    );
    let annealed = anneal(
        &mut population,
        2,
        &kernels,
        &family,
        &mut rng,
        &mut kaustik_mcmc::Ignore,
    );
    // without what an undecided proposal leaves behind
    assert_eq!(written(&again(&annealed)), written(&annealed));
}

type Spreading = (
    Redistributor<Point<Exponential>, Vec<f64>>,
    Redistribution,
    Metropolis<Point<Exponential>, Vec<f64>, 1>,
    Pcg64Dxsm,
);

#[test]
fn redistribution_resumes_between_starts() {
    let scalar = |value: &Vec<f64>| [value.iter().sum()];
    let kernel = PointKernel::new(Walk, 0.1);
    let plan = Redistribution::new(5, 0.3)
        .expect("a sound plan")
        .most_chains(7)
        .patience(3);
    let make = || {
        let mut rng = generator(45, 0);
        let start = Metropolis::start(&Walk, &scalar, 0, Exponential::default(), &mut rng);
        (Redistributor::new(), plan, start, rng)
    };
    let step = |(redistributor, plan, start, rng): &mut Spreading, _| {
        let mut told = Vec::new();
        start.restart(&Walk, &scalar, rng);
        let mut deposit = |deposit: Deposit<'_, Vec<f64>>| {
            told.extend([deposit.weight(), deposit.density].map(f64::to_bits));
        };
        let begin = (start.state(), start.value(), start.density());
        let chains = redistributor.run(plan, begin, &kernel, &scalar, rng, &mut deposit);
        told.push(u64::from(chains));
        told
    };
    assert_resumes_but(make, step, written); // without the memory of proposals
    let make = || {
        let mut spreading = make();
        spreading.0.carry(Some(0.3));
        spreading
    };
    assert_resumes_but(make, step, written);
}

#[test]
fn adaptations_and_diagnostics_resume_at_every_step() {
    let kernel = PointKernel::new(Walk, 0.1);
    let make = || {
        let base = WrappedNormal::new(0.05);
        let adaptations = (
            AcceptanceAdaptation::new(base)
                .with_target(0.4)
                .with_gain(1.0, 0.7)
                .in_logarithms(),
            JumpAdaptation::new(base),
            DiminishingAdaptation::new().with_target(0.3),
        );
        let diagnostics = (
            Autocorrelation::new(),
            Halves::new(),
            Jumps::<2>::circular(),
            Mean::new(),
        );
        (adaptations, diagnostics, chain(base))
    };
    assert_resumes(make, |(adaptations, diagnostics, (chain, rng)), i| {
        let mut told = Vec::new();
        chain.step(&kernel, &family, rng, &mut tell(&mut told));
        let (time, halves, jumps, mean) = diagnostics;
        let x = chain.value()[0];
        time.push(x);
        halves.push(x);
        jumps.push([x, chain.density().fract()]);
        mean.push(x);
        told.extend(time.time().map(f64::to_bits));
        told.extend(halves.halves().iter().flatten().map(|m| m.mean().to_bits()));
        told.push(jumps.squares().mean().to_bits());
        if i % 7 == 6 {
            let (acceptance, jump, diminishing) = adaptations;
            let small = chain.statistics().small();
            told.push(diminishing.end_round(small).size().to_bits());
            let next = if i % 2 == 0 {
                acceptance.end_round(small)
            } else {
                jump.end_round(jumps.end_round().mean())
            };
            told.push(next.sigma().to_bits());
            chain.set_mutation(next, rng);
        }
        told
    });
}

#[test]
fn pools_plans_and_generators_are_read_as_they_were() {
    let read = target(|u: &mut dyn Coordinates| u.get(Stream::Camera, 3) - 0.2);
    let plan = Stratification::new(3, 1)
        .with(Stream::Camera, 3)
        .with(Stream::Time, 0);
    let mut value = 0.0;
    let pool = Pool::new((0..100).map(|i| {
        read.evaluate(&mut again(&plan).at(i), &mut value);
        let mut plain = 0.0;
        read.evaluate(&mut plan.at(i), &mut plain);
        assert_eq!(value.to_bits(), plain.to_bits());
        value // some are negative, and so defects
    }));
    assert!(pool.defects() > 0);
    assert_eq!(again(&pool), pool);
    let start = pool.choose(&mut generator(1, 0)).expect("not dark");
    assert_eq!(again(&start), start);
    assert_eq!(again(&generator(5, 6)), generator(5, 6));
    let all = SampleGenerators::new(7, 8);
    assert_eq!(again(&all).at(9), all.at(9));
    let plain = Independent::new(generator(5, 6));
    assert_eq!(again(&plain).into_inner(), plain.into_inner());
    let rough = RoughNormalisers::guess([0.25, 3.0]); // of unknown error
    assert_eq!(again(&rough), rough);
    for step in [Step::Small, Step::Large] {
        assert_eq!(again(&step), step);
    }
}

/// An open proposal is no part of a state: what is written is the point without it.
#[test]
fn a_forgotten_proposal_is_not_written() {
    let (mut plain, mut rng) = chain(Exponential::default());
    let kernel = PointKernel::new(Walk, 0.0);
    for _ in 0..20 {
        plain.step(&kernel, &family, &mut rng, &mut kaustik_mcmc::Ignore);
    }
    let mut point = plain.state().clone();
    let before = point.record();
    let mut proposal = point.propose(Step::Small, &mut rng);
    let mut value = Vec::new();
    Walk.evaluate(&mut proposal, &mut value);
    std::mem::forget(proposal);
    assert_eq!(again(&point).record(), before);
    assert_eq!(point.record(), before);
}
