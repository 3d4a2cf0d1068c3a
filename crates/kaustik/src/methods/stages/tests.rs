//! Stages against cuts, threads, states and replays.

use std::collections::HashSet;

use kaustik_film::Image;
use kaustik_path::{Event, trace};
use kaustik_scene::Scene;

use super::StagedEngine;
use super::sums::Sums;
use crate::engine::Engine;
use crate::retold::cut;
use crate::state::{Header, Keep, Snapshot, Source, State, take_up};
use crate::threads::pool;
use crate::{
    Budget, Direct, Method, RenderSettings, StageLadder, StepId, replay, replay_from, small,
};

const METHODS: [Method; 2] = [Method::MltMultistage, Method::PssmltMultistage];
const SIDE: u32 = 8;

fn scene() -> Scene {
    small::scene("cornell", [SIDE; 2])
}

/// Stages of some hundred steps of a ladder, in a render that goes beyond the last of them.
fn settings(method: Method, ladders: u32) -> RenderSettings {
    let mut settings = RenderSettings {
        max_depth: 5,
        threads: 1,
        seed: 3,
        features: false,
        ..small::settings(method, [SIDE; 2])
    };
    settings.options.ladders = ladders;
    settings.options.pilot = 600;
    settings.options.stages.budget = 12 * u64::from(ladders);
    settings
}

fn bytes(scene: &Scene, settings: &RenderSettings, engine: &dyn Keep) -> Vec<u8> {
    let header = Header::new(scene, settings, 0.0);
    let snapshot = Snapshot::new(header, engine);
    snapshot.bytes(&Source::default()).expect("a state")
}

/// What ladders are to have taken when so many steps are allowed for each, of a render of so many in all.
fn due(settings: &RenderSettings, total: u64, allowed: u64) -> Vec<u64> {
    let settings = RenderSettings {
        budget: Budget::Total(total),
        ..settings.clone()
    };
    let ladders = settings.ladder_range();
    ladders
        .map(|ladder| settings.planned(ladder).min(allowed))
        .collect()
}

/// Takes an engine to there.
fn go(engine: &mut StagedEngine<'_>, due: &[u64]) {
    let taken = engine.taken();
    let plan: Vec<u64> = due
        .iter()
        .zip(taken)
        .map(|(due, taken)| due - taken)
        .collect();
    let steps = engine.advance(&plan, None);
    assert_eq!(steps, plan.iter().sum::<u64>(), "all that the plan says");
    assert_eq!(engine.taken(), due);
}

/// The bits are the same wherever rounds are cut and on any number of threads, also for totals that the number
/// of ladders does not divide or that end just before or after the end of a stage.
#[test]
fn cuts_and_threads_do_not_show() {
    let scene = scene();
    for method in METHODS {
        let settings = settings(method, 3);
        let ends: Vec<u64> = {
            let engine = StagedEngine::new(&scene, &settings).expect("an engine");
            (0..7).map(|number| engine.plan.stage(number).end).collect()
        };
        assert!(ends[6] < 4000, "{ends:?}");
        for end in [ends[1], ends[4], ends[6]] {
            for total in 3 * end - 2..=3 * end + 2 {
                let run = |threads: usize, chunk: u64| {
                    let pool = pool(threads).expect("threads");
                    pool.install(|| {
                        let mut engine = StagedEngine::new(&scene, &settings).expect("an engine");
                        let mut allowed = 0;
                        while allowed < total.div_ceil(3) {
                            allowed += chunk;
                            go(&mut engine, &due(&settings, total, allowed));
                        }
                        let on = due(&settings, total + 50, total);
                        let there = bytes(&scene, &settings, &engine);
                        go(&mut engine, &on);
                        (there, bytes(&scene, &settings, &engine))
                    })
                };
                let whole = run(1, total);
                for (threads, chunk) in [(2, total), (3, 97), (1, 64), (3, 1)] {
                    // one step a round is much the slowest
                    if chunk > 1 || end == ends[1] {
                        let cut = run(threads, chunk);
                        assert!(whole == cut, "{method} {total} {threads} {chunk}");
                    }
                }
            }
        }
    }
}

/// A state from before, at and after the end of a stage leads to where the render itself comes to.
#[test]
fn states_of_any_place_go_on() {
    let scene = scene();
    for method in METHODS {
        for ladder in [StageLadder::Widths, StageLadder::Two] {
            let mut settings = settings(method, 2);
            settings.options.stages.ladder = ladder;
            let mut through = StagedEngine::new(&scene, &settings).expect("an engine");
            let end = through.plan.stage(0).end;
            let last = due(&settings, u64::MAX, 3 * end + 500);
            let mut states = Vec::new();
            for allowed in [0, end - 1, end, end + 1, end + 70, 3 * end] {
                go(&mut through, &due(&settings, u64::MAX, allowed));
                states.push(bytes(&scene, &settings, &through));
            }
            go(&mut through, &last);
            let whole = bytes(&scene, &settings, &through);
            for state in states {
                let state = State::from_bytes(state).expect("a state");
                let mut engine = StagedEngine::new(&scene, &settings).expect("an engine");
                take_up(&mut engine, &state, true).expect("a state of this render");
                go(&mut engine, &last);
                assert!(bytes(&scene, &settings, &engine) == whole, "{method}");
            }
        }
    }
}

/// Stages that are not those of the settings, ladders of another stage, sums that are not finite.
#[test]
fn states_that_lie_are_refused() {
    let scene = scene();
    for method in METHODS {
        let settings = settings(method, 2);
        let new = || StagedEngine::new(&scene, &settings).expect("an engine");
        let mut sound = new();
        let end = sound.plan.stage(1).end;
        go(&mut sound, &due(&settings, u64::MAX, end + 40));
        let refused = |lie: &dyn Fn(&mut StagedEngine<'_>)| {
            let mut liar = new();
            go(&mut liar, &due(&settings, u64::MAX, end + 40));
            lie(&mut liar);
            let state = State::from_bytes(bytes(&scene, &settings, &liar)).expect("a state");
            take_up(&mut new(), &state, true).is_err()
        };
        assert!(!refused(&|_| {}));
        assert!(refused(&|liar| liar.stage += 1));
        assert!(refused(&|liar| liar.stage = 1));
        assert!(refused(&|liar| (liar.began, liar.stage) = (3, 3)));
        assert!(refused(&|liar| liar.stage = usize::MAX));
        assert!(refused(&|liar| liar.past = super::Past::default()));
        let planes = |value: f32| {
            let planes = [(); 3].map(|()| vec![value; (SIDE * SIDE) as usize]);
            Image::from_rgb(SIDE, SIDE, planes).expect("an image")
        };
        assert!(refused(
            &|liar| liar.sums = liar.sums.with(&planes(f32::INFINITY), 1)
        ));
        // Another picture is another map, and another pool.
        let mut bright = vec![0.0; (SIDE * SIDE) as usize];
        bright[5] = 1e6;
        let planes = [(); 3].map(|()| bright.clone());
        let image = Image::from_rgb(SIDE, SIDE, planes).expect("an image");
        assert!(refused(&|liar| liar.sums = liar.sums.with(&image, 7)));
    }
}

/// Pictures count by their mutations.
#[test]
fn pictures_count_by_mutations() {
    let scene = scene();
    let settings = settings(METHODS[0], 1);
    let layout = settings.layout();
    let image = |value: f32| {
        let planes = [value, 2.0 * value, 3.0 * value].map(|v| vec![v; (SIDE * SIDE) as usize]);
        Image::from_rgb(SIDE, SIDE, planes).expect("an image")
    };
    let sums = Sums::black(&layout)
        .with(&image(1.0), 100)
        .with(&image(5.0), 300);
    let mean = sums.image(&layout).expect("an image");
    for (plane, value) in mean.rgb().into_iter().zip([4.0_f32, 8.0, 12.0]) {
        assert!(plane.iter().all(|v| (v - value).abs() < 1e-6));
    }
    assert_eq!(scene.image_size(), [mean.width(), mean.height()]);
}

/// No stage of renders of neighbouring seeds draws what another one does, or a render without stages.
#[test]
fn no_stream_repeats() {
    let of_render = |render: u64| (0..40).map(move |number| super::seed(render, number));
    let seeds: HashSet<u64> = (0..100).flat_map(of_render).collect();
    assert_eq!(seeds.len(), 4000);
    assert!((0..100).all(|render| !seeds.contains(&render)));
}

/// Steps of the first stage and of later ones, on both sides of the ends: a replay tells what the render
/// told, from its start and from a state.
#[test]
fn steps_of_stages_are_retold() {
    let scene = scene();
    let mut settings = settings(Method::PssmltMultistage, 2);
    // samples beside the chains would be told among their steps
    settings.options.direct = Direct::Together;
    let pool = pool(1).expect("threads");
    let (told, ends, state) = pool.install(|| {
        let mut engine = StagedEngine::new(&scene, &settings).expect("an engine");
        let ends: Vec<u64> = (0..4).map(|number| engine.plan.stage(number).end).collect();
        let mut told = Vec::new();
        let mut state = None;
        for (number, &end) in ends.iter().enumerate() {
            // The turn to the next stage tells of its pool: steps alone are looked at.
            if number > 0 {
                engine.turn();
            }
            if number == 2 {
                let bytes = bytes(&scene, &settings, &engine);
                state = Some(State::from_bytes(bytes).expect("a state"));
            }
            let events = trace(|| go(&mut engine, &due(&settings, u64::MAX, end))).1;
            told.push(events);
        }
        (told, ends, state.expect("of the third stage"))
    });
    let mut start = 0;
    for (number, (events, &end)) in told.iter().zip(&ends).enumerate() {
        let steps = cut(events, |event| *event == Event::Begin);
        let each = (end - start) as usize;
        assert_eq!(steps.len(), 2 * each, "one evaluation a step");
        for ladder in [0, 1] {
            for within in [0, 1, each / 2, each - 1] {
                let step = start + within as u64;
                let place = StepId { ladder, step };
                let expected = steps[ladder as usize * each + within];
                let shown = replay(&scene, &settings, place).expect("events");
                assert!(shown == expected, "{number} {ladder} {within}");
                let mut ahead = 0;
                let again = replay_from(&scene, &settings, Some(&state), place, &mut |n| ahead = n);
                assert!(
                    again.expect("events") == expected,
                    "{number} {ladder} {within}"
                );
                // The state is of the third stage: later steps are one stage away, those before follow from the start.
                let left = if number < 2 { number } else { number - 2 };
                assert_eq!(ahead, left as u64, "{number} {ladder} {within}");
            }
        }
        start = end;
    }
}
