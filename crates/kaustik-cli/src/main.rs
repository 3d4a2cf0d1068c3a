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

/// A decoder that panics over a stranger's bytes has its panic turned into an error; nobody is told of it twice.
fn keep_fenced_panics_quiet() {
    let told = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if !(kaustik::scene::is_fenced() || kaustik::film::is_fenced()) {
            told(panic);
        }
    }));
}

fn main() -> ExitCode {
    keep_fenced_panics_quiet();
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
