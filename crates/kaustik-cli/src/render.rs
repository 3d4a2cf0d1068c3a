//! `kaustik render`.

use std::process::ExitCode;
use std::time::Duration;

use kaustik::film::{FilmError, check_writable, exr, png, write_file};
use kaustik::scene::{Scene, SceneOptions};
use kaustik::spectrum::WavelengthSampling;
use kaustik::{Budget, Control, Options, Outcome, RenderError, RenderSettings, Rendered, render};
use serde_json::{Value, json};

use crate::arguments::RenderWords;
use crate::progress::Display;
use crate::signals::Signals;
use crate::{Failure, input, output};

pub(crate) fn run(words: &RenderWords) -> Result<ExitCode, Failure> {
    let settings = settings(words)?;
    for path in [&words.output, &words.png, &words.stats]
        .into_iter()
        .flatten()
    {
        check_writable(path).map_err(Failure::input)?;
    }
    let remark = |line: &str| {
        if !words.quiet {
            output::note(line);
        }
    };
    if words.output.is_none() && words.png.is_none() {
        remark("warning: neither -o nor --png is given: the picture will not be kept");
    }
    let input = input::load(&words.scene, words.max_memory, words.variant.as_deref())?;
    for warning in &input.warnings {
        remark(&format!("warning: {warning}"));
    }
    let size = (words.width, words.height);
    let (width, height) = input::image_size(&input.description, words.camera.as_deref(), size);
    let options = SceneOptions {
        width,
        height,
        camera: words.camera.clone(),
        environment: words
            .environment
            .as_deref()
            .map(input::environment)
            .transpose()?,
        compensation: settings.options.compensation,
    };
    let scene = Scene::new(&input.description, &options)
        .map_err(|error| Failure::Input(format!("{}: {error}", words.scene)))?;
    drop(input);
    for notice in scene.notices() {
        remark(&format!("note: {notice}"));
    }
    let settings = RenderSettings {
        width,
        height,
        ..settings
    };
    finish(words, &settings, &scene)
}

/// Renders, writes what there is, and says how it went.
fn finish(
    words: &RenderWords,
    settings: &RenderSettings,
    scene: &Scene,
) -> Result<ExitCode, Failure> {
    let signals = Signals::listen()?;
    let mut display = Display::new(words.quiet);
    let mut show = |progress: &kaustik::Progress| display.show(progress);
    let mut control = Control {
        stop: Some(&signals.stop),
        progress: Some(&mut show),
    };
    let rendered = render(scene, settings, &mut control);
    display.finish();
    let rendered = rendered.map_err(|error| match error {
        RenderError::Setting { .. } | RenderError::Film(FilmError::Empty { .. }) => {
            Failure::input(error)
        }
        _ => Failure::other(error),
    })?;
    write(words, settings, rendered)?;
    Ok(signals.status().map_or(ExitCode::SUCCESS, ExitCode::from))
}

fn write(
    words: &RenderWords,
    settings: &RenderSettings,
    rendered: Rendered,
) -> Result<(), Failure> {
    let Rendered {
        image,
        statistics,
        outcome,
    } = rendered;
    let metadata = metadata(words, settings, &json!(statistics));
    let image = image.with_metadata(metadata.clone());
    if let Some(path) = &words.output {
        exr::write(path, &image).map_err(Failure::other)?;
    }
    if let Some(path) = &words.png {
        png::write(path, &image, &words.display()).map_err(Failure::other)?;
    }
    if let Some(path) = &words.stats {
        let text = format!("{metadata:#}\n");
        write_file(path, |file| {
            std::io::Write::write_all(file, text.as_bytes())
        })
        .map_err(Failure::other)?;
    }
    if words.quiet {
        return Ok(());
    }
    if outcome == Outcome::Black {
        output::note(
            "note: nothing that was tried brings light to the camera: the picture is black",
        );
        return Ok(());
    }
    let mut line = format!(
        "{}: {:.1} samples a pixel in {:.1} s ({:.2} M/s)",
        statistics.method,
        statistics.per_pixel,
        statistics.seconds,
        statistics.steps as f64 / statistics.seconds.max(1e-9) * 1e-6
    );
    if let Some(chain) = &statistics.chain {
        line += &format!(
            ", accepted {:.1} % of small and {:.1} % of large steps, b = {:.6} +- {:.6}",
            chain.small_acceptance * 100.0,
            chain.large_acceptance * 100.0,
            chain.normalisation,
            chain.normalisation_error
        );
    }
    output::note(&line);
    if let Some(replicas) = &statistics.replicas {
        for notice in replicas.notices() {
            output::note(&notice);
        }
    }
    if let Some(energy) = &statistics.energy {
        for notice in energy.notices() {
            output::note(&notice);
        }
    }
    let lost = statistics.nonfinite + statistics.film.non_finite + statistics.film.too_large;
    if lost > 0 {
        let place = statistics.first_nonfinite.map_or(String::new(), |place| {
            format!(
                "; the first at {}:{}:{} (seed:ladder:step)",
                statistics.seed, place.ladder, place.step
            )
        });
        output::note(&format!(
            "warning: {lost} contributions were not finite or too large, left out{place}"
        ));
    }
    if statistics.film.overflowed > 0 {
        output::note(
            "warning: sums of the film overflowed: the picture is wrong where it is brightest",
        );
    }
    Ok(())
}

/// The settings that do not depend on the scene.
fn settings(words: &RenderWords) -> Result<RenderSettings, Failure> {
    let mut options = Options::default();
    if words.wavelengths.as_deref() == Some("1") {
        options.wavelengths = WavelengthSampling::Single;
    }
    for setting in &words.settings {
        options
            .set(words.method, setting)
            .map_err(|error| Failure::Input(format!("--set {setting}: {error}")))?;
    }
    let one = options.wavelengths == WavelengthSampling::Single;
    if words
        .wavelengths
        .as_deref()
        .is_some_and(|n| (n == "1") != one)
    {
        return Err(Failure::Input(
            "--wavelengths and --set wavelengths contradict each other: 4 is hero, 1 is uniform"
                .to_owned(),
        ));
    }
    if options.builder == kaustik::Builder::Endpoint && !options.next_event {
        return Err(Failure::Input(
            "--set nextevent=off with --set builder=endpoint: an endpoint is joined or it is nothing"
                .to_owned(),
        ));
    }
    let default = RenderSettings::default();
    let budget = match (words.spp, words.mutations, words.time) {
        (Some(n), _, _) => Budget::PerPixel(n),
        (_, Some(n), _) => Budget::Total(n),
        (_, _, time) => Budget::Time(time.unwrap_or(Duration::from_secs(60))),
    };
    Ok(RenderSettings {
        method: words.method,
        options,
        crop: words.crop,
        filter: words.filter,
        budget,
        seed: words.seed,
        threads: words
            .threads
            .map_or(default.threads, |threads| threads as usize),
        max_depth: words.max_depth,
        ladders: words.ladders.clone(),
        features: !words.no_features,
        ..default
    })
}

/// What goes into the EXR and into `--stats`.
fn metadata(words: &RenderWords, settings: &RenderSettings, statistics: &Value) -> Value {
    let set: serde_json::Map<String, Value> = (settings.options)
        .entries(settings.method)
        .into_iter()
        .map(|(key, value)| (key.to_owned(), Value::String(value)))
        .collect();
    let budget = match settings.budget {
        Budget::PerPixel(n) => format!("{n} a pixel"),
        Budget::Total(n) => format!("{n} in all"),
        Budget::Time(time) => format!("{} s", time.as_secs_f64()),
    };
    json!({
        "software": format!("kaustik {}", env!("CARGO_PKG_VERSION")),
        "scene": words.scene,
        "width": settings.width,
        "height": settings.height,
        "max_depth": settings.max_depth,
        "filter": settings.filter.to_string(),
        "crop": settings.layout().crop.to_string(),
        "budget": budget,
        "camera": words.camera,
        "variant": words.variant,
        "environment": words.environment,
        "ladders": [settings.ladder_range().start, settings.ladder_range().end],
        "set": set,
        "statistics": statistics,
    })
}
