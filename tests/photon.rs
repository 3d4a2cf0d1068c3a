//! Photon methods: against bidirectional paths as the radius shrinks, against each other at any radius.

use kaustik::estimate::Combine;
use kaustik::film::Image;
use kaustik::scene::Scene;
use kaustik::{
    Budget, Control, LadderSize, Method, Normalisation, RenderSettings, RenderStatistics, render,
};

use crate::support::{means, picture, scene, settings, tile_means};

pub(crate) const SIDE: u32 = 32;

/// Settings for so many iterations of so many light paths.
pub(crate) fn photons(method: Method, iterations: u64, photons: u64) -> RenderSettings {
    let mut settings = settings(method, SIDE, iterations);
    settings.budget = Budget::PerPixel(iterations);
    settings.options.photon.photons = Some(photons);
    settings.options.ladders = 16;
    // What discs of one size show, the same for all.
    settings.options.photon.reduction = None;
    settings
}

pub(crate) fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Root of the mean squared relative difference of tiles.
fn distance(a: &Image, b: &Image) -> f64 {
    let tiles = tile_means(a).into_iter().zip(tile_means(b));
    let squares: Vec<f64> = tiles
        .map(|(a, b)| {
            let (a, b) = (luminance(a), luminance(b));
            ((a - b) / b.max(1e-3)).powi(2)
        })
        .collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

pub(crate) fn reference(scene: &Scene, spp: u64) -> Image {
    picture(scene, &settings(Method::Bdpt, SIDE, spp))
}

/// Errors against bidirectional paths, for each of the radii and numbers of iterations.
fn errors(words: &str, method: Method, spp: u64, each: u64, radii: &[(f64, u64)]) -> Vec<f64> {
    let scene = scene(words, SIDE);
    let truth = reference(&scene, spp);
    let error = |&(radius, iterations): &(f64, u64)| {
        let mut settings = photons(method, iterations, each);
        settings.options.photon.radius = radius;
        distance(&picture(&scene, &settings), &truth)
    };
    radii.iter().map(error).collect()
}

#[test]
fn the_error_falls_with_the_radius() {
    let errors = errors(
        "cornell",
        Method::Sppm,
        128,
        60_000,
        &[(2.0, 12), (0.5, 12)],
    );
    assert!(
        errors[1] < 0.45 * errors[0] && errors[1] < 0.1,
        "{errors:?}"
    );
}

/// Discs are as large as a pixel's footprint, which is long where a surface is seen at a grazing angle: the error falls with the
/// radius, to about 1 % over tiles. Less from the largest to the next than after it, as the largest discs end where their
/// surface does. The small radii take many photons: with twelve iterations 0.15 has 1.7 % of noise.
fn falls(errors: &[f64]) -> bool {
    errors[1] < 0.6 * errors[0] && errors[2] < 0.5 * errors[1] && errors[3] < 0.015
}

macro_rules! errors_fall_with_the_radius {
    ($($name:ident: $words:literal, $method:ident;)*) => {$(
        #[test]
        #[ignore = "long"]
        fn $name() {
            let radii = [(2.0, 12), (0.6, 12), (0.15, 96), (0.05, 192)];
            let errors = errors($words, Method::$method, 8_000, 1_000_000, &radii);
            eprintln!("{}, {}: {errors:?}", $words, Method::$method);
            assert!(falls(&errors), "{errors:?}");
        }
    )*};
}

errors_fall_with_the_radius! {
    the_error_falls_with_the_radius_on_cornell: "cornell", Sppm;
    the_error_falls_with_the_radius_on_glass_cube: "glass-cube?light=0.8", Sppm;
    the_error_of_sppm_falls_with_the_radius: "ring-and-sphere?light=0.8", Sppm;
    the_error_of_photon_visibility_falls_with_the_radius: "ring-and-sphere?light=0.8", PhotonVisibility;
    the_error_of_photon_density_falls_with_the_radius: "ring-and-sphere?light=0.8", PhotonDensity;
    the_error_of_photon_image_falls_with_the_radius: "ring-and-sphere?light=0.8", PhotonImage;
    the_error_of_photon_spatial_falls_with_the_radius: "ring-and-sphere?light=0.8", PhotonSpatial;
}

/// A surface that is diffuse and glossy shows the one by photons and the other by what is left to the camera: with any
/// threshold each light path counts once.
#[test]
fn surfaces_of_two_parts_count_once() {
    let scene = scene("glossy-cornell", SIDE);
    let truth = reference(&scene, 256);
    for roughness in [0.05, 0.39] {
        let mut settings = photons(Method::Sppm, 12, 60_000);
        settings.options.photon.radius = 0.5;
        settings.options.photon.roughness = roughness;
        let image = picture(&scene, &settings);
        let (error, bias) = (
            distance(&image, &truth),
            luminance(means(&image)) / luminance(means(&truth)) - 1.0,
        );
        assert!(
            error < 0.12 && bias.abs() < 0.035,
            "{roughness}: {error}, {bias}"
        );
    }
}

/// A radius that shrinks from iteration to iteration ends nearer to the truth.
#[test]
fn reduction_takes_the_error_away() {
    let scene = scene("cornell", SIDE);
    let truth = reference(&scene, 256);
    let [kept, reduced] = [None, Some(0.1)].map(|reduction| {
        let mut settings = photons(Method::Sppm, 32, 20_000);
        settings.options.photon.radius = 2.0;
        settings.options.photon.reduction = reduction;
        distance(&picture(&scene, &settings), &truth)
    });
    assert!(reduced < 0.7 * kept, "{reduced} and {kept}");
}

/// With discs that shrink fewer light paths are visible from iteration to iteration, and each has its own share of them: by the
/// mean share this is a tenth too bright.
#[test]
fn chains_agree_while_discs_shrink() {
    const SIDE: u32 = 16;
    let scene = scene("cornell", SIDE);
    let brightness = |method| {
        let of = |seed: u64| {
            let mut settings = photons(method, 96, 4_000);
            // paths that land once
            (settings.width, settings.height, settings.max_depth) = (SIDE, SIDE, 2);
            settings.seed = seed;
            let photon = &mut settings.options.photon;
            (photon.radius, photon.reduction) = (0.5, Some(0.1));
            photon.combine = Combine::Average;
            luminance(means(&picture(&scene, &settings)))
        };
        (0..4).map(of).sum::<f64>()
    };
    let bias = brightness(Method::PhotonVisibility) / brightness(Method::Sppm) - 1.0;
    assert!(bias.abs() < 0.03, "{bias}");
}

/// Mean and standard error of it.
fn mean_of(values: &[f64]) -> [f64; 2] {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    [mean, (squares / (n - 1.0) / n).sqrt()]
}

/// Visibility goes with the wavelengths of an iteration, as roulette does: by the mean share of visible paths the red
/// canyon is some per cent too bright, by each iteration's own it is as independent photons see it.
#[test]
#[ignore = "long"]
fn an_iteration_has_its_own_share_of_visible_paths() {
    let scene = scene("canyon", SIDE);
    let brightness = |method, normalisation| -> Vec<f64> {
        let of = |seed| {
            let mut settings = photons(method, 40, 40_000);
            settings.seed = seed;
            settings.options.photon.normalisation = normalisation;
            luminance(means(&picture(&scene, &settings)))
        };
        (0..40).map(of).collect()
    };
    let [own, all] = [Normalisation::Iteration, Normalisation::Progressive]
        .map(|normalisation| brightness(Method::PhotonVisibility, normalisation));
    let independent = brightness(Method::Sppm, Normalisation::Iteration);
    let (own_mean, wanted) = (mean_of(&own), mean_of(&independent));
    let off = (own_mean[0] - wanted[0]) / own_mean[1].hypot(wanted[1]);
    let pairs: Vec<f64> = all
        .iter()
        .zip(&own)
        .map(|(all, own)| all / own - 1.0)
        .collect();
    let [bias, error] = mean_of(&pairs);
    eprintln!(
        "off by {off:.2} standard errors of {own_mean:?}, {wanted:?}; by the mean share {bias} +- {error}"
    );
    assert!(off.abs() < 3.5, "{own_mean:?}, {wanted:?}");
    assert!(bias > 4.0 * error, "{bias} +- {error}");
}

/// All methods estimate the same, the kernel's error included; so do the ways of combining chains.
#[test]
fn photon_methods_agree_with_each_other() {
    let scene = scene("ring-and-sphere?light=0.8", SIDE);
    let independent = picture(&scene, &photons(Method::Sppm, 16, 60_000));
    let chains = [
        (Method::PhotonVisibility, LadderSize::Two, Combine::Balance),
        (Method::PhotonVisibility, LadderSize::Two, Combine::Average),
        (Method::PhotonSpatial, LadderSize::Four, Combine::Balance),
        (Method::PhotonSpatial, LadderSize::Four, Combine::Average),
        (Method::PhotonSpatial, LadderSize::Three, Combine::Balance),
        (Method::PhotonSpatial, LadderSize::Two, Combine::Balance),
        (Method::PhotonImage, LadderSize::Four, Combine::Balance),
        (Method::PhotonDensity, LadderSize::Two, Combine::Balance),
    ];
    for (method, levels, combine) in chains {
        let mut settings = photons(method, 16, 60_000);
        settings.options.photon.levels = levels;
        settings.options.photon.combine = combine;
        let image = picture(&scene, &settings);
        let error = distance(&image, &independent);
        let bias = luminance(means(&image)) / luminance(means(&independent)) - 1.0;
        assert!(
            error < 0.05 && bias.abs() < 0.015,
            "{method}, {levels:?} levels, {combine:?}: {error}, {bias}"
        );
    }
}

/// Without the remainder glossy walls show no light that comes by mirrors, glass and glossy walls alone; with it they
/// do.
#[test]
fn the_remainder_is_what_photons_leave_out() {
    let scene = scene("glossy-cornell", SIDE);
    let truth = reference(&scene, 256);
    let [with, without] = [true, false].map(|remainder| {
        let mut settings = photons(Method::Sppm, 8, 30_000);
        settings.options.photon.remainder = remainder;
        settings.options.photon.radius = 0.1;
        settings.options.photon.roughness = 1.0;
        picture(&scene, &settings)
    });
    let brightness = |image: &Image| luminance(means(image));
    let (with, without, truth) = (brightness(&with), brightness(&without), brightness(&truth));
    assert!((with / truth - 1.0).abs() < 0.05, "{with}, {truth}");
    assert!(without < 0.9 * with, "{without}, {with}");
}

fn statistics(scene: &Scene, settings: &RenderSettings) -> RenderStatistics {
    let done = render(scene, settings, &mut Control::default());
    done.expect("a render").statistics
}

/// Chains report their levels; each normaliser is at most that of the level below, and visibility is what a plain
/// count says.
#[test]
fn chains_tell_their_normalisers() {
    let scene = scene("cornell", SIDE);
    let statistics = statistics(&scene, &photons(Method::PhotonSpatial, 4, 60_000));
    let photons = statistics.photons.expect("of chains");
    assert_eq!((photons.iterations, photons.levels.len()), (4, 4));
    for pair in photons.levels.windows(2) {
        assert!(
            pair[1].normaliser <= 1.001 * pair[0].normaliser,
            "{photons:?}"
        );
        assert!(pair[1].normaliser > 0.0 && pair[1].error < 0.5 * pair[1].normaliser);
        assert!(pair[1].acceptance > 0.05, "{photons:?}");
    }
    // What is not known of visibility is not known of what stands above it, and there is more.
    let relative = |level: usize| photons.levels[level].error / photons.levels[level].normaliser;
    assert!(relative(1) > 0.0, "{photons:?}");
    for level in [2, 3] {
        assert!(relative(level) > 1.01 * relative(1), "{photons:?}");
    }
    assert_eq!(statistics.nonfinite, 0);
    assert_eq!(statistics.steps, 4 * 60_000);
}

/// A single ladder tells its errors by batches of its sweeps.
#[test]
fn one_ladder_tells_errors_too() {
    let scene = scene("cornell", SIDE);
    let mut settings = photons(Method::PhotonSpatial, 4, 20_000);
    settings.options.ladders = 1;
    let photons = statistics(&scene, &settings).photons.expect("of chains");
    let relative = |level: usize| photons.levels[level].error / photons.levels[level].normaliser;
    for level in [2, 3] {
        let error = relative(level);
        assert!(error > 1.01 * relative(1) && error < 1.0, "{photons:?}");
    }
}

/// One lamp and roulette by albedo leave photons about equally bright; eight lamps of all colours do not.
#[test]
fn chains_tell_how_much_photons_differ() {
    let spread = |words: &str| {
        let scene = scene(words, SIDE);
        let statistics = statistics(&scene, &photons(Method::PhotonVisibility, 1, 2_000));
        statistics.photons.expect("of chains").power_spread
    };
    let (one, many) = (spread("cornell"), spread("disco"));
    assert!(one < 0.01 && many > 0.3, "{one}, {many}");
}

/// A share of the ladders would see other iterations than the rest: it is refused.
#[test]
fn shares_of_ladders_are_refused() {
    let scene = scene("cornell", SIDE);
    let settings = RenderSettings {
        ladders: Some(0..8),
        ..photons(Method::PhotonVisibility, 1, 1_000)
    };
    let error = render(&scene, &settings, &mut Control::default()).expect_err("a part");
    assert!(error.to_string().contains("0..16") || error.to_string().contains("all of them"));
}

/// What the target function is there for: where hardly any light comes to the camera, a chain that follows it has less noise from the same
/// number of light paths than one that goes wherever anything is seen. One that was the same everywhere would have as much.
#[test]
#[ignore = "long"]
fn the_target_of_regions_evens_out_noise() {
    const SEEDS: u64 = 10;
    let scene = scene("dinner-hall", SIDE);
    let pictures = |method: Method| -> Vec<Image> {
        let of = |seed| {
            let mut settings = photons(method, 12, 100_000);
            settings.options.photon.burn_in = None;
            picture(&scene, &RenderSettings { seed, ..settings })
        };
        (0..SEEDS).map(of).collect()
    };
    let nsd = |pictures: &[Image]| {
        let all: Vec<&Image> = pictures.iter().collect();
        kaustik::film::metrics::nsd(&all).expect("a picture").mean
    };
    let (spatial, visibility) = (
        nsd(&pictures(Method::PhotonSpatial)),
        nsd(&pictures(Method::PhotonVisibility)),
    );
    println!("{spatial} {visibility}");
    assert!(spatial < 0.8 * visibility, "{spatial} {visibility}");
}
