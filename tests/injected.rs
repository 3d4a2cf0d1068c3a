//! Faults at the system's calls: killed at each one of a checkpoint, writes and syncs that fail, disks that are full.
//!
//! The full forms inject faults by `strace`, and mount a small disk: they are skipped, with a word, where that is not to be
//! had. The small forms need neither.
#![cfg(target_os = "linux")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use kaustik::State;

use crate::words::{files, kaustik, path};

/// Words of a render whose files take several writes.
fn words<'a>(method: &'a str, spp: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let mut words = vec!["render", "builtin:cornell", "--method", method, "-q"];
    words.extend(["--width", "96", "--spp", spp, "--max-depth", "4"]);
    if method == "pssmlt" {
        words.extend(["--set", "pilot=1000", "--set", "ladders=8"]);
    }
    words.extend(more);
    words
}

fn done(words: &[&str]) {
    let output = kaustik(words);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{words:?}: {said}");
}

/// Says that a test was not run, and why.
#[expect(clippy::print_stderr, reason = "whoever runs the tests is to see it")]
pub(crate) fn skipped(why: &str) {
    eprintln!("SKIPPED: {why}");
}

/// Can strace trace a child here?
pub(crate) fn has_strace() -> bool {
    let traced = Command::new("strace")
        .args(["-qq", "-o", "/dev/null", "true"])
        .stderr(Stdio::null())
        .status();
    let there = traced.is_ok_and(|status| status.success());
    if !there {
        skipped("strace is not there, or may not trace");
    }
    there
}

/// The command under strace, with its words; the main thread alone, which is the one that writes.
fn traced(strace: &[&str], words: &[&str]) -> Output {
    Command::new("strace")
        .args(["-qq", "-s", "256"])
        .args(strace)
        .arg(env!("CARGO_BIN_EXE_kaustik"))
        .args(words)
        .output()
        .expect("strace runs")
}

/// A system call: its name, and which of that name it is, from 1.
type Call = (String, usize);

/// Calls of the main thread that write the file of this name, from the first look at its place to the sync of its folder. Calls
/// whose number hangs on other threads are left out.
fn calls(trace: &str, file: &str) -> Vec<Call> {
    let mut counts = std::collections::BTreeMap::<&str, usize>::new();
    let mut all: Vec<(Call, &str)> = Vec::new();
    for line in trace.lines() {
        let Some((name, _)) = line.split_once('(') else {
            continue;
        };
        let count = counts.entry(name).or_default();
        *count += 1;
        all.push(((name.to_owned(), *count), line));
    }
    let renamed = format!("\"{file}\"");
    let rename = all.iter().position(|((name, _), line)| {
        name.starts_with("rename") && line.contains(".kaustik-") && line.contains(&renamed)
    });
    let rename = rename.unwrap_or_else(|| panic!("{file} was not written: {trace}"));
    let begin = all[..rename]
        .iter()
        .rposition(|((name, _), line)| name == "readlink" && line.contains(&renamed));
    let syncs = all[rename..]
        .iter()
        .position(|((name, _), _)| name == "fsync");
    let end = rename + syncs.expect("the folder is synced") + 2;
    let timely = [
        "futex",
        "sched_yield",
        "madvise",
        "brk",
        "mmap",
        "munmap",
        "mprotect",
    ];
    all[begin.expect("a look at its place")..end.min(all.len())]
        .iter()
        .map(|(call, _)| call.clone())
        .filter(|(name, _)| !timely.contains(&name.as_str()))
        .collect()
}

/// Killed before each call of the second checkpoint: what is there is the first state or the second, and goes on to the
/// picture of an uninterrupted render.
#[test]
#[ignore = "a minute, with strace"]
fn killed_at_every_call_of_a_checkpoint() {
    if !has_strace() {
        return;
    }
    for method in ["path", "light", "bdpt", "pssmlt", "mmlt"] {
        let folder = tempfile::tempdir().expect("a folder");
        let file = |name: &str| path(folder.path(), name);
        let (first, state, trace) = (file("first"), file("state"), file("trace"));
        let (whole, resumed) = (file("whole.exr"), file("resumed.exr"));
        done(&words(method, "1", &["--checkpoint", &first]));
        done(&words(method, "3", &["--no-features", "-o", &whole]));
        let whole = fs::read(&whole).expect("a picture");
        let more = ["--resume", first.as_str(), "--checkpoint", &state];
        let second = words(method, "2", &more);
        fs::copy(&first, &state).expect("a copy");
        assert!(traced(&["-o", &trace], &second).status.success());
        let calls = calls(&fs::read_to_string(&trace).expect("a trace"), &state);
        let writes = calls.iter().filter(|(name, _)| name == "write").count();
        assert!(writes > 2, "{method}: {calls:?}");
        let old = fs::read(&first).expect("a state");
        let (mut olds, mut news) = (0, 0);
        for (name, which) in &calls {
            fs::copy(&first, &state).expect("a copy");
            let inject = format!("inject={name}:signal=KILL:when={which}");
            let output = traced(&["-o", "/dev/null", "-e", &inject], &second);
            assert!(
                !output.status.success(),
                "{method}: not killed at {name} {which}"
            );
            let there = fs::read(&state).expect("a state");
            State::from_bytes(there.clone()).expect("one that loads");
            match there == old {
                true => olds += 1,
                false => news += 1,
            }
            done(&words(
                method,
                "3",
                &["--no-features", "--resume", &state, "-o", &resumed],
            ));
            let resumed = fs::read(&resumed).expect("a picture");
            assert!(
                pixels(&resumed) == pixels(&whole),
                "{method}: {name} {which}"
            );
        }
        assert!(olds > 3 && news > 0, "{method}: {olds} {news}");
        figures(&format!(
            "{method}: {} calls, {olds} old, {news} new",
            calls.len()
        ));
    }
}

/// Figures of a campaign, for whoever keeps them.
#[expect(
    clippy::print_stderr,
    reason = "figures of a campaign that is run by name"
)]
pub(crate) fn figures(line: &str) {
    eprintln!("{line}");
}

/// The values of a picture: its metadata has times.
fn pixels(bytes: &[u8]) -> Vec<u32> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.exr");
    fs::write(&file, bytes).expect("a file");
    let limits = kaustik::film::Limits::default();
    let image = kaustik::film::read(&file, &limits, kaustik::film::Keep::All);
    crate::bits::bits(&image.expect("a picture"))
}

/// Does this folder hold these files, with nothing beside them?
fn only(folder: &Path, names: &[&str]) {
    assert_eq!(files(folder), names);
}

/// Each call that writes a picture or a state fails once: status 1 and a reason, the old file to the byte, nothing beside it. But a
/// file that may not take its name stays, whole, under another; and that the folder cannot be opened to sync it is no failure.
#[test]
#[ignore = "a minute, with strace"]
fn writes_and_syncs_that_fail() {
    if !has_strace() {
        return;
    }
    let outside = tempfile::tempdir().expect("a folder");
    let trace = path(outside.path(), "trace");
    for (word, name) in [
        ("-o", "a.exr"),
        ("--png", "a.png"),
        ("--checkpoint", "a.state"),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        let file = path(folder.path(), name);
        let words = words("path", "1", &[word, &file]);
        done(&words);
        let old = fs::read(&file).expect("a file");
        assert!(traced(&["-o", &trace], &words).status.success());
        let calls = calls(&fs::read_to_string(&trace).expect("a trace"), &file);
        fs::write(&file, &old).expect("a file");
        let mut failed = 0;
        for (call, which) in &calls {
            let error = match call.as_str() {
                "write" | "openat" | "renameat" | "rename" => "ENOSPC",
                "fsync" => "EIO",
                _ => continue,
            };
            let inject = format!("inject={call}:error={error}:when={which}");
            let output = traced(&["-o", "/dev/null", "-e", &inject], &words);
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            let rename = calls
                .iter()
                .rposition(|(name, _)| name.starts_with("rename"));
            let late = calls.iter().position(|c| (&c.0, c.1) == (call, *which)) > rename;
            if late && call == "openat" {
                // A folder that may not be read: the file has its name all the same.
                assert_eq!(output.status.code(), Some(0), "{name} {inject}: {said}");
                fs::write(&file, &old).expect("a file");
                continue;
            }
            assert_eq!(output.status.code(), Some(1), "{name} {inject}: {said}");
            let place = folder.path().to_str().expect("a path");
            assert!(said.contains(place), "{name} {inject}: {said}");
            if call.starts_with("rename") {
                let kept = files(folder.path());
                let kept = kept
                    .iter()
                    .find(|kept| *kept != name)
                    .expect("all of it, kept");
                assert!(said.contains(kept), "{name} {inject}: {said}");
                let kept = folder.path().join(kept);
                assert_eq!(fs::read(&kept).expect("a file").len(), old.len(), "{said}");
                fs::remove_file(kept).expect("a file");
            }
            // After the rename the new file is whole; that it will stay is not known.
            let there = fs::read(&file).expect("a file");
            if late {
                assert_eq!(there.len(), old.len(), "{name} {inject}");
                fs::write(&file, &old).expect("a file");
            } else {
                assert!(there == old, "{name} {inject}");
            }
            only(folder.path(), &[name]);
            failed += 1;
        }
        assert!(failed > 4, "{name}: {calls:?}");
        figures(&format!("{name}: {failed} calls failed, one at a time"));
    }
}

/// A disk of a megabyte that fills up: the state that fits is kept, the one that does not costs nothing but itself.
#[test]
#[ignore = "mounts a disk"]
fn a_small_disk_fills_up() {
    let outside = tempfile::tempdir().expect("a folder");
    let disk = outside.path().join("disk");
    fs::create_dir(&disk).expect("a folder");
    let mounted = Command::new("mount")
        .args(["-t", "tmpfs", "-o", "size=1m", "none"])
        .arg(&disk)
        .stderr(Stdio::null())
        .status();
    if !mounted.is_ok_and(|status| status.success()) {
        return skipped("no disk may be mounted here");
    }
    let result = std::panic::catch_unwind(|| fill_up(&disk));
    let unmounted = Command::new("umount").arg(&disk).status();
    assert!(unmounted.expect("umount runs").success());
    if let Err(panic) = result {
        std::panic::resume_unwind(panic);
    }
}

fn fill_up(disk: &Path) {
    let file = |name: &str| path(disk, name);
    let (state, exr, png) = (file("a.state"), file("a.exr"), file("a.png"));
    // A state of some 15 bytes a pixel fits once, but not twice: the old one stays.
    let big = |spp: &'static str, more: &[&str]| {
        let mut words = vec![
            "render",
            "builtin:cornell",
            "--method",
            "path",
            "-q",
            "--width",
            "210",
        ];
        words.extend(["--spp", spp, "--max-depth", "4"]);
        words.extend(more);
        kaustik(&words)
    };
    assert!(big("1", &["--checkpoint", &state]).status.success());
    let old = fs::read(&state).expect("a state");
    assert!(old.len() > 1 << 19, "{}", old.len());
    let output = big(
        "2",
        &[
            "--checkpoint",
            &state,
            "--resume",
            &state,
            "-o",
            &exr,
            "--png",
            &png,
        ],
    );
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("No space left"), "{said}");
    assert!(fs::read(&state).expect("a state") == old);
    for picture in [&exr, &png] {
        if let Ok(bytes) = fs::read(picture) {
            let limits = kaustik::film::Limits::default();
            let whole = kaustik::film::read(Path::new(picture), &limits, kaustik::film::Keep::All);
            assert!(
                picture.ends_with("png") || whole.is_ok(),
                "{picture}: {}",
                bytes.len()
            );
        }
    }
    let left = fs::read_dir(disk).expect("a folder");
    let left: Vec<_> = left
        .map(|entry| entry.expect("an entry").file_name())
        .collect();
    assert!(
        left.iter()
            .all(|name| !name.to_string_lossy().contains(".tmp")),
        "{left:?}"
    );
}

/// Without tools: the system lets a file grow to so many bytes and no further. No file is cut short, old ones stay to the
/// byte, and the status is 1.
#[test]
fn files_that_may_not_grow() {
    for (word, name) in [
        ("-o", "a.exr"),
        ("--png", "a.png"),
        ("--checkpoint", "a.state"),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        let file = path(folder.path(), name);
        let words = words("path", "1", &[word, &file]);
        done(&words);
        let old = fs::read(&file).expect("a file");
        let blocks = old.len() as u64 / 512;
        assert!(blocks > 3, "{name}");
        for limit in [0, 1, blocks / 2, blocks - 1] {
            // The signal of the limit is ignored: the write fails.
            let script = format!("trap '' XFSZ; ulimit -f {limit}; exec \"$@\"");
            let output = Command::new("sh")
                .args(["-c", &script, "sh", env!("CARGO_BIN_EXE_kaustik")])
                .args(&words)
                .output()
                .expect("a shell");
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(1), "{name} {limit}: {said}");
            assert!(said.contains("File too large"), "{name} {limit}: {said}");
            assert!(fs::read(&file).expect("a file") == old, "{name} {limit}");
            only(folder.path(), &[name]);
        }
    }
}
