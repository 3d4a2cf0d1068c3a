//! Campaigns of broken files: each becomes a picture or a refusal, soon, within its memory.

use std::process::ExitCode;

fn main() -> ExitCode {
    kaustik_fuzz::main()
}
