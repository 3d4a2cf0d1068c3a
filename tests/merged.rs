//! Errors of pixels from the spread of parts that are merged.

use std::sync::atomic::AtomicBool;

use kaustik::film::Image;
use kaustik::scene::Scene;
use kaustik::{
    Control, Direct, Method, Options, Outcome, Progress, RenderSettings, Rendered, State, merge,
    merged_settings, render_watched, resume,
};

use crate::bits::bits;
use crate::state::{Keeper, SIDE, a_scene, last_state, merged, read, shares};
use crate::support::{picture, settings};

/// Weighted mean and its standard error, a number for each channel of each pixel.
fn spread(parts: &[(Vec<f32>, f64)]) -> Vec<[f64; 2]> {
    let weight: f64 = parts.iter().map(|(_, w)| w).sum();
    let of = |at: usize| {
        let numbers = || parts.iter().map(|(p, w)| (f64::from(p[at]), w));
        let mean = numbers().map(|(x, w)| x * w).sum::<f64>() / weight;
        let squares: f64 = numbers().map(|(x, w)| w * (x - mean).powi(2)).sum();
        let freedom = parts.len() as f64 - 1.0;
        [mean, (squares / (weight * freedom)).sqrt()]
    };
    (0..parts[0].0.len()).map(of).collect()
}

fn planes(image: &Image) -> Vec<f32> {
    image.rgb().concat()
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-5 * a.abs().max(b.abs()).max(1e-6)
}

fn merged_with_layers(scene: &Scene, states: &[State]) -> Rendered {
    let settings = RenderSettings {
        features: true,
        ..merged_settings(states).expect("parts of one picture")
    };
    merge(scene, &settings, states, &mut Keeper::default()).expect("a picture")
}

/// Is the merged picture the mean of its parts' pictures?
#[derive(Clone, Copy, PartialEq)]
enum IsMean {
    Yes,
    /// Shares' own pictures have normalisers of their own; the whole has one.
    No,
}

/// Error and statistics of merged parts are those of their pictures, and so is the mean, where it is one.
fn check_spread(what: &str, all: &Rendered, parts: &[(Vec<f32>, f64)], is_mean: IsMean) {
    let layer = all.image.layer("error").expect("errors");
    let errors: Vec<f32> = (layer.channels.iter())
        .flat_map(|channel| channel.samples.clone())
        .collect();
    let wanted = spread(parts);
    assert!(
        wanted.iter().filter(|[_, error]| *error > 0.0).count() > 300,
        "{what}"
    );
    for (at, [mean, error]) in wanted.into_iter().enumerate() {
        let found = f64::from(planes(&all.image)[at]);
        assert!(
            is_mean == IsMean::No || close(found, mean),
            "{what} {at}: {found} {mean}"
        );
        assert!(
            close(f64::from(errors[at]), error),
            "{what} {at}: {} {error}",
            errors[at]
        );
    }
    let merged = all.statistics.merged.as_ref().expect("statistics");
    assert_eq!(merged.parts.len(), parts.len());
    assert!(
        merged.luminance_error > Some(0.0) && merged.pixel_error > Some(0.0),
        "{what}"
    );
}

#[test]
fn renders_of_other_seeds_are_averaged_and_tell_their_error() {
    let scene = a_scene();
    for method in [
        Method::Path,
        Method::Sppm,
        Method::PhotonVisibility,
        Method::Relt,
    ] {
        let of = |seed, spp| {
            let mut settings = settings(method, SIDE, spp);
            settings.options = Options::default();
            settings.seed = seed;
            let set: &[&str] = match method {
                Method::Path => &[],
                // short sweeps, so that budgets are what they are to be
                Method::Relt => &["even=2", "particles=1000"],
                Method::Sppm => &["photons=1000"],
                _ => &["photons=1000", "pilot=2000"],
            };
            for set in set {
                (settings.options.set(method, set)).expect("a setting");
            }
            settings
        };
        let renders = [of(9, 6), of(2, 3), of(5, 6), of(u64::MAX, 12)];
        let states: Vec<State> = (renders.iter())
            .map(|s| read(&last_state(&scene, s)))
            .collect();
        let all = merged_with_layers(&scene, &states);
        let parts: Vec<_> = (renders.iter())
            .map(|settings| {
                let done = kaustik::render(&scene, settings, &mut Control::default());
                let done = done.expect("a render");
                (planes(&done.image), done.statistics.steps as f64)
            })
            .collect();
        check_spread(method.name(), &all, &parts, IsMean::Yes);
        let mut others = states.clone();
        others.rotate_left(2);
        let again = merged_with_layers(&scene, &others);
        assert!(
            bits(&again.image) == bits(&all.image),
            "{method}: another order"
        );
        // Far apart in size they say nothing.
        let uneven = [states[1].clone(), read(&last_state(&scene, &of(7, 40)))];
        let uneven = merged_with_layers(&scene, &uneven);
        assert!(uneven.image.layer("error").is_none(), "{method}");
        let merged = uneven.statistics.merged.expect("statistics");
        assert!(
            merged
                .unknown
                .is_some_and(|why| why.contains("more than 4 times"))
        );
    }
}

#[test]
fn shares_tell_their_error() {
    let scene = a_scene();
    for method in [Method::Pssmlt, Method::Light, Method::Mlt, Method::Relt] {
        let mut settings = settings(method, SIDE, 40);
        settings.options = Options {
            direct: Direct::Lamps,
            ..Options::default()
        };
        let bounds = [0, 20, 40, 64];
        let states = shares(&scene, &settings, &bounds);
        let all = merged_with_layers(&scene, &states);
        let parts: Vec<_> = (bounds.windows(2))
            .map(|pair| {
                let share = RenderSettings {
                    ladders: Some(pair[0]..pair[1]),
                    ..settings.clone()
                };
                let done = kaustik::render(&scene, &share, &mut Control::default());
                let done = done.expect("a render");
                (planes(&done.image), done.statistics.steps as f64)
            })
            .collect();
        check_spread(method.name(), &all, &parts, IsMean::No);
        // The picture is that of one process all the same.
        assert!(
            bits(&all.image) == bits(&picture(&scene, &settings)),
            "{method}"
        );
    }
    // Bands of the image say nothing of each other.
    let settings = settings(Method::Bdpt, SIDE, 2);
    let all = merged_with_layers(&scene, &shares(&scene, &settings, &[0, 30, 64]));
    assert!(all.image.layer("error").is_none());
    let merged = all.statistics.merged.expect("statistics");
    assert!(merged.unknown.is_some_and(|why| why.contains("bands")));
}

/// Renders of two seeds, each in shares: these are added up first, and the layer is that of the seeds.
#[test]
fn seeds_in_shares_tell_their_error() {
    let scene = a_scene();
    let (bounds, seeds) = ([0, 20, 64], [3, 4]);
    let of = |seed| RenderSettings {
        seed,
        ..settings(Method::Pssmlt, SIDE, 8)
    };
    let parts = seeds.map(|seed| {
        let done = kaustik::render(&scene, &of(seed), &mut Control::default());
        let done = done.expect("a render");
        (planes(&done.image), done.statistics.steps as f64)
    });
    let in_shares = seeds.map(|seed| shares(&scene, &of(seed), &bounds));
    let all = merged_with_layers(&scene, &in_shares.concat());
    check_spread("seeds in shares", &all, &parts, IsMean::Yes);
}

/// Shares may have come to different lengths: those behind catch up round by round, so that a budget of time, checkpoints
/// and signals are looked at on the way.
#[test]
fn uneven_shares_catch_up_in_rounds() {
    let scene = a_scene();
    for method in [Method::Path, Method::Pssmlt, Method::Relt] {
        let whole = settings(method, SIDE, 512);
        let all = whole.options.ladders;
        let share = |ladders, spp| {
            let share = RenderSettings {
                ladders: Some(ladders),
                ..settings(method, SIDE, spp)
            };
            read(&last_state(&scene, &share))
        };
        let states = [share(0..all / 2, 512), share(all / 2..all, 1)];
        let mut keeper = Keeper::default();
        let before = merged(&scene, &states, &mut keeper).statistics.steps;
        let state = read(keeper.states.last().expect("a state"));
        let mut told = Vec::new();
        let mut tell = |progress: &Progress| told.push(progress.steps);
        let mut control = Control {
            stop: None,
            progress: Some(&mut tell),
        };
        let done = resume(&scene, &whole, state, &mut control, &mut Keeper::default());
        let after = done.expect("a render").statistics.steps;
        let first = told.first().expect("a round") - before;
        assert!(
            told.len() > 3 && first < (after - before) / 2,
            "{method}: {told:?} {before} {after}"
        );
    }
}

/// A render that was stopped before anything was whole holds nothing; one that finds no light holds a black picture.
#[test]
fn what_holds_nothing_is_told_from_what_is_black() {
    let stopped = AtomicBool::new(true);
    for (words, stop, outcome) in [
        ("cornell", Some(&stopped), Outcome::Stopped),
        ("mirror-balls", None, Outcome::Complete),
    ] {
        let scene = crate::support::scene(words, SIDE);
        let settings = settings(Method::Bdpt, SIDE, 1);
        let mut keeper = Keeper::default();
        let mut control = Control {
            stop,
            ..Control::default()
        };
        render_watched(&scene, &settings, &mut control, &mut keeper).expect("a render");
        let states = [read(keeper.states.last().expect("a state"))];
        let merged = merged(&scene, &states, &mut Keeper::default());
        assert_eq!(
            (merged.outcome, merged.statistics.steps == 0),
            (outcome, stop.is_some())
        );
    }
}
