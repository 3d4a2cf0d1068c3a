//! How much of its start a render has time for.

use glam::DVec2;
use kaustik_geometry::Ray;
use kaustik_mcmc::{Draws, Independent, SampleGenerators};
use kaustik_path::{Bidirectional, Contributions, Form, PathBuilder};
use kaustik_scene::Scene;
use kaustik_spectrum::Wavelengths;

use super::builders::{builder, builder_settings};
use crate::sampling::streams;
use crate::{Budget, Method, Mis, Normaliser, RenderError, RenderSettings, StartShare, State};

/// A start may take this share of the time that a render has. (Measured, `relt` on three scenes with caustics: with a third to a half of three seconds it has less
/// error than with a quarter or with all of them.)
const OF_TIME: f64 = 1.0 / 3.0;
/// Samples of the look.
const SAMPLES: u64 = 64;
/// The look's own seed.
const SEED: u64 = 0x057A_27E2_B0D6_E7ED;
/// Seconds that a ray is taken to last with all that is done for it, on each of [`THREADS`] threads. (By the samples of `path` and `bdpt` on `cornell` 0.26 and 0.35 us; there are slower machines.)
const A_RAY: f64 = 0.45e-6;
/// As many threads are taken to be there, whatever there are: the picture is not to depend on them.
const THREADS: f64 = 2.0;
/// So many surfaces on a line are nothing unusual;
const USUAL_SURFACES: f64 = 32.0;
/// with every so many more a ray is taken to last as long again. (Measured on a stack of 20,000 sheets of glass.)
const SURFACES: f64 = 8.0;

/// What the state of a render was made with.
pub(crate) fn of_state(state: &State) -> StartShare {
    match state.settings().map(|settings| settings.options.start) {
        Ok(share @ StartShare::Halved(_)) => share,
        // Of a method that has no such setting, or not of this program: it is refused for what it is.
        Ok(StartShare::Auto) | Err(_) => StartShare::WHOLE,
    }
}

/// Has the method a start that may be shortened?
pub(crate) fn has_start(method: Method) -> bool {
    method.keys().any(|key| key.name == "start")
}

/// Which share is made where that is left open ([`StartShare::Auto`]): all of it but where the time is short for what a look at the scene
/// finds. The look counts rays instead of asking the clock: on every machine, and every time, the start is the same.
pub(crate) fn choice(scene: &Scene, settings: &RenderSettings) -> StartShare {
    let Budget::Time(limit) = settings.budget else {
        return StartShare::WHOLE;
    };
    if !may_be_shortened(settings) {
        return StartShare::WHOLE;
    }
    let Ok(seconds) = seconds_a_sample(scene, settings) else {
        // The engine tells what is wrong.
        return StartShare::WHOLE;
    };
    let most = OF_TIME * limit.as_secs_f64() / seconds;
    let fits = |halvings: &u32| samples(settings, StartShare::Halved(*halvings)) <= most;
    let halvings = (0..StartShare::MOST_HALVINGS).find(fits);
    StartShare::Halved(halvings.unwrap_or(StartShare::MOST_HALVINGS))
}

/// Shares of a render must start alike, whatever time each is given; and what fixes the brightness for good is worth its time.
fn may_be_shortened(settings: &RenderSettings) -> bool {
    let options = &settings.options;
    let all = settings.ladder_range() == (0..options.ladders);
    let fixes = options.normaliser == Normaliser::Initial || options.mis == Mis::Printed;
    has_start(settings.method) && all && !fixes
}

/// About how many samples, as costly as those of the look, a start takes, with particles that move at each level, scouts, and looks of the meter. (Measured on six
/// built-in scenes.)
fn samples(settings: &RenderSettings, share: StartShare) -> f64 {
    let options = &settings.options;
    let (count, each) = match settings.method {
        Method::Relt => (options.particles, 30.0),
        _ => (options.pilot, 4.0),
    };
    share.of(count) as f64 * each
}

/// What a sample is taken to last, by its rays and by how many surfaces lie on some of them.
fn seconds_a_sample(scene: &Scene, settings: &RenderSettings) -> Result<f64, RenderError> {
    let paths: Box<dyn PathBuilder> = match settings.method {
        Method::Pssmlt | Method::ErptPss | Method::Erpt => builder(scene, settings)?,
        _ => Box::new(Bidirectional {
            settings: builder_settings(settings),
            form: Form::Full,
            heuristic: settings.options.heuristic,
        }),
    };
    let generators = SampleGenerators::new(SEED, streams::START_LOOK);
    let mut value = Contributions::default();
    let (mut rays, mut lines, mut surfaces) = (0, 0_u32, 0);
    for index in 0..SAMPLES {
        let mut u = Independent::new(generators.at(2 * index));
        paths.build(scene, &mut u, &mut value);
        rays += value.rays().closest + value.rays().any;
        for ray in first_rays(scene, settings, &mut generators.at(2 * index + 1)) {
            lines += 1;
            surfaces += surfaces_on(scene, &ray);
        }
    }
    let unusual = (surfaces as f64 / f64::from(lines) - USUAL_SURFACES).max(0.0);
    let a_ray = A_RAY * (1.0 + unusual / SURFACES);
    Ok(rays as f64 / SAMPLES as f64 * a_ray / THREADS)
}

/// A ray from the camera, and one from an emitter.
fn first_rays(
    scene: &Scene,
    settings: &RenderSettings,
    draws: &mut impl Draws,
) -> impl Iterator<Item = Ray> {
    let mut uniform = || draws.uniform();
    let raster = builder_settings(settings).raster(DVec2::new(uniform(), uniform()));
    let seen = scene.camera().sample_ray(raster, [uniform(), uniform()]);
    let wavelengths = Wavelengths::sample(uniform(), settings.options.wavelengths);
    let emitted = scene.sample_emission(&wavelengths, |_| uniform());
    [Some(seen.ray()), emitted.map(|emission| emission.ray)]
        .into_iter()
        .flatten()
}

/// How many surfaces lie on a ray, whatever is in front of what.
fn surfaces_on(scene: &Scene, ray: &Ray) -> u64 {
    let mut count = 0;
    scene.world().occluded_filtered(ray, |_| {
        count += 1;
        false
    });
    count
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::small;

    fn chosen(method: Method, change: impl FnOnce(&mut RenderSettings)) -> StartShare {
        const SIDE: u32 = 8;
        let mut settings = RenderSettings {
            budget: Budget::Time(Duration::from_millis(1)),
            ..small::settings(method, [SIDE; 2])
        };
        settings.options.pilot = 100_000;
        settings.options.particles = 10_000;
        change(&mut settings);
        choice(&small::scene("cornell", [SIDE; 2]), &settings)
    }

    #[test]
    fn a_start_is_shortened_where_there_is_no_time_for_all() {
        let least = StartShare::Halved(StartShare::MOST_HALVINGS);
        for method in Method::ALL {
            let shortened = chosen(method, |_| {});
            let expected = match method {
                Method::Pssmlt
                | Method::Mmlt
                | Method::Relt
                | Method::ErptPss
                | Method::Mlt
                | Method::Erpt => least,
                _ => StartShare::WHOLE,
            };
            assert_eq!(shortened, expected, "{method}");
            let hour = |s: &mut RenderSettings| s.budget = Budget::Time(Duration::from_secs(3600));
            assert_eq!(chosen(method, hour), StartShare::WHOLE, "{method}");
        }
    }

    #[test]
    fn what_must_start_alike_does() {
        let shortened = chosen(Method::Pssmlt, |s| s.ladders = Some(0..s.options.ladders));
        assert!(shortened != StartShare::WHOLE);
        let whole: [fn(&mut RenderSettings); 5] = [
            |s| s.budget = Budget::PerPixel(1),
            |s| s.budget = Budget::Total(1),
            |s| s.ladders = Some(0..1),
            |s| s.options.normaliser = Normaliser::Initial,
            |s| s.options.mis = Mis::Printed,
        ];
        for change in whole {
            assert_eq!(chosen(Method::Pssmlt, change), StartShare::WHOLE);
        }
    }

    #[test]
    fn a_share_leaves_some_samples() {
        assert_eq!(StartShare::Auto.of(10_000), 10_000);
        assert_eq!(StartShare::Halved(3).of(10_000), 1250);
        assert_eq!(StartShare::Halved(10).of(10_000), 64);
        assert_eq!(StartShare::Halved(10).of(12), 12);
        assert_eq!(StartShare::Halved(64).of(12), 12);
    }

    #[test]
    fn words_for_shares_are_read_again() {
        for halvings in 0..=StartShare::MOST_HALVINGS {
            let share = StartShare::Halved(halvings);
            assert_eq!(StartShare::parse(&share.text()), Some(share));
        }
        assert_eq!(StartShare::parse("auto"), Some(StartShare::Auto));
        for wrong in [
            "", "1", "1/1", "1/3", "1/2048", "1/0", "1/-2", "2/1", "0.5", "half",
        ] {
            assert_eq!(StartShare::parse(wrong), None, "{wrong}");
        }
    }
}
