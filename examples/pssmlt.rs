//! The figures of Kelemen and Szirmay-Kalos (2002) on our scenes.
//!
//! ```sh
//! cargo run --release --example pssmlt -- [--quick | --as-published] [--figure N] [FOLDER]
//! ```
//!
//! Renders go to FOLDER (`study-pssmlt` by default) with tables, curves and the page `index.html`. Each claim
//! of the paper is printed with what was measured and whether it holds. A run that was cut goes on where
//! it was.
#![expect(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "an example talks to whoever runs it"
)]

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Parser;
use kaustik_study::named::{self, Scale};
use kaustik_study::{StudyError, StudyProgress};

/// The figures of Kelemen and Szirmay-Kalos (2002) on our scenes.
#[derive(Parser)]
struct Words {
    /// A small version: shows that everything works
    #[arg(long, conflicts_with = "as_published")]
    quick: bool,
    /// The paper's own sizes and times: hours
    #[arg(long)]
    as_published: bool,
    /// One figure of the paper, by its number
    #[arg(long, value_name = "N")]
    figure: Option<u32>,
    /// Where everything goes
    #[arg(default_value = "study-pssmlt")]
    folder: PathBuf,
}

fn main() -> Result<(), StudyError> {
    let words = Words::parse();
    let scale = match (words.quick, words.as_published) {
        (true, _) => Scale::Quick,
        (_, true) => Scale::AsPublished,
        _ => Scale::Usual,
    };
    let study = named::find("pssmlt").expect("a study of this name");
    let mut last = Instant::now();
    let mut tell = |progress: &StudyProgress<'_>| {
        if last.elapsed() > Duration::from_secs(5) {
            last = Instant::now();
            eprintln!("{:3.0} %  {}", 100.0 * progress.fraction, progress.what);
        }
        ControlFlow::Continue(())
    };
    let done = study.run(scale, words.figure, &words.folder, &mut tell)?;
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
