//! Replays against renders, event by event: all that a render tells on one thread is what replays of its steps tell, bit for
//! bit.

use kaustik_path::{Event, Role, Side, trace};
use kaustik_scene::Scene;

use crate::engine::Engine;
use crate::render::engine;
use crate::state::{Header, Snapshot};
use crate::threads::pool;
use crate::{Budget, Method, Pace, Place, RenderSettings, replay, replay_from, small};

const SIDE: u32 = 6;

fn scene() -> Scene {
    small::scene("cornell", [SIDE; 2])
}

fn settings(method: Method) -> RenderSettings {
    let mut settings = RenderSettings {
        max_depth: 4,
        threads: 1,
        seed: 5,
        budget: Budget::PerPixel(3),
        features: false,
        ..small::settings(method, [SIDE; 2])
    };
    let options = &mut settings.options;
    options.ladders = 2;
    options.pilot = 1000;
    options.particles = 1000;
    options.photon.remainder = false;
    options.photon.burn_in = 3;
    // Wide enough for some to be met, and not by every photon.
    options.photon.radius = 0.5;
    settings
}

/// What an engine tells when it takes so many of its grains, on one thread.
fn told(engine: &mut dyn Engine, settings: &RenderSettings, grains: u64) -> Vec<Event> {
    let ladders = settings.ladder_range();
    let grain = |ladder: u32| engine.grain(ladder).min(engine.planned(ladder, settings));
    let plan: Vec<u64> = ladders.map(|ladder| grains * grain(ladder)).collect();
    let events = trace(|| engine.advance(&plan, None)).1;
    assert!(events.len() < 1 << 20, "all are written down");
    events
}

/// Cuts before every event of a kind; what comes before the first is left out.
pub(crate) fn cut(events: &[Event], begins: impl Fn(&Event) -> bool) -> Vec<&[Event]> {
    let at: Vec<usize> = (0..events.len()).filter(|&i| begins(&events[i])).collect();
    let ends = at.iter().skip(1).copied().chain([events.len()]);
    at.iter()
        .zip(ends)
        .map(|(&from, to)| &events[from..to])
        .collect()
}

/// Every path of a round of `annealing`.
#[test]
fn rounds_are_retold() {
    let scene = scene();
    let mut settings = settings(Method::Annealing);
    settings.budget = Budget::Total(3);
    let pool = pool(settings.threads).expect("threads");
    let (events, cost) = pool.install(|| {
        let mut engine = engine(&scene, &settings).expect("an engine");
        let cost = engine.grain(0);
        let plan = [3 * cost, 0];
        (trace(|| engine.advance(&plan, None)).1, cost)
    });
    let paths = cut(&events, |event| *event == Event::Begin);
    assert!(paths.len() as u64 >= 3 * cost, "{} {cost}", paths.len());
    // Ladders take rounds in turn.
    for (round, ladder, of_ladder) in [(0, 0, 0), (1, 1, 0), (2, 0, 1)] {
        // Of all levels; samples, and either step of a particle.
        for within in (0..cost)
            .step_by(cost as usize / 9)
            .chain([999, 1000, 1001, cost - 1])
        {
            for threads in [1, 3] {
                let settings = RenderSettings {
                    threads,
                    ..settings.clone()
                };
                let step = of_ladder * cost + within;
                let shown = replay(&scene, &settings, Place { ladder, step }).expect("events");
                let index = Event::Index {
                    of: "round",
                    number: of_ladder,
                };
                assert_eq!(shown[0], index);
                let shown: Vec<Event> = shown
                    .into_iter()
                    .filter(|e| !matches!(e, Event::Index { .. } | Event::Decision { .. }))
                    .collect();
                assert!(
                    shown == paths[(round * cost + within) as usize],
                    "{round} {within}"
                );
            }
        }
    }
}

/// What a light path is made of, and what it brings.
fn is_of_light(event: &&Event) -> bool {
    match event {
        Event::Start { side, .. }
        | Event::Vertex { side, .. }
        | Event::Escape { side, .. }
        | Event::Scatter { side, .. }
        | Event::Roulette { side, .. } => *side == Side::Light,
        Event::Photon { .. } | Event::Visit { .. } | Event::Deposit { .. } => true,
        _ => false,
    }
}

/// A replay of a step of a chain of photons in its parts.
#[derive(Debug)]
struct Shown {
    current: Vec<Event>,
    /// With what the step reports; nothing of a chain that rests.
    proposed: Vec<Event>,
    /// What the chain reports in exchanges after it.
    after: Vec<Event>,
}

fn parts(events: &[Event]) -> Shown {
    let at = |wanted: fn(&Event) -> bool| events.iter().position(wanted);
    let current = at(|e| {
        matches!(
            e,
            Event::LightPath {
                role: Role::Current
            }
        )
    })
    .expect("a path");
    let proposed = at(|e| {
        matches!(
            e,
            Event::LightPath {
                role: Role::Proposed
            }
        )
    });
    let decided = at(|e| matches!(e, Event::Decision { .. }));
    assert_eq!(proposed.is_some(), decided.is_some());
    let part = |range: std::ops::Range<usize>| -> Vec<Event> {
        let events = events[range].iter();
        events.filter(is_of_light).copied().collect()
    };
    let Some((proposed, decided)) = proposed.zip(decided) else {
        // It rests: first the path, then what it reports.
        let told = part(current..events.len());
        let (current, after) = told.split_at(walk(&told).len());
        return Shown {
            current: current.to_vec(),
            proposed: Vec::new(),
            after: after.to_vec(),
        };
    };
    Shown {
        current: part(current..proposed),
        proposed: part(proposed..decided),
        after: part(decided..events.len()),
    }
}

/// Visits of one chain with their deposits.
fn of_chain(events: &[Event], chain: usize) -> Vec<Event> {
    let visits = cut(events, |event| matches!(event, Event::Visit { .. }));
    let own = visits
        .into_iter()
        .filter(|visit| matches!(visit[0], Event::Visit { level, .. } if level as usize == chain));
    own.flatten().copied().collect()
}

/// Steps of all chains of two ladders in several iterations: the path where the chain is was told before, the one that it may go
/// to and what falls on the image is what the render told there. A chain that rests goes nowhere.
#[test]
fn chains_of_photons_are_retold() {
    let even = [1; 4];
    for (method, chains, pace) in [
        (Method::PhotonVisibility, 2, even),
        (Method::PhotonDensity, 2, even),
        (Method::PhotonSpatial, 4, even),
        (Method::PhotonSpatial, 4, [1, 8, 8, 8]),
        (Method::PhotonImage, 4, [3, 2, 2, 1]),
    ] {
        let mut settings = settings(method);
        // As few as give two ladders, of uneven length.
        settings.options.photon.photons = 2 * 16_384 + chains as u64;
        settings.options.photon.pace = Pace::Periods(pace);
        retell_photons(&settings, &pace[..chains]);
    }
}

fn retell_photons(settings: &RenderSettings, periods: &[u32]) {
    const ITERATIONS: u64 = 2;
    let (scene, method, chains) = (scene(), settings.method, periods.len());
    let burn_in = settings.options.photon.burn_in;
    let steps = |chain: usize, sweep: u64| {
        let told = sweep.checked_sub(burn_in);
        told.is_none_or(|told| told.is_multiple_of(u64::from(periods[chain])))
    };
    let rate: f64 = periods.iter().map(|&period| 1.0 / f64::from(period)).sum();
    let all = (settings.options.photon.photons as f64 / rate).ceil() as u64;
    let sweeps = [0, 1].map(|ladder| all / 2 + u64::from(ladder < all % 2) + burn_in);
    let pool = pool(settings.threads).expect("threads");
    let told: Vec<Vec<Event>> = pool.install(|| {
        let mut engine = engine(&scene, settings).expect("an engine");
        let mut told = || {
            let events = told(engine.as_mut(), settings, 1);
            events.into_iter().filter(|e| is_of_light(&e)).collect()
        };
        (0..ITERATIONS).map(|_| told()).collect()
    });
    // Light paths before a sweep.
    let before = |ladder: usize, sweep: u64| {
        let mut ladders = sweeps[..ladder].iter().copied().chain([sweep]);
        let of = |chain| move |sweep: &u64| steps(chain, *sweep);
        let in_all = |sweeps: u64| -> usize {
            (0..chains)
                .map(|chain| (0..sweeps).filter(of(chain)).count())
                .sum()
        };
        // States are read anew, then ladder after ladder sweeps.
        2 * chains + ladders.by_ref().map(in_all).sum::<usize>()
    };
    let mut deposits = 0;
    for (iteration, events) in (0..).zip(&told) {
        let paths = cut(events, |event| matches!(event, Event::Start { .. }));
        assert_eq!(paths.len(), before(1, sweeps[1]), "{method}");
        for (ladder, sweep) in [
            (0, 0),
            (0, burn_in),
            (0, 77),
            (0, sweeps[0] - 1),
            (1, 1),
            (1, burn_in + 2048),
            (1, sweeps[1] - 1),
        ] {
            let what = format!("{method} {periods:?} {iteration} {ladder} {sweep}");
            let mut next = before(ladder, sweep);
            let shown: Vec<Shown> = (0..chains)
                .map(|chain| {
                    let sweep = iteration * sweeps[ladder] + sweep;
                    let place = Place {
                        ladder: ladder as u32,
                        step: sweep * chains as u64 + chain as u64,
                    };
                    parts(&replay(&scene, settings, place).expect("events"))
                })
                .collect();
            let mut rest: &[Event] = &[];
            for (chain, shown) in shown.iter().enumerate() {
                // Light paths that the render has told so far, without what they brought.
                let mut known = paths[..next].iter().map(|path| walk(path));
                assert!(
                    known.any(|path| path == walk(&shown.current)),
                    "{what} {chain}"
                );
                if !steps(chain, sweep) {
                    assert!(shown.proposed.is_empty(), "{what} {chain}");
                    continue;
                }
                assert!(rest.is_empty(), "{what} {chain}");
                assert!(paths[next].starts_with(&shown.proposed), "{what} {chain}");
                rest = &paths[next][shown.proposed.len()..];
                next += 1;
            }
            // The exchanges, and at the end of a half what is still to be reported.
            for (chain, shown) in shown.iter().enumerate() {
                assert!(of_chain(rest, chain) == shown.after, "{what} {chain}");
                let both = shown.proposed.iter().chain(&shown.after);
                deposits += both.filter(|e| matches!(e, Event::Deposit { .. })).count();
            }
        }
    }
    assert!(deposits > 20, "{method} {periods:?}: {deposits}");
}

/// A light path without its visits.
fn walk(events: &[Event]) -> &[Event] {
    let end = events.iter().position(|e| matches!(e, Event::Visit { .. }));
    &events[..end.unwrap_or(events.len())]
}

/// A replay from a state is that from the start, on any number of threads.
#[test]
fn states_change_nothing() {
    let scene = scene();
    for method in [Method::PhotonSpatial, Method::PhotonVisibility] {
        let mut settings = settings(method);
        settings.options.photon.photons = 40_000;
        let pool = pool(settings.threads).expect("threads");
        let state = pool.install(|| {
            let mut engine = engine(&scene, &settings).expect("an engine");
            told(engine.as_mut(), &settings, 2);
            let header = Header::new(&scene, &settings, 0.0);
            Snapshot::new(header, engine.as_ref())
                .state()
                .expect("a state")
        });
        for step in [3_000, 30_000, 100_001, 170_000] {
            let place = Place { ladder: 1, step };
            let mut all = Vec::new();
            for (state, threads) in [(None, 1), (None, 3), (Some(&state), 1), (Some(&state), 3)] {
                let settings = RenderSettings {
                    threads,
                    ..settings.clone()
                };
                let mut ahead = 0;
                let shown = replay_from(&scene, &settings, state, place, &mut |n| ahead = n);
                all.push((shown.expect("events"), ahead));
            }
            for (shown, _) in &all {
                assert!(*shown == all[0].0, "{method} {step}");
            }
            let [start, .., state] = &all[..] else {
                unreachable!("four of them")
            };
            let iteration = match start.0[0] {
                Event::Index { number, .. } => number,
                _ => panic!("{:?}", start.0[0]),
            };
            assert_eq!(start.1, iteration, "{method} {step}");
            // A state that is past the step is of no use.
            let due = iteration.checked_sub(2).unwrap_or(iteration);
            assert_eq!(state.1, due, "{method} {step}");
        }
    }
}
