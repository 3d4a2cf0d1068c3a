//! The book-keeping of a chain: every step's weight is reported, once.

use kaustik_mcmc::{
    Draws, Exponential, Ignore, Kernel, Metropolis, Move, PointKernel, Pool, StartError,
    Statistics, Visit, generator, sample, sample_generator, target,
};
use kaustik_pss::{Coordinates, Stream};

/// A value that is told from all others by its serial number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Numbered {
    x: f64,
}

fn line() -> impl kaustik_mcmc::Target<Value = Numbered> {
    target(|u: &mut dyn Coordinates| Numbered {
        x: u.get(Stream::Camera, 0),
    })
}

fn wavy(value: &Numbered) -> [f64; 2] {
    [1.0, if value.x < 0.3 { 0.0 } else { value.x }]
}

#[test]
fn weights_sum_to_the_steps_and_independent_proposals_come_once() {
    const STEPS: u64 = 5000;
    let mut rng = generator(41, 0);
    let target = line();
    let kernel = PointKernel::new(&target, 0.3);
    let mut chain = loop {
        let chain = Metropolis::start(&target, &wavy, 1, Exponential::default(), &mut rng);
        if chain.density() > 0.0 {
            break chain;
        }
    };
    let (mut weight, mut independent, mut visits, mut flushed) = (0.0, 0.0, 0u64, 0);
    let mut seen = std::collections::HashSet::new();
    let mut record = |visit: Visit<'_, Numbered, 2>| {
        assert_eq!(visit.level, 1);
        assert_eq!(
            visit.densities.map(f64::to_bits),
            wavy(visit.value).map(f64::to_bits)
        );
        assert!(visit.weight > 0.0 || visit.independent > 0.0);
        assert!(visit.weight <= 0.0 || visit.density() > 0.0);
        seen.insert(visit.value.x.to_bits());
        weight += visit.weight;
        independent += visit.independent;
        visits += 1;
    };
    for step in 0..STEPS {
        chain.step(&kernel, &wavy, &mut rng, &mut record);
        if step % 1000 == 999 {
            chain.flush(&mut record);
            chain.flush(&mut record); // nothing is left to say
            flushed += 1;
        }
    }
    assert!((weight - STEPS as f64).abs() < 1e-7, "{weight}");
    let statistics = chain.statistics();
    let large = statistics.large().proposed;
    assert!(
        (independent - large as f64).abs() < 0.5,
        "{independent} {large}"
    );
    assert!(visits <= STEPS + flushed, "one visit a step: {visits}");
    assert!(
        seen.len() as u64 + flushed >= visits,
        "each value is told of once"
    );
    assert_eq!(statistics.steps, STEPS);
    assert_eq!(statistics.small().proposed + large, STEPS);
    assert_eq!(statistics.independent[0].count(), large);
    assert!((statistics.independent[0].mean() - 1.0).abs() < 1e-12);
    let b = statistics.independent[1];
    assert!((b.mean() - 0.455).abs() < 4.0 * b.standard_error());
    let rate = statistics.small().accepted as f64 / statistics.small().proposed as f64;
    assert!((rate - statistics.small().rate()).abs() < 0.02);
    assert!(statistics.longest_stay > 0 && statistics.defects == 0);
}

#[test]
fn merged_statistics_are_sums() {
    let run = |ladder, steps| {
        let mut rng = generator(42, ladder);
        let target = line();
        let mut chain = Metropolis::start(&target, &wavy, 1, Exponential::default(), &mut rng);
        for _ in 0..steps {
            chain.step(
                &PointKernel::new(&target, 0.5),
                &wavy,
                &mut rng,
                &mut Ignore,
            );
        }
        chain.statistics().clone()
    };
    let (a, b) = (run(0, 100), run(1, 300));
    let mut both = Statistics::new();
    both.merge(&a);
    both.merge(&b);
    assert_eq!(both.steps, 400);
    assert_eq!(
        both.large().proposed,
        a.large().proposed + b.large().proposed
    );
    // Those from where a chain began in the dark are samples, and no moves that tell anything.
    assert!(both.independent[1].count() >= both.large().proposed);
    assert!(both.large().proposed > 150);
    assert_eq!(both.longest_stay, a.longest_stay.max(b.longest_stay));
}

/// NaN, infinite and negative densities: counted, never reported, never a state.
#[test]
fn defects_never_enter() {
    for bad in [f64::NAN, f64::INFINITY, -1.0] {
        let spoiled = move |value: &Numbered| [if value.x > 0.8 { bad } else { value.x }];
        let target = line();
        let mut rng = generator(43, 0);
        let mut chain =
            Metropolis::start(&target, &spoiled, 0, Exponential::new(0.01, 0.2), &mut rng);
        let mut record = |visit: Visit<'_, Numbered, 1>| assert!(visit.value.x <= 0.8);
        for _ in 0..2000 {
            chain.step(
                &PointKernel::new(&target, 0.3),
                &spoiled,
                &mut rng,
                &mut record,
            );
            assert!(chain.density().is_finite());
        }
        chain.flush(&mut record);
        let statistics = chain.statistics();
        assert!(statistics.defects > 50 && statistics.first_defect.is_some());
        let b = statistics.independent[0];
        assert!(
            (b.mean() - 0.32).abs() < 4.0 * b.standard_error(),
            "counted as zero"
        );
    }
}

/// A start in the dark: time spent there stands for nothing.
#[test]
fn a_dark_start_is_left_and_not_reported() {
    let island = |value: &Numbered| [f64::from(u8::from(value.x > 0.95)), 1.0];
    let target = line();
    let mut rng = generator(44, 3);
    let mut chain = Metropolis::start(&target, &island, 0, Exponential::default(), &mut rng);
    assert!(chain.density() <= 0.0);
    let (mut weight, mut dark) = (0.0, 0);
    let mut record = |visit: Visit<'_, Numbered, 2>| {
        if visit.density() > 0.0 {
            weight += visit.weight;
        } else {
            assert!(visit.weight <= 0.0 && visit.independent > 0.0);
            dark += 1;
        }
    };
    let mut lit = 0;
    for _ in 0..2000 {
        lit += u64::from(chain.density() > 0.0);
        chain.step(
            &PointKernel::new(&target, 0.2),
            &island,
            &mut rng,
            &mut record,
        );
    }
    chain.flush(&mut record);
    assert!(dark > 100 && lit > 0);
    // the step that arrives reports its proposal with a = 1
    assert!((weight - (lit + 1) as f64).abs() < 1e-9, "{weight} {lit}");
}

#[test]
fn a_start_is_rebuilt_to_the_bit_or_refused() {
    let target = line();
    let mut value = Numbered::default();
    let family = |v: &Numbered| [v.x];
    let pool = Pool::new(
        (0..100)
            .map(|i| sample(&target, &family, sample_generator(45, 0, i), &mut value).unwrap()[0]),
    );
    let b = pool.normaliser();
    assert!((b.mean() - 0.5).abs() < 4.0 * b.standard_error());
    let start = pool.choose(&mut generator(45, 0)).unwrap();
    let rebuild = |index| {
        let mut rng = sample_generator(45, 0, index);
        Metropolis::rebuild(
            &target,
            &family,
            0,
            Exponential::default(),
            &start,
            &mut rng,
        )
    };
    let chain = rebuild(start.index).unwrap();
    assert_eq!(chain.density().to_bits(), start.density.to_bits());
    let error = rebuild(start.index + 1).unwrap_err();
    assert!(matches!(error, StartError::Differs { .. }));
    assert!(
        error
            .to_string()
            .contains(&format!("sample {}", start.index))
    );
}

/// A target that asks twice is caught when its start is rebuilt: plain Monte Carlo does not
/// remember.
#[test]
fn a_target_that_asks_twice_is_refused() {
    let target = target(|u: &mut dyn Coordinates| u.get(Stream::Time, 0) * u.get(Stream::Time, 0));
    let family = |v: &f64| [*v];
    let mut value = 0.0;
    let pool = Pool::new(
        (0..4)
            .map(|i| sample(&target, &family, sample_generator(46, 0, i), &mut value).unwrap()[0]),
    );
    let start = pool.choose(&mut generator(46, 0)).unwrap();
    let mut rng = sample_generator(46, 0, start.index);
    let chain = Metropolis::rebuild(
        &target,
        &family,
        0,
        Exponential::default(),
        &start,
        &mut rng,
    );
    assert!(matches!(chain, Err(StartError::Differs { .. })));
}

/// Restarting reuses the chain and forgets the place.
#[test]
fn a_restart_is_a_start() {
    let target = line();
    let family = |v: &Numbered| [v.x];
    let mut rng = generator(47, 0);
    let mut chain = Metropolis::start(&target, &family, 0, Exponential::default(), &mut rng);
    for _ in 0..50 {
        chain.step(
            &PointKernel::new(&target, 0.3),
            &family,
            &mut rng,
            &mut Ignore,
        );
    }
    chain.restart(&target, &family, &mut sample_generator(47, 0, 9));
    let fresh = Metropolis::start(
        &target,
        &family,
        0,
        Exponential::default(),
        &mut sample_generator(47, 0, 9),
    );
    assert_eq!(chain.value(), fresh.value());
    let (mut a, mut b) = (generator(48, 0), generator(48, 0));
    let mut fresh = fresh;
    for _ in 0..50 {
        chain.step(
            &PointKernel::new(&target, 0.3),
            &family,
            &mut a,
            &mut Ignore,
        );
        fresh.step(
            &PointKernel::new(&target, 0.3),
            &family,
            &mut b,
            &mut Ignore,
        );
        assert_eq!(chain.value(), fresh.value());
    }
    assert_eq!(chain.statistics().steps, 100);
}

/// A kernel that cannot move.
struct Stuck(f64);

impl Kernel<()> for Stuck {
    type Value = f64;
    fn propose<D: Draws + ?Sized>(&self, (): &mut (), _: &f64, _: &mut f64, _: &mut D) -> Move {
        Move::new(5, self.0)
    }
}

#[test]
fn impossible_moves_are_no_defects_but_senseless_ratios_are() {
    let family = |_: &f64| [1.0];
    let mut rng = generator(49, 0);
    for (ratio, defects) in [(0.0, 0), (f64::NAN, 7), (-1.0, 7), (f64::INFINITY, 7)] {
        let mut chain = Metropolis::at((), 0.5, &family, 0);
        let mut weight = 0.0;
        let mut record = |visit: Visit<'_, f64, 1>| weight += visit.weight;
        for _ in 0..7 {
            assert!(!chain.step(&Stuck(ratio), &family, &mut rng, &mut record));
        }
        chain.flush(&mut record);
        assert_eq!(chain.statistics().defects, defects);
        assert_eq!(chain.statistics().moves[5].proposed, 7);
        assert_eq!(chain.statistics().longest_stay, 7);
        assert!((weight - 7.0).abs() < 1e-12);
    }
}
