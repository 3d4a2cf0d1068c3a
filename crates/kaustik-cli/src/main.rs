//! The `kaustik` command.

mod arguments;
mod checkpoint;
mod compare;
mod failure;
mod info;
mod input;
mod lists;
mod lock;
mod merge;
mod output;
mod picture;
mod progress;
mod render;
mod replay;
mod signals;
mod study;

use std::process::ExitCode;

use clap::Parser;

use arguments::{Arguments, Command};
use failure::Failure;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let done = match &arguments.command {
        Command::Render(words) => render::run(words),
        Command::Replay(words) => replay::run(words),
        Command::Merge(words) => merge::run(words),
        Command::Scenes(words) => lists::scenes(words),
        Command::Methods(words) => lists::methods(words),
        Command::Info(words) => info::run(words),
        Command::Compare(words) => compare::run(words),
        Command::Study(words) => study::run(words),
    };
    match done {
        Ok(code) => code,
        Err(failure) => {
            output::note(&format!("error: {failure}"));
            ExitCode::from(failure.status())
        }
    }
}
