//! Replica exchange: its picture, its parts, what it does without a replica.

use glam::{Affine3A, Vec3};
use kaustik::mcmc::Schedule;
use kaustik::path::Class;
use kaustik::scene::description::{Lens, LightDescription, LightKind};
use kaustik::{
    Budget, Control, Direct, EvenSamples, Method, Normaliser, RenderSettings, Rendered, Steps,
    render,
};

use crate::support::{Tile, agree, compile, means, picture, scene, settings, tiles_of_seeds};

fn rendered(words: &str, settings: &RenderSettings) -> Rendered {
    let scene = scene(words, settings.width);
    render(&scene, settings, &mut Control::default()).expect("a render")
}

/// A lens with area shares that light with walks that fall on it, of which a tour knows nothing.
#[test]
fn through_a_lens_with_area_there_are_no_tours() {
    let mut description =
        kaustik::scene::builtin::load("water-cornell?light=0.8").expect("a scene");
    let tours = |description: &kaustik::scene::Description| {
        let scene = compile(description, 16);
        let done = render(
            &scene,
            &settings(Method::Relt, 16, 64),
            &mut Control::default(),
        );
        let replicas = done.expect("a render").statistics.replicas;
        replicas.expect("statistics of replicas").tours
    };
    assert!(tours(&description) > 0);
    description.cameras[0].lens = Some(Lens {
        aperture: 0.2,
        focus: 8.0,
        blades: None,
    });
    assert_eq!(tours(&description), 0);
}

/// Every way to exchange and to step has the same picture, that of a path tracer.
#[test]
fn all_variants_agree_roughly_with_path() {
    const SIDE: u32 = 16;
    let scene = scene("cornell", SIDE);
    let path = tiles_of_seeds(&scene, &settings(Method::Path, SIDE, 256), 0..8);
    type Change = fn(&mut kaustik::Options);
    let variants: [(&str, Change); 11] = [
        ("default", |_| {}),
        ("exchange", |o| o.normaliser = Normaliser::Exchange),
        ("initial", |o| {
            o.normaliser = Normaliser::Initial;
            o.particles = 10_000;
        }),
        ("lamps by chains", |o| o.direct = Direct::Together),
        ("pair", |o| o.exchange = Schedule::RandomPair),
        ("gibbs, beta 1", |o| {
            o.exchange = Schedule::Permutation;
            o.beta = 1.0;
        }),
        ("none", |o| o.exchange = Schedule::Off),
        ("adapted", |o| {
            o.steps = Steps::Adapted;
            o.ladders = 4;
        }),
        ("side by side", |o| {
            o.replicas = Some("sides".parse().expect("a set"));
        }),
        ("as published", |o| {
            o.replicas = Some("paper".parse().expect("a set"));
            o.exchange = Schedule::RandomPair;
            o.steps = Steps::Paper;
        }),
        ("two replicas", |o| {
            o.replicas = Some("uniform;1,0,1,1,1,1".parse().expect("a set"));
        }),
    ];
    for (name, change) in variants {
        let mut settings = settings(Method::Relt, SIDE, 256);
        change(&mut settings.options);
        let verdict = agree(
            &path,
            &tiles_of_seeds(&scene, &settings, 0..8),
            |_| true,
            0.1,
        );
        assert!(verdict.rejected.is_empty(), "{name}: {verdict:?}");
        assert!(verdict.uncertain.is_empty(), "{name}: {verdict:?}");
    }
}

/// Exchanges that try pairs tell how each fares, one that permutes all tells of the whole, and none tells nothing.
#[test]
fn each_exchange_tells_its_own_rates() {
    let told = |exchange| {
        let mut settings = settings(Method::Relt, 16, 64);
        settings.options.exchange = exchange;
        let replicas = rendered("cornell", &settings).statistics.replicas;
        replicas.expect("statistics of replicas")
    };
    let is_rate = |rate: Option<f64>| rate.is_some_and(|rate| rate > 0.0 && rate <= 1.0);
    for exchange in [
        Schedule::Alternating,
        Schedule::RandomPair,
        Schedule::RandomMatching,
    ] {
        let told = told(exchange);
        let mut rates = told.exchange_acceptance.iter();
        assert!(rates.all(|&rate| is_rate(rate)), "{exchange:?} {told:?}");
        assert_eq!(told.permutation_acceptance, None, "{exchange:?}");
    }
    let all = told(Schedule::Permutation);
    assert!(is_rate(all.permutation_acceptance), "{all:?}");
    let none = told(Schedule::Off);
    assert_eq!(none.permutation_acceptance, None);
    for told in [all, none] {
        assert!(
            told.exchange_acceptance.iter().all(Option::is_none),
            "{told:?}"
        );
        assert_eq!(told.exchange_acceptance.len(), told.pairs.len());
    }
}

/// Tiles where the pictures differ by more than a share of their mean, noise apart, and those where
/// noise is too large to tell.
fn further_apart(a: &[Tile], b: &[Tile], share: f64) -> [Vec<usize>; 2] {
    let mut lists = [Vec::new(), Vec::new()];
    for (tile, (a, b)) in a.iter().zip(b).enumerate() {
        let (a, b) = (a.luminance, b.luminance);
        let error = (a.variance + b.variance).sqrt();
        if (a.mean - b.mean).abs() > share * a.mean + 3.0 * error {
            lists[0].push(tile);
        }
        if error > share * a.mean {
            lists[1].push(tile);
        }
    }
    lists
}

#[test]
#[ignore = "long"]
fn it_agrees_with_path_within_one_percent_on_cornell() {
    const SIDE: u32 = 64;
    let scene = scene("cornell", SIDE);
    let path = tiles_of_seeds(&scene, &settings(Method::Path, SIDE, 400), 0..16);
    let relt = tiles_of_seeds(&scene, &settings(Method::Relt, SIDE, 1_000), 0..16);
    let [apart, uncertain] = further_apart(&path, &relt, 0.01);
    assert!(apart.is_empty(), "{apart:?}");
    assert!(uncertain.len() <= 3, "{uncertain:?}");
}

#[test]
#[ignore = "long"]
fn it_agrees_with_path_through_glass() {
    const SIDE: u32 = 32;
    let scene = scene("glass-cube?light=0.8", SIDE);
    let path = tiles_of_seeds(&scene, &settings(Method::Path, SIDE, 4_000), 0..16);
    let relt = tiles_of_seeds(&scene, &settings(Method::Relt, SIDE, 4_000), 0..16);
    let verdict = agree(&path, &relt, |_| true, 0.03);
    assert!(verdict.rejected.is_empty(), "{verdict:?}");
    assert!(verdict.uncertain.len() <= 3, "{verdict:?}");
}

/// Paths of one edge are all of a class that no replica but the uniform one follows.
#[test]
fn what_no_chain_reaches_is_left_to_the_uniform_replica() {
    let with = |method| {
        let mut settings = settings(method, 16, 512);
        settings.max_depth = 1;
        settings.options.direct = Direct::Together;
        settings
    };
    let done = rendered("furnace?kind=diffuse", &with(Method::Relt));
    let replicas = done.statistics.replicas.expect("statistics of replicas");
    assert_eq!(replicas.levels.len(), 1);
    assert!(replicas.dropped.is_some() && replicas.notices().len() == 1);
    let path = means(&rendered("furnace?kind=diffuse", &with(Method::Path)).image);
    for (found, wanted) in means(&done.image).into_iter().zip(path) {
        assert!((found / wanted - 1.0).abs() < 0.02, "{found} {wanted}");
    }
}

/// A specific replica whose light is next to nothing does not run, and its light is not lost.
#[test]
fn a_negligible_replica_is_dropped_and_its_light_kept() {
    let words = "furnace?kind=glass";
    let mut small = settings(Method::Relt, 16, 256);
    // scaled so far down that its normaliser is negligible
    let set = "uniform;1,0,1,1,1,1;1,0,0,1,1,1;1e-6,0,0,0,0,1e-8";
    small.options.replicas = Some(set.parse().expect("a set"));
    let done = rendered(words, &small);
    let replicas = done.statistics.replicas.expect("statistics of replicas");
    assert_eq!(replicas.levels.len(), 3);
    assert!(replicas.dropped.is_some());
    for mean in means(&done.image) {
        assert!((mean - 1.0).abs() < 0.03, "{mean}");
    }
    let mut paper = small.clone();
    paper.options.replicas = Some("paper".parse().expect("a set"));
    let kept = rendered(words, &paper);
    let replicas = kept.statistics.replicas.expect("statistics of replicas");
    assert!(replicas.dropped.is_none() && replicas.levels.len() == 4);
    assert!(replicas.levels[3].weights[Class::L0 as usize] > 0.0);
    for mean in means(&kept.image) {
        assert!((mean - 1.0).abs() < 0.03, "{mean}");
    }
}

/// Nor does one whose light scouts find everywhere: that is left to independent samples, in a furnace all light there is. Where
/// they find some seldom it runs.
#[test]
fn a_specific_replica_that_nobody_needs_is_dropped_and_its_light_kept() {
    let with = |words, spp| {
        let done = rendered(words, &settings(Method::Relt, 16, spp));
        let replicas = done.statistics.replicas.expect("statistics of replicas");
        (means(&done.image), replicas)
    };
    let (shown, replicas) = with("furnace?kind=glass", 256);
    assert_eq!((replicas.levels.len(), replicas.scouts), (1, 0));
    for mean in shown {
        assert!((mean - 1.0).abs() < 0.02, "{mean}");
    }
    let (_, replicas) = with("prism?light=0.4", 64);
    assert_eq!((replicas.levels.len(), replicas.scouts), (3, 0));
    let why = &replicas.notices()[0];
    assert!(
        why.contains("walks from the camera find its light"),
        "{why}"
    );
    // Of one seed the brightness is known to some percent: the mean of six.
    let scene = scene("prism?light=0.4", 16);
    let brightness = |method| {
        let mut sums = [0.0; 3];
        for seed in 0..6 {
            let settings = RenderSettings {
                seed,
                ..settings(method, 16, 2048)
            };
            for (sum, mean) in sums.iter_mut().zip(means(&picture(&scene, &settings))) {
                *sum += mean / 6.0;
            }
        }
        sums
    };
    let [found, wanted] = [Method::Relt, Method::Bdpt].map(brightness);
    for (found, wanted) in found.into_iter().zip(wanted) {
        assert!((found / wanted - 1.0).abs() < 0.1, "{found} {wanted}");
    }
    let (_, replicas) = with("glass-cube", 256);
    assert!(replicas.dropped.is_none() && replicas.levels.len() == 4);
    // nothing is left to even samples where there are none
    let mut alone = settings(Method::Relt, 16, 16);
    alone.options.even = EvenSamples::Count(0);
    let replicas = rendered("prism?light=0.4", &alone).statistics.replicas;
    assert_eq!(replicas.expect("statistics of replicas").levels.len(), 4);
}

/// Light without extent cannot be run into.
#[test]
fn without_extended_emitters_there_is_no_specific_replica() {
    let mut description = kaustik::scene::builtin::load("glass-cube").expect("a scene");
    for material in &mut description.materials {
        (material.emissive, material.emission) = ([0.0; 3], None);
    }
    description.lights.push(LightDescription {
        name: String::new(),
        kind: LightKind::Point,
        color: [1.0; 3],
        intensity: 10.0,
        range: None,
        transform: Affine3A::from_translation(Vec3::new(2.0, 4.0, -2.0)),
    });
    let scene = compile(&description, 16);
    let done = render(
        &scene,
        &settings(Method::Relt, 16, 64),
        &mut Control::default(),
    );
    let replicas = done.expect("a render").statistics.replicas;
    let replicas = replicas.expect("statistics of replicas");
    assert_eq!(replicas.levels.len(), 3);
    let why = &replicas.notices()[0];
    assert!(why.contains("run into"), "{why}");
}

#[test]
fn the_replicas_layers_add_up_to_the_picture() {
    let settings = RenderSettings {
        features: true,
        ..settings(Method::Relt, 16, 64)
    };
    let image = rendered("glass-cube?light=0.8", &settings).image;
    for (name, plane) in ["R", "G", "B"].into_iter().zip(image.rgb()) {
        let layers = ["replica-1", "replica-2", "replica-3", "replica-4", "direct"];
        let parts = layers.map(|layer| {
            let layer = image.layer(layer).expect("its layer");
            layer.channel(name).expect("its channel").to_vec()
        });
        for (pixel, &whole) in plane.iter().enumerate() {
            let sum: f32 = parts.iter().map(|part| part[pixel]).sum();
            assert!(
                (sum - whole).abs() <= 1e-4 * whole.abs().max(1.0),
                "{sum} {whole}"
            );
        }
    }
}

/// Budgets count paths: a sweep is as many as its replicas take steps, scouts apart.
#[test]
fn a_sweep_is_as_many_mutations_as_its_replicas_take() {
    let with = |total| {
        let mut settings = settings(Method::Relt, 16, 1);
        settings.budget = Budget::Total(total);
        settings.options.even = EvenSamples::Count(0);
        settings
    };
    // without a mirror or glass there is no specific replica
    for (words, total, steps, each) in [
        ("cornell", 1, 3, 3),
        ("cornell", 1_003, 1_002, 3),
        ("glass-cube", 1_003, 1_002, 6),
        ("glass-cube", 4_096, 4_092, 6),
    ] {
        let done = rendered(words, &with(total));
        assert_eq!(done.statistics.steps, steps, "{words} {total}");
        let replicas = done.statistics.replicas.expect("statistics of replicas");
        assert_eq!(replicas.sweeps, steps / each);
        let scouts = if words == "cornell" { 0 } else { 16 };
        assert_eq!(replicas.scouts, replicas.sweeps * scouts);
        assert_eq!(replicas.pairs.len(), replicas.levels.len() - 1);
    }
}

/// Many without a specific replica, fewer beside one, fewest where it has much to show.
#[test]
fn even_samples_go_by_what_is_hard_to_find() {
    let a_sweep = |words: &str| {
        let done = rendered(words, &settings(Method::Relt, 16, 32));
        let replicas = done.statistics.replicas.expect("statistics of replicas");
        replicas.even / replicas.sweeps
    };
    assert_eq!(a_sweep("glossy-cornell"), 64);
    assert!((9..=32).contains(&a_sweep("glass-cube")));
    assert_eq!(a_sweep("water-cornell"), 8);
}

#[test]
fn annealing_climbs_a_line() {
    let mut sides = settings(Method::Annealing, 16, 1);
    sides.options.replicas = Some("sides".parse().expect("a set"));
    let scene = scene("cornell", 16);
    let error = render(&scene, &sides, &mut Control::default()).expect_err("no line");
    assert!(error.to_string().contains("replicas"), "{error}");
}

/// Scouts are worth what independent samples are: the same light, with a smaller error.
#[test]
fn scouts_know_the_specific_light_better_than_samples_do() {
    let with = |replicas: &str| {
        let mut settings = settings(Method::Relt, 16, 256);
        settings.options.replicas = Some(replicas.parse().expect("a set"));
        settings.options.meter = false;
        // many of those would know it too
        settings.options.even = EvenSamples::Count(2);
        let done = rendered("water-cornell?light=0.8", &settings);
        let mean = means(&done.image)[1];
        let replicas = done.statistics.replicas.expect("statistics of replicas");
        let specific = replicas.levels[3].clone();
        let error = specific.share_error.expect("an error");
        (specific.share, error, mean, replicas.scouts_followed)
    };
    let (share, error, mean, followed) = with("uniform+16;1,0,1,1,1,1;1,0,0,1,1,1;1,0,0,0,0,0.05");
    let (alone, larger, other, none) = with("paper");
    assert!(error < 0.5 * larger, "{error} {larger}");
    assert!(
        (share - alone).abs() < 4.5 * larger.hypot(error),
        "{share} {alone}"
    );
    assert!((mean / other - 1.0).abs() < 0.1, "{mean} {other}");
    assert!(followed > 100 && none == 0, "{followed} {none}");
}

/// Tours show the specific replica's light where its own steps show it.
#[test]
#[ignore = "long"]
fn tours_show_the_same_light() {
    const SEEDS: u64 = 6;
    let with = |last: &str| {
        let mut quarters = [0.0; 4];
        let mut told = None;
        for seed in 0..SEEDS {
            let mut settings = RenderSettings {
                features: true,
                seed,
                ..settings(Method::Relt, 16, 256)
            };
            let set = format!("uniform+16;1,0,1,1,1,1;1,0,0,1,1,1;1,0,0,0,0,0.05*3{last}");
            settings.options.replicas = Some(set.parse().expect("a set"));
            let done = rendered("water-cornell?light=0.8", &settings);
            let layer = done.image.layer("replica-4").expect("its layer");
            let plane = layer.channel("G").expect("its channel");
            for (pixel, value) in plane.iter().enumerate() {
                quarters[pixel / 16 / 8 * 2 + pixel % 16 / 8] += f64::from(*value);
            }
            told = done.statistics.replicas;
        }
        (quarters, told.expect("statistics of replicas"))
    };
    let ((steps, without), (tours, replicas)) = (with(""), with("~8"));
    let sum: f64 = steps.iter().sum();
    for (one, other) in steps.iter().zip(&tours) {
        // 3 % is the standard deviation
        assert!((one - other).abs() < 0.1 * sum, "{steps:?} {tours:?}");
    }
    assert_eq!((without.tours, without.tour_steps), (0, 0));
    assert_eq!(replicas.tours, 2 * replicas.sweeps);
    assert_eq!(replicas.tour_steps % 8, 0);
    let share = replicas.tours_followed as f64 / (replicas.tour_steps / 8) as f64;
    assert!(share > 0.5, "{share}");
    assert!(replicas.tour_steps > 1_000, "{}", replicas.tour_steps);
    assert!(
        (0.1..0.9).contains(&replicas.tour_acceptance),
        "{}",
        replicas.tour_acceptance
    );
}

#[test]
fn gibbs_takes_no_more_replicas_than_it_can() {
    let mut six = settings(Method::Relt, 16, 1);
    let set = format!("uniform{}", ";1,0,1,1,1,1".repeat(5));
    six.options.replicas = Some(set.parse().expect("a set"));
    six.options.exchange = Schedule::Permutation;
    let scene = scene("cornell", 16);
    assert!(render(&scene, &six, &mut Control::default()).is_err());
    six.options.exchange = Schedule::Full;
    assert!(picture(&scene, &six).rgb()[1].iter().any(|&v| v > 0.0));
}
