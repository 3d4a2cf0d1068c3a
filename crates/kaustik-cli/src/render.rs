//! `kaustik render`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use kaustik::film::FilmError;
use kaustik::scene::{Scene, SceneOptions};
use kaustik::spectrum::WavelengthSampling;
use kaustik::{
    Budget, Control, Options, Outcome, RenderError, RenderSettings, RenderStatistics, Rendered,
    Source, StartShare, State, render_watched, resume,
};

use crate::arguments::{OutputWords, RenderWords};
use crate::checkpoint::Checkpoints;
use crate::lock::Locks;
use crate::picture::{self, remark};
use crate::progress::{Display, line};
use crate::signals::Signals;
use crate::{Failure, input, output};

pub(crate) fn run(words: &RenderWords) -> Result<ExitCode, Failure> {
    let settings = settings(words)?;
    picture::check(&words.outputs, words.checkpoint.as_ref(), &inputs(words))?;
    let locks = Locks::take(words.outputs.files().chain(&words.checkpoint))?;
    let signals = Signals::listen(words.checkpoint.is_some(), &locks)?;
    let state = state(words)?;
    let source = Source {
        scene: words.scene.clone(),
        camera: words.camera.clone(),
        variant: words.variant.clone(),
        environment: words.environment.clone(),
    };
    let loading = Loading {
        outputs: &words.outputs,
        source: &source,
        written: (words.outputs.files().chain(&words.checkpoint)).collect(),
        max_memory: words.max_memory,
        size: (words.width, words.height),
    };
    let scene = loading.load(&settings)?;
    let [width, height] = scene.image_size();
    let settings = RenderSettings {
        width,
        height,
        ..settings
    };
    finish(words, &settings, &scene, &source, state, &signals)
}

/// The files that it is made from, as far as words name them; those that are none are not there.
fn inputs(words: &RenderWords) -> impl Iterator<Item = &Path> + Clone {
    let resumed = words.resume.as_deref().into_iter();
    resumed.chain(scene_files(words))
}

fn scene_files(words: &RenderWords) -> impl Iterator<Item = &Path> + Clone {
    picture::scene_files(&words.scene, words.environment.as_deref())
}

/// The state to go on from; refuses what could not be kept or read before the scene is loaded.
fn state(words: &RenderWords) -> Result<Option<State>, Failure> {
    if let Some(path) = &words.checkpoint {
        // It may take the place of the state that the render goes on from.
        picture::refuse_inputs(path, scene_files(words))?;
        kaustik::film::check_writable(path).map_err(Failure::input)?;
        if words.resume.is_none() && path.is_file() && !words.outputs.quiet {
            let path = path.display();
            output::note(&format!(
                "note: {path} is there and will be replaced; --resume {path} would go on from it"
            ));
        }
    }
    let Some(path) = &words.resume else {
        return Ok(None);
    };
    let state = State::read(path);
    Ok(Some(state.map_err(|error| {
        Failure::Input(format!("{}: {error}", path.display()))
    })?))
}

/// How the scene of a render is loaded.
pub(crate) struct Loading<'a> {
    pub(crate) outputs: &'a OutputWords,
    pub(crate) source: &'a Source,
    /// All files that will be written: none of them may be one that the scene is made from.
    pub(crate) written: Vec<&'a PathBuf>,
    pub(crate) max_memory: Option<u64>,
    /// Columns and rows as far as they are known.
    pub(crate) size: (Option<u32>, Option<u32>),
}

impl Loading<'_> {
    /// Loads it, on the render's threads.
    pub(crate) fn load(&self, settings: &RenderSettings) -> Result<Scene, Failure> {
        let compensation = settings.options.compensation;
        let load = || self.load_here(compensation);
        kaustik::on_threads(settings.threads, load).map_err(|error| failure(&error))?
    }

    fn load_here(&self, compensation: bool) -> Result<Scene, Failure> {
        let Self {
            outputs,
            source,
            size,
            ..
        } = *self;
        let input = input::load(&source.scene, self.max_memory, source.variant.as_deref())?;
        for path in &self.written {
            picture::refuse_inputs(path, input.files.iter().map(PathBuf::as_path))?;
        }
        for warning in &input.warnings {
            remark(outputs, &format!("warning: {warning}"));
        }
        let (width, height) = input::image_size(&input.description, source.camera.as_deref(), size);
        let environment = source.environment.as_deref().map(input::environment);
        let environment = environment.transpose()?.map(|(environment, mended)| {
            if mended > 0 {
                let warning =
                    format!("warning: --environment: {mended} values were negative, too large or not finite, and were replaced");
                remark(outputs, &warning);
            }
            environment
        });
        let options = SceneOptions {
            width,
            height,
            camera: source.camera.clone(),
            environment,
            compensation,
        };
        let scene = Scene::new(&input.description, &options)
            .map_err(|error| Failure::Input(format!("{}: {error}", source.scene)))?;
        for notice in scene.notices() {
            remark(outputs, &format!("note: {notice}"));
        }
        Ok(scene)
    }
}

/// Renders, writes what there is, and says how it went.
fn finish(
    words: &RenderWords,
    settings: &RenderSettings,
    scene: &Scene,
    source: &Source,
    state: Option<State>,
    signals: &Signals,
) -> Result<ExitCode, Failure> {
    let mut checkpoints = Checkpoints::new(words, settings, source, signals);
    let mut display = Display::of_render(words.outputs.quiet);
    let mut show =
        |progress: &kaustik::Progress| display.show(progress.fraction, || line(progress));
    let mut control = Control {
        stop: Some(&signals.stop),
        progress: Some(&mut show),
    };
    let rendered = match state {
        Some(state) => resume(scene, settings, state, &mut control, &mut checkpoints),
        None => render_watched(scene, settings, &mut control, &mut checkpoints),
    };
    display.finish();
    let rendered = match (rendered, signals.status()) {
        (Ok(rendered), _) => rendered,
        // It was to end: the state is kept, if one was asked for.
        (Err(error), Some(status)) => {
            let failure = resumed(words, &error);
            output::note(&format!("error: {failure}: no picture was written"));
            return Ok(ExitCode::from(status));
        }
        (Err(error), None) => return Err(resumed(words, &error)),
    };
    let (statistics, outcome) = (rendered.statistics.clone(), rendered.outcome);
    let mut written = Ok(());
    if outcome == Outcome::Stopped && statistics.steps == 0 {
        output::note(
            "stopped before the first whole pass, iteration or round was done: no picture was written",
        );
    } else {
        note_layers(words, outcome, &rendered);
        note_start(words, settings, &statistics);
        note_budget(words, &statistics);
        let rendered = match checkpoints.kept() {
            Some(state) if outcome == Outcome::Stopped => soon_written(words, state, rendered),
            _ => rendered,
        };
        written = picture::write(&words.outputs, source, settings, rendered);
        picture::report(&words.outputs, outcome, &statistics);
    }
    let kept = checkpoints.report(&words.outputs, &statistics);
    written?;
    Ok(match signals.status() {
        Some(status) => ExitCode::from(status),
        None if kept => ExitCode::SUCCESS,
        None => ExitCode::FAILURE,
    })
}

/// The failure of a render, with the state's name if that is what is wrong.
fn resumed(words: &RenderWords, error: &RenderError) -> Failure {
    match (error, &words.resume) {
        (RenderError::State(_), Some(path)) => failure(error).within(&path.display().to_string()),
        _ => failure(error),
    }
}

/// Says so where a picture that was stopped has not all of its layers.
fn note_layers(words: &RenderWords, outcome: Outcome, rendered: &Rendered) {
    let there = rendered.image.layers().iter().any(|l| l.name == "albedo");
    if outcome == Outcome::Stopped && !words.outputs.no_features && !there {
        let left_out = "note: stopped: the picture is without albedo, normal and depth";
        remark(&words.outputs, left_out);
    }
}

/// Says so where the start was shortened because of `--time`, or, where it must be whole, took most of it.
fn note_start(words: &RenderWords, settings: &RenderSettings, statistics: &RenderStatistics) {
    let Budget::Time(limit) = settings.budget else {
        return;
    };
    // A resumed render has no choice: it must start as the first did.
    if words.resume.is_some() {
        return;
    }
    let share = statistics.start_share;
    if share < 1.0 && settings.options.start == StartShare::Auto {
        let share = 1.0 / share;
        let note = format!(
            "note: for --time a 1/{share} of the start was made: --set start=1/{share} makes as much, start=whole all of it"
        );
        remark(&words.outputs, &note);
        return;
    }
    let start = statistics.pilot_seconds;
    if start <= limit.as_secs_f64() / 2.0 {
        return;
    }
    let entries = settings.options.entries(settings.method);
    let shorter = ["pilot", "particles"].map(|name| entries.iter().find(|(key, _)| *key == name));
    let Some((key, value)) = shorter.into_iter().flatten().next() else {
        return;
    };
    let note = format!(
        "note: the start took {start:.1} s, more than half of --time; a smaller --set {key} (now {value}) makes it shorter"
    );
    remark(&words.outputs, &note);
}

/// Says so where a state held so much that the picture has more than was asked for.
fn note_budget(words: &RenderWords, statistics: &RenderStatistics) {
    let Some(path) = &words.resume else { return };
    if statistics
        .planned
        .is_some_and(|planned| statistics.steps > planned)
    {
        let path = path.display();
        let note = format!(
            "note: what {path} held is all in the picture, which has more than was asked for"
        );
        remark(&words.outputs, &note);
    }
}

/// More samples of pictures take more than a second to compress.
const SOON: u64 = 1 << 23;

/// What a render that was stopped writes where a state holds all of it: of a picture that would take seconds
/// to write, no more than the main layer.
fn soon_written(words: &RenderWords, state: &Path, rendered: Rendered) -> Rendered {
    let image = &rendered.image;
    let planes: usize = image.layers().iter().map(|l| l.channels.len()).sum();
    let has_others = image.layers().len() > 1 && words.outputs.output.is_some();
    if !has_others || planes as u64 * image.pixels() as u64 <= SOON {
        return rendered;
    }
    let left_out = format!(
        "note: stopped: the picture is without its other layers, which `kaustik merge {}` makes from the state",
        state.display()
    );
    remark(&words.outputs, &left_out);
    Rendered {
        image: rendered.image.without_layers(),
        ..rendered
    }
}

/// Whose fault it is.
pub(crate) fn failure(error: &RenderError) -> Failure {
    match error {
        RenderError::Setting { .. }
        | RenderError::State(_)
        | RenderError::Film(FilmError::Empty { .. }) => Failure::input(error),
        _ => Failure::other(error),
    }
}

/// The settings that do not depend on the scene.
pub(crate) fn settings(words: &RenderWords) -> Result<RenderSettings, Failure> {
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
    options
        .check(words.method)
        .map_err(|error| failure(&error))?;
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
        features: !words.outputs.no_features,
        ..default
    })
}
