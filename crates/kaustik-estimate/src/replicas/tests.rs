//! The composition (RELT eqs. 22 and 23) on a toy of one dimension whose picture is known.

use kaustik_film::{Layout, Quantum};
use kaustik_mcmc::{
    Draws, Exponential, Ladder, LevelKernel, Metropolis, Pcg64Dxsm, Point, Target, Touring,
    generator, target,
};
use kaustik_pss::{Coordinates, Stream};
use kaustik_spectrum::Xyz;

use super::*;

const PIXELS: usize = 10;
/// Steps of a tour.
const TOUR: u32 = 4;

/// What the toy brings in each class at a point: a narrow specular peak, light that only the uniform
/// replica sees, smooth rest, and specular light that others find as well; dark at the right end but for class 1.
fn classes(u: f64) -> [f64; Class::COUNT] {
    let bump = |at: f64, width: f64| libm::exp(-((u - at) / width) * ((u - at) / width));
    let lit = if u < 0.9 { 1.0 } else { 0.0 };
    [
        lit * 30.0 * bump(0.735, 0.008),
        if (0.2..=0.85).contains(&u) { 0.0 } else { 0.7 },
        lit * (1.0 + 0.8 * libm::sin(9.0 * u)),
        if u < 0.3 { 0.2 } else { 0.0 },
        lit * 2.0 * bump(0.35, 0.03),
        if (0.25..0.85).contains(&u) {
            0.5 + u
        } else {
            0.0
        },
        lit * 6.0 * bump(0.6, 0.03),
    ]
}

fn toy() -> impl Target<Value = Contributions> {
    target(|coordinates: &mut dyn Coordinates| -> Contributions {
        let u = coordinates.get(Stream::Camera, 0);
        let mut out = Contributions::default();
        for (class, value) in Class::ALL.into_iter().zip(classes(u)) {
            // a third of the scalar in each of X, Y, Z
            out.push([u, 0.5].into(), Xyz([value as f32 / 3.0; 3]), class);
        }
        out
    })
}

/// Its implicit specular light alone.
fn specular() -> impl Target<Value = Contributions> {
    target(|coordinates: &mut dyn Coordinates| -> Contributions {
        let u = coordinates.get(Stream::Camera, 0);
        let mut out = Contributions::default();
        out.push(
            [u, 0.5].into(),
            Xyz([classes(u)[0] as f32 / 3.0; 3]),
            Class::L0,
        );
        out
    })
}

fn set() -> ReplicaSet {
    ReplicaSet::standard(ReplicaSet::DELTA)
}

fn family() -> ReplicaFamily<4> {
    ReplicaFamily::new(&set(), ScalarTarget::Xyz)
}

/// Integrals by the midpoint rule: the normalisers, and the picture.
fn exact() -> ([f64; 4], [f64; PIXELS]) {
    let points = 400_000;
    let (mut b, mut pixels) = ([0.0; 4], [0.0; PIXELS]);
    for i in 0..points {
        let u = (f64::from(i) + 0.5) / f64::from(points);
        let l = classes(u);
        b[0] += 1.0;
        for (b, row) in b.iter_mut().zip(set().rows()).skip(1) {
            *b += row.iter().zip(&l).map(|(d, l)| d * l).sum::<f64>();
        }
        // the full and the indirect replica, not the specific one
        b[1] += l[6];
        b[2] += l[6];
        pixels[(u * PIXELS as f64) as usize] += l.iter().sum::<f64>();
    }
    let n = f64::from(points);
    (b.map(|b| b / n), pixels.map(|p| p / n))
}

/// A state of the law of a level, by rejection.
fn stationary(
    toy: &impl Target<Value = Contributions>,
    level: usize,
    mutation: Exponential,
    rng: &mut Pcg64Dxsm,
) -> (Point<Exponential>, Contributions) {
    const MOST: f64 = 40.0;
    loop {
        let chain = Metropolis::start(toy, &family(), level, mutation, rng);
        if level == 0 || rng.uniform() * MOST < chain.density() {
            return (chain.state().clone(), chain.value().clone());
        }
    }
}

fn films() -> [Film; 4] {
    let layout = Layout::new(PIXELS as u32, 1);
    [(); 4].map(|()| Film::with_layout(&layout, Quantum::from_mean(1.0)).unwrap())
}

/// A way to combine: what stands in the weights, what scales the films.
struct Variant {
    name: &'static str,
    weights: ReplicaWeights<4>,
    scales: [f64; 4],
    /// Independent samples a sweep beside the ladder's.
    even: u32,
    /// Visits of tours go to the specific film, which counts so many visits a sweep.
    tours: (bool, u32),
    right: bool,
}

fn variants(b: [f64; 4]) -> Vec<Variant> {
    let wrong = [1.0, 0.7, 1.4, 2.5];
    let rough: [f64; 4] = std::array::from_fn(|k| b[k] * wrong[k]);
    let scales = wrong.map(|w| 1.0 / w);
    let one = |name, constants, beta, specific, scales, right| Variant {
        name,
        weights: ReplicaWeights::new(constants, beta, specific).with_counts([1.0, 1.0, 1.0, 2.0]),
        scales,
        even: 0,
        // a step, and one by a tour
        tours: (false, 2),
        right,
    };
    let beside = |name, counts: f64, even, right| {
        let variant = one(name, rough, 2.0, true, scales, right);
        let weights = variant.weights.with_counts([counts, 1.0, 1.0, 2.0]);
        Variant {
            weights,
            even,
            ..variant
        }
    };
    let worth = |name, right| {
        let variant = one(name, rough, 2.0, true, scales, right);
        let weights = variant.weights.with_worth([1.0, 0.1, 0.1, 1.0]);
        Variant { weights, ..variant }
    };
    let touring = |name, tours, right| Variant {
        tours,
        ..one(name, rough, 2.0, true, scales, right)
    };
    vec![
        touring("tours", (true, 2 + TOUR), true),
        touring("tours that are not counted", (true, 2), false),
        touring("tours that are not there", (false, 2 + TOUR), false),
        one("beta 1", rough, 1.0, false, scales, true),
        one("beta 2", rough, 2.0, false, scales, true),
        one("beta 2.5", rough, 2.5, false, scales, true),
        one("two groups", rough, 2.0, true, scales, true),
        one(
            "rough constants for true ones",
            rough,
            2.0,
            false,
            [1.0; 4],
            false,
        ),
        one("the same, two groups", rough, 2.0, true, [1.0; 4], false),
        one("eq. 22 as printed", b, 2.0, false, scales, false),
        beside("samples beside the ladder", 4.0, 3, true),
        worth("visits that count for a tenth", true),
        Variant {
            weights: one("", rough, 2.0, true, scales, true)
                .weights
                .with_counts([1.0, 0.1, 0.1, 2.0]),
            ..one("visits that are not there", rough, 2.0, true, scales, false)
        },
        beside("samples that are not counted", 1.0, 3, false),
        beside("samples that are not there", 4.0, 0, false),
    ]
}

/// Tells all variants the same, but of tours those that take them.
struct All<'a>(Vec<ReplicaDeposit<'a, 4>>, Vec<bool>);

impl TourRecorder<Contributions> for All<'_> {
    fn record_tour(&mut self, visit: Visit<'_, Contributions, 1>) {
        for (deposit, _) in self.0.iter_mut().zip(&self.1).filter(|(_, takes)| **takes) {
            deposit.record_tour(visit);
        }
    }
}

impl Recorder<Contributions, 4> for All<'_> {
    fn record(&mut self, visit: Visit<'_, Contributions, 4>) {
        for deposit in &mut self.0 {
            deposit.record(visit);
        }
    }
}

/// Pictures of all variants after many short runs from stationary starts.
fn batch(index: u64, runs: u32, sweeps: u32, variants: &[Variant]) -> Vec<[f64; PIXELS]> {
    let toy = toy();
    let mut rng = generator(71, index);
    let sizes = [61.0, 61.0, 61.0, 96.0].map(|n| Exponential::new(1.0 / n, 16.0 / n));
    let kernels: [_; 4] =
        std::array::from_fn(|k| LevelKernel::new(&toy, if k == 0 { 1.0 } else { 0.0 }, sizes[k]));
    let films: Vec<[Film; 4]> = variants.iter().map(|_| films()).collect();
    let scale = Scale {
        width: PIXELS as f64,
        height: 1.0,
    };
    let deposits = variants.iter().zip(&films);
    let all = deposits
        .map(|(variant, films)| ReplicaDeposit {
            films,
            scale,
            weights: variant.weights,
            shares: ReplicaShares::default(),
            each: [1.0, 1.0, 1.0, 0.5],
            each_specific: 1.0 / f64::from(variant.tours.1),
        })
        .collect();
    let mut all = All(
        all,
        variants.iter().map(|variant| variant.tours.0).collect(),
    );
    let mut tour = Metropolis::at(
        Point::new(sizes[3]),
        Contributions::default(),
        &|_: &Contributions| [0.0],
        0,
    );
    let touring = Touring {
        target: &toy,
        surrogate: &specular(),
        density: &SpecificFamily::new(&set(), ScalarTarget::Xyz),
        still: &[Stream::Light],
        steps: TOUR,
    };
    let beside = family();
    for _ in 0..runs {
        let starts = std::array::from_fn(|k| stationary(&toy, k, sizes[k], &mut rng));
        let mut ladder = Ladder::new(starts, &family());
        for _ in 0..sweeps {
            ladder.step(&kernels, &family(), &mut rng, &mut all);
            ladder.step_by_tour(3, &touring, &mut tour, &family(), &mut rng, &mut all);
            ladder.exchange(&kernels, &mut rng, &mut all);
            for (deposit, variant) in all.0.iter_mut().zip(variants) {
                for _ in 0..variant.even {
                    let mut value = Contributions::default();
                    toy.evaluate(&mut Fixed(rng.uniform()), &mut value);
                    deposit.record(Visit {
                        level: 0,
                        value: &value,
                        densities: &beside.densities(&value),
                        weight: 1.0,
                        independent: 1.0,
                    });
                }
            }
        }
        ladder.flush(&mut all);
    }
    let per_sweep = 1.0 / (f64::from(runs) * f64::from(sweeps));
    let picture = |(variant, films): (&Variant, &[Film; 4])| {
        let mut pixels = [0.0; PIXELS];
        for (film, scale) in films.iter().zip(variant.scales) {
            let factor = scale * per_sweep * film.quantum().value();
            for (i, sum) in film.sums().enumerate() {
                pixels[i / 3] += sum as f64 * factor;
            }
        }
        pixels
    };
    variants.iter().zip(&films).map(picture).collect()
}

#[test]
fn the_picture_is_right_for_any_rough_constants_and_mistakes_show() {
    const BATCHES: u64 = 25;
    let (b, wanted) = exact();
    let variants = variants(b);
    let batches: Vec<_> = (0..BATCHES).map(|i| batch(i, 200, 50, &variants)).collect();
    for (v, variant) in variants.iter().enumerate() {
        let mut chi2 = 0.0;
        for (pixel, wanted) in wanted.iter().enumerate() {
            let values = batches.iter().map(|batch| batch[v][pixel]);
            let mean: kaustik_mcmc::Mean = values.collect();
            chi2 += ((mean.mean() - wanted) / mean.standard_error()).powi(2) / PIXELS as f64;
        }
        // 10 squares of Student's t with 24 degrees of freedom: 3.6 is one in a thousand
        if variant.right {
            assert!(chi2 < 3.6, "{}: chi2 / 10 is {chi2}", variant.name);
        } else {
            assert!(chi2 > 20.0, "{}: chi2 / 10 is {chi2}", variant.name);
        }
    }
}

#[test]
fn weights_are_a_partition_of_unity() {
    let mut rng = generator(72, 0);
    let family = family();
    for _ in 0..2_000 {
        let mut value = Contributions::default();
        toy().evaluate(&mut Fixed(rng.uniform()), &mut value);
        let q = family.densities(&value);
        let rough: [f64; 4] = [(); 4].map(|()| libm::exp(6.0 * rng.uniform() - 3.0));
        for beta in [1.0, 2.0, 2.5, 3.0] {
            for specific in [false, true] {
                let counts: [f64; 4] = [(); 4].map(|()| 1.0 + 9.0 * rng.uniform());
                let worth: [f64; 4] = [(); 4].map(|()| 0.01 + rng.uniform());
                let weights = ReplicaWeights::new(rough, beta, specific)
                    .with_counts(counts)
                    .with_worth(worth);
                // w_k = (n_k q_k / b_hat_k) * factor: what a film gains over the density of its samples
                let sum: f64 = (0..weights.shared())
                    .map(|k| counts[k] * q[k] / rough[k] * weights.factor(k, &q))
                    .sum();
                assert!((sum - 1.0).abs() < 1e-12, "{sum}");
                if q[3] > 0.0 {
                    let one = q[3] / rough[3] * weights.specific_factor(q[3]);
                    assert!((one - 1.0).abs() < 1e-12, "{one}");
                }
            }
        }
    }
}

/// Every coordinate is this one.
struct Fixed(f64);

impl Coordinates for Fixed {
    fn get(&mut self, _: Stream, _: u32) -> f64 {
        self.0
    }
}
