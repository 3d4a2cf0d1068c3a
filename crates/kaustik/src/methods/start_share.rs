//! How much of its start a render has time for.

use std::time::{Duration, Instant};

use kaustik_mcmc::{Independent, SampleGenerators};
use kaustik_path::{Bidirectional, Contributions, Form, PathBuilder};
use kaustik_scene::Scene;

use super::builders::{builder, builder_settings};
use crate::sampling::streams;
use crate::{Budget, Method, Normaliser, RenderError, RenderSettings, StartShare, State};

/// A start may take this share of the time that a render has. (Measured, `relt` on three scenes with caustics: with a third to a half of three seconds it has less
/// error than with a quarter or with all of them.)
const OF_TIME: f64 = 0.5;
/// Samples that are timed together.
const BATCH: u64 = 16;
/// The look ends after so many batches,
const BATCHES: usize = 32;
/// or after the first that ends beyond this share of the time.
const OF_LOOK: u32 = 64;
/// The look's own seed.
const SEED: u64 = 0x057A_27E2_B0D6_E7ED;

/// What the state of a render was made with.
pub(crate) fn of_state(state: &State) -> StartShare {
    match state.settings().map(|settings| settings.options.start) {
        Ok(share @ StartShare::Halved(_)) => share,
        // Of a method that has no such setting, or not of this program: it is refused for what it is.
        Ok(StartShare::Auto) | Err(_) => StartShare::WHOLE,
    }
}

/// Which share is made where that is left open ([`StartShare::Auto`]): all of it but where the time is short. This is the one choice that goes by
/// the clock, as does how long such a render is; what it has come to stands in the state.
pub(crate) fn choice(scene: &Scene, settings: &RenderSettings) -> StartShare {
    let Budget::Time(limit) = settings.budget else {
        return StartShare::WHOLE;
    };
    if !may_be_shortened(settings) {
        return StartShare::WHOLE;
    }
    let Ok(seconds) = seconds_a_sample(scene, settings, limit / OF_LOOK) else {
        // The engine tells what is wrong.
        return StartShare::WHOLE;
    };
    let threads = rayon::current_num_threads() as f64;
    let most = OF_TIME * limit.as_secs_f64() * threads / seconds;
    let fits = |halvings: &u32| samples(settings, StartShare::Halved(*halvings)) <= most;
    let halvings = (0..StartShare::MOST_HALVINGS).find(fits);
    StartShare::Halved(halvings.unwrap_or(StartShare::MOST_HALVINGS))
}

/// Shares of a render must start alike, whatever machines they are on; and what fixes the brightness for good is not to depend on the
/// clock.
fn may_be_shortened(settings: &RenderSettings) -> bool {
    let starts = settings.method.keys().any(|key| key.name == "start");
    let all = settings.ladder_range() == (0..settings.options.ladders);
    starts && all && settings.options.normaliser != Normaliser::Initial
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

/// What a sample takes on one thread: the median of batches.
fn seconds_a_sample(
    scene: &Scene,
    settings: &RenderSettings,
    patience: Duration,
) -> Result<f64, RenderError> {
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
    let begin = Instant::now();
    let mut batches = Vec::new();
    while batches.is_empty() || (batches.len() < BATCHES && begin.elapsed() < patience) {
        let (first, batch) = (BATCH * batches.len() as u64, Instant::now());
        for index in first..first + BATCH {
            let mut u = Independent::new(generators.at(index));
            paths.build(scene, &mut u, &mut value);
        }
        batches.push(batch.elapsed().as_secs_f64() / BATCH as f64);
    }
    // A batch in which the processor was away tells nothing.
    batches.sort_by(f64::total_cmp);
    Ok(batches[(batches.len() - 1) / 2])
}

#[cfg(test)]
mod tests {
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
        let whole: [fn(&mut RenderSettings); 4] = [
            |s| s.budget = Budget::PerPixel(1),
            |s| s.budget = Budget::Total(1),
            |s| s.ladders = Some(0..1),
            |s| s.options.normaliser = Normaliser::Initial,
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
