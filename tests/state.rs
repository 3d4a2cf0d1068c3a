//! States: resumed, merged, refused.

use std::sync::atomic::{AtomicBool, Ordering};

use kaustik::estimate::Refinement;
use kaustik::film::Filter;
use kaustik::scene::Scene;
use kaustik::{
    Budget, Control, Direct, Energy, Method, Mis, Normalisation, Options, Outcome, Progress,
    RenderError, RenderSettings, Rendered, Snapshot, Source, StageLadder, State, StateError, Steps,
    TargetFunction, Watch, merge, merged_settings, render_watched, resume,
};

use crate::bits::bits;
use crate::support::{picture, scene, settings};

pub(crate) const SIDE: u32 = 20;

pub(crate) fn a_scene() -> Scene {
    scene("glass-cube?light=0.8", SIDE)
}

/// Keeps states: the last, or all; may look at pictures as well.
#[derive(Default)]
pub(crate) struct Keeper {
    all: bool,
    looks: bool,
    pub(crate) states: Vec<Vec<u8>>,
}

impl Watch for Keeper {
    fn wants_image(&mut self, _: &Progress) -> bool {
        self.looks
    }

    fn see_image(&mut self, _: Rendered) {}

    fn wants_state(&mut self, _: &Progress, last: bool) -> bool {
        last || self.all
    }

    fn see_state(&mut self, snapshot: &Snapshot<'_>) {
        let bytes = snapshot.bytes(&Source::default());
        self.states.push(bytes.expect("a state can be written"));
    }
}

/// The bytes of a render's last state.
pub(crate) fn last_state(scene: &Scene, settings: &RenderSettings) -> Vec<u8> {
    let mut keeper = Keeper::default();
    render_watched(scene, settings, &mut Control::default(), &mut keeper).expect("a render");
    keeper.states.pop().expect("a state")
}

/// What a state keeps: all but the header, which has the time, and the checksum. Sums of films differ in it where
/// pictures round the difference away.
fn kept(bytes: &[u8]) -> &[u8] {
    let header = bytes[17..25].try_into().map(u64::from_le_bytes);
    &bytes[25 + header.expect("a length") as usize..bytes.len() - 32]
}

pub(crate) fn read(bytes: &[u8]) -> State {
    State::from_bytes(bytes.to_vec()).expect("what was written")
}

pub(crate) fn resumed(
    scene: &Scene,
    settings: &RenderSettings,
    bytes: &[u8],
) -> Result<Rendered, RenderError> {
    let nobody = &mut Keeper::default();
    resume(
        scene,
        settings,
        read(bytes),
        &mut Control::default(),
        nobody,
    )
}

/// Every method that keeps states, and settings under which it keeps more or other things.
pub(crate) fn cases() -> Vec<(String, RenderSettings)> {
    let settings = |method| {
        let mut settings = settings(method, SIDE, 12);
        settings.options.photon.photons = Some(1_000);
        if method == Method::Annealing {
            // several rounds, each of 1,000 particles
            settings.options.particles = 1_000;
            settings.budget = Budget::PerPixel(120);
        }
        // What another method reads is in no state: as on the command line.
        let entries = settings.options.entries(method);
        settings.options = Options::default();
        for (key, value) in entries {
            let set = settings.options.set(method, &format!("{key}={value}"));
            set.expect("a setting of the method");
        }
        settings
    };
    let mut cases: Vec<_> = Method::ALL
        .into_iter()
        .map(|method| (method.to_string(), settings(method)))
        .collect();
    let mut add = |what: &str, method, change: fn(&mut RenderSettings)| {
        let mut settings = settings(method);
        change(&mut settings);
        cases.push((format!("{method} {what}"), settings));
    };
    // Direct light has an eighth of the passes: so many that parts of them have other eighths.
    for method in [Method::Pssmlt, Method::Mmlt, Method::Relt, Method::Mlt] {
        add("apart", method, |s| {
            s.options.direct = Direct::Apart;
            s.budget = Budget::PerPixel(30);
        });
    }
    // A pass of the meter falls due every thousand mutations or so.
    for method in [Method::Pssmlt, Method::Mmlt, Method::Mlt] {
        add("metered", method, |s| s.options.pilot = 1_000);
    }
    // Lamps have a pass each 16: the whole more than any share.
    add("long", Method::Pssmlt, |s| s.budget = Budget::PerPixel(40));
    add("printed", Method::Pssmlt, |s| s.options.mis = Mis::Printed);
    add("off, few ladders", Method::Pssmlt, |s| {
        s.options.mis = Mis::Off;
        s.options.ladders = 3;
    });
    // Steps learn after a thousand sweeps of a ladder.
    add("adapted", Method::Relt, |s| {
        s.options.steps = Steps::Adapted;
        s.options.ladders = 3;
        s.budget = Budget::PerPixel(80);
    });
    add("few ladders", Method::Annealing, |s| s.options.ladders = 3);
    add("by passes, filtered", Method::Erpt, |s| {
        s.options.energy = Energy::Passes;
        s.options.consecutive = Some(2);
        s.options.proposed = Some(1.5);
    });
    add("filtered", Method::ErptPss, |s| {
        s.options.consecutive = Some(1);
    });
    add("shrinking", Method::Sppm, |s| {
        s.options.photon.reduction = Some(0.7);
    });
    add("with maps", Method::PhotonSpatial, |s| {
        s.options.photon.maps = true;
        s.features = true;
    });
    add("by second moments", Method::PhotonImage, |s| {
        s.options.photon.target_function = TargetFunction::SecondMoment;
        s.options.photon.refinement = Refinement::Iterations;
        s.options.photon.normalisation = Normalisation::Progressive;
        s.options.photon.reduction = None;
    });
    add("in the middle of a pass", Method::Path, |s| {
        s.budget = Budget::Total(12 * u64::from(SIDE * SIDE) + 77);
    });
    // Some steps of a ladder short of a stage's end, and beyond the last.
    for method in [Method::MltMultistage, Method::PssmltMultistage] {
        add("of many stages", method, |s| {
            s.options.ladders = 3;
            s.options.stages.budget = 8;
        });
        add("of two stages", method, |s| {
            s.options.ladders = 3;
            s.options.stages.ladder = StageLadder::Two;
        });
    }
    add("filtered", Method::Path, |s| {
        s.filter = Filter::new("tent", Some(1.5)).expect("a filter");
    });
    cases
}

/// About a third of what was asked.
fn shorter(settings: &RenderSettings) -> RenderSettings {
    let budget = match settings.budget {
        Budget::PerPixel(n) => Budget::PerPixel(n / 3),
        Budget::Total(n) => Budget::Total(n / 3),
        Budget::Time(time) => Budget::Time(time / 3),
    };
    RenderSettings {
        budget,
        ..settings.clone()
    }
}

/// More than was asked.
fn longer(settings: &RenderSettings) -> RenderSettings {
    let budget = match settings.budget {
        Budget::PerPixel(n) => Budget::PerPixel(n + 5),
        Budget::Total(n) => Budget::Total(n * 2),
        Budget::Time(time) => Budget::Time(time * 2),
    };
    RenderSettings {
        budget,
        ..settings.clone()
    }
}

#[test]
fn a_resumed_render_has_the_bits_of_one_that_went_through() {
    let scene = a_scene();
    for (what, settings) in cases() {
        let through = bits(&picture(&scene, &settings));
        assert!(through.iter().any(|&v| v != 0), "{what}");
        let state = last_state(&scene, &shorter(&settings));
        let part = bits(&picture(&scene, &shorter(&settings)));
        assert!(part != through, "{what}: nothing was left to do");
        let whole = last_state(&scene, &settings);
        for threads in [1, 2, 3, 8] {
            let settings = RenderSettings {
                threads,
                ..settings.clone()
            };
            let mut keeper = Keeper::default();
            let control = &mut Control::default();
            let done = resume(&scene, &settings, read(&state), control, &mut keeper);
            let done = done.expect("a render");
            assert!(bits(&done.image) == through, "{what}, {threads} threads");
            assert_eq!(done.outcome, Outcome::Complete);
            assert!(
                kept(&keeper.states[0]) == kept(&whole),
                "{what}, {threads} threads"
            );
        }
    }
}

/// States and pictures on the way, after every round, change nothing; each of the states leads to the end.
#[test]
fn states_and_pictures_on_the_way_change_nothing() {
    let scene = a_scene();
    for (what, settings) in cases() {
        let alone = bits(&picture(&scene, &settings));
        let mut keeper = Keeper {
            all: true,
            looks: true,
            ..Keeper::default()
        };
        let watched = render_watched(&scene, &settings, &mut Control::default(), &mut keeper);
        assert!(bits(&watched.expect("a render").image) == alone, "{what}");
        assert!(keeper.states.len() >= 2, "{what}");
        let last = keeper.states.last().expect("a state");
        assert!(kept(last) == kept(&last_state(&scene, &settings)), "{what}");
        for (round, state) in keeper.states.iter().enumerate() {
            let done = resumed(&scene, &settings, state).expect("a render");
            assert!(bits(&done.image) == alone, "{what}, after round {round}");
        }
    }
}

/// Stopped in the middle of a round, wherever each ladder is.
#[test]
fn a_stopped_render_goes_on() {
    let scene = a_scene();
    for (what, settings) in cases() {
        let through = bits(&picture(&scene, &settings));
        let stop = AtomicBool::new(false);
        let mut keeper = Keeper::default();
        let mut rounds = 0;
        let mut tell = |_: &Progress| {
            rounds += 1;
            stop.store(rounds >= 2, Ordering::Relaxed);
        };
        let mut control = Control {
            stop: Some(&stop),
            progress: Some(&mut tell),
        };
        let stopped = render_watched(&scene, &settings, &mut control, &mut keeper);
        assert_eq!(stopped.expect("a render").outcome, Outcome::Stopped);
        // And once more, before it could do anything at all.
        let state = read(keeper.states.last().expect("a state"));
        let mut again = Keeper::default();
        let mut control = Control {
            stop: Some(&stop),
            progress: None,
        };
        resume(&scene, &settings, state, &mut control, &mut again).expect("a render");
        let state = again.states.last().expect("a state");
        let done = resumed(&scene, &settings, state).expect("a render");
        assert!(bits(&done.image) == through, "{what}");
    }
}

/// The states of these shares of a render.
pub(crate) fn shares(scene: &Scene, settings: &RenderSettings, bounds: &[u32]) -> Vec<State> {
    let ranges = bounds.windows(2).map(|pair| pair[0]..pair[1]);
    let share = |range| RenderSettings {
        ladders: Some(range),
        ..settings.clone()
    };
    ranges
        .map(|range| read(&last_state(scene, &share(range))))
        .collect()
}

pub(crate) fn merged(scene: &Scene, states: &[State], keeper: &mut Keeper) -> Rendered {
    let settings = RenderSettings {
        features: false,
        ..merged_settings(states).expect("shares of one render")
    };
    merge(scene, &settings, states, keeper).expect("a picture")
}

#[test]
fn shares_add_up_to_the_whole() {
    assert_shares_add_up(|count| vec![0, count / 3, count / 2 + 1, count - 1, count]);
}

#[test]
#[ignore = "long"]
fn halves_add_up_to_the_whole() {
    assert_shares_add_up(|count| vec![0, count / 2, count]);
}

/// `bounds`: where so many ladders are parted.
fn assert_shares_add_up(bounds: fn(u32) -> Vec<u32>) {
    let scene = a_scene();
    for (what, settings) in cases() {
        if !settings.method.has_shares() {
            let half = RenderSettings {
                ladders: Some(0..settings.options.ladders / 2),
                ..settings
            };
            let refused = render_watched(
                &scene,
                &half,
                &mut Control::default(),
                &mut Keeper::default(),
            );
            let why = refused.expect_err("no share").to_string();
            assert!(why.contains("all of them: the iterations"), "{what}: {why}");
            continue;
        }
        let one = bits(&picture(&scene, &settings));
        let through = last_state(&scene, &settings);
        let count = settings.options.ladders;
        let mut bounds = bounds(count);
        bounds.dedup();
        let mut states = shares(&scene, &settings, &bounds);
        let mut keeper = Keeper::default();
        let all = merged(&scene, &states, &mut keeper);
        assert!(bits(&all.image) == one, "{what}: {bounds:?}");
        states.reverse();
        let all = merged(&scene, &states, &mut Keeper::default());
        assert!(bits(&all.image) == one, "{what}: {bounds:?} reversed");
        // The state of the whole is that of one process: it goes on as one.
        let more = longer(&settings);
        let state = keeper.states.last().expect("a state");
        assert!(kept(state) == kept(&through), "{what}: {bounds:?} kept");
        let on = resumed(&scene, &more, state).expect("a render");
        assert!(
            bits(&on.image) == bits(&picture(&scene, &more)),
            "{what}: {bounds:?} gone on"
        );
    }
}

#[test]
fn shares_that_do_not_add_up_are_refused() {
    let scene = a_scene();
    let settings = settings(Method::Path, SIDE, 4);
    let states = shares(&scene, &settings, &[0, 8, 20, 64]);
    let fault = |states: &[State]| merged_settings(states).expect_err("no whole").to_string();
    let pair = |a: usize, b: usize| fault(&[states[a].clone(), states[b].clone()]);
    assert!(pair(0, 2).contains("0..8 and 20..64 leave a gap"));
    assert!(pair(1, 1).contains("8..20 and 8..20 overlap"));
    assert!(fault(&[]).contains("none"));
    let seeded = RenderSettings {
        seed: 7,
        ..settings.clone()
    };
    let other = shares(&scene, &seeded, &[8, 64]);
    let message = fault(&[states[0].clone(), other[0].clone()]);
    assert!(
        message.contains("seed 0 has the ladders 0..8, seed 7 has 8..64"),
        "{message}"
    );
    // Light of `bdpt` falls anywhere: bands with different numbers of passes cannot be weighed.
    let long = crate::support::settings(Method::Bdpt, SIDE, 4);
    let short = RenderSettings {
        budget: Budget::PerPixel(2),
        ..long.clone()
    };
    let mut states = shares(&scene, &long, &[0, 8]);
    states.extend(shares(&scene, &short, &[8, 64]));
    let settings = merged_settings(&states).expect("shares of one render");
    let uneven = merge(&scene, &settings, &states, &mut Keeper::default());
    let message = uneven.expect_err("no picture").to_string();
    assert!(message.contains("passes"), "{message}");
}

#[test]
fn another_render_is_refused_with_both_values() {
    let scene = a_scene();
    let settings = settings(Method::Pssmlt, SIDE, 2);
    let state = last_state(&scene, &settings);
    let refused = |settings: &RenderSettings, scene: &Scene| {
        let error = resumed(scene, settings, &state).expect_err("another render");
        assert!(
            matches!(&error, RenderError::State(StateError::Other(_))),
            "{error}"
        );
        error.to_string()
    };
    type Change = fn(&mut RenderSettings);
    let changes: [(&str, Change); 7] = [
        ("seed is 0 in the state, 5 here", |s| s.seed = 5),
        ("max-depth is 12 in the state, 9 here", |s| s.max_depth = 9),
        ("plarge is 0.3 in the state, 0.5 here", |s| {
            s.options.p_large = 0.5;
        }),
        ("pilot is 5000 in the state, 7 here", |s| {
            s.options.pilot = 7;
        }),
        ("filter is box:0.5 in the state, tent:1 here", |s| {
            s.filter = Filter::new("tent", Some(1.0)).expect("a filter");
        }),
        ("method is pssmlt in the state, mmlt here", |s| {
            s.method = Method::Mmlt;
        }),
        ("ladders are 0..64 in the state, 0..3 here", |s| {
            s.ladders = Some(0..3);
        }),
    ];
    for (wanted, change) in changes {
        let mut other = settings.clone();
        change(&mut other);
        let message = refused(&other, &scene);
        assert!(message.contains(wanted), "{message}");
    }
    let message = refused(&settings, &self::scene("glass-cube?light=0.7", SIDE));
    assert!(message.contains("scene's content is"), "{message}");
    // What is no matter of the picture is no matter here.
    let mut same = settings.clone();
    (same.threads, same.features) = (3, true);
    assert!(resumed(&scene, &same, &state).is_ok());
}
