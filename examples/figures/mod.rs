//! What the examples of the papers have in common: words, progress, claims.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Parser;
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
    /// Where everything goes [default: study- and the example's name]
    folder: Option<PathBuf>,
}

/// Runs the study of this name as the command line asks.
pub(crate) fn run(name: &str) -> Result<(), StudyError> {
    let words = Words::parse();
    let scale = FigureScale::of_words(words.quick, words.as_published);
    let folder = (words.folder).unwrap_or_else(|| format!("study-{name}").into());
    let study = named::find(name).expect("a study of this name");
    let mut last = Instant::now();
    let mut tell = |progress: &StudyProgress<'_>| {
        if last.elapsed() > Duration::from_secs(5) {
            last = Instant::now();
            eprintln!("{:3.0} %  {}", 100.0 * progress.fraction, progress.what);
        }
        ControlFlow::Continue(())
    };
    let done = study.run(scale, words.figure, &folder, &mut tell)?;
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
