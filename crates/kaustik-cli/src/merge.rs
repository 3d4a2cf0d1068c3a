//! `kaustik merge`.

use std::path::PathBuf;
use std::process::ExitCode;

use kaustik::film::{WriteError, check_writable};
use kaustik::{
    Outcome, Progress, RenderSettings, Snapshot, Source, State, Watch, merge, merged_settings,
};

use crate::arguments::MergeWords;
use crate::lock::Locks;
use crate::render::{Loading, failure};
use crate::{Failure, output, picture};

pub(crate) fn run(words: &MergeWords) -> Result<ExitCode, Failure> {
    let inputs = words.states.iter().map(PathBuf::as_path);
    picture::check(&words.outputs, words.state.as_ref(), &inputs)?;
    if let Some(path) = &words.state {
        picture::refuse_inputs(path, inputs)?;
        check_writable(path).map_err(Failure::input)?;
    }
    let _locks = Locks::take(words.outputs.files().chain(&words.state))?;
    let states = words.states.iter().map(|path| {
        State::read(path).map_err(|error| Failure::Input(format!("{}: {error}", path.display())))
    });
    let states = states.collect::<Result<Vec<_>, _>>()?;
    let several = states
        .windows(2)
        .any(|pair| pair[0].seed() != pair[1].seed());
    if words.state.is_some() && several {
        return Err(Failure::Input(
            "--state: renders of several seeds have no state in common; merge the shares of each by themselves"
                .to_owned(),
        ));
    }
    let settings = RenderSettings {
        threads: words.threads.map_or(0, |threads| threads as usize),
        features: !words.outputs.no_features,
        ..merged_settings(&states).map_err(Failure::input)?
    };
    let source = source(words, &states);
    for path in words.outputs.files().chain(&words.state) {
        picture::refuse_inputs(path, picture::source_files(&source))?;
    }
    let size = (Some(settings.width), Some(settings.height));
    let loading = Loading {
        outputs: &words.outputs,
        source: &source,
        written: (words.outputs.files().chain(&words.state)).collect(),
        max_memory: words.max_memory,
        size,
    };
    let scene = loading.load(&settings)?;
    let mut keeper = Keeper {
        words,
        source: &source,
        failure: None,
    };
    let rendered = merge(&scene, &settings, &states, &mut keeper);
    let rendered = rendered.map_err(|error| failure(&error))?;
    let (statistics, outcome) = (rendered.statistics.clone(), rendered.outcome);
    if outcome == Outcome::Stopped && statistics.steps == 0 {
        if let Some(error) = keeper.failure {
            output::note(&format!("error: {error}"));
        }
        return Err(Failure::Input(
            "the states hold no whole pass, iteration or round: no picture was written".to_owned(),
        ));
    }
    let unkept = keeper.failure;
    let written = picture::write(&words.outputs, &source, &settings, rendered);
    picture::report(&words.outputs, outcome, &statistics);
    note_missing(words, &settings);
    written?;
    match unkept {
        Some(error) => Err(Failure::other(error)),
        None => Ok(ExitCode::SUCCESS),
    }
}

/// Says so where states of other ladders exist, or were to.
fn note_missing(words: &MergeWords, settings: &RenderSettings) {
    let (here, all) = (settings.ladder_range(), settings.options.ladders);
    if here.len() as u64 != u64::from(all) {
        picture::remark(
            &words.outputs,
            &format!(
                "warning: only ladders {}..{} of 0..{all} were given: the light of the others is missing from the picture",
                here.start, here.end
            ),
        );
    }
}

/// Where the scene is: where the first state says, or where the user says.
fn source(words: &MergeWords, states: &[State]) -> Source {
    let mut source = states
        .first()
        .map(State::source)
        .cloned()
        .unwrap_or_default();
    if let Some(scene) = &words.scene {
        source.scene.clone_from(scene);
    }
    source
}

/// Keeps the state of the whole.
struct Keeper<'a> {
    words: &'a MergeWords,
    source: &'a Source,
    failure: Option<WriteError>,
}

impl Keeper<'_> {
    fn path(&self) -> Option<&PathBuf> {
        self.words.state.as_ref()
    }
}

impl Watch for Keeper<'_> {
    fn wants_state(&mut self, _: &Progress, _: bool) -> bool {
        self.path().is_some()
    }

    fn see_state(&mut self, snapshot: &Snapshot<'_>) {
        if let Some(path) = self.path() {
            self.failure = snapshot.write(path, self.source).err();
        }
    }
}
