//! What the examples of the papers have in common: words, progress, claims.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use kaustik_study::named::{self, FigureScale};
use kaustik_study::{StudyError, StudyProgress};

/// Renders the figures of a paper and says of each of its claims what was measured.
#[derive(Parser)]
struct Words {
    /// A small version: shows that everything works
    #[arg(long, conflicts_with = "as_published")]
    quick: bool,
    /// The paper's own sizes and times: hours to days
    #[arg(long)]
    as_published: bool,
    /// One figure of the paper, by its number
    #[arg(long, value_name = "N")]
    figure: Option<u32>,
    /// Where everything goes [default: study- and the study's name, with -quick or -as-published]
    folder: Option<PathBuf>,
}

/// How far the whole study is, on standard error: a bar on a terminal, lines elsewhere.
struct Display {
    bar: ProgressBar,
    last: Instant,
}

impl Display {
    fn new() -> Self {
        let template = "{bar:30} {percent:>3} %  {elapsed} + {eta}  {msg}";
        let style = ProgressStyle::with_template(template).expect("a template");
        Self {
            bar: ProgressBar::new(1000).with_style(style),
            last: Instant::now(),
        }
    }

    fn show(&mut self, progress: &StudyProgress<'_>) {
        if !self.bar.is_hidden() {
            self.bar.set_position((1000.0 * progress.fraction) as u64);
            self.bar.set_message(progress.what.to_owned());
        } else if self.last.elapsed() > Duration::from_secs(5) {
            self.last = Instant::now();
            eprintln!("{:3.0} %  {}", 100.0 * progress.fraction, progress.what);
        }
    }
}

/// Runs the study of this name as the command line asks.
pub(crate) fn run(name: &str) -> Result<(), StudyError> {
    let words = Words::parse();
    let scale = FigureScale::of_words(words.quick, words.as_published);
    let folder = (words.folder).unwrap_or_else(|| scale.folder(name));
    let study = named::find(name).expect("a study of this name");
    let mut display = Display::new();
    let mut tell = |progress: &StudyProgress<'_>| {
        display.show(progress);
        ControlFlow::Continue(())
    };
    let done = study.run(scale, words.figure, &folder, &mut tell);
    display.bar.finish_and_clear();
    let done = done?;
    for (number, claims) in &done.judged {
        for judged in claims {
            println!("figure {number}: {}", judged.claim);
            println!("  measured: {}", judged.finding.measured);
            println!("  {}", judged.finding.verdict.word());
        }
    }
    println!("{}", done.page.display());
    Ok(())
}
