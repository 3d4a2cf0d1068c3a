//! The light of a picture measured beside the chains that make it.

use glam::Affine3A;
use kaustik::estimate::{Contribution, ScalarTarget};
use kaustik::film::{Filter, Window};
use kaustik::scene::Scene;
use kaustik::scene::builtin;
use kaustik::scene::description::{Lens, LightDescription, LightKind};
use kaustik::{
    Budget, Builder, ChainStatistics, Control, Direct, Method, Mis, Normaliser, RenderSettings,
    StepId, render, replay,
};

use crate::bits::bits;
use crate::support::{compile, picture, scene, settings as small};

const SIDE: u32 = 16;

/// With a pilot and a population that know the light well: the meter's grid goes by the one.
fn settings(method: Method, side: u32, spp: u64) -> RenderSettings {
    let mut settings = small(method, side, spp);
    (settings.options.pilot, settings.options.particles) = (20_000, 2_000);
    settings
}

fn chain(scene: &Scene, settings: &RenderSettings) -> ChainStatistics {
    let done = render(scene, settings, &mut Control::default()).expect("a render");
    done.statistics.chain.expect("a chain")
}

/// Methods that it measures for, and settings under which it measures something else.
fn metered() -> [RenderSettings; 8] {
    let with = |method, builder| {
        // A sample of `mmlt` is one strategy of many.
        let spp = if method == Method::Mmlt { 2_000 } else { 300 };
        let mut settings = settings(method, SIDE, spp);
        settings.options.builder = builder;
        settings.options.direct = Direct::Lamps;
        settings
    };
    let mut luminance = with(Method::Pssmlt, Builder::Simple);
    luminance.options.target = ScalarTarget::Luminance;
    let mut apart = with(Method::Pssmlt, Builder::Endpoint);
    apart.options.direct = Direct::Apart;
    apart.budget = Budget::PerPixel(1_500);
    // Its `b` is of the image, whatever the window.
    let mut window = with(Method::Mlt, Builder::default());
    window.filter = Filter::new("tent", Some(2.0)).expect("a filter");
    window.crop = Some(Window {
        x0: 3,
        y0: 2,
        x1: 13,
        y1: 16,
    });
    [
        with(Method::Pssmlt, Builder::Unidirectional),
        with(Method::Pssmlt, Builder::Bidirectional),
        with(Method::Mmlt, Builder::default()),
        with(Method::Mlt, Builder::default()),
        with(Method::Relt, Builder::default()),
        luminance,
        apart,
        window,
    ]
}

/// By how many of its errors the light is off from what samples of the method's own say, and the error as a share of it.
fn off(scene: &Scene, settings: &RenderSettings, depth: u32) -> [f64; 2] {
    let with = |meter, depth| {
        let mut settings = settings.clone();
        settings.options.meter = meter;
        settings.max_depth = depth;
        chain(scene, &settings)
    };
    let (here, own) = (with(true, depth), with(false, settings.max_depth));
    assert!(here.metered > 0.2 && own.metered.to_bits() == 0, "{here:?}");
    let error = here.normalisation_error.hypot(own.normalisation_error);
    [
        (here.normalisation - own.normalisation).abs() / error,
        error / own.normalisation,
    ]
}

/// In a scene whose light is all Dirac, and easy to find for whoever looks for it.
#[test]
fn it_measures_the_light_that_the_methods_show() {
    let scene = lamp();
    for settings in metered() {
        let of = &settings.options;
        let name = format!("{} {:?}", settings.method, of.builder);
        let [off_by, error] = off(&scene, &settings, settings.max_depth);
        assert!(off_by < 4.0 && error < 0.03, "{name}: {off_by} {error}");
        // The test of the test: light by paths of five edges at most.
        let [off_by, _] = off(&scene, &settings, 5);
        assert!(off_by > 5.0, "{name}: {off_by}");
    }
}

/// A lamp that is seen through glass; the methods' own samples meet its light seldom.
fn lamp() -> Scene {
    scene("glass-cube?light=1.5", SIDE)
}

/// The specific replica's light, measured and by its scouts alone.
#[test]
fn it_measures_the_specific_replica() {
    let scene = lamp();
    let light = |meter, depth| {
        let mut settings = settings(Method::Relt, SIDE, 300);
        (settings.options.meter, settings.max_depth) = (meter, depth);
        let done = render(&scene, &settings, &mut Control::default()).expect("a render");
        let levels = done.statistics.replicas.expect("replicas").levels;
        let last = levels.last().expect("a level");
        [last.share, last.share_error.expect("an error")]
    };
    let ([with, error], [without, own_error]) = (light(true, 64), light(false, 64));
    let off = |with: f64| (with - without).abs() / error.hypot(own_error);
    assert!(
        off(with) < 4.0,
        "{with} +- {error}, {without} +- {own_error}"
    );
    assert!(error < 0.7 * own_error, "{error} {own_error}");
    // The test of the test: by paths of five edges at most.
    let [less, _] = light(true, 5);
    assert!(off(less) > 4.0, "{less} {without} +- {own_error}");
}

const SEEDS: u64 = 16;
/// 0.0001 and 0.9999 quantiles of chi-square with 15 degrees of freedom: light that is met seldom makes the law of an error
/// wider.
const BOUNDS: std::ops::Range<f64> = 2.4..44.3;

/// The first two of the same number of passes.
const SPREAD: [(Method, u64); 3] = [
    (Method::Pssmlt, 1_000),
    (Method::Mlt, 2_000),
    (Method::Relt, 200),
];

#[test]
fn seeds_differ_by_the_error_that_they_state() {
    assert_stated_errors(&SPREAD[..1]);
}

#[test]
#[ignore = "long"]
fn seeds_of_every_method_differ_by_the_error_that_they_state() {
    assert_stated_errors(&SPREAD);
}

fn assert_stated_errors(methods: &[(Method, u64)]) {
    let scene = lamp();
    for &(method, spp) in methods {
        let of_seed = |seed| {
            let mut settings = settings(method, SIDE, spp);
            (settings.seed, settings.options.pilot) = (seed, 5_000);
            let chain = chain(&scene, &settings);
            [chain.normalisation, chain.normalisation_error]
        };
        let found: Vec<[f64; 2]> = (0..SEEDS).map(of_seed).collect();
        let mean = found.iter().map(|[b, _]| b).sum::<f64>() / SEEDS as f64;
        let chi_square = |factor: f64| -> f64 {
            let off = |[b, error]: &[f64; 2]| ((b - mean) / (error * factor)).powi(2);
            found.iter().map(off).sum()
        };
        let right = chi_square(1.0);
        assert!(BOUNDS.contains(&right), "{method}: {right} {found:?}");
        // The test of the test.
        for factor in [0.2, 5.0] {
            assert!(!BOUNDS.contains(&chi_square(factor)), "{method}: {found:?}");
        }
    }
}

/// Without Dirac surfaces, without a running scale, with weights that need none, where another integral is wanted, and where the
/// method does not show all of the light, there is nothing to measure.
#[test]
fn elsewhere_it_changes_nothing() {
    let (lamp, cornell) = (lamp(), scene("cornell", SIDE));
    let mut description = builtin::load("glass-cube").expect("a built-in scene");
    description.lights.push(LightDescription {
        name: "point".to_owned(),
        kind: LightKind::Point,
        color: [1.0; 3],
        intensity: 1.0,
        range: None,
        transform: Affine3A::IDENTITY,
    });
    let point = compile(&description, SIDE);
    type Change = fn(&mut RenderSettings);
    let same: [(&Scene, Change); 7] = [
        (&cornell, |_| {}),
        (&lamp, |s| s.options.normaliser = Normaliser::Initial),
        (&lamp, |s| s.options.mis = Mis::Printed),
        (&lamp, |s| {
            s.options.contribution = Contribution::Maximum;
        }),
        (&point, |_| {}),
        (&lamp, |s| {
            (s.method, s.options.normaliser) = (Method::Relt, Normaliser::Exchange);
        }),
        // no scouts, no meter
        (&lamp, |s| {
            s.method = Method::Relt;
            s.options
                .set(Method::Relt, "replicas=paper")
                .expect("a setting");
        }),
    ];
    let both = |scene: &Scene, change: Change| {
        [true, false].map(|meter| {
            let mut settings = settings(Method::Pssmlt, SIDE, 20);
            change(&mut settings);
            settings.options.meter = meter;
            bits(&picture(scene, &settings))
        })
    };
    for (at, (scene, change)) in same.into_iter().enumerate() {
        let [with, without] = both(scene, change);
        assert!(with == without, "{at}");
    }
    // It does where there is.
    let [with, without] = both(&lamp, |_| {});
    assert!(with != without);
    let [with, without] = both(&lamp, |s| s.method = Method::Relt);
    assert!(with != without);
    let [with, without] = both(&point, |s| s.options.builder = Builder::Bidirectional);
    assert!(with != without);
    let [with, without] = both(&point, |s| s.method = Method::Mlt);
    assert!(with != without);
    // Points by way of glass alone, through a lens with area, are nothing that `mlt` shows.
    description.cameras[0].lens = Some(Lens {
        aperture: 0.05,
        focus: 3.0,
        blades: None,
    });
    let [with, without] = both(&compile(&description, SIDE), |s| s.method = Method::Mlt);
    assert!(with == without);
}

#[test]
fn its_samples_are_replayed() {
    let show = |scene: &Scene, method, step| {
        let place = StepId {
            ladder: StepId::METER,
            step,
        };
        replay(scene, &settings(method, SIDE, 1), place)
    };
    let (lamp, cornell) = (lamp(), scene("cornell", SIDE));
    for method in [Method::Pssmlt, Method::Mmlt, Method::Mlt, Method::Relt] {
        // joined walks, scouts
        let events: usize = (0..50)
            .map(|step| show(&lamp, method, step).expect("events").len())
            .sum();
        assert!(events > 50, "{method}: {events}");
        let refused = show(&cornell, method, 0).expect_err("no meter");
        assert!(refused.to_string().contains("meter"), "{refused}");
    }
    assert!(show(&lamp, Method::Path, 0).is_err());
}
