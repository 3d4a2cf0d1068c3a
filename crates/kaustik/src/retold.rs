//! Replays against renders, event by event: all that a render tells on one thread is what replays of its steps tell, bit for
//! bit.

use kaustik_path::{Event, Role, Side, trace};
use kaustik_scene::Scene;

use crate::engine::Engine;
use crate::render::engine;
use crate::state::{Header, Snapshot};
use crate::threads::pool;
use crate::{Budget, Method, Place, RenderSettings, replay, replay_from, small};

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
    /// With what the step reports.
    proposed: Vec<Event>,
    /// What the chain reports in exchanges after it.
    after: Vec<Event>,
}

fn parts(events: &[Event]) -> Shown {
    let at = |wanted: &Event| events.iter().position(|e| e == wanted).expect("an event");
    let path = |role| at(&Event::LightPath { role });
    let [from, to] = [path(Role::Current), path(Role::Proposed)];
    let decided = events
        .iter()
        .position(|e| matches!(e, Event::Decision { .. }));
    let decided = decided.expect("a decision");
    let part = |range: std::ops::Range<usize>| {
        let events = events[range].iter();
        events.filter(is_of_light).copied().collect()
    };
    Shown {
        current: part(from..to),
        proposed: part(to..decided),
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
/// to and what falls on the image is what the render told there.
#[test]
fn chains_of_photons_are_retold() {
    const ITERATIONS: u64 = 2;
    let scene = scene();
    for (method, chains) in [
        (Method::PhotonVisibility, 2),
        (Method::PhotonDensity, 2),
        (Method::PhotonSpatial, 4),
        (Method::PhotonImage, 4),
    ] {
        let mut settings = settings(method);
        // As few as give two ladders, one sweep uneven.
        let photons = 2 * chains as u64 * 4096 + chains as u64;
        settings.options.photon.photons = photons;
        let burn_in = settings.options.photon.burn_in;
        let sweeps = [4097 + burn_in, 4096 + burn_in];
        let pool = pool(settings.threads).expect("threads");
        let told: Vec<Vec<Event>> = pool.install(|| {
            let mut engine = engine(&scene, &settings).expect("an engine");
            let mut told = || {
                let events = told(engine.as_mut(), &settings, 1);
                events.into_iter().filter(|e| is_of_light(&e)).collect()
            };
            (0..ITERATIONS).map(|_| told()).collect()
        });
        let mut deposits = 0;
        for (iteration, events) in (0..).zip(&told) {
            let paths = cut(events, |event| matches!(event, Event::Start { .. }));
            // States are read anew, then ladder after ladder sweeps.
            let read = 2 * chains;
            let all = sweeps.iter().sum::<u64>() as usize;
            assert_eq!(paths.len(), read + all * chains, "{method}");
            for (ladder, sweep) in [
                (0, 0),
                (0, burn_in),
                (0, 77),
                (0, 4099),
                (1, 1),
                (1, 2050),
                (1, 4098),
            ] {
                let before = if ladder == 0 { 0 } else { sweeps[0] };
                let first = read + (before + sweep) as usize * chains;
                let shown: Vec<Shown> = (0..chains)
                    .map(|chain| {
                        let sweep = iteration * sweeps[ladder as usize] + sweep;
                        let step = sweep * chains as u64 + chain as u64;
                        let place = Place { ladder, step };
                        let shown = replay(&scene, &settings, place).expect("events");
                        parts(&shown)
                    })
                    .collect();
                let mut rest: &[Event] = &[];
                for (chain, shown) in shown.iter().enumerate() {
                    let path = paths[first + chain];
                    let what = format!("{method} {iteration} {ladder} {sweep} {chain}");
                    assert!(path.starts_with(&shown.proposed), "{what}");
                    rest = &path[shown.proposed.len()..];
                    assert!(rest.is_empty() || chain + 1 == chains, "{what}");
                    // Light paths that the render has told so far, without what they brought.
                    let here = &paths[..first + chain];
                    let known = (here.iter().map(|path| walk(path)))
                        .any(|path| path == walk(&shown.current));
                    assert!(known, "{what}");
                }
                // The exchanges, and at the end of a half what is still to be reported.
                for (chain, shown) in shown.iter().enumerate() {
                    let own = of_chain(rest, chain);
                    assert!(
                        own == shown.after,
                        "{method} {iteration} {ladder} {sweep} {chain}"
                    );
                    let both = shown.proposed.iter().chain(&shown.after);
                    deposits += both.filter(|e| matches!(e, Event::Deposit { .. })).count();
                }
            }
        }
        assert!(deposits > 20, "{method}: {deposits}");
    }
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
