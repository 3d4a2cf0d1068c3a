//! `kaustik study`.

use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use kaustik_study::named::{self, Named, Scale};
use kaustik_study::{Runner, Section, Study, StudyError, StudyProgress, write};

use crate::arguments::StudyWords;
use crate::lock::Locks;
use crate::render::failure;
use crate::signals::Signals;
use crate::{Failure, output};

pub(crate) fn run(words: &StudyWords) -> Result<ExitCode, Failure> {
    let what = what(words)?;
    let folder = folder(words);
    let signals = Signals::listen(false, &Locks::default())?;
    // A study always ends in order: what it has rendered is kept.
    signals.sampling();
    let mut display = Display::new(words.quiet);
    let mut listener = |progress: &StudyProgress<'_>| {
        display.show(progress);
        if signals.stop.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let done = match &what {
        What::Named(named) => {
            let done = named.run(scale(words), words.figure, &folder, &mut listener);
            done.map(|done| (done.page, done.judged))
        }
        What::File(study) => Runner::new(study, &folder)
            .run(&mut listener)
            .and_then(|results| {
                let section = Section {
                    results: &results,
                    judged: &[],
                };
                let page = write(&folder, &study.title, &[("study", section)])?;
                Ok((page, Vec::new()))
            }),
    };
    display.finish();
    let (page, judged) = match done {
        Ok(done) => done,
        Err(StudyError::Stopped) => {
            output::note(&format!("{}", StudyError::Stopped));
            return Ok(signals.status().map_or(ExitCode::FAILURE, ExitCode::from));
        }
        Err(error @ (StudyError::Words { .. } | StudyError::Scene { .. })) => {
            return Err(Failure::input(error));
        }
        Err(StudyError::Render { what, source }) => {
            return Err(failure(&source).within(&what));
        }
        Err(error) => return Err(Failure::other(error)),
    };
    for (number, claims) in judged {
        for judged in claims {
            let (finding, claim) = (judged.finding, judged.claim);
            output::print(&format!(
                "figure {number}: {claim}\n  measured: {}\n  {}\n",
                finding.measured,
                finding.verdict.word()
            ))?;
        }
    }
    output::note(&format!("{}", page.display()));
    Ok(ExitCode::SUCCESS)
}

/// What is to be rendered.
enum What {
    Named(&'static Named),
    File(Box<Study>),
}

fn what(words: &StudyWords) -> Result<What, Failure> {
    if let Some(named) = named::find(&words.study) {
        return Ok(What::Named(named));
    }
    if !words.study.ends_with(".toml") {
        let known: Vec<&str> = named::ALL.iter().map(|named| named.name).collect();
        return Err(Failure::Input(format!(
            "there is no study '{}'; there are {}, and files whose names end in .toml",
            words.study,
            known.join(", ")
        )));
    }
    if words.quick || words.as_published || words.figure.is_some() {
        return Err(Failure::Input(
            "--quick, --as-published and --figure are for the studies of papers, not for files"
                .to_owned(),
        ));
    }
    let study = Study::load(Path::new(&words.study)).map_err(Failure::input)?;
    Ok(What::File(Box::new(study)))
}

fn scale(words: &StudyWords) -> Scale {
    match (words.quick, words.as_published) {
        (true, _) => Scale::Quick,
        (_, true) => Scale::AsPublished,
        _ => Scale::Usual,
    }
}

fn folder(words: &StudyWords) -> PathBuf {
    let stem = Path::new(&words.study).file_stem();
    let name = stem.map_or_else(|| "study".into(), |stem| stem.to_string_lossy());
    let default = || PathBuf::from(format!("study-{name}"));
    words.output.clone().unwrap_or_else(default)
}

/// Time between two plain lines.
const LINE_EVERY: Duration = Duration::from_secs(10);

/// Shows how far a study is: a bar on a terminal, lines elsewhere.
enum Display {
    Quiet,
    Bar(ProgressBar),
    Lines { last: Instant },
}

impl Display {
    fn new(quiet: bool) -> Self {
        if quiet {
            return Self::Quiet;
        }
        if !std::io::stderr().is_terminal() {
            return Self::Lines {
                last: Instant::now(),
            };
        }
        let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr());
        let template = "{bar:30} {percent:>3} %  {elapsed} + {eta}  {msg}";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        Self::Bar(bar)
    }

    fn show(&mut self, progress: &StudyProgress<'_>) {
        match self {
            Self::Quiet => {}
            Self::Bar(bar) => {
                bar.set_position((progress.fraction * 1000.0) as u64);
                bar.set_message(progress.what.to_owned());
            }
            Self::Lines { last } => {
                if last.elapsed() >= LINE_EVERY {
                    *last = Instant::now();
                    let percent = progress.fraction * 100.0;
                    output::note(&format!("{percent:3.0} %  {}", progress.what));
                }
            }
        }
    }

    fn finish(&self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}
