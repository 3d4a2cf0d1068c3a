//! `kaustik study`.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::Ordering;
use std::time::Duration;

use kaustik_study::named::{self, Done, FigureScale, Named};
use kaustik_study::{Judged, Listener, Runner, Section, Study, StudyError, StudyProgress, write};

use crate::arguments::StudyWords;
use crate::lock::Locks;
use crate::progress::Display;
use crate::render::failure;
use crate::signals::Signals;
use crate::{Failure, output};

pub(crate) fn run(words: &StudyWords) -> Result<ExitCode, Failure> {
    let what = what(words)?;
    let signals = Signals::listen(false, &Locks::default())?;
    // A study always ends in order: what it has rendered is kept.
    signals.sampling();
    let template = "{bar:30} {percent:>3} %  {elapsed} + {eta}  {msg}";
    let mut display = Display::new(words.quiet, template, Duration::from_secs(10));
    let mut listener = |progress: &StudyProgress<'_>| {
        display.show(progress.fraction, || progress.what.to_owned());
        if signals.stop.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let done = what.render(words, &mut listener);
    display.finish();
    let done = match done {
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
    print_claims(&done)?;
    output::note(&format!("{}", done.page.display()));
    Ok(ExitCode::SUCCESS)
}

/// The claims of a paper, and what was measured.
fn print_claims(done: &Done) -> Result<(), Failure> {
    for (number, claims) in &done.judged {
        for Judged { claim, finding } in claims {
            output::print(&format!(
                "figure {number}: {claim}\n  measured: {}\n  {}\n",
                finding.measured,
                finding.verdict.word()
            ))?;
        }
    }
    Ok(())
}

/// What is to be rendered.
enum What {
    Named(&'static Named),
    File(Box<Study>),
}

impl What {
    /// Renders what is missing of it, and writes its page.
    fn render(&self, words: &StudyWords, listener: &mut Listener<'_>) -> Result<Done, StudyError> {
        let folder = folder(words);
        match self {
            Self::Named(named) => {
                let scale = FigureScale::of_words(words.quick, words.as_published);
                named.run(scale, words.figure, &folder, listener)
            }
            Self::File(study) => {
                let results = Runner::new(study, &folder).run(listener)?;
                let section = Section {
                    results: &results,
                    judged: &[],
                };
                Ok(Done {
                    page: write(&folder, &study.title, &[("study", section)])?,
                    judged: Vec::new(),
                })
            }
        }
    }
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

/// `study-NAME`, with the scale if it is not the usual one; where a file is called as a paper's study, `study-NAME-toml`: they are
/// not one study.
fn folder(words: &StudyWords) -> PathBuf {
    let named = named::find(&words.study).is_some();
    let stem = Path::new(&words.study).file_stem();
    let mut name = stem.map_or_else(|| "study".into(), |stem| stem.to_string_lossy());
    if !named && named::find(&name).is_some() {
        name += "-toml";
    }
    let default = || FigureScale::of_words(words.quick, words.as_published).folder(&name);
    words.output.clone().unwrap_or_else(default)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_has_not_the_folder_of_a_paper() {
        let of = |study: &str, quick: bool| {
            folder(&StudyWords {
                study: study.to_owned(),
                quick,
                figure: None,
                as_published: false,
                output: None,
                quiet: true,
            })
        };
        assert_eq!(of("relt", false), Path::new("study-relt"));
        assert_eq!(of("relt", true), Path::new("study-relt-quick"));
        assert_eq!(of("a/relt.toml", false), Path::new("study-relt-toml"));
        assert_eq!(of("a/my.toml", false), Path::new("study-my"));
    }
}
