//! Files from strangers: a value or an error, and what was read can be used.

use kaustik_mcmc::{
    AcceptanceAdaptation, Autocorrelation, Exponential, Halves, Ignore, JumpAdaptation, Jumps,
    Ladder, LevelKernel, PerCoordinate, PointKernel, Pool, Population, Redistribution, Resampling,
    Schedule, Stratification, generator,
};
use kaustik_pss::{Coordinates, Stream};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use super::resume::{Walk, family, written};

/// All files that differ from a file in one place: each number, name, list and field replaced
/// by what does not belong there.
fn broken(file: &Value, visit: &mut dyn FnMut(Value)) {
    let strange = [
        json!(-1),
        json!(0),
        json!(1),
        json!(1000),
        json!(4_611_686_018_427_387_904u64),
        json!(u64::MAX),
        json!(1e300),
        json!(-0.25),
        json!(1.5),
        json!(null),
        json!("Permutation"),
        json!([]),
    ];
    strange.into_iter().for_each(&mut *visit);
    match file {
        Value::Array(items) => {
            let mut longer = items.clone();
            longer.extend(items.first().cloned());
            visit(Value::Array(longer));
            visit(Value::Array(items.iter().skip(1).cloned().collect()));
            for i in 0..items.len() {
                broken(&items[i], &mut |item| {
                    let mut items = items.clone();
                    items[i] = item;
                    visit(Value::Array(items));
                });
            }
        }
        Value::Object(fields) => {
            for name in fields.keys() {
                broken(&fields[name], &mut |field| {
                    let mut fields = fields.clone();
                    fields[name] = field;
                    visit(Value::Object(fields));
                });
                let mut less = fields.clone();
                less.remove(name);
                visit(Value::Object(less));
            }
        }
        _ => {}
    }
}

/// Reads all broken files and uses what can be read; how many could not.
fn survive<T: Serialize + DeserializeOwned>(state: &T, mut run: impl FnMut(T)) -> usize {
    let file: Value = serde_json::from_str(&written(state)).expect("JSON");
    let (mut read, mut refused) = (0, 0);
    broken(&file, &mut |broken| match serde_json::from_value(broken) {
        Ok(state) => {
            read += 1;
            run(state);
        }
        Err(_) => refused += 1,
    });
    assert!(read > 0 && refused > 0, "{read} read, {refused} refused");
    refused
}

fn small_family(value: &Vec<f64>) -> [f64; 2] {
    let [_, sum, ..] = family(value);
    [1.0, sum]
}

#[test]
fn broken_ladders_are_refused_or_run() {
    let kernels = [1.0, 0.1].map(|large| PointKernel::new(Walk, large));
    let mut rng = generator(51, 0);
    let sizes = [0.5, 0.1].map(|s| Exponential::new(s / 16.0, s));
    let mut ladder =
        Ladder::start(&Walk, &small_family, sizes, &mut rng).with_schedule(Schedule::Alternating);
    for _ in 0..30 {
        ladder.sweep(&kernels, &small_family, &mut rng, &mut Ignore);
    }
    survive(&ladder, |mut ladder| {
        let other = ladder.clone();
        for _ in 0..3 {
            ladder.sweep(&kernels, &small_family, &mut rng, &mut Ignore);
        }
        ladder.flush(&mut Ignore);
        let mut statistics = ladder.replicas()[0].statistics().clone();
        statistics.merge(other.replicas()[0].statistics());
        let mut stone = ladder.stepping_stone().clone();
        stone.merge(other.stepping_stone());
        let _ = (stone.normalisers(1.0), ladder.indices().level(1));
        assert!(
            ladder
                .replicas()
                .iter()
                .all(|r| r.densities().iter().all(|d| *d >= 0.0))
        );
    });
}

#[test]
fn broken_populations_are_refused_or_run() {
    let sizes = [0.5, 0.1].map(|s| Exponential::new(s / 16.0, s));
    let kernels = sizes.map(|mutation| LevelKernel::new(Walk, 0.1, mutation));
    let mut rng = generator(52, 0);
    let mut population = Population::start(
        3,
        &Walk,
        &small_family,
        &sizes[0],
        Resampling::Systematic,
        &mut rng,
    );
    for (level, kernel) in kernels.iter().enumerate() {
        population.advance(level, kernel, &mut rng).expect("alive");
        population.step(kernel, &small_family, &mut rng, &mut Ignore);
    }
    survive(&population, |mut population| {
        for (level, kernel) in kernels.iter().enumerate() {
            let _ = population.advance(level, kernel, &mut rng);
            population.step(kernel, &small_family, &mut rng, &mut Ignore);
        }
        population.visit(&mut Ignore);
        let _ = population.choose(&mut rng);
    });
}

#[test]
fn all_else_is_refused_or_used() {
    let mut rng = generator(53, 0);
    let mut acceptance = AcceptanceAdaptation::new(Exponential::default());
    let counts = kaustik_mcmc::Acceptance {
        proposed: 10,
        accepted: 3,
        expected: 3.5,
    };
    let _ = acceptance.end_round(&counts);
    survive(&acceptance, |mut adaptation| {
        let _ = (adaptation.end_round(&counts), adaptation.end_round(&counts));
    });
    survive(
        &JumpAdaptation::new(Exponential::default()),
        |mut adaptation| {
            for jump in [0.1, 0.2, 0.0, 0.3] {
                let _ = adaptation.end_round(jump);
            }
        },
    );
    let (mut time, mut halves, mut jumps) = (Autocorrelation::new(), Halves::new(), Jumps::new());
    for i in 0..70u32 {
        let x = f64::from(i).sin();
        time.push(x);
        halves.push(x);
        jumps.push([x]);
    }
    survive(&time, |mut time| {
        time.push(0.5);
        let _ = (time.time(), time.standard_error());
    });
    survive(&halves, |mut halves| {
        (0..70).for_each(|_| halves.push(0.5));
        let _ = halves.halves();
    });
    survive(&jumps, |mut jumps| jumps.push([0.5]));
    survive(&Pool::new([0.5, f64::NAN, 1.0]), |pool| {
        let _ = (pool.choose(&mut rng), pool.normaliser().standard_error());
    });
    let plan = Stratification::new(1, 2).with(Stream::Camera, 1);
    survive(&plan, |plan| {
        let plan = plan.with(Stream::Light, 0);
        let mut u = plan.at(3);
        assert!((0.0..1.0).contains(&u.get(Stream::Camera, 1)));
    });
    let each = PerCoordinate::new(Exponential::default()).with(
        Stream::Camera,
        1..3,
        Exponential::default(),
    );
    survive(&each, |each| {
        let _ = (each.at(Stream::Camera, 2), each.at(Stream::Light, 9));
    });
    let plan = Redistribution::new(5, 0.25).expect("a sound plan");
    let refused = survive(&plan, |plan| {
        assert!(plan.steps() > 0 && plan.unit() > 0.0);
    });
    assert!(refused > 20);
}

/// Whether a file with another value in one place is read.
fn reads<T: Serialize + DeserializeOwned>(state: &T, path: &str, value: &Value) -> bool {
    let mut file: Value = serde_json::from_str(&written(state)).expect("JSON");
    *file.pointer_mut(path).unwrap_or_else(|| panic!("{path}")) = value.clone();
    serde_json::from_value::<T>(file).is_ok()
}

fn assert_refused<T: Serialize + DeserializeOwned>(state: &T, places: &[(&str, Value)]) {
    for (path, value) in places {
        assert!(!reads(state, path, value), "{path} = {value} was read");
    }
}

/// The places that a check was written for, each by a file that breaks it alone.
#[test]
fn what_cannot_be_is_refused() {
    let mut rng = generator(54, 0);
    let sizes = [Exponential::default(); 2];
    let ladder = Ladder::start(&Walk, &small_family, sizes, &mut rng);
    assert!(reads(&ladder, "/turn", &json!(7)));
    assert_refused(
        &ladder,
        &[
            ("/turn", json!(u64::MAX)),
            ("/replicas", json!([])),
            ("/replicas/0/level", json!(1)),
            ("/replicas/1/level", json!(2)),
            ("/replicas/0/densities", json!([1.0])),
            ("/replicas/0/densities", json!([1.0, 1.0, 1.0])),
            ("/replicas/0/densities/1", json!(-1.0)),
            ("/replicas/0/pending/weight", json!(-1.0)),
            // what a reader makes of it that rounds twice
            ("/replicas/0/exact/0", json!(182.075_663_777_778_77)),
            ("/replicas/0/state/time", json!(-1)),
            ("/replicas/0/state/time", json!(i64::MAX)),
            ("/replicas/0/state/large_time", json!(1)),
            ("/replicas/0/state/streams/0/0/0", json!(1.0)),
            ("/replicas/0/state/streams/0/0/1", json!(1)),
            ("/replicas/0/state/streams/0/0/2", json!(-2)),
            ("/replicas/0/state/streams", json!([[], []])),
            ("/replicas/0/state/mutation/1", json!(0.75)),
            ("/graph", json!([[0, 2]])),
            ("/graph", json!([[0, 1], [1, 0]])),
            ("/indices/lineages", json!([1, 1])),
            ("/stepping_stone/below", json!([0, 1])),
            ("/statistics/swaps", json!([[], []])),
            ("/statistics/rounds", json!(u64::MAX)),
        ],
    );
    // A coordinate that slept for 2^40 steps: drawn anew if these mix, replayed for an hour if not.
    let asleep = |sizes: [f64; 2]| {
        json!({
            "mutation": sizes,
            "time": 1u64 << 40,
            "large_time": 0,
            "streams": [[[0.5, 3, 3]], [], [], [], [], [], []],
        })
    };
    let state = "/replicas/0/state";
    assert!(reads(&ladder, state, &asleep([0.01, 0.1])));
    assert_refused(&ladder, &[(state, asleep([0.1, 0.1]))]);
    let chain = ladder.replicas()[1].clone();
    assert!(reads(&chain, "/level", &json!(0)));
    assert_refused(&chain, &[("/level", json!(2)), ("/level", json!(-1))]);
    let scheme = Resampling::Systematic;
    let population = Population::start(3, &Walk, &small_family, &sizes[0], scheme, &mut rng);
    assert!(reads(&population, "/founders/0", &json!(2)));
    assert_refused(
        &population,
        &[
            ("/founders/0", json!(3)),
            ("/founders", json!([0, 1])),
            ("/particles/1/level", json!(1)),
            ("/level", json!(2)),
        ],
    );
}
