//! Replays against renders, event by event: all that a render tells on one thread is what replays of its
//! steps tell, bit for bit.

use kaustik_path::{Event, Role, Side, trace};
use kaustik_scene::Scene;

use crate::engine::Engine;
use crate::methods::engine;
use crate::state::{Header, Snapshot};
use crate::threads::pool;
use crate::{Budget, Method, Pace, RenderSettings, StepId, replay, replay_from, small};

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
    options.photon.burn_in = Some(3);
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
                let shown = replay(&scene, &settings, StepId { ladder, step }).expect("events");
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

/// Steps of all chains of two ladders in several iterations: the path where the chain is was told before, the
/// one that it may go to and what falls on the image is what the render told there. A chain that rests goes
/// nowhere.
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
        settings.options.photon.photons = Some(2 * 16_384 + chains as u64);
        settings.options.photon.pace = Pace::Periods(pace);
        // So that many land.
        settings.options.photon.radius = 2.0;
        retell_photons(&settings, &pace[..chains]);
    }
}

fn retell_photons(settings: &RenderSettings, periods: &[u32]) {
    const ITERATIONS: u64 = 2;
    let (scene, method) = (scene(), settings.method);
    let course = Course::new(settings, periods);
    let (burn_in, [first, second]) = (course.burn_in, course.sweeps);
    let mut deposits = 0;
    for (iteration, events) in (0..).zip(&iterations(&scene, settings, ITERATIONS)) {
        let paths = cut(events, |event| matches!(event, Event::Start { .. }));
        assert_eq!(paths.len(), course.before(1, second), "{method}");
        for (ladder, sweep) in [
            (0, 0),
            (0, burn_in),
            (0, 77),
            (0, first - 1),
            (1, 1),
            (1, burn_in + 2048),
            (1, second - 1),
        ] {
            let what = format!("{method} {periods:?} {iteration} {ladder} {sweep}");
            let shown = course.replays(&scene, settings, ladder, iteration, sweep);
            assert_retold(&shown, &paths, &course, (ladder, sweep), &what);
            let told = shown.iter().flat_map(|s| s.proposed.iter().chain(&s.after));
            deposits += told.filter(|e| matches!(e, Event::Deposit { .. })).count();
        }
    }
    assert!(deposits > 20, "{method} {periods:?}: {deposits}");
}

/// What a render tells of light paths in each of its first iterations.
fn iterations(scene: &Scene, settings: &RenderSettings, count: u64) -> Vec<Vec<Event>> {
    pool(settings.threads).expect("threads").install(|| {
        let mut engine = engine(scene, settings).expect("an engine");
        let mut told = || {
            let events = told(engine.as_mut(), settings, 1);
            events.into_iter().filter(|e| is_of_light(&e)).collect()
        };
        (0..count).map(|_| told()).collect()
    })
}

/// When the chains of two ladders take their steps in an iteration.
struct Course<'a> {
    periods: &'a [u32],
    burn_in: u64,
    /// Of each ladder.
    sweeps: [u64; 2],
}

impl<'a> Course<'a> {
    fn new(settings: &RenderSettings, periods: &'a [u32]) -> Self {
        let photon = &settings.options.photon;
        let rate: f64 = periods.iter().map(|&period| 1.0 / f64::from(period)).sum();
        let all = (settings.photons() as f64 / rate).ceil() as u64;
        let burn_in = photon.burn_in.expect("one is set");
        Self {
            periods,
            burn_in,
            sweeps: [0, 1].map(|ladder| all / 2 + u64::from(ladder < all % 2) + burn_in),
        }
    }

    /// Does a chain take a step in a sweep?
    fn steps(&self, chain: usize, sweep: u64) -> bool {
        let told = sweep.checked_sub(self.burn_in);
        told.is_none_or(|told| told.is_multiple_of(u64::from(self.periods[chain])))
    }

    /// Light paths that an iteration tells before a sweep.
    fn before(&self, ladder: usize, sweep: u64) -> usize {
        let chains = self.periods.len();
        let steps = |sweeps: u64| -> usize {
            (0..chains)
                .map(|chain| (0..sweeps).filter(|&at| self.steps(chain, at)).count())
                .sum()
        };
        // States are read anew, then ladder after ladder sweeps.
        let earlier: usize = self.sweeps[..ladder].iter().map(|&all| steps(all)).sum();
        2 * chains + earlier + steps(sweep)
    }

    /// Replays of the steps of all chains in a sweep.
    fn replays(
        &self,
        scene: &Scene,
        settings: &RenderSettings,
        ladder: usize,
        iteration: u64,
        sweep: u64,
    ) -> Vec<Shown> {
        let sweep = iteration * self.sweeps[ladder] + sweep;
        let chains = self.periods.len() as u64;
        let replay_of = |chain: u64| {
            let place = StepId {
                ladder: ladder as u32,
                step: sweep * chains + chain,
            };
            parts(&replay(scene, settings, place).expect("events"))
        };
        (0..chains).map(replay_of).collect()
    }
}

/// What replays show of a sweep is what the render has told, which is cut into light paths.
fn assert_retold(
    shown: &[Shown],
    paths: &[&[Event]],
    course: &Course<'_>,
    (ladder, sweep): (usize, u64),
    what: &str,
) {
    let mut next = course.before(ladder, sweep);
    let mut rest: &[Event] = &[];
    for (chain, shown) in shown.iter().enumerate() {
        // Light paths that the render has told so far, without what they brought.
        let mut known = paths[..next].iter().map(|path| walk(path));
        assert!(
            known.any(|path| path == walk(&shown.current)),
            "{what} {chain}"
        );
        if !course.steps(chain, sweep) {
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
        settings.options.photon.photons = Some(40_000);
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
            let place = StepId { ladder: 1, step };
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
