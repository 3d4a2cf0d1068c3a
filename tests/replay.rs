//! Samples and steps of renders, shown once more.

use glam::{DVec2, DVec3};
use kaustik::film::{Film, Image, Quantum, develop};
use kaustik::geometry::Ray;
use kaustik::path::{Event, Role, Side, Stand};
use kaustik::spectrum::{WavelengthSampling, Wavelengths, Xyz};
use kaustik::{
    Control, Direct, Energy, Method, RenderError, RenderSettings, StepId, render, replay,
};

use crate::faults::shown;
use crate::support::{picture, scene, settings};

/// What all samples of a render bring, replayed one by one, is its picture.
#[test]
fn all_samples_replayed_are_the_picture() {
    const SIDE: u32 = 6;
    let scene = scene("glass-cube?light=0.8", SIDE);
    for method in [Method::Path, Method::Light, Method::Bdpt] {
        let mut settings = settings(method, SIDE, 1);
        settings.options.ladders = 4;
        settings.seed = 5;
        let image = picture(&scene, &settings);
        let film = Film::with_layout(&settings.layout(), Quantum::from_mean(1e-3)).expect("a film");
        for ladder in 0..4 {
            for step in 0..u64::from(SIDE * SIDE / 4) {
                let events = replay(&scene, &settings, StepId { ladder, step });
                for event in events.expect("events") {
                    if let Event::Splat { raster, xyz, .. } = event {
                        add(&film, SIDE, raster, xyz, 1.0);
                    }
                }
            }
        }
        let again = develop(&[(&film, 1.0)]).expect("a picture");
        assert_same(method.name(), &image, &again);
    }
}

/// A walk's vertices lie where its rays lead, one after the other, and what it brings is what was splatted.
#[test]
fn the_vertices_of_a_walk_follow_on_each_other() {
    let scene = scene("cornell", 8);
    let settings = settings(Method::Path, 8, 1);
    let (mut edges, mut lights) = (0, 0);
    for ladder in 0..64 {
        let events = replay(&scene, &settings, StepId { ladder, step: 0 }).expect("events");
        let mut from = None;
        for event in &events {
            assert!(event.is_finite());
            match *event {
                Event::Start {
                    side,
                    position,
                    direction,
                    ..
                } => {
                    assert_eq!(side, Side::Camera);
                    from = Some((position, direction, 0));
                }
                Event::Vertex {
                    edge,
                    position,
                    distance,
                    ..
                } => {
                    let (last, direction, before) = from.expect("a start");
                    assert!((last + direction * distance - position).length() < 1e-4 * distance);
                    assert_eq!(edge, before + 1);
                    from = Some((position, direction, edge));
                    edges += 1;
                }
                Event::Scatter { direction, pdf, .. } => {
                    assert!(pdf > 0.0);
                    let (position, _, edge) = from.expect("a vertex");
                    from = Some((position, direction, edge));
                }
                Event::Light { .. } => lights += 1,
                _ => {}
            }
        }
    }
    assert!(edges > 64 && lights > 64, "{edges} {lights}");
}

/// A step of a chain is that of the chain: for any share of the ladders and any number of threads, and each another one.
#[test]
fn steps_of_chains_are_replayed() {
    let scene = scene("cornell", 8);
    let methods = [
        Method::Pssmlt,
        Method::Mmlt,
        Method::Relt,
        Method::ErptPss,
        Method::Mlt,
    ];
    for method in methods {
        let mut settings = settings(method, 8, 4);
        // Else events of two parts are told.
        settings.options.direct = Direct::Lamps;
        let show = |settings: &RenderSettings, ladder, step| {
            replay(&scene, settings, StepId { ladder, step }).expect("events")
        };
        let events = show(&settings, 3, 200);
        let evaluations = events.iter().filter(|e| **e == Event::Begin).count();
        if matches!(method, Method::Pssmlt | Method::Mmlt) {
            assert_eq!(evaluations, 1, "{method}: a proposal is evaluated once");
        }
        let proposals = events.iter();
        let proposals = proposals.filter(|e| matches!(e, Event::Proposal { .. }));
        let proposals = proposals.count();
        assert!(evaluations + proposals > 0, "{method}");
        let other = RenderSettings {
            threads: 3,
            ladders: Some(2..5),
            ..settings.clone()
        };
        assert!(events == show(&other, 3, 200), "{method}");
        // A sweep of `relt` has several steps.
        assert!(events != show(&settings, 3, 300), "{method}");
        assert!(events != show(&settings, 4, 200), "{method}");
        let seeded = RenderSettings {
            seed: 1,
            ..settings.clone()
        };
        assert!(events != show(&seeded, 3, 200), "{method}");
    }
}

/// Adds what falls at a raster point to a film of an image of this side.
fn add(film: &Film, side: u32, raster: DVec2, xyz: Xyz, weight: f64) {
    let at = raster * f64::from(side);
    film.splat_weighted(at.x, at.y, xyz, weight);
}

/// Two pictures of the same light: all but what films round.
fn assert_same(what: &str, image: &Image, again: &Image) {
    let mut lit = 0;
    for (a, b) in image.rgb().iter().zip(again.rgb()) {
        for (a, b) in a.iter().zip(b) {
            assert!((a - b).abs() <= 2e-5 + 2e-5 * a.abs(), "{what}: {a} {b}");
            lit += usize::from(a.abs() > 0.0);
        }
    }
    assert!(lit > 10, "{what}: {lit}");
}

/// What the steps of all chains of `mlt` show, each path with its share of the step, is the picture.
#[test]
fn all_mutations_replayed_are_the_picture() {
    const SIDE: u32 = 6;
    const STEPS: u64 = 18;
    let scene = scene("glass-cube?light=0.8", SIDE);
    let mut settings = settings(Method::Mlt, SIDE, 1);
    settings.seed = 3;
    settings.options.ladders = 2;
    settings.options.pilot = 500;
    settings.options.direct = Direct::Together;
    let rendered = render(&scene, &settings, &mut Control::default()).expect("a render");
    let b = rendered.statistics.chain.expect("chains").normalisation;
    let film = Film::with_layout(&settings.layout(), Quantum::from_mean(1e-5)).expect("a film");
    let mut decisions = [0, 0];
    for ladder in 0..2 {
        let mut before = None;
        for step in 0..STEPS {
            let events = replay(&scene, &settings, StepId { ladder, step }).expect("events");
            let (mut current, mut proposed) = (None, None);
            for event in events {
                match event {
                    Event::Path {
                        role,
                        raster,
                        density,
                        colour,
                    } => match role {
                        Role::Sampled(_) => {}
                        Role::Current => current = Some((raster, density, colour)),
                        Role::Proposed => proposed = Some((raster, density, colour)),
                    },
                    Event::Proposal { acceptance, .. } => {
                        let (raster, density, colour) = current.expect("a path");
                        assert!(density > 0.0);
                        add(&film, SIDE, raster, colour, b * (1.0 - acceptance));
                        if let Some((raster, _, colour)) = proposed {
                            add(&film, SIDE, raster, colour, b * acceptance);
                        }
                        // A chain goes on from where the step before left it.
                        assert!(before.is_none() || before == current, "{ladder} {step}");
                    }
                    Event::Decision { accepted } => {
                        before = if accepted { proposed } else { current };
                        decisions[usize::from(accepted)] += 1;
                    }
                    _ => {}
                }
            }
        }
    }
    assert!(decisions.iter().all(|&n| n > 3), "{decisions:?}");
    let again = develop(&[(&film, 1.0)]).expect("a picture");
    assert_same("mlt", &rendered.image, &again);
}

/// What samples and chains of `erpt` show is the picture, also where the number of chains follows from what came before.
#[test]
fn all_redistributed_samples_replayed_are_the_picture() {
    const SIDE: u32 = 6;
    let scene = scene("glass-cube?light=0.8", SIDE);
    for energy in [Energy::Pilot, Energy::Passes] {
        let mut settings = settings(Method::Erpt, SIDE, 3);
        settings.seed = 3;
        settings.options.ladders = 2;
        settings.options.pilot = 500;
        settings.options.direct = Direct::Together;
        settings.options.energy = energy;
        let image = picture(&scene, &settings);
        let film = Film::with_layout(&settings.layout(), Quantum::from_mean(1e-5)).expect("a film");
        let [mut sampled, mut proposed] = [0, 0];
        for ladder in 0..2 {
            for step in 0..u64::from(SIDE * SIDE / 2 * 3) {
                let events = replay(&scene, &settings, StepId { ladder, step });
                for event in events.expect("events") {
                    match event {
                        Event::Deposit { raster, xyz, .. } => add(&film, SIDE, raster, xyz, 1.0),
                        Event::Path { role, .. } => {
                            sampled += usize::from(matches!(role, Role::Sampled(_)));
                        }
                        Event::Proposal { .. } => proposed += 1,
                        _ => {}
                    }
                }
            }
        }
        assert!(sampled > 100 && proposed > 100, "{sampled} {proposed}");
        let again = develop(&[(&film, 1.0 / 3.0)]).expect("a picture");
        assert_same("erpt", &image, &again);
    }
}

/// What light paths of `sppm` show, with the samples of what photons cannot carry, is the picture.
#[test]
fn all_light_paths_replayed_are_the_picture() {
    const SIDE: u32 = 6;
    const PHOTONS: u64 = 60;
    const ITERATIONS: u64 = 3;
    let scene = scene("glass-cube?light=0.8", SIDE);
    let mut settings = settings(Method::Sppm, SIDE, ITERATIONS);
    settings.options.ladders = 2;
    settings.options.pilot = 500;
    settings.options.photon.photons = Some(PHOTONS);
    settings.options.photon.radius = 20.0;
    let image = picture(&scene, &settings);
    let film = |mean| Film::with_layout(&settings.layout(), Quantum::from_mean(mean));
    let (photons, samples) = (film(1e-3).expect("a film"), film(1e-5).expect("a film"));
    let [mut walks, mut met, mut fell] = [0, 0, 0];
    // Each ladder takes two passes over its half of the image an iteration.
    let passes = 2 * ITERATIONS;
    let due = passes * u64::from(SIDE * SIDE / 2);
    for ladder in 0..2 {
        for step in 0..due.max(PHOTONS * ITERATIONS) {
            let events = replay(&scene, &settings, StepId { ladder, step });
            for event in events.expect("events") {
                let wanted = step < PHOTONS * ITERATIONS;
                match event {
                    Event::Deposit { raster, xyz, .. } if wanted => {
                        fell += 1;
                        add(&photons, SIDE, raster, xyz, 1.0);
                    }
                    Event::Photon { met: count, .. } if wanted => met += u64::from(count),
                    Event::Splat { raster, xyz, .. } if step < due => {
                        add(&samples, SIDE, raster, xyz, 1.0);
                    }
                    Event::Start { side, .. } => walks += u64::from(wanted && side == Side::Light),
                    _ => {}
                }
            }
        }
    }
    assert_eq!((walks, met), (PHOTONS * ITERATIONS, fell));
    assert!(met > 200, "{met}");
    let films = [
        (&photons, 1.0 / (PHOTONS * ITERATIONS) as f64),
        (&samples, 1.0 / passes as f64),
    ];
    let again = develop(&films).expect("a picture");
    assert_same("sppm", &image, &again);
}

/// Vertices of paths stand where light can go from one to the next: what is shown is a path of the scene.
#[test]
fn the_vertices_of_a_path_see_each_other() {
    let scene = scene("cornell", 8);
    let mut settings = settings(Method::Mlt, 8, 1);
    settings.options.pilot = 500;
    let (mut paths, mut surfaces) = (0, 0);
    let wavelengths = Wavelengths::sample(0.5, WavelengthSampling::Hero);
    for ladder in 0..32 {
        let events = replay(&scene, &settings, StepId { ladder, step: 2 }).expect("events");
        let mut before: Option<(DVec3, DVec3)> = None;
        for event in &events {
            assert!(event.is_finite());
            match *event {
                Event::Path { .. } => before = None,
                Event::PathVertex {
                    index,
                    stand,
                    position,
                    normal,
                    material,
                    ..
                } => {
                    assert_eq!(index == 0, stand == Stand::Emitter);
                    assert_eq!(material.is_none(), stand == Stand::Lens);
                    paths += usize::from(stand == Stand::Lens);
                    surfaces += usize::from(stand == Stand::Surface);
                    if let Some((from, up)) = before {
                        let way = (position - from).normalize();
                        // Nothing in this room lets light through.
                        assert!(way.dot(up) > 0.0, "{from} {position}");
                        assert!(stand == Stand::Lens || way.dot(normal) < 0.0);
                        let (from, to) = (from + way * 1e-4, position - way * 1e-4);
                        let ray = Ray::new(from.as_vec3(), way.as_vec3());
                        let free = f64::from(to.distance(from) as f32);
                        let ray = Ray {
                            t_max: free as f32,
                            ..ray
                        };
                        let around = scene.camera_interior();
                        let passed = scene.visibility(&ray, &around, &wavelengths);
                        assert!(!passed.is_nothing(), "{from} {to}");
                    }
                    before = Some((position, normal));
                }
                _ => {}
            }
        }
    }
    assert!(paths > 40 && surfaces > 40, "{paths} {surfaces}");
}

/// All methods show their steps; a ladder that there is not is refused.
#[test]
fn every_method_is_replayed() {
    let scene = scene("cornell", 8);
    for method in Method::ALL {
        let mut settings = settings(method, 8, 1);
        settings.options.pilot = 1000;
        let show = |ladder, step| replay(&scene, &settings, StepId { ladder, step });
        let shown = show(0, 1).expect("events");
        assert!(shown.iter().all(Event::is_finite), "{method}");
        assert!(!shown.is_empty(), "{method}");
        let wrong = show(64, 0);
        assert!(
            matches!(&wrong, Err(RenderError::Setting { found, .. }) if found == "64"),
            "{method}: {wrong:?}"
        );
        let lamps = show(StepId::LAMPS, 3);
        let beside = [
            Method::Pssmlt,
            Method::Mmlt,
            Method::Relt,
            Method::Mlt,
            Method::Erpt,
            Method::Annealing,
            Method::MltMultistage,
            Method::PssmltMultistage,
        ];
        match lamps {
            Ok(events) => assert!(beside.contains(&method) && !events.is_empty()),
            Err(error) => {
                assert!(!beside.contains(&method), "{method}: {error}");
                assert!(error.to_string().contains("beside"), "{error}");
            }
        }
    }
}

#[test]
fn any_sample_is_shown() {
    let text = shown(&[
        "replay",
        "builtin:cornell",
        "--method",
        "bdpt",
        "--width",
        "16",
        "--at",
        "7:5:2",
    ]);
    for word in [
        "bdpt of builtin:cornell, step 7:5:2",
        "camera walk from",
        "light walk from",
        ", material 0 'white', instance",
        "scatters toward",
        "strategy s = ",
        "1 evaluations",
        "everything is finite",
    ] {
        assert!(text.contains(word), "no '{word}' in: {text}");
    }
}
