//! The command's words.

use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::campaign::Campaign;
use crate::kind::Kind;
use crate::{check, seeds, table};

/// Break files and see that each becomes a picture or a refusal.
#[derive(Debug, Parser)]
#[command(name = "kaustik-fuzz", version, about, max_term_width = 100)]
struct Words {
    #[command(subcommand)]
    command: Option<Command>,
    /// Broken files of each kind
    #[arg(long, value_name = "N", default_value_t = 500)]
    files: u64,
    /// Only this kind: model, png, jpeg, webp, hdr, exr
    #[arg(long, value_name = "KIND")]
    kind: Option<Kind>,
    /// Every choice follows from it
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Children at a time
    #[arg(long, value_name = "J", default_value_t = 2, value_parser = clap::value_parser!(u64).range(1..=256))]
    jobs: u64,
    /// Folder for files that did what they must not
    #[arg(long, value_name = "FOLDER", default_value = "broken")]
    keep: PathBuf,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// What becomes of one file (a campaign starts one such child for each)
    Check {
        /// What the file claims to be
        kind: Kind,
        /// The file
        file: PathBuf,
    },
    /// Writes the sound files that campaigns break, for a coverage-guided run to begin with
    Seeds {
        /// A folder for each kind is made in it
        folder: PathBuf,
    },
}

/// Does what the command line asks for.
pub fn main() -> ExitCode {
    let words = Words::parse();
    match &words.command {
        Some(Command::Check { kind, file }) => return check::run(*kind, file),
        Some(Command::Seeds { folder }) => return status(seeds::write(folder).map(|()| true)),
        None => {}
    }
    let kinds = match words.kind {
        Some(kind) => vec![kind],
        None => Kind::CAMPAIGN.to_vec(),
    };
    status(run(&words, &kinds))
}

/// 0 where all is well.
fn status(clean: io::Result<bool>) -> ExitCode {
    match clean {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            let _ = writeln!(io::stderr().lock(), "error: {error}");
            ExitCode::from(1)
        }
    }
}

/// Runs the campaigns; were all files well behaved?
fn run(words: &Words, kinds: &[Kind]) -> io::Result<bool> {
    let mut out = io::stdout().lock();
    writeln!(out, "{}", table::HEAD)?;
    let mut clean = true;
    for &kind in kinds {
        let campaign = Campaign {
            kind,
            files: words.files,
            seed: words.seed,
            jobs: words.jobs,
            keep: words.keep.clone(),
        };
        let verdicts = campaign.run()?;
        let row = table::Row::of(kind, &verdicts);
        writeln!(out, "{row}")?;
        clean &= row.is_clean();
    }
    Ok(clean)
}
