//! Exact: populations small enough to be enumerated.

use kaustik_pss::{Coordinates, Stream};
use proptest::prelude::*;

use super::*;
use crate::testing::{Enumerator, GridStep, enumerate};
use crate::toys::{CELLS, Cells, Ring, STATES, cell, lazy, mutations};
use crate::{
    Ignore, LevelKernel, Mean, Move, PointKernel, Visit, anneal, generator, sample_generator,
    target,
};

const TOLERANCE: f64 = 1e-12;

/// Up or down alike.
const RING: Ring = Ring { up: 0.5 };

/// Nested supports; some populations die.
const TABLE: [[f64; 3]; STATES] = [[1.0, 0.5, 0.2], [1.0, 2.0, 3.0], [1.0, 0.0, 0.0]];

fn family(state: &usize) -> [f64; 3] {
    TABLE[*state]
}

/// The integral of q_k h under the uniform law, h that tells the states apart.
fn integral(level: usize, h: impl Fn(usize) -> f64) -> f64 {
    let sum: f64 = (0..STATES).map(|s| TABLE[s][level] * h(s)).sum();
    sum / STATES as f64
}

fn population(
    count: usize,
    scheme: Resampling,
    draws: &mut Enumerator,
) -> Population<(), usize, 3> {
    let samples = (0..count).map(|_| ((), draws.index(&[1.0; STATES])));
    Population::from_samples(samples, &family, scheme)
}

/// Outcomes of an annealing as bits, with their probabilities.
fn law<const N: usize>(
    count: usize,
    scheme: Resampling,
    moves: usize,
    outcome: impl Fn(&Annealing, [[f64; STATES]; 3]) -> [f64; N],
) -> Vec<([f64; N], f64)> {
    let law = enumerate(1, |draws| {
        let mut population = population(count, scheme, draws);
        let mut seen = [[0.0; STATES]; 3];
        let mut record = |visit: Visit<'_, usize, 3>| {
            seen[visit.level][*visit.value] += visit.weight / count as f64;
        };
        let annealed = anneal(
            &mut population,
            moves,
            &[RING; 3],
            &family,
            draws,
            &mut record,
        );
        outcome(&annealed, seen).map(f64::to_bits)
    });
    law.into_iter()
        .map(|(bits, p)| (bits.map(f64::from_bits), p))
        .collect()
}

type Annealing = crate::Annealed<(), usize, 3>;

/// Small enough for all: (particles, scheme, moves).
const CASES: [(usize, Resampling, usize); 6] = [
    (1, Resampling::Systematic, 2),
    (2, Resampling::Systematic, 1),
    (3, Resampling::Systematic, 1),
    (2, Resampling::Multinomial, 1),
    (3, Resampling::Multinomial, 0),
    (3, Resampling::Systematic, 0),
];

fn mean<const N: usize>(law: &[([f64; N], f64)]) -> [f64; N] {
    std::array::from_fn(|i| law.iter().map(|(x, p)| x[i] * p).sum())
}

#[test]
fn normalisers_are_unbiased() {
    for (count, scheme, moves) in CASES {
        let law = law(count, scheme, moves, |a, _| a.normalisers.values());
        for (k, z) in mean(&law).into_iter().enumerate() {
            let exact = integral(k, |_| 1.0);
            assert!(
                (z - exact).abs() < TOLERANCE,
                "{count} {scheme:?} {moves} level {k}: {z}"
            );
        }
        let dead: f64 = law
            .iter()
            .filter(|(z, _)| z[2] <= 0.0)
            .map(|(_, p)| p)
            .sum();
        assert!(dead > 0.01, "extinction takes part");
    }
}

#[test]
fn starts_and_visits_weighted_by_their_normaliser_are_unbiased() {
    let h = |s: usize| [0.3, 1.0, 7.0][s];
    for (count, scheme, moves) in CASES {
        let law = law(count, scheme, moves, |annealed, seen| {
            let z = annealed.normalisers.values();
            let start = |k: usize| annealed.starts[k].map_or(0.0, |((), s)| h(s));
            let visited = |k: usize| (0..STATES).map(|s| seen[k][s] * h(s)).sum::<f64>();
            let of = |k: usize| [z[k] * start(k), z[k] * visited(k)];
            [of(0), of(1), of(2)]
                .concat()
                .try_into()
                .unwrap_or([0.0; 6])
        });
        for (i, found) in mean(&law).into_iter().enumerate() {
            let exact = integral(i / 2, h);
            assert!(
                (found - exact).abs() < TOLERANCE,
                "{count} {scheme:?} {moves}: {i} {found}"
            );
        }
    }
}

/// Densities of two levels at three states: the second is zero wherever the first is.
fn nested() -> impl Strategy<Value = [[f64; 2]; STATES]> {
    let density = || prop_oneof![1 => Just(0.0), 3 => 1e-3..1.0f64];
    prop::array::uniform3((density(), density())).prop_map(|rows| {
        rows.map(|(first, second)| [first, if first > 0.0 { second } else { 0.0 }])
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// E[Z_k] = Z_k and E[Z_k h(start)] = integral of q_k h, whatever the levels.
    #[test]
    fn normalisers_are_unbiased_whatever_the_levels(
        table in nested(), count in 1..4usize, moves in 0..2usize, multinomial in any::<bool>(),
    ) {
        let moves = if count == 3 { 0 } else { moves };
        let scheme = [Resampling::Systematic, Resampling::Multinomial][usize::from(multinomial)];
        let family = |state: &usize| table[*state];
        let h = [0.3, 1.0, 7.0];
        let mut found = [0.0; 4];
        let law = enumerate(1, |draws| {
            let samples = (0..count).map(|_| ((), draws.index(&[1.0; STATES])));
            let samples: Vec<_> = samples.collect();
            let mut population = Population::from_samples(samples, &family, scheme);
            let annealed = anneal(&mut population, moves, &[RING; 2], &family, draws, &mut Ignore);
            let z = annealed.normalisers.values();
            let start = |k: usize| annealed.starts[k].map_or(0.0, |((), s)| z[k] * h[s]);
            [z[0], z[1], start(0), start(1)].map(f64::to_bits)
        });
        for (values, p) in law {
            for (sum, bits) in found.iter_mut().zip(values) {
                *sum += p * f64::from_bits(bits);
            }
        }
        for k in 0..2 {
            let exact = |h: [f64; 3]| (0..STATES).map(|s| table[s][k] * h[s]).sum::<f64>() / 3.0;
            prop_assert!((found[k] - exact([1.0; 3])).abs() < TOLERANCE, "{k}: {found:?}");
            prop_assert!((found[2 + k] - exact(h)).abs() < TOLERANCE, "{k}: {found:?}");
        }
    }
}

/// Leaving extinct runs out of the mean biases it.
#[test]
fn survivors_alone_are_biased() {
    let law = law(2, Resampling::Systematic, 1, |a, _| a.normalisers.values());
    let alive: f64 = law.iter().filter(|(z, _)| z[2] > 0.0).map(|(_, p)| p).sum();
    assert!(mean(&law)[2] / alive > 1.1 * integral(2, |_| 1.0));
}

/// E[Z^2 relative variance] = var Z with multinomial resampling, to rounding error.
#[test]
fn the_squared_error_is_an_unbiased_variance() {
    for (count, moves) in [(2, 0), (2, 1), (3, 0)] {
        let law = law(count, Resampling::Multinomial, moves, |annealed, _| {
            let of = |k: usize| {
                let z = annealed.normalisers.values()[k];
                let stage = annealed.stages[k];
                [z * z, z * z * stage.map_or(0.0, |s| s.relative_variance)]
            };
            [of(0), of(1), of(2)]
                .concat()
                .try_into()
                .unwrap_or([0.0; 6])
        });
        let mean = mean(&law);
        for k in 0..3 {
            let variance = mean[2 * k] - integral(k, |_| 1.0).powi(2);
            let found = mean[2 * k + 1];
            assert!(
                (found - variance).abs() < TOLERANCE,
                "{count} {moves} {k}: {found} {variance}"
            );
        }
    }
}

/// Larger populations: the error is that of repeated runs.
#[test]
fn errors_are_those_of_repeated_runs() {
    for (scheme, range) in [
        (Resampling::Multinomial, 0.9..1.1),
        (Resampling::Systematic, 0.9..1.15),
    ] {
        let (mut value, mut error) = (Mean::new(), Mean::new());
        for index in 0..1500 {
            let mut rng = generator(17, index);
            let samples = (0..60)
                .map(|_| ((), rng.index(&[1.0; STATES])))
                .collect::<Vec<_>>();
            let mut population = Population::from_samples(samples, &family, scheme);
            let kernels = [RING; 3];
            let annealed = anneal(&mut population, 1, &kernels, &family, &mut rng, &mut Ignore);
            let z = annealed.normalisers.estimates()[2];
            value.push(z.value);
            error.push(z.standard_error.powi(2));
        }
        let ratio = (error.mean() / value.variance()).sqrt();
        assert!(range.contains(&ratio), "{scheme:?}: {ratio}");
    }
}

#[test]
fn extinction_is_reported_and_stays() {
    let mut rng = generator(9, 0);
    let samples = [2, 2, 2].map(|s| ((), s));
    let mut population = Population::from_samples(samples, &family, Resampling::Systematic);
    let stage = population
        .advance(0, &RING, &mut rng)
        .expect("all are alive");
    assert!(!stage.resampled && stage.founders == 3);
    assert!((stage.effective - 3.0).abs() < 1e-15);
    let dead = Extinct { level: 1 };
    assert_eq!(population.advance(1, &RING, &mut rng), Err(dead));
    assert_eq!(population.advance(2, &RING, &mut rng), Err(dead));
    assert_eq!(
        (population.level(), population.normaliser().to_bits()),
        (Some(0), 0)
    );

    let mut again = Population::from_samples(samples, &family, Resampling::Systematic);
    let kernels = [RING; 3];
    let annealed = anneal(&mut again, 1, &kernels, &family, &mut rng, &mut Ignore);
    assert_eq!(annealed.extinct, Some(dead));
    assert!(annealed.starts[0].is_some() && annealed.starts[1].is_none());
    assert!(annealed.stages[1].is_none());
    assert_eq!(annealed.into_ladder(&family).err(), Some(dead));
    let nobody = Population::<(), usize, 3>::from_samples([], &family, Resampling::default());
    assert!(nobody.choose(&mut rng).is_none() && nobody.level().is_none());
    assert!(nobody.clone().advance(0, &RING, &mut rng).is_err());
}

/// Particles of the base law are what the first weights are for: no step may move them before.
#[test]
fn nothing_moves_before_the_first_level() {
    let family = |x: &f64| [2.0, *x];
    struct Away;
    impl Kernel<()> for Away {
        type Value = f64;
        fn propose<D: Draws + ?Sized>(
            &self,
            (): &mut (),
            _: &f64,
            to: &mut f64,
            _: &mut D,
        ) -> Move {
            *to = 9.0;
            Move::new(3, 1.0)
        }
    }
    let values = [1.0, 3.0].map(|x| ((), x));
    let mut population = Population::from_samples(values, &family, Resampling::Systematic);
    let mut rng = generator(11, 0);
    let places = |population: &Population<(), f64, 2>| -> Vec<u64> {
        let particles = population.particles().iter();
        particles.map(|p| p.value().to_bits()).collect()
    };
    let before = places(&population);
    population.step(&Away, &family, &mut rng, &mut Ignore);
    assert_eq!(places(&population), before);
    population.advance(0, &Away, &mut rng).expect("alive");
    population.step(&Away, &family, &mut rng, &mut Ignore);
    assert_eq!(places(&population), [9.0_f64.to_bits(); 2]);
}

#[test]
fn defects_weigh_nothing_and_are_counted() {
    let family = |x: &f64| [1.0, *x];
    struct Stay;
    impl Kernel<()> for Stay {
        type Value = f64;
        fn propose<D: Draws + ?Sized>(&self, (): &mut (), _: &f64, _: &mut f64, _: &mut D) -> Move {
            Move::impossible(2)
        }
    }
    let values = [1.0, f64::NAN, 3.0, -1.0].map(|x| ((), x));
    let mut population = Population::from_samples(values, &family, Resampling::Systematic);
    assert_eq!(population.defects(), 2);
    let mut rng = generator(10, 0);
    let stage = population
        .advance(1, &Stay, &mut rng)
        .expect("two are alive");
    assert!((stage.normaliser.value - 1.0).abs() < 1e-15);
    assert!(population.particles().iter().all(|p| p.density() > 0.0));
    let threes = population
        .particles()
        .iter()
        .filter(|p| *p.value() > 2.0)
        .count();
    assert_eq!(threes, 3);
}

fn densities(&(first, second): &Cells) -> [f64; 2] {
    let part = |table: [f64; CELLS]| second.map_or(0.7, |i| table[i]);
    [
        [0.6, 1.0, 0.4][first] * part([1.0, 0.2, 0.5]),
        [1.0, 0.5, 0.9][first] * part([0.1, 1.0, 0.3]),
    ]
}

/// max over points of |E[Z_1 1(particle is there)] - integral| for a lazy particle that
/// took two steps at level 0, then some at level 1, whose mutation is another.
fn lazy_defect<N: Kernel<Point<GridStep>, Value = Cells>>(
    kernels: &[N; 2],
    enter: impl Fn(&mut Population<Point<GridStep>, Cells, 2>),
) -> f64 {
    let law = enumerate(CELLS, |draws| {
        let [first, _] = mutations();
        let scheme = Resampling::Systematic;
        let mut population = Population::start(1, &lazy(), &densities, &first, scheme, draws);
        if population.advance(0, &kernels[0], draws).is_err() {
            return ([0; 2], 0);
        }
        for _ in 0..2 {
            population.step(&kernels[0], &densities, draws, &mut Ignore);
        }
        if population.advance(1, &kernels[1], draws).is_err() {
            return ([0; 2], 0);
        }
        enter(&mut population);
        population.step(&kernels[1], &densities, draws, &mut Ignore);
        let z = population.normaliser();
        let mut u = population.particles[0].state.current(draws);
        let at = [Stream::Camera, Stream::Light].map(|s| cell(u.get(s, 0)));
        (at, z.to_bits())
    });
    let mut found = [[0.0; CELLS]; CELLS];
    for (([a, b], z), p) in law {
        found[a][b] += p * f64::from_bits(z);
    }
    let points = (0..CELLS * CELLS).map(|i| (i % CELLS, i / CELLS));
    points
        .map(|(a, b)| {
            let exact = densities(&(a, (a != 2).then_some(b)))[1] / (CELLS * CELLS) as f64;
            (found[a][b] - exact).abs()
        })
        .fold(0.0, f64::max)
}

fn level_kernels() -> [LevelKernel<impl Target<Value = Cells>, GridStep>; 2] {
    mutations().map(|mutation| LevelKernel::new(lazy(), 0.0, mutation))
}

#[test]
fn lazy_particles_that_change_their_steps_are_unbiased() {
    let defect = lazy_defect(&level_kernels(), |population| {
        let [_, second] = mutations();
        assert_eq!(population.particles()[0].state().mutation(), &second);
    });
    assert!(defect < TOLERANCE, "{defect:e}");
}

#[test]
fn a_particle_that_does_not_settle_is_caught() {
    /// A kernel that nobody told of entering.
    struct Silent<N>(N);

    impl<N: Kernel<Point<GridStep>, Value = Cells>> Kernel<Point<GridStep>> for Silent<N> {
        type Value = Cells;

        fn propose<D: Draws + ?Sized>(
            &self,
            point: &mut Point<GridStep>,
            current: &Cells,
            proposed: &mut Cells,
            draws: &mut D,
        ) -> Move {
            self.0.propose(point, current, proposed, draws)
        }

        fn accept(&self, point: &mut Point<GridStep>) {
            self.0.accept(point);
        }

        fn reject(&self, point: &mut Point<GridStep>) {
            self.0.reject(point);
        }
    }

    let unpaid = |population: &mut Population<Point<GridStep>, Cells, 2>| {
        let [_, second] = mutations();
        population.particles[0].state.mutation = second;
    };
    let defect = lazy_defect(&level_kernels().map(Silent), unpaid);
    assert!(defect > 1e-4, "{defect:e}");
}

/// Moved slot by slot with generators of their own, in any order: the same bits.
#[test]
fn slots_may_be_moved_in_any_order() {
    let walk = target(|u: &mut dyn Coordinates| {
        let length = 1 + (u.get(Stream::Technique, 0) * 10.0) as u32;
        (0..length).map(|i| u.get(Stream::Camera, i)).sum::<f64>()
    });
    let family = |x: &f64| [1.0, *x, x * x];
    let run = |reverse: bool| {
        let mut rng = generator(11, 0);
        let sizes = crate::Exponential::default();
        let mut population =
            Population::start(40, &walk, &family, &sizes, Resampling::Systematic, &mut rng);
        let mut generators: Vec<_> = (0..40).map(|slot| sample_generator(11, 1, slot)).collect();
        let kernel = PointKernel::new(&walk, 0.1);
        for level in 0..3 {
            population.advance(level, &kernel, &mut rng).expect("alive");
            let mut slots: Vec<_> = population
                .particles_mut()
                .iter_mut()
                .zip(&mut generators)
                .collect();
            if reverse {
                slots.reverse();
            }
            for (particle, rng) in slots {
                for _ in 0..5 {
                    particle.step(&kernel, &family, rng, &mut Ignore);
                }
            }
        }
        let values = population.particles().iter().map(|p| p.value().to_bits());
        (
            values.collect::<Vec<_>>(),
            population.normaliser().to_bits(),
        )
    };
    assert_eq!(run(false), run(true));
}
