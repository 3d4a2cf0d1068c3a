//! The tool itself: a small campaign is clean, and planted faults are seen.

use std::process::{Command, Output};

fn fuzz(words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_kaustik-fuzz"))
        .args(words)
        .output()
        .expect("the tool runs")
}

#[test]
fn a_small_campaign_is_clean() {
    let folder = tempfile::tempdir().expect("a folder");
    let keep = folder.path().join("broken");
    let output = fuzz(&["--files", "12", "--keep", keep.to_str().expect("a path")]);
    let table = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{table}");
    assert_eq!(table.lines().count(), 7, "{table}");
    assert!(!keep.exists());
}

#[test]
#[cfg(target_os = "linux")]
fn planted_faults_are_seen() {
    let folder = tempfile::tempdir().expect("a folder");
    let keep = folder.path().join("broken");
    for (kind, column) in [
        ("planted-panic", 4),
        ("planted-abort", 5),
        ("planted-hang", 6),
        ("planted-hunger", 5),
    ] {
        let keep = keep.to_str().expect("a path");
        let output = fuzz(&["--files", "1", "--kind", kind, "--keep", keep]);
        let table = String::from_utf8_lossy(&output.stdout).into_owned();
        assert_eq!(output.status.code(), Some(1), "{table}");
        let row = table.lines().nth(1).expect("a row");
        let cell = row.split_whitespace().nth(column);
        assert_eq!(cell, Some("1"), "{kind}: {table}");
    }
    assert_eq!(std::fs::read_dir(&keep).expect("kept files").count(), 4);
}
