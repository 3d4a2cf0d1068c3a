//! Renders that run while the test goes on.
#![cfg(unix)]

use std::fs;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A render that nobody waits for the end of.
pub(crate) fn begin(words: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_kaustik"))
        .args(words)
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command runs")
}

pub(crate) fn signal(child: &Child, name: &str) {
    let kill = Command::new("kill")
        .args(["-s", name, &child.id().to_string()])
        .status();
    assert!(kill.expect("kill runs").success());
}

/// Waits until a file is there; again and again for another one, if `old` is given.
pub(crate) fn wait_for(file: &str, old: Option<&fs::Metadata>) -> fs::Metadata {
    let start = Instant::now();
    loop {
        if let Ok(now) = fs::metadata(file) {
            let new = old.is_none_or(|old| old.modified().ok() != now.modified().ok());
            if new {
                return now;
            }
        }
        assert!(start.elapsed() < Duration::from_secs(60), "no {file}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// More samples than a test will wait for.
pub(crate) const ENDLESS: &str = "10000000";
