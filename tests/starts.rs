//! Starts that are shortened where a render has little time.

use std::time::Duration;

use kaustik::scene::Scene;
use kaustik::{
    Budget, Control, Method, Options, RenderError, RenderSettings, StartShare, State, merge,
    merged_settings, resume,
};

use crate::bits::bits;
use crate::state::{Keeper, SIDE, a_scene, last_state, read};
use crate::support::{picture, settings};

const METHODS: [Method; 6] = [
    Method::Pssmlt,
    Method::Mmlt,
    Method::Relt,
    Method::ErptPss,
    Method::Mlt,
    Method::Erpt,
];

/// With a start that takes longer than the render may.
fn hurried(method: Method, seed: u64) -> RenderSettings {
    RenderSettings {
        budget: Budget::Time(Duration::from_millis(1)),
        options: Options::default(),
        seed,
        ..settings(method, SIDE, 0)
    }
}

fn start_of(state: &State) -> StartShare {
    state.settings().expect("settings").options.start
}

/// More samples from a state on, or anew.
fn longer(settings: &RenderSettings, start: StartShare) -> RenderSettings {
    let mut settings = RenderSettings {
        budget: Budget::PerPixel(24),
        ..settings.clone()
    };
    settings.options.start = start;
    settings
}

fn resumed(
    scene: &Scene,
    settings: &RenderSettings,
    state: State,
) -> Result<Vec<u32>, RenderError> {
    let done = resume(scene, settings, state, &mut Control::default(), &mut ())?;
    Ok(bits(&done.image))
}

/// A render that was short of time goes on from the start that it had, as one that was asked for such a start.
#[test]
fn a_shortened_start_is_resumed() {
    let scene = a_scene();
    for method in METHODS {
        let short = hurried(method, 7);
        let state = read(&last_state(&scene, &short));
        let start = start_of(&state);
        assert!(
            matches!(start, StartShare::Halved(1..)),
            "{method}: {start:?}"
        );
        let asked = picture(&scene, &longer(&short, start));
        let went_on = resumed(&scene, &longer(&short, StartShare::Auto), state.clone());
        assert!(went_on.expect("a picture") == bits(&asked), "{method}");
        let whole = resumed(&scene, &longer(&short, StartShare::WHOLE), state);
        let refused = whole.expect_err("another start").to_string();
        assert!(refused.contains("start is 1/"), "{method}: {refused}");
    }
}

/// Renders of two seeds may have had time for different starts; shares of one may not.
#[test]
fn seeds_with_different_starts_are_averaged() {
    let scene = a_scene();
    let of = |seed, halvings| {
        let settings = longer(&hurried(Method::Pssmlt, seed), StartShare::Halved(halvings));
        read(&last_state(&scene, &settings))
    };
    let average = |states: &[State]| {
        let settings = merged_settings(states)?;
        merge(&scene, &settings, states, &mut Keeper::default())
    };
    let states = [of(1, 8), of(2, 6)];
    let found: Result<_, RenderError> = average(&states);
    let found = found.expect("an average").image.rgb().concat();
    let parts = states.map(|state| {
        let own = longer(&hurried(Method::Pssmlt, state.seed()), start_of(&state));
        picture(&scene, &own).rgb().concat()
    });
    for (at, found) in found.into_iter().enumerate() {
        let mean = 0.5 * (parts[0][at] + parts[1][at]);
        assert!((found - mean).abs() <= 1e-5 * mean.abs().max(1e-3), "{at}");
    }
    let share = |ladders: std::ops::Range<u32>, halvings| {
        let mut settings = longer(&hurried(Method::Pssmlt, 3), StartShare::Halved(halvings));
        settings.ladders = Some(ladders);
        read(&last_state(&scene, &settings))
    };
    let refused = average(&[share(0..30, 8), share(30..64, 6)]).expect_err("no render");
    assert!(refused.to_string().contains("start is 1/256"), "{refused}");
}
