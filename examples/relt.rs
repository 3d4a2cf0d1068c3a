//! The figures of Kitaoka, Kitamura and Kishino (2009) on our scenes.
//!
//! ```sh
//! cargo run --release --example relt -- [--quick | --as-published] [--figure N] [FOLDER]
//! ```
//!
//! Renders go to FOLDER (`study-relt` by default, with `-quick` or `-as-published`) with tables, curves and the page `index.html`. Each claim
//! of the paper is printed with what was measured and whether it holds. A run that was cut goes on where
//! it was.
//!
//! The figures and claims are in `crates/kaustik-study/src/named/relt.rs`, the method is in
//! `crates/kaustik/src/methods/relt.rs`; `docs/papers/relt.md` has its equations, each with its item.
#![expect(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "an example talks to whoever runs it"
)]

use kaustik_study::StudyError;

mod figures;

fn main() -> Result<(), StudyError> {
    figures::run("relt")
}
