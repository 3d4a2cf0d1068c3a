//! After warm-up a step allocates nothing. (A binary of its own: it owns the allocator.)

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use kaustik_mcmc::{
    AcceptanceAdaptation, Autocorrelation, Deposit, Exponential, Halves, Ignore, Jumps, Ladder,
    LevelKernel, Metropolis, Mixture, Mutation, PerCoordinate, Point, PointKernel, Population,
    Power, Redistribution, Redistributor, Resampling, Schedule, Stratification, Target, Uniform,
    Visit, WrappedCauchy, WrappedNormal, generator,
};
use kaustik_pss::{Coordinates, Stream};

/// The system's allocator, counting what each thread asks for.
struct Counting;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

#[expect(
    unsafe_code,
    reason = "an allocator can only be written so; it forwards to System"
)]
// SAFETY: every call is passed on to `System` unchanged; the counter neither allocates nor
// unwinds (a const-initialised Cell without a destructor).
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's promise is passed on
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise is passed on
        unsafe { System.dealloc(memory, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn allocations() -> u64 {
    COUNT.with(Cell::get)
}

/// Variable length, with a buffer in its value.
struct Walk;

type Products = Vec<f64>;

impl Target for Walk {
    type Value = Products;

    fn evaluate(&self, u: &mut dyn Coordinates, value: &mut Vec<f64>) {
        value.clear();
        let length = 1 + (u.get(Stream::Technique, 0) * 30.0) as u32;
        for i in 0..length {
            value.push(u.get(Stream::Camera, 4 * i) * u.get(Stream::Light, 4 * i));
        }
    }
}

fn family(value: &Products) -> [f64; 2] {
    [1.0, value.iter().sum()]
}

#[test]
fn a_step_allocates_nothing_after_warm_up() {
    let mut rng = generator(1, 0);
    let kernel = PointKernel::new(Walk, 0.3);
    let mut sum = 0.0;
    let mut record = |visit: Visit<'_, Vec<f64>, 2>| sum += visit.weight;
    let mut chain = Metropolis::start(&Walk, &family, 1, Exponential::default(), &mut rng);
    for _ in 0..1000 {
        chain.step(&kernel, &family, &mut rng, &mut record);
    }
    let before = allocations();
    for step in 0..10_000 {
        chain.step(&kernel, &family, &mut rng, &mut record);
        match step % 100 {
            0 => chain.set_mutation(Exponential::new(0.001, 0.1), &mut rng),
            50 => chain.restart(&Walk, &family, &mut rng),
            _ => {}
        }
    }
    assert_eq!(allocations() - before, 0);
    let probe = Box::new(sum); // the counter does count
    assert_eq!(allocations() - before, 1, "{probe}");
}

fn sizes() -> [Exponential; 2] {
    [
        Exponential::default(),
        Exponential::new(1.0 / 96.0, 1.0 / 6.0),
    ]
}

#[test]
fn a_sweep_allocates_nothing_after_warm_up() {
    for schedule in [
        Schedule::RandomPair,
        Schedule::RandomMatching,
        Schedule::Alternating,
        Schedule::Full,
        Schedule::Permutation,
    ] {
        let mut rng = generator(2, 0);
        let kernels = [1.0, 0.1].map(|large| PointKernel::new(Walk, large));
        let mut sum = 0.0;
        let mut record = |visit: Visit<'_, Vec<f64>, 2>| sum += visit.weight;
        let mut ladder = Ladder::start(&Walk, &family, sizes(), &mut rng).with_schedule(schedule);
        for _ in 0..1000 {
            ladder.sweep(&kernels, &family, &mut rng, &mut record);
        }
        let before = allocations();
        for _ in 0..10_000 {
            ladder.sweep(&kernels, &family, &mut rng, &mut record);
        }
        assert_eq!(allocations() - before, 0, "{schedule:?}");
        assert!(ladder.statistics().round_trips > 100, "states did travel");
    }
}

#[test]
fn annealing_allocates_nothing_after_warm_up() {
    for scheme in [Resampling::Systematic, Resampling::Multinomial] {
        let mut rng = generator(3, 0);
        let kernels = sizes().map(|mutation| LevelKernel::new(Walk, 0.3, mutation));
        let first = Exponential::default();
        let mut population = Population::start(20, &Walk, &family, &first, scheme, &mut rng);
        let mut resampled = 0;
        let mut before = 0;
        for round in 0..400 {
            if round == 200 {
                before = allocations();
            }
            for (level, kernel) in kernels.iter().enumerate() {
                let stage = population.advance(level, kernel, &mut rng).expect("alive");
                resampled += u32::from(stage.resampled);
                population.step(kernel, &family, &mut rng, &mut Ignore);
                population.step(kernel, &family, &mut rng, &mut Ignore);
            }
        }
        assert_eq!(allocations() - before, 0, "{scheme:?}");
        assert!(resampled > 300);
    }
}

/// Allocations of `run` once it has been called before.
fn after_warm_up(mut run: impl FnMut()) -> u64 {
    run();
    let before = allocations();
    run();
    allocations() - before
}

fn weigh(sum: &mut f64) -> impl FnMut(Visit<'_, Products, 2>) + '_ {
    |visit| *sum += visit.weight
}

/// A point and a value as large as they can become.
fn chain<M: Mutation>(mutation: M) -> Metropolis<Point<M>, Products, 2> {
    let mut point = Point::new(mutation);
    for stream in [Stream::Technique, Stream::Camera, Stream::Light] {
        point.reserve(stream, 121);
    }
    let mut rng = generator(2, 0);
    let mut chain = Metropolis::at(point, Vec::with_capacity(32), &family, 1);
    chain.restart(&Walk, &family, &mut rng);
    chain
}

fn steps<M: Mutation>(mutation: M) -> u64 {
    let mut rng = generator(3, 0);
    let kernel = PointKernel::new(Walk, 0.3);
    let mut chain = chain(mutation);
    let mut sum = 0.0;
    after_warm_up(|| {
        for _ in 0..3000 {
            chain.step(&kernel, &family, &mut rng, &mut weigh(&mut sum));
        }
    })
}

#[test]
fn no_mutation_allocates() {
    assert_eq!(steps(Uniform::new(0.1)), 0);
    assert_eq!(steps(WrappedNormal::new(0.01)), 0);
    assert_eq!(steps(WrappedCauchy::new(0.01)), 0);
    assert_eq!(steps(Power::new(0.1)), 0);
    let mutation = PerCoordinate::new(Exponential::default()).with(
        Stream::Light,
        (0..100).step_by(4),
        Exponential::new(0.1, 0.2),
    );
    assert_eq!(steps(mutation), 0);
}

#[test]
fn mixtures_and_delayed_rejection_allocate_nothing() {
    let mut rng = generator(4, 0);
    let delayed = PointKernel::new(Walk, 0.6);
    let suits = |value: &Products| [1.0, value.len() as f64];
    let mixed = Mixture::new(
        (PointKernel::new(Walk, 0.0), PointKernel::new(Walk, 1.0)),
        suits,
    );
    let mut chain = chain(Exponential::default());
    let mut sum = 0.0;
    let count = after_warm_up(|| {
        for _ in 0..3000 {
            chain.step_delayed(&delayed, &family, &mut rng, &mut weigh(&mut sum));
            chain.step(&mixed, &family, &mut rng, &mut weigh(&mut sum));
        }
    });
    assert_eq!(count, 0);
}

#[test]
fn redistribution_allocates_nothing_after_warm_up() {
    let mut rng = generator(5, 0);
    let kernel = PointKernel::new(Walk, 0.1);
    let scalar = |value: &Products| [value.iter().sum()];
    let plan = Redistribution::new(20, 0.05).expect("a sound plan");
    let mut start = chain(Exponential::default());
    let mut redistributor = Redistributor::new();
    let mut sum = 0.0;
    let mut run = |starts: u32| {
        let mut chains = 0;
        for _ in 0..starts {
            start.restart(&Walk, &family, &mut rng);
            let weight = start.density();
            let mut deposit = |deposit: Deposit<'_, Products>| sum += deposit.weight();
            let begin = (start.state(), start.value(), weight);
            chains += redistributor.run(&plan, begin, &kernel, &scalar, &mut rng, &mut deposit);
        }
        chains
    };
    assert!(run(500) > 500); // the longest value and point have been met
    assert_eq!(after_warm_up(|| assert!(run(200) > 200)), 0);
}

#[test]
fn adaptation_diagnostics_and_stratified_samples_allocate_nothing() {
    let mut rng = generator(6, 0);
    let kernel = PointKernel::new(Walk, 0.3);
    let mut adaptation = AcceptanceAdaptation::new(Exponential::default());
    let mut chain = chain(adaptation.mutation());
    let (mut time, mut halves, mut jumps) = (Autocorrelation::new(), Halves::new(), Jumps::new());
    let plan = Stratification::new(1, 0).with(Stream::Technique, 0);
    let (mut sum, mut value) = (0.0, Vec::with_capacity(32));
    let count = after_warm_up(|| {
        for step in 0..3000 {
            chain.step(&kernel, &family, &mut rng, &mut weigh(&mut sum));
            time.push(chain.density());
            halves.push(chain.density());
            jumps.push([chain.density()]);
            Walk.evaluate(&mut plan.at(step), &mut value);
            if step % 500 == 0 {
                let mutation = adaptation.end_round(chain.statistics().small());
                chain.set_mutation(mutation, &mut rng);
            }
        }
        assert!(time.time().is_some() && halves.halves().is_some());
    });
    assert_eq!(count, 0);
}
