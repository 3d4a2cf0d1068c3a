//! Mutations by address, and points written down.

use kaustik_mcmc::testing::{GridStep, Law, point_key};
use kaustik_mcmc::{
    Draws, Exponential, Ignore, Metropolis, Mutation, PerCoordinate, Point, PointKernel, Pool,
    Scalable, StartError, Step, Uniform, generator, sample, sample_generator, target,
};
use kaustik_pss::{Coordinates, Recorded, Stream};
use proptest::prelude::*;

/// A step whose size says who made it; forgets after `mixed` steps.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shift {
    by: f64,
    mixed: u64,
}

impl Mutation for Shift {
    fn mutate<D: Draws + ?Sized>(&self, x: f64, _: &mut D) -> f64 {
        (x + self.by).fract()
    }
    fn mixed_after(&self) -> u64 {
        self.mixed
    }
}

fn shift(by: f64, mixed: u64) -> Shift {
    Shift { by, mixed }
}

fn shifts() -> PerCoordinate<Shift> {
    PerCoordinate::new(shift(0.01, 99))
        .with(Stream::Camera, 0..2, shift(0.02, 99))
        .with(Stream::Camera, (1..20).step_by(4), shift(0.03, 99))
        .with_stream(Stream::Light, shift(0.04, 99))
        .with(Stream::Light, [7], shift(0.05, 2))
}

#[test]
fn each_address_has_its_own() {
    let mutation = shifts();
    for (stream, index, by) in [
        (Stream::Time, 0, 0.01),
        (Stream::Camera, 0, 0.02),
        (Stream::Camera, 1, 0.03),
        (Stream::Camera, 2, 0.01),
        (Stream::Camera, 17, 0.03),
        (Stream::Camera, 21, 0.01),
        (Stream::Light, 0, 0.04),
        (Stream::Light, 7, 0.05),
        (Stream::Light, 8, 0.04),
        (Stream::Light, 9999, 0.04),
    ] {
        assert!(
            (mutation.at(stream, index).by - by).abs() < 1e-15,
            "{stream:?} {index}"
        );
    }
    assert_eq!(mutation.mixed_after(), 99);
    assert_eq!(mutation.mixed_after_at(Stream::Light, 7), 2);
    let scaled = PerCoordinate::new(Uniform::new(0.1))
        .with(Stream::Time, [0], Uniform::new(0.2))
        .scaled(2.0);
    assert_eq!(scaled.at(Stream::Time, 0), &Uniform::new(0.4));
    assert_eq!(scaled.at(Stream::Time, 1), &Uniform::new(0.2));
}

/// Steps, replays and settled debts are made with the mutation of the coordinate.
#[test]
fn debts_are_paid_in_a_coordinates_own_coin() {
    let addresses = [
        (Stream::Time, 0),
        (Stream::Camera, 0),
        (Stream::Camera, 5),
        (Stream::Light, 0),
        (Stream::Light, 7),
    ];
    for settle in [false, true] {
        let mut rng = generator(1, 0);
        let mut point = Point::new(shifts());
        let mut first = point.propose(Step::Large, &mut rng);
        let begin = addresses.map(|(stream, index)| first.get(stream, index));
        first.decide(1.0);
        for _ in 0..3 {
            point.propose(Step::Small, &mut rng).decide(1.0); // reads nothing
        }
        if settle {
            point.settle(&mut rng);
        }
        let mut last = point.propose(Step::Small, &mut rng);
        let end = addresses.map(|(stream, index)| last.get(stream, index));
        for (i, by) in [0.01, 0.02, 0.03, 0.04].into_iter().enumerate() {
            let moved = (end[i] - begin[i]).rem_euclid(1.0);
            assert!((moved - 4.0 * by).abs() < 1e-12, "{i}: {moved}");
        }
        // asleep for longer than it remembers: drawn anew
        let moved = (end[4] - begin[4]).rem_euclid(1.0);
        assert!((moved - 0.2).abs() > 1e-6);
    }
}

const CELLS: usize = 4;

fn cell(x: f64) -> usize {
    (x * CELLS as f64) as usize
}

/// The exact law of lazy points with steps that differ by coordinate, over four steps.
#[test]
fn lazy_points_keep_the_target() {
    let toy = target(|u: &mut dyn Coordinates| -> [usize; 3] {
        let first = cell(u.get(Stream::Camera, 0));
        let mut light = |reads: bool, i| {
            if reads {
                cell(u.get(Stream::Light, i))
            } else {
                9
            }
        };
        [
            first,
            light(first < 2, 0),
            light(first.is_multiple_of(2), 1),
        ]
    });
    let density = |v: &[usize; 3]| {
        let part = |i: usize, t: [f64; CELLS]| t.get(i).copied().unwrap_or(0.7);
        [part(v[0], [0.6, 1.0, 0.3, 0.8])
            * part(v[1], [1.0, 0.2, 0.0, 0.5])
            * part(v[2], [0.1, 0.9, 0.4, 1.0])]
    };
    let mutation = PerCoordinate::new(GridStep::symmetric(CELLS, 1)).with(
        Stream::Light,
        [0],
        GridStep::new(CELLS, &[(0, 0.7), (2, 0.3)]),
    );
    type Chain = Metropolis<Point<PerCoordinate<GridStep>>, [usize; 3], 1>;
    let key = |chain: &Chain| (*chain.value(), point_key(chain.state()));
    let mut law = Law::certain(())
        .then(
            CELLS,
            |(): &(), draws| Metropolis::start(&&toy, &density, 0, mutation.clone(), draws),
            key,
        )
        .weighted(|chain| chain.density());
    let shares = |law: &Law<Chain>| -> Vec<f64> {
        let mut shares = vec![0.0; 1000];
        for (chain, p) in law.iter() {
            let v = chain.value();
            shares[100 * v[0] + 10 * v[1] + v[2]] += p;
        }
        shares
    };
    let exact = shares(&law);
    let kernel = PointKernel::new(&toy, 0.1);
    for _ in 0..4 {
        law = law.then(
            CELLS,
            |chain, draws| {
                let mut chain = chain.clone();
                chain.step(&kernel, &density, draws, &mut Ignore);
                chain
            },
            key,
        );
    }
    let found = shares(&law);
    let defect: f64 = exact.iter().zip(found).map(|(a, b)| (a - b).abs()).sum();
    assert!(defect < 1e-12, "{defect}");
}

type Reads = Vec<(Stream, u32, u64)>;

/// A walk of random length, whose value is all that it has read.
fn walk() -> impl kaustik_mcmc::Target<Value = Reads> {
    target(|u: &mut dyn Coordinates| {
        let mut reads = Reads::new();
        let mut read = |stream: Stream, index: u32| {
            let x = u.get(stream, index);
            reads.push((stream, index, x.to_bits()));
            x
        };
        let mut i = 0;
        while read(Stream::Camera, 2 * i) < 0.8 && i < 20 {
            read(Stream::ALL[(i % 7) as usize], 100 + i);
            i += 1;
        }
        reads
    })
}

proptest! {
    /// The record of a state is what its evaluation read, whatever has happened since.
    #[test]
    fn a_record_evaluates_to_the_state(seed in any::<u64>(), steps in 0usize..60, forget in any::<bool>()) {
        let target = walk();
        let family = |reads: &Reads| [reads.len() as f64];
        let kernel = PointKernel::new(&target, 0.3);
        let mut rng = generator(seed, 0);
        let mut chain = Metropolis::start(&&target, &family, 0, Exponential::default(), &mut rng);
        for step in 0..steps {
            chain.step(&kernel, &family, &mut rng, &mut Ignore);
            if step % 10 == 9 {
                chain.settle(&mut rng);
            }
        }
        let mut point = chain.state().clone();
        if forget {
            let mut proposal = point.propose(Step::Small, &mut rng);
            (0..5).for_each(|i| { proposal.get(Stream::Camera, i); });
            std::mem::forget(proposal);
        }
        let mut recorded = point.record();
        prop_assert_eq!(recorded.len(), chain.value().len());
        let mut value = Reads::new();
        kaustik_mcmc::Target::evaluate(&target, &mut recorded, &mut value);
        prop_assert_eq!(&value, chain.value());
        prop_assert!(recorded.missing().is_none());
        // a point made from it goes on from there
        let mut again = Point::from_recorded(Exponential::default(), &recorded);
        kaustik_mcmc::Target::evaluate(&target, &mut again.current(&mut rng), &mut value);
        prop_assert_eq!(&value, chain.value());
        prop_assert_eq!(again.record(), recorded);
        // so does one that is copied over another
        let mut copy = Point::new(Exponential::default());
        copy.propose(Step::Large, &mut rng).get(Stream::Light, 500);
        copy.clone_from(chain.state());
        let (mut a, mut b) = (generator(seed, 1), generator(seed, 1));
        let mut one = Metropolis::at(copy, value.clone(), &family, 0);
        let mut two = Metropolis::at(chain.state().clone(), value, &family, 0);
        for _ in 0..20 {
            one.step(&kernel, &family, &mut a, &mut Ignore);
            two.step(&kernel, &family, &mut b, &mut Ignore);
            prop_assert_eq!(one.value(), two.value());
        }
    }
}

#[test]
fn a_recorded_point_is_fresh_elsewhere_and_mended_where_it_is_wrong() {
    let recorded: Recorded = [
        (Stream::Camera, 1, 0.25),
        (Stream::Light, 0, 1.0),
        (Stream::Light, 1, f64::NAN),
        (Stream::Light, 2, -3.0),
    ]
    .into_iter()
    .collect();
    let mut rng = generator(3, 0);
    let mut point = Point::from_recorded(Uniform::new(0.1), &recorded);
    let mut u = point.current(&mut rng);
    let read = [0, 1, 2].map(|i| u.get(Stream::Light, i));
    assert!(read[0] < 1.0 && read[0] > 0.999 && read[1].abs() < 1e-300 && read[2].abs() < 1e-300);
    let (a, b) = (u.get(Stream::Camera, 0), u.get(Stream::Camera, 2));
    assert!((a - b).abs() > 1e-9 && (u.get(Stream::Camera, 1) - 0.25).abs() < 1e-300);
    assert!(Point::new(Uniform::new(0.1)).record().is_empty());
}

#[test]
fn chains_are_rebuilt_from_records() {
    let toy = target(|u: &mut dyn Coordinates| u.get(Stream::Time, 0));
    let family = |x: &f64| [*x];
    let mut value = 0.0;
    let pool = Pool::new((0..8).map(|i| {
        sample(&toy, &family, sample_generator(4, 0, i), &mut value).map_or(0.0, |d| d[0])
    }));
    let start = pool.choose(&mut generator(4, 0)).unwrap();
    let rebuild = |mut recorded: Recorded| {
        Metropolis::<_, _, 1>::rebuild_from(
            &toy,
            &family,
            0,
            Exponential::default(),
            &start,
            &mut recorded,
        )
    };
    let right = [(Stream::Time, 0, start.density)].into_iter().collect();
    let chain = rebuild(right).unwrap();
    assert_eq!(chain.value().to_bits(), start.density.to_bits());
    assert_eq!(chain.state().record().len(), 1);
    assert!(matches!(
        rebuild(Recorded::new()),
        Err(StartError::Differs { .. })
    ));
}
