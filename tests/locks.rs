//! Two commands on one output.
#![cfg(unix)]

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::words::{files, kaustik, path, refused};

/// A render that does not end by itself, once it holds its locks.
fn at_work(words: &[&str], lock: &str) -> Child {
    let mut all = vec![
        "render",
        "builtin:cornell",
        "--method",
        "path",
        "--width",
        "16",
    ];
    all.extend(["--time", "1h", "-q"]);
    all.extend(words);
    let child = Command::new(env!("CARGO_BIN_EXE_kaustik"))
        .args(all)
        .stderr(Stdio::null())
        .spawn()
        .expect("the command runs");
    let start = Instant::now();
    let signed = || fs::read_to_string(lock).is_ok_and(|text| text.ends_with('\n'));
    while !signed() {
        assert!(start.elapsed() < Duration::from_secs(60), "no {lock}");
        std::thread::sleep(Duration::from_millis(5));
    }
    child
}

fn small<'a>(words: &[&'a str]) -> Vec<&'a str> {
    let mut all = vec![
        "render",
        "builtin:cornell",
        "--method",
        "path",
        "--width",
        "8",
    ];
    all.extend(["--spp", "1"]);
    all.extend(words);
    all
}

#[test]
fn a_second_process_on_an_output_is_refused() {
    for (word, name) in [
        ("-o", "a.exr"),
        ("--png", "a.png"),
        ("--checkpoint", "a.state"),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        let file = path(folder.path(), name);
        let lock = path(folder.path(), &format!(".{name}.lock"));
        let mut child = at_work(&[word, &file], &lock);
        let holder = format!("process {} is writing it", child.id());
        refused(&small(&[word, &file]), &[&file, &holder]);
        // By any of its names, and for any purpose.
        let winding = path(
            folder.path(),
            &format!("../{}/{name}", {
                folder.path().file_name().expect("a name").to_string_lossy()
            }),
        );
        refused(&small(&["--stats", &winding]), &[&holder]);
        // Another output is free, also in this folder, and the first goes on undisturbed.
        let other = path(folder.path(), "b.exr");
        assert!(kaustik(&small(&["-o", &other])).status.success());
        assert!(child.try_wait().expect("a child").is_none(), "{word}");
        // A killed process holds nothing, though its lock file is still there.
        child.kill().expect("SIGKILL");
        child.wait().expect("it ends");
        assert!(Path::new(&lock).exists());
        let output = kaustik(&small(&[word, &file]));
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        assert_eq!(files(folder.path()), [name, "b.exr"], "{word}");
    }
}

#[test]
fn locks_go_when_a_render_ends_or_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| path(folder.path(), name);
    let (exr, link, state) = (file("a.exr"), file("link.png"), file("s"));
    assert!(
        kaustik(&small(&["-o", &exr, "--checkpoint", &state]))
            .status
            .success()
    );
    assert_eq!(files(folder.path()), ["a.exr", "s"]);
    let missing = file("missing");
    refused(
        &small(&["-o", &exr, "--resume", &missing]),
        &["cannot be read"],
    );
    assert_eq!(files(folder.path()), ["a.exr", "s"]);
    refused(
        &small(&["-o", &exr, "--checkpoint", &exr]),
        &["two outputs of this command"],
    );
    std::os::unix::fs::symlink(&exr, &link).expect("a link");
    refused(
        &small(&["-o", &exr, "--png", &link]),
        &["two outputs of this command"],
    );
    assert_eq!(files(folder.path()), ["a.exr", "link.png", "s"]);
    // What is no file has none.
    assert!(
        kaustik(&small(&["-o", "/dev/null", "--png", "/dev/null"]))
            .status
            .success()
    );
    // SIGTERM ends a render as its end does.
    let mut child = at_work(&["-o", &exr], &file(".a.exr.lock"));
    let kill = Command::new("kill")
        .args(["-s", "TERM", &child.id().to_string()])
        .status();
    assert!(kill.expect("kill runs").success());
    assert_eq!(child.wait().expect("it ends").code(), Some(143));
    assert_eq!(files(folder.path()), ["a.exr", "link.png", "s"]);
}

/// Of many that begin at once, each is alone or refused: the picture is never written by two.
#[test]
fn of_many_at_once_none_is_beside_another() {
    let folder = tempfile::tempdir().expect("a folder");
    let exr = path(folder.path(), "a.exr");
    let mut children: Vec<Child> = (0..8)
        .map(|_| {
            Command::new(env!("CARGO_BIN_EXE_kaustik"))
                .args(small(&["-o", &exr]))
                .stderr(Stdio::null())
                .spawn()
                .expect("the command runs")
        })
        .collect();
    let codes: Vec<_> = (children.iter_mut())
        .map(|child| child.wait().expect("it ends").code())
        .collect();
    assert!(
        codes.iter().all(|code| matches!(code, Some(0 | 2))),
        "{codes:?}"
    );
    assert!(codes.contains(&Some(0)), "{codes:?}");
    assert_eq!(files(folder.path()), ["a.exr"]);
}
