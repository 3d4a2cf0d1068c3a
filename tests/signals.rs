//! What a render leaves that is told to stop, or to show what it has.
#![cfg(unix)]

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use crate::child::{ENDLESS, begin, signal, wait_for};
use crate::kept::{done, picture, told, words};
use crate::words::path;

#[test]
fn signals_write_state_and_image() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| path(folder.path(), name);
    for (name, status) in [("INT", 130), ("TERM", 143)] {
        let (state, part) = (file(name), file("part.exr"));
        let more = [
            "--checkpoint",
            &state,
            "--checkpoint-every",
            "100ms",
            "-o",
            &part,
        ];
        let mut child = begin(&words("pssmlt", ENDLESS, &more));
        wait_for(&state, None);
        signal(&child, name);
        let sent = Instant::now();
        assert_eq!(child.wait().expect("it ends").code(), Some(status));
        assert!(sent.elapsed() < Duration::from_secs(10));
        assert!(!picture(&part).is_empty());
        // Picture and state are of one moment: resumed without anything left to do, the state is that picture.
        let again = file("again.exr");
        let small = ["--resume", &state, "-o", &again];
        done(&words("pssmlt", "1", &small));
        assert!(picture(&again) == picture(&part), "{name}");
    }
}

#[test]
fn hanging_up_writes_both_and_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| path(folder.path(), name);
    let (state, part) = (file("s"), file("part.exr"));
    let more = [
        "--checkpoint",
        &state,
        "--checkpoint-every",
        "150ms",
        "-o",
        &part,
    ];
    let mut child = begin(&words("pssmlt", ENDLESS, &more));
    wait_for(&state, None);
    assert!(!Path::new(&part).exists());
    signal(&child, "HUP");
    let first = wait_for(&part, None);
    signal(&child, "HUP");
    wait_for(&part, Some(&first));
    assert!(child.try_wait().expect("a child").is_none(), "it goes on");
    signal(&child, "TERM");
    assert_eq!(child.wait().expect("it ends").code(), Some(143));
}

/// Of a large picture all that takes long to write is left to the state.
#[test]
fn a_large_picture_is_written_soon() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| path(folder.path(), name);
    let (state, part, whole) = (file("s"), file("part.exr"), file("whole.exr"));
    let mut words = vec![
        "render",
        "builtin:cornell",
        "--method",
        "relt",
        "--spp",
        ENDLESS,
    ];
    // Twelve planes of it are more than eight million samples.
    words.extend(["--width", "900", "--height", "900", "--max-depth", "4"]);
    words.extend(["--set", "particles=1000", "-o", &part]);
    words.extend(["--checkpoint", &state, "--checkpoint-every", "100ms"]);
    let child = begin(&words);
    wait_for(&state, None);
    signal(&child, "TERM");
    let output = child.wait_with_output().expect("it ends");
    let said = told(&output);
    assert_eq!(output.status.code(), Some(143), "{said}");
    assert!(said.contains(&format!("`kaustik merge {state}`")), "{said}");
    let small = picture(&part);
    assert_eq!(small.len(), 1, "the picture itself alone");
    done(&["merge", &state, "-o", &whole]);
    let all = picture(&whole);
    assert!(all.len() > 3, "its replicas too: {:?}", all.keys());
    let (name, pixels) = small.first_key_value().expect("a layer");
    assert!(all.get(name) == Some(pixels), "the same picture");
}

/// Before the first sample there is nothing to write: a signal ends the render at once, and leaves nothing, not even a lock.
#[test]
fn a_signal_in_a_pilot_leaves_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let (exr, lock) = (
        path(folder.path(), "a.exr"),
        path(folder.path(), ".a.exr.lock"),
    );
    for (name, status) in [("INT", 130), ("TERM", 143)] {
        let mut words = vec!["render", "builtin:cornell", "--method", "pssmlt"];
        words.extend(["--set", "pilot=10000000", "--threads", "1", "-o", &exr]);
        let child = begin(&words);
        wait_for(&lock, None);
        // Loading takes no time, the pilot many seconds.
        std::thread::sleep(Duration::from_millis(500));
        let sent = Instant::now();
        signal(&child, name);
        let output = child.wait_with_output().expect("it ends");
        assert!(sent.elapsed() < Duration::from_secs(2));
        assert_eq!(output.status.code(), Some(status));
        let said = told(&output);
        assert!(said.contains("before the first sample"), "{said}");
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 0);
    }
}

/// A pass or iteration that a signal breaks off is taken back: the state is that of whole ones, or of none, and goes on to the
/// picture of a render that nothing interrupted.
#[test]
fn a_broken_pass_is_taken_back() {
    broken_passes("bdpt", "400", "heuristic=power");
    broken_passes("erpt", "48", "chains=1");
    broken_passes("photon-spatial", "64", "photons=200000");
}

fn broken_passes(method: &str, width: &str, set: &str) {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| path(folder.path(), name);
    let (state, whole, through) = (file("s"), file("whole.exr"), file("through.exr"));
    let words = |spp: &'static str, more: &[&str]| -> Vec<String> {
        let mut words = vec![
            "render",
            "builtin:cornell",
            "--method",
            method,
            "--spp",
            spp,
        ];
        words.extend([
            "--width",
            width,
            "--max-depth",
            "4",
            "--no-features",
            "--set",
            set,
        ]);
        words.extend(more);
        words.into_iter().map(str::to_owned).collect()
    };
    let run = |words: &[String]| done(&words.iter().map(String::as_str).collect::<Vec<_>>());
    run(&words("3", &["-o", &through]));
    let mut states = 0;
    // The longest for machines that are busy with other things.
    for wait in [60, 300, 1500, 10_000, 60_000] {
        if wait > 1500 && states > 0 {
            break;
        }
        // As many passes as of the whole: a fast machine takes no more, and may be done before the signal.
        let part = words("3", &["--checkpoint", &state, "--threads", "1"]);
        let child = begin(&part.iter().map(String::as_str).collect::<Vec<_>>());
        std::thread::sleep(Duration::from_millis(wait));
        signal(&child, "INT");
        let output = child.wait_with_output().expect("it ends");
        let status = output.status.code();
        assert!(matches!(status, Some(0 | 130)), "{}", told(&output));
        if Path::new(&state).exists() {
            states += 1;
            run(&words("3", &["--resume", &state, "-o", &whole]));
            assert!(
                picture(&whole) == picture(&through),
                "{method} after {wait} ms"
            );
            fs::remove_file(&state).expect("a state");
        }
    }
    assert!(states > 0, "{method}");
}
