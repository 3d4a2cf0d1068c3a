//! Renders of hours: memory and descriptors, and how soon a signal ends one.
#![cfg(target_os = "linux")]

use std::fs;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use kaustik::Method;

use crate::injected::figures;
use crate::words::path;

fn begin(words: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_kaustik"))
        .args(words)
        .stderr(Stdio::null())
        .spawn()
        .expect("the command runs")
}

fn end(child: &mut Child, signal: &str) -> Option<i32> {
    let kill = Command::new("kill")
        .args(["-s", signal, &child.id().to_string()])
        .status();
    assert!(kill.expect("kill runs").success());
    child.wait().expect("it ends").code()
}

/// Resident memory in bytes and open descriptors of a process.
fn taken(child: &Child) -> [u64; 2] {
    let status = fs::read_to_string(format!("/proc/{}/status", child.id())).expect("a process");
    let line = status.lines().find(|line| line.starts_with("VmRSS:"));
    let pages = line.and_then(|line| line.split_whitespace().nth(1));
    let memory: u64 = pages.and_then(|n| n.parse().ok()).expect("a number");
    let descriptors = fs::read_dir(format!("/proc/{}/fd", child.id())).expect("a process");
    [memory * 1024, descriptors.count() as u64]
}

/// What is kept of memory and of descriptors in the second quarter and in the last, of looks in order of time (0 to 1).
///
/// Both come and go with each state, and a look may fall within the writing of one: memory is at its highest in most
/// looks (allocators give little back), so its most counts; a descriptor is open for an instant, so those count that
/// all looks of the span found, as they find every one that was left open.
fn come(looks: &[(f64, [u64; 2])]) -> [(u64, u64); 2] {
    let within = |from: f64, to: f64, which: usize| {
        let within = looks.iter().filter(move |(at, _)| (from..to).contains(at));
        within.map(move |(_, taken)| taken[which])
    };
    let most = |from, to| within(from, to, 0).max().expect("looks");
    let least = |from, to| within(from, to, 1).min().expect("looks");
    [
        (most(0.25, 0.5), most(0.75, 2.0)),
        (least(0.25, 0.5), least(0.75, 2.0)),
    ]
}

#[test]
fn a_leak_is_told_from_a_file_that_is_open_for_an_instant() {
    let looks = |descriptors: fn(u64) -> u64| {
        let look = |i: u64| (i as f64 / 100.0, [1000, descriptors(i)]);
        (0..100).map(look).collect::<Vec<_>>()
    };
    let [_, open] = come(&looks(|i| 7 + u64::from(i == 80)));
    assert_eq!(open, (7, 7));
    let [_, leaked] = come(&looks(|i| 7 + i / 10));
    assert_eq!(leaked, (9, 14));
}

/// Renders for so long with states so often; by how much memory grew from the first quarter to the end, and how many
/// descriptors came.
fn soaked(method: &str, width: &str, seconds: f64, every: &str) -> (f64, u64) {
    let folder = tempfile::tempdir().expect("a folder");
    let (state, exr) = (path(folder.path(), "s"), path(folder.path(), "a.exr"));
    let mut words = vec!["render", "builtin:cornell", "--method", method, "-q"];
    words.extend(["--width", width, "--time", "10h", "-o", &exr]);
    words.extend(["--checkpoint", &state, "--checkpoint-every", every]);
    let mut child = begin(&words);
    let start = Instant::now();
    let mut looks: Vec<(f64, [u64; 2])> = Vec::new();
    while start.elapsed().as_secs_f64() < seconds {
        std::thread::sleep(Duration::from_secs_f64((seconds / 200.0).clamp(0.02, 5.0)));
        assert!(child.try_wait().expect("a child").is_none(), "it goes on");
        looks.push((start.elapsed().as_secs_f64() / seconds, taken(&child)));
    }
    assert!(fs::metadata(&state).is_ok(), "states were written");
    assert_eq!(end(&mut child, "TERM"), Some(143));
    let [memory, descriptors] = come(&looks);
    let (early, late) = memory;
    let descriptors = descriptors.1.saturating_sub(descriptors.0);
    let growth = late as f64 / early as f64 - 1.0;
    figures(&format!(
        "{method}: {seconds} s, {:.1} MB, then {:.1} MB ({:+.2} %), {descriptors} more descriptors",
        early as f64 * 1e-6,
        late as f64 * 1e-6,
        growth * 100.0
    ));
    (growth, descriptors)
}

#[test]
fn a_short_soak() {
    let (growth, descriptors) = soaked("path", "64", 4.0, "50ms");
    // Allocators settle for longer than that: only a leak of each state would show.
    assert!(growth < 0.1, "{growth}");
    assert_eq!(descriptors, 0);
}

/// Half an hour, or what `KAUSTIK_SOAK` says in seconds.
#[test]
#[ignore = "half an hour"]
fn a_soak() {
    let seconds = std::env::var("KAUSTIK_SOAK").map_or(1800.0, |s| s.parse().expect("seconds"));
    for method in ["path", "pssmlt"] {
        let (growth, descriptors) = soaked(method, "512", seconds / 2.0, "5s");
        assert!(growth < 0.01, "{method}: {growth}");
        assert_eq!(descriptors, 0, "{method}");
    }
}

/// Longest that is waited for an end.
const PATIENCE: Duration = Duration::from_secs(20);

/// Seconds from a signal to the end of a render at 1920 x 1080 that it came upon after so many; `None`: it was killed.
fn seconds_to_end(method: Method, after: f64, (signal, status): (&str, i32)) -> Option<f64> {
    let folder = tempfile::tempdir().expect("a folder");
    let (state, exr) = (path(folder.path(), "s"), path(folder.path(), "a.exr"));
    let mut words = vec!["render", "builtin:water-cornell", "--method", method.name()];
    words.extend([
        "--width", "1920", "--height", "1080", "--time", "1h", "-o", &exr,
    ]);
    words.extend(["--checkpoint", &state]);
    let mut child = Command::new(env!("CARGO_BIN_EXE_kaustik"))
        .args(words)
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command runs");
    std::thread::sleep(Duration::from_secs_f64(after));
    let kill = Command::new("kill")
        .args(["-s", signal, &child.id().to_string()])
        .status();
    assert!(kill.expect("kill runs").success());
    let sent = Instant::now();
    while child.try_wait().expect("a child").is_none() {
        if sent.elapsed() > PATIENCE {
            child.kill().expect("SIGKILL");
            child.wait().expect("it ends");
            return None;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    let seconds = sent.elapsed().as_secs_f64();
    let output = child.wait_with_output().expect("it has ended");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let name = method.name();
    assert_eq!(
        output.status.code(),
        Some(status),
        "{name} after {after} s: {said}"
    );
    let early = said.contains("stopped before the first");
    assert_eq!(
        fs::metadata(&exr).is_err(),
        early,
        "{name} after {after} s: {said}"
    );
    if !said.contains("before the first sample") {
        kaustik::State::read(state.as_ref()).expect("a state");
    }
    Some(seconds)
}

/// SIGINT and SIGTERM in pilots and later: how long until picture and state are there.
#[test]
#[ignore = "minutes"]
fn signals_are_heard_within_two_seconds() {
    let mut late = Vec::new();
    for method in Method::ALL {
        let (int, term) = (("INT", 130), ("TERM", 143));
        let mut worst = Some(0.0_f64);
        for (after, signal) in [(0.3, int), (1.5, term), (4.0, int), (8.0, term)] {
            let Some(so_far) = worst else { break };
            worst = seconds_to_end(method, after, signal).map(|s| s.max(so_far));
        }
        let said = worst.map_or("more than 20".to_owned(), |s| format!("{s:.2}"));
        figures(&format!("{method}: {said} s"));
        if worst.is_none_or(|s| s > 2.0) {
            late.push((method, worst));
        }
    }
    assert!(late.is_empty(), "{late:?}");
}
