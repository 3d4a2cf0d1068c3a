//! Where a picture goes, and what is said about it.

use std::path::{Path, PathBuf};

use kaustik::film::{check_writable, exr, png, write_file};
use kaustik::{
    Budget, Method, Outcome, RenderSettings, RenderStatistics, Rendered, Source, StepId,
};
use serde_json::{Value, json};

use crate::arguments::OutputWords;
use crate::{Failure, output};

/// Finds out before a long render what could not be written after it, or would take the place of what it is made from.
/// `state`: where a state will be that keeps the picture as well.
pub(crate) fn check<'a>(
    words: &OutputWords,
    state: Option<&PathBuf>,
    inputs: &(impl Iterator<Item = &'a Path> + Clone),
) -> Result<(), Failure> {
    for path in words.files().chain(state) {
        if path.as_os_str() == "-" {
            return Err(Failure::Input(
                "-: pictures, states and statistics do not go to standard output: expected the name of a file (./- is one)"
                    .to_owned(),
            ));
        }
    }
    for path in words.files() {
        refuse_inputs(path, inputs.clone())?;
        check_writable(path).map_err(Failure::input)?;
    }
    let kind = |path: &Option<PathBuf>| path.as_deref().and_then(ending);
    if let Some(other) = kind(&words.output).filter(|kind| kind != "exr") {
        return Err(Failure::Input(format!(
            "-o writes EXR, and is given a file that ends in .{other}: expected .exr (--png writes PNG)"
        )));
    }
    if let Some(other) = kind(&words.png).filter(|kind| kind != "png") {
        return Err(Failure::Input(format!(
            "--png writes PNG, and is given a file that ends in .{other}: expected .png (-o writes EXR)"
        )));
    }
    if words.output.is_none() && words.png.is_none() && state.is_none() {
        remark(
            words,
            "warning: neither -o nor --png is given: the picture will not be kept",
        );
    }
    Ok(())
}

/// What the name of a file ends in, in small letters.
pub(crate) fn ending(path: &Path) -> Option<String> {
    let ending = path.extension()?;
    Some(ending.to_string_lossy().to_lowercase())
}

/// Refuses an output that is one of the inputs.
pub(crate) fn refuse_inputs<'a>(
    output: &Path,
    mut inputs: impl Iterator<Item = &'a Path>,
) -> Result<(), Failure> {
    let Ok(there) = output.canonicalize() else {
        return Ok(());
    };
    match inputs.find(|input| input.canonicalize().is_ok_and(|input| input == there)) {
        None => Ok(()),
        Some(input) => Err(Failure::Input(format!(
            "{}: this is {}, which is read: expected another file to write to",
            output.display(),
            input.display()
        ))),
    }
}

/// The files that a scene is made from, as far as these words name them; those that are none are not there.
pub(crate) fn scene_files<'a>(
    scene: &'a str,
    environment: Option<&'a str>,
) -> impl Iterator<Item = &'a Path> + Clone {
    std::iter::once(scene).chain(environment).map(Path::new)
}

/// The same of a source.
pub(crate) fn source_files(source: &Source) -> impl Iterator<Item = &Path> + Clone {
    scene_files(&source.scene, source.environment.as_deref())
}

/// A line for whoever wants to read.
pub(crate) fn remark(words: &OutputWords, line: &str) {
    if !words.quiet {
        output::note(line);
    }
}

/// Writes the picture and its statistics, without a word about it. All that can be written is written, even
/// if something else cannot be; the first failure is returned, others are told.
pub(crate) fn write(
    words: &OutputWords,
    source: &Source,
    settings: &RenderSettings,
    rendered: Rendered,
) -> Result<(), Failure> {
    let metadata = metadata(source, settings, &json!(rendered.statistics));
    let image = rendered.image.with_metadata(metadata.clone());
    let mut written = Vec::new();
    if let Some(path) = &words.output {
        written.push(exr::write(path, &image));
    }
    if let Some(path) = &words.png {
        written.push(png::write(path, &image, &words.display()));
    }
    if let Some(path) = &words.stats {
        let text = format!("{metadata:#}\n");
        written.push(write_file(path, |file| {
            std::io::Write::write_all(file, text.as_bytes())
        }));
    }
    let mut failures = written.into_iter().filter_map(Result::err);
    let first = failures.next();
    for other in failures {
        output::note(&format!("error: {other}"));
    }
    first.map_or(Ok(()), |error| Err(Failure::other(error)))
}

/// Places that are printed; `--stats` has more.
const PRINTED: usize = 8;

/// Where contributions were left out, and what shows one of them again.
fn places(statistics: &RenderStatistics) -> String {
    let seed = statistics.seed;
    let place = |place: &StepId| format!("{seed}:{place}");
    let places = &statistics.nonfinite_places;
    let Some(first) = places.first().map(place) else {
        return String::new();
    };
    let all: Vec<_> = places.iter().take(PRINTED).map(place).collect();
    let mut text = format!(
        "; the first of each ladder at {} (seed:ladder:step)",
        all.join(", ")
    );
    text +=
        &format!("; kaustik replay with the words of this render and --at {first} shows that path");
    if statistics.start_share < 1.0 {
        // A render that went on has the start of a shorter time.
        text += &format!(" (with --set start=1/{})", 1.0 / statistics.start_share);
    }
    text
}

/// Says how it went.
pub(crate) fn report(words: &OutputWords, outcome: Outcome, statistics: &RenderStatistics) {
    if words.quiet {
        return;
    }
    if outcome == Outcome::Black {
        output::note(
            "note: nothing that was tried brings light to the camera: the picture is black",
        );
    } else {
        output::note(&summary(statistics));
        note_what_methods_say(statistics);
    }
    // A picture may be black because all of its light was left out.
    warn_of_losses(statistics);
}

fn note_what_methods_say(statistics: &RenderStatistics) {
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
    if let Some(merged) = &statistics.merged {
        for notice in merged.notices() {
            output::note(&notice);
        }
    }
}

/// Contributions that are not in the picture.
fn warn_of_losses(statistics: &RenderStatistics) {
    let lost = statistics.nonfinite + statistics.film.non_finite + statistics.film.too_large;
    if lost > 0 {
        output::note(&format!(
            "warning: {lost} contributions were not finite or too large, left out{}",
            places(statistics)
        ));
    }
    if statistics.film.overflowed > 0 {
        output::note(
            "warning: sums of the film overflowed: the picture is wrong where it is brightest",
        );
    }
}

/// How much was done, how fast, and what chains say of themselves, in a line.
fn summary(statistics: &RenderStatistics) -> String {
    let steps = (statistics.method.parse()).map_or("samples", Method::steps);
    let mut work = format!("{:.1} {steps} a pixel", statistics.per_pixel);
    if let Some(photons) = &statistics.photons {
        work = format!("{} iterations, {work}", photons.iterations);
    }
    let mut line = format!(
        "{}: {work} in {:.1} s ({:.2} M/s)",
        statistics.method,
        statistics.seconds,
        statistics.steps as f64 / statistics.seconds.max(1e-9) * 1e-6
    );
    if let Some(chain) = &statistics.chain {
        line += &format!(
            ", accepted {:.1} % of small",
            chain.small_acceptance * 100.0
        );
        // not all chains have any
        if chain.large_acceptance > 0.0 {
            line += &format!(" and {:.1} % of large", chain.large_acceptance * 100.0);
        }
        line += " steps";
        // Not kept by populations, whose particles have no past.
        if chain.longest_stay > 0 {
            line += &format!(", longest stay {}", chain.longest_stay);
        }
        // Points and wavelengths of an iteration have a target, and a scale, of their own.
        let of = match statistics.photons {
            Some(_) => " of the last iteration",
            None => "",
        };
        line += &format!(", b{of} = {}", significant(chain.normalisation));
        // one round of a population tells none
        if chain.normalisation_error.is_finite() {
            line += &format!(" +- {}", significant(chain.normalisation_error));
        }
    }
    line
}

/// Four digits of it.
fn significant(x: f64) -> String {
    if x == 0.0 || (1e-3..1e4).contains(&x.abs()) {
        let digits = if x == 0.0 {
            0.0
        } else {
            x.abs().log10().floor()
        };
        let places = (3.0 - digits).clamp(0.0, 6.0) as usize;
        return format!("{x:.places$}");
    }
    format!("{x:.3e}")
}

/// What goes into the EXR and into `--stats`.
fn metadata(source: &Source, settings: &RenderSettings, statistics: &Value) -> Value {
    let set: serde_json::Map<String, Value> = (settings.options)
        .entries(settings.method)
        .into_iter()
        .map(|(key, value)| (key.to_owned(), Value::String(value)))
        .collect();
    let budget = match settings.budget {
        // of a merge, which takes what there is
        Budget::Total(0) => None,
        Budget::PerPixel(n) if settings.method.traces_photons() => Some(format!("{n} iterations")),
        Budget::PerPixel(n) => Some(format!("{n} a pixel")),
        Budget::Total(n) => Some(format!("{n} in all")),
        Budget::Time(time) => Some(format!("{} s", time.as_secs_f64())),
    };
    json!({
        "software": format!("kaustik {}", env!("CARGO_PKG_VERSION")),
        "scene": source.scene,
        "width": settings.width,
        "height": settings.height,
        "max_depth": settings.max_depth,
        "filter": settings.filter.to_string(),
        "crop": settings.layout().crop.to_string(),
        "budget": budget,
        "camera": source.camera,
        "variant": source.variant,
        "environment": source.environment,
        "ladders": [settings.ladder_range().start, settings.ladder_range().end],
        "set": set,
        "statistics": statistics,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use kaustik::scene::{Scene, SceneOptions, builtin};
    use kaustik::{Control, Method, render};

    fn line(method: Method) -> String {
        let description = builtin::load("cornell").expect("a built-in scene");
        let options = SceneOptions {
            width: 8,
            height: 8,
            ..SceneOptions::default()
        };
        let scene = Scene::new(&description, &options).expect("a sound scene");
        let mut settings = RenderSettings {
            method,
            width: 8,
            height: 8,
            // some sweeps of every ladder of replicas: most are even samples
            budget: Budget::PerPixel(64),
            ..RenderSettings::default()
        };
        (settings.options.pilot, settings.options.particles) = (1000, 1000);
        settings.options.chains = Some(1.0);
        settings.options.photon.photons = Some(1000);
        let rendered = render(&scene, &settings, &mut Control::default()).expect("a render");
        summary(&rendered.statistics)
    }

    #[test]
    fn chains_tell_their_longest_stay() {
        for method in [Method::Pssmlt, Method::Relt, Method::Mlt, Method::Erpt] {
            let line = line(method);
            let (before, after) = line.split_once(" steps, longest stay ").expect(&line);
            let (stay, b) = after.split_once(", b = ").expect(&line);
            assert!(before.contains("accepted") && b.contains("+-"), "{line}");
            assert!(stay.parse::<u64>().is_ok_and(|stay| stay > 0), "{line}");
        }
        for method in [Method::Path, Method::Annealing] {
            let line = line(method);
            assert!(!line.contains("longest stay"), "{line}");
        }
    }

    #[test]
    fn photons_tell_whose_scale_they_tell() {
        let line = line(Method::PhotonVisibility);
        assert!(line.contains(", b of the last iteration = "), "{line}");
    }

    #[test]
    fn an_error_that_nothing_tells_is_not_told() {
        let line = line(Method::Annealing);
        assert!(line.contains(", b = ") && !line.contains("+-"), "{line}");
    }
}
